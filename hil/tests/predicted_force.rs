//! What the simulated strut does in motions like those of a rough road, for the strategies that predict forces.
//!
//! The controller knows no plant, so the comparison is a file: this test holds it to the plant, and a test in
//! `controller/src/strategy/parts/strut_force.rs` holds the prediction to the file. `OLEO_BLESS=1 cargo test -p oleo-hil --test predicted_force`
//! rewrites it after an intended change of the plant.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use oleo_interface::StrutValves;
use oleo_plant_sim::strut::{Strut, StrutModel};

const FILE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../controller/src/strategy/parts/strut_force/simulated.csv"
);
/// Static load of a strut of the unladen vehicle, N.
const LOAD_N: f64 = 3923.0;
/// Amplitudes, m, and frequencies, Hz: the body's swing, and the wheel's.
const MOTIONS: [(f64, f64); 2] = [(0.03, 1.5), (0.008, 7.0)];
const STEP_S: f64 = 0.001;

/// A row each eighth of the second period: bypass valves, speed in m/s, gauge pressures in Pa.
fn simulated() -> String {
    let mut text = "open1,open2,speed_m_s,p1_Pa,p2_Pa,p4_Pa\n".to_owned();
    for (one, two) in [(true, true), (false, true), (true, false), (false, false)] {
        for (amplitude_m, frequency_hz) in MOTIONS {
            let signals = StrutValves::new(one, two, true);
            let mut strut = Strut::at_rest(&StrutModel::defender110(LOAD_N), signals).unwrap();
            let period = (1.0 / (frequency_hz * STEP_S)).round() as u32;
            for step in 1..2 * period {
                let phase = TAU * frequency_hz * STEP_S * f64::from(step);
                let out = strut.advance(amplitude_m * libm::sin(phase), STEP_S, signals);
                if step > period && step % (period / 8) == 0 {
                    let speed_m_s = amplitude_m * TAU * frequency_hz * libm::cos(phase);
                    let [p1, p2, _, p4] = out.pressure_pa;
                    let (one, two) = (u8::from(one), u8::from(two));
                    writeln!(text, "{one},{two},{speed_m_s:.4},{p1:.0},{p2:.0},{p4:.0}").unwrap();
                }
            }
        }
    }
    text
}

#[test]
fn the_file_is_what_the_plant_does() {
    let text = simulated();
    if std::env::var_os("OLEO_BLESS").is_some() {
        std::fs::write(FILE, &text).unwrap();
    }
    let kept = std::fs::read_to_string(FILE).unwrap();
    assert_eq!(
        kept, text,
        "{FILE}: if intended, OLEO_BLESS=1 cargo test -p oleo-hil --test predicted_force"
    );
}
