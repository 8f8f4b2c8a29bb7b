//! One strut, one motion, by our solver and by a library's: what `tests/side_by_side.py` times beside SciPy's solvers.
//!
//! `strut_by_solvers model` prints the model's file. `strut_by_solvers oleo CASE STEPS REPEATS OUT` and `strut_by_solvers bdf CASE TOLERANCE REPEATS OUT`
//! solve the case so often, print the calls of the right-hand side in one of the repeats, and write p1 to p4 of all samples to OUT (doubles, little
//! endian). Whoever calls it measures the processor time. `strut_by_solvers exact CASE - 1 OUT` does so with a tolerance of 1e-11, and `strut_by_solvers right-hand-side CASE - REPEATS -` makes
//! a million calls a repeat; `motion` instead of it computes the motion alone. CASE is a number from 0.

#[path = "../../../plant-sim/tests/plain_strut/mod.rs"]
mod plain_strut;

use std::hint::black_box;

use diffsol::{MatrixCommon, NalgebraLU, NalgebraMat, OdeBuilder, OdeSolverMethod};
use plain_strut::{CASES, Middle, PlainStrut, Pressures, SAMPLES, displacement, model, of_strut, times};

/// Tolerance of what the others are held against.
const EXACT: f64 = 1e-11;
/// Calls in a repeat.
const CALLS: u32 = 1_000_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let model = model();
    let [what, case, setting, repeats, out] = words[..] else {
        print!("{}", model.to_toml());
        return Ok(());
    };
    let case = *CASES.get(case.parse::<usize>()?).ok_or("CASE is 0, 1 or 2")?;
    let repeats: usize = repeats.parse()?;
    let plain = PlainStrut::of(&model, case, Middle::Newton);
    match what {
        "oleo" => {
            let steps = setting.parse()?;
            let pressures = repeated(repeats, || of_strut(&model, case, steps));
            write(out, &pressures)?;
        }
        "bdf" => {
            let tolerance = setting.parse()?;
            let pressures = repeated(repeats, || by_bdf(&plain, tolerance));
            println!("calls {}", plain.calls() / repeats.max(1) as u64);
            write(out, &pressures)?;
        }
        "exact" => write(out, &by_bdf(&PlainStrut::of(&model, case, Middle::Bisection), EXACT))?,
        "motion" => {
            repeated(repeats, || {
                for call in 0..CALLS {
                    black_box(displacement(3.0 * f64::from(call) / f64::from(CALLS)));
                }
                Vec::new()
            });
            println!("calls {CALLS}");
        }
        "right-hand-side" => {
            let (state, mut slope) = (plain.start(), [0.0; 5]);
            repeated(repeats, || {
                for call in 0..CALLS {
                    let t = 3.0 * f64::from(call) / f64::from(CALLS);
                    plain.derivative(t, black_box(&state), &mut slope);
                    black_box(&slope);
                }
                Vec::new()
            });
            println!("calls {CALLS}");
        }
        _ => return Err(format!("{what}: give model, oleo, bdf, exact, motion or right-hand-side").into()),
    }
    Ok(())
}

/// The pressures at all samples by diffsol's BDF with a relative and absolute tolerance.
fn by_bdf(strut: &PlainStrut<'_>, tolerance: f64) -> Pressures {
    let problem = OdeBuilder::<NalgebraMat<f64>>::new()
        .rtol(tolerance)
        .atol([tolerance])
        .h0(1e-6)
        .rhs_implicit(
            |y: &[f64], _p: &[f64], t: f64, out: &mut [f64]| strut.derivative(t, y, out),
            |y: &[f64], _p: &[f64], t: f64, direction: &[f64], out: &mut [f64]| {
                // Central difference along the direction.
                let e = 1e-6;
                let shifted = |s: f64| -> Vec<f64> { y.iter().zip(direction).map(|(y, d)| y + s * e * d).collect() };
                let (mut up, mut down) = (vec![0.0; 5], vec![0.0; 5]);
                strut.derivative(t, &shifted(1.0), &mut up);
                strut.derivative(t, &shifted(-1.0), &mut down);
                out.iter_mut()
                    .zip(up.iter().zip(&down))
                    .for_each(|(o, (u, d))| *o = (u - d) / (2.0 * e));
            },
        )
        .init(
            |_p: &[f64], _t: f64, y: &mut [f64]| y.copy_from_slice(&strut.start()),
            5,
        )
        .build()
        .unwrap();
    let times = times();
    let mut solver = problem.bdf::<NalgebraLU<f64>>().unwrap();
    let (states, _) = solver.solve_dense(&times).unwrap();
    assert_eq!(states.ncols(), SAMPLES);
    (times.iter().enumerate())
        .map(|(k, t)| strut.pressures(*t, states.inner().column(k).as_slice()))
        .collect()
}

/// Does the work so often.
fn repeated(repeats: usize, mut work: impl FnMut() -> Pressures) -> Pressures {
    let mut pressures = Pressures::new();
    for _ in 0..repeats {
        pressures = black_box(work());
    }
    pressures
}

fn write(path: &str, pressures: &Pressures) -> std::io::Result<()> {
    let bytes: Vec<u8> = pressures
        .iter()
        .flatten()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    std::fs::write(path, bytes)
}
