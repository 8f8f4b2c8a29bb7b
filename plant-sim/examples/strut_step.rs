//! Measures the cost of a strut's step, term by term: `cargo run --release -p oleo-plant-sim --example strut_step`.
//!
//! One strut of the preset driven as a vehicle on a rough road drives it, 1 ms steps, best of five runs. Ratios are
//! what to read. With a number of steps as argument it runs once with the whole preset only: the difference of two such
//! runs under `valgrind --tool=callgrind` is the instruction count.

use std::time::Instant;

use oleo_interface::StrutValves;
use oleo_plant_sim::strut::{Effects, Strut, StrutModel};

const STEPS: usize = 40_000;

fn nanoseconds(model: &StrutModel, steps: usize, runs: usize) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..runs {
        let Ok(mut strut) = Strut::at_rest(model, StrutValves::from_array([true; 3])) else {
            return f64::NAN;
        };
        let mut before = 0.0;
        let begin = Instant::now();
        for i in 1..=steps {
            let t = 1e-3 * i as f64;
            // Triangle waves of 1.3 and 9 Hz: no sine to pay for.
            let triangle = |hertz: f64| ((t * hertz).fract() - 0.5).abs() - 0.25;
            let speed_step = 0.12 * triangle(1.3) + 0.02 * triangle(9.0) + 0.025;
            let soft = i % 2000 < 1200;
            std::hint::black_box(strut.advance_with_speeds(
                speed_step,
                before,
                (speed_step - strut.displacement_m()) / 1e-3,
                1e-3,
                StrutValves::new(i % 500 < 250, true, soft),
            ));
            before = (speed_step - strut.displacement_m()) / 1e-3;
        }
        best = best.min(begin.elapsed().as_secs_f64() / steps as f64 * 1e9);
    }
    best
}

fn main() {
    let full = StrutModel::defender110(5000.0);
    if let Some(steps) = std::env::args().nth(1).and_then(|a| a.parse().ok()) {
        println!("{:.0} ns a step", nanoseconds(&full, steps, 1));
        return;
    }
    let mut model = full.clone();
    model.effects = Effects::default();
    let report = |what: &str, model: &StrutModel| println!("{what:34} {:6.0} ns a step", nanoseconds(model, STEPS, 5));
    report("no term", &model);
    model.effects.oil_compressibility = full.effects.oil_compressibility.clone();
    report("+ oil compressibility", &model);
    model.effects.gas_heat_transfer = full.effects.gas_heat_transfer.clone();
    report("+ gas heat transfer", &model);
    model.effects.valve_transition = full.effects.valve_transition.clone();
    report("+ valve transition", &model);
    model.effects.seal_friction = full.effects.seal_friction.clone();
    report("+ seal friction", &model);
    model.effects.entrained_air = full.effects.entrained_air.clone();
    report("+ entrained air", &model);
    report("+ real nitrogen, stops: the preset", &full);
}
