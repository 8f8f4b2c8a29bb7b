//! A step of one strut: 1 ms of a sine of 20 mm at 1.5 Hz.

use std::f64::consts::TAU;

use divan::Bencher;
use oleo_interface::StrutValves;
use oleo_plant_sim::strut::{Strut, StrutModel};

const STEP_S: f64 = 1e-3;
/// Steps of a half period of the valves' signals where they are switched.
const STEPS_OF_A_HALF: u64 = 100;

fn step(bencher: Bencher, signals: impl Fn(u64) -> StrutValves<bool>) {
    let model = StrutModel::defender110(8000.0);
    let mut strut = Strut::at_rest(&model, signals(0)).expect("the preset");
    let mut steps = 0_u64;
    bencher.bench_local(|| {
        steps += 1;
        let displacement_m = 0.02 * libm::sin(TAU * 1.5 * STEP_S * steps as f64);
        strut.advance(displacement_m, STEP_S, signals(steps))
    });
}

/// Stiff spring and high damping.
#[divan::bench]
fn strut_step(bencher: Bencher) {
    step(bencher, |_| StrutValves::new(false, false, false));
}

/// All valves switched every 100 ms, so that one is moving in most steps.
#[divan::bench]
fn strut_step_while_valves_move(bencher: Bencher) {
    step(bencher, |steps| {
        let open = (steps / STEPS_OF_A_HALF).is_multiple_of(2);
        StrutValves::new(open, open, open)
    });
}
