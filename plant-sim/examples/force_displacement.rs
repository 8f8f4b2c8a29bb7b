//! The strut on its own: `cargo run --release -p oleo-plant-sim --example force_displacement [MODEL.toml]`.
//!
//! Prints the force over the displacement of one strut in four settings of its valves, at 10 mm/s (the spring alone, the gas
//! takes 4 s from end to end) and at 0.3 m/s (the dampers on top of it). Start here if the strut is all that you want of this
//! crate; the vehicle, the road and the controller are not needed.

use oleo_interface::StrutValves;
use oleo_plant_sim::strut::{Strut, StrutModel};

/// The ends of the stroke, m: 40 mm of jounce (compression, positive) and 40 mm of rebound.
const STROKE_M: f64 = 0.04;
/// How often the strut is asked for its force, s. The solver takes shorter steps of its own where it needs them.
const INTERVAL_S: f64 = 1e-3;
/// Displacements at which the table has a row, m.
const ROWS_M: [f64; 9] = [-0.04, -0.03, -0.02, -0.01, 0.0, 0.01, 0.02, 0.03, 0.04];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // 1. A model: geometry, gas charges, dampers, valves, and the physical effects that are switched on.
    let model = match std::env::args().nth(1) {
        Some(path) => StrutModel::from_toml(&std::fs::read_to_string(&path)?, &path)?,
        None => StrutModel::defender110(8000.0),
    };
    println!("{}: force in kN, compression positive", model.specimen.name);

    // 2. Valves 1 and 2 bypass the dampers, valve 3 connects the large accumulator. True is open.
    let settings = [
        ("soft spring, low damping", StrutValves::new(true, true, true)),
        ("soft spring, high damping", StrutValves::new(false, false, true)),
        ("stiff spring, low damping", StrutValves::new(true, true, false)),
        ("stiff spring, high damping", StrutValves::new(false, false, false)),
    ];
    for (name, valves) in settings {
        // 3. Each stroke goes from rebound to jounce at one speed, by a strut that begins at rest in rebound.
        let slow = stroke(&model, valves, 0.01)?;
        let fast = stroke(&model, valves, 0.3)?;
        println!("\n{name}\n  {:>6} {:>10} {:>10}", "mm", "0.01 m/s", "0.3 m/s");
        for (x, (slow, fast)) in ROWS_M.iter().zip(slow.iter().zip(&fast)) {
            println!("  {:>6.0} {:>10.2} {:>10.2}", 1e3 * x, 1e-3 * slow, 1e-3 * fast);
        }
    }
    Ok(())
}

/// Force at each row of the table, N, while the strut is compressed at a speed (m/s).
fn stroke(
    model: &StrutModel,
    valves: StrutValves<bool>,
    speed_m_s: f64,
) -> Result<Vec<f64>, Box<dyn std::error::Error>> {
    // A strut at rest: gas at ambient temperature, both accumulators at one pressure.
    let mut strut = Strut::at_rest_at(model, valves, -STROKE_M)?;
    let mut forces = Vec::new();
    let steps = (2.0 * STROKE_M / speed_m_s / INTERVAL_S).round();
    let mut before = (-STROKE_M, strut.output().force_n);
    for k in 0..=steps as usize {
        // 4. Tell it where to be at the end of the step, how long the step takes, and what the valves are commanded; it
        //    answers with the force and the four pressures. Displacement is counted from the static position.
        let x = -STROKE_M + 2.0 * STROKE_M * k as f64 / steps;
        let now = match k {
            0 => before,
            _ => (x, strut.advance(x, INTERVAL_S, valves).force_n),
        };
        // A row lies between two steps or on one of them.
        while let Some(row) = ROWS_M.get(forces.len()).filter(|row| **row <= now.0 + 1e-9) {
            let part = if now.0 > before.0 {
                (row - before.0) / (now.0 - before.0)
            } else {
                1.0
            };
            forces.push(before.1 + part * (now.1 - before.1));
        }
        before = now;
    }
    Ok(forces)
}
