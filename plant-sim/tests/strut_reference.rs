//! The fixed-step strut against a library's solver (Dormand and Prince's of eighth order in `differential-equations`, tolerance 1e-10) on equations that are
//! written independently (`plain_strut`). The strut runs at the recordings' own 2 ms. Asked: 0.1 % of the pressure.

mod plain_strut;

use differential_equations::prelude::{ExplicitRungeKutta, IVP, ODE};
use plain_strut::{CASES, Case, Middle, PlainStrut, Pressures, deviations, model, of_strut, times};

impl ODE<f64, [f64; 5]> for PlainStrut<'_> {
    fn diff(&self, t: f64, y: &[f64; 5], slope: &mut [f64; 5]) {
        self.derivative(t, y, slope);
    }
}

/// The pressures at all samples by the library. From sample to sample, because a polynomial between its steps is far less accurate than their ends where the
/// equations are stiff.
fn by_library(strut: &PlainStrut<'_>) -> Pressures {
    let (mut from_s, mut state) = (0.0, strut.start());
    let at_next = |end_s: f64| {
        let solution = IVP::ode(strut, from_s, end_s, state)
            .method(ExplicitRungeKutta::dop853().rtol(1e-10).atol(1e-10))
            .solve()
            .expect("a solution");
        (from_s, state) = (end_s, *solution.last().expect("a state at the end").1);
        strut.pressures(end_s, &state)
    };
    times().into_iter().map(at_next).collect()
}

fn compare(case: Case) {
    let model = model();
    let exact = by_library(&PlainStrut::of(&model, case, Middle::Bisection));
    assert_eq!(exact.len(), plain_strut::SAMPLES);
    let worst = deviations(&of_strut(&model, case, 1), &exact);
    let Case {
        dampers_open,
        valve3_from_s,
        ..
    } = case;
    println!(
        "dampers open {dampers_open}, valve 3 from {valve3_from_s} s: largest relative deviations of p1..p4 {worst:?}"
    );
    assert!(worst.iter().all(|w| *w < 1e-3), "{worst:?}");
}

#[test]
fn soft_and_low_damping() {
    compare(CASES[0]);
}

#[test]
fn soft_and_high_damping() {
    compare(CASES[1]);
}

#[test]
fn stiff_then_valve_3_opens_away_from_the_static_position() {
    compare(CASES[2]);
}

/// What is timed side by side solves the same equations.
#[test]
fn the_plain_strut_finds_the_same_p3_either_way() {
    let model = model();
    let by = |middle| by_library(&PlainStrut::of(&model, CASES[1], middle));
    let worst = deviations(&by(Middle::Newton), &by(Middle::Bisection));
    assert!(worst.iter().all(|w| *w < 1e-6), "{worst:?}");
}
