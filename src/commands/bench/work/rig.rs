//! Recordings of a strut on a rig: the motion of a rough road in small, all valves switched, and noise on every column.

use std::f64::consts::TAU;

use oleo_diagnose::recording::Recording;
use oleo_diagnose::selftest::Draw;
use oleo_interface::StrutValves;
use oleo_plant_sim::strut::{COLUMNS, GasChargeError, Inputs, StrutModel, replay};

use crate::failure::Failure;

/// Load of the strut, N.
const LOAD_N: f64 = 8000.0;
/// Sampling interval, s.
const INTERVAL_S: f64 = 0.005;
/// Sines of each recording: amplitude, m, and frequency, Hz.
const SINES: [[(f64, f64); 3]; 2] = [
    [(0.020, 0.31), (0.008, 1.3), (0.002, 4.1)],
    [(0.015, 0.23), (0.010, 0.9), (0.003, 3.3)],
];
/// Times for which each valve holds its signal, s.
const HOLDS_S: [f64; 3] = [1.1, 1.7, 2.3];
/// More gas in the second accumulator than the model says.
const CHARGE_ERROR: f64 = 0.1;
/// How far the numbers of the model may be off, which calibration corrects.
const TOLERANCES: [(&str, f64); 3] = [
    ("static_gas_volume", 0.02),
    ("flow_coefficient", 0.03),
    ("pressure_offset_Pa", 1e4),
];

/// The model that is believed.
pub fn believed() -> StrutModel {
    let mut model = StrutModel::defender110(LOAD_N);
    let tolerances = TOLERANCES.map(|(what, size)| (what.to_owned(), size));
    model.tolerance.extend(tolerances);
    model
}

/// Two recordings with so many samples together.
pub fn recordings(samples: u64) -> Result<Vec<Recording>, Failure> {
    let mut truth = believed();
    truth.effects.gas_charge_error = Some(GasChargeError {
        relative_error_1: 0.0,
        relative_error_2: CHARGE_ERROR,
    });
    let each = (samples / SINES.len() as u64) as usize;
    (SINES.iter().enumerate())
        .map(|(k, sines)| recording(&truth, &format!("road-{}", k + 1), each, sines))
        .collect()
}

fn recording(truth: &StrutModel, name: &str, samples: usize, sines: &[(f64, f64)]) -> Result<Recording, Failure> {
    let time_s: Vec<f64> = (0..samples).map(|k| INTERVAL_S * k as f64).collect();
    let position = |t: &f64| -> f64 { sines.iter().map(|(size, hz)| size * libm::sin(TAU * hz * t)).sum() };
    let displacement_m: Vec<f64> = time_s.iter().map(position).collect();
    let is_open = |t: f64| HOLDS_S.map(|hold| ((t / hold) as u64).is_multiple_of(2));
    let signals: Vec<StrutValves<bool>> = time_s.iter().map(|t| StrutValves::from_array(is_open(*t))).collect();
    let noise = |column: &str| truth.noise.get(column).copied().unwrap_or(0.0);
    // The truth is simulated with the true motion, of which nothing is to be smoothed away.
    let out = replay(truth, &Inputs::from_recording(&time_s, &displacement_m, &signals, 1e-9))?;
    let mut draw = Draw::named(name);
    let mut columns = vec![displacement_m, out.force_n];
    columns.extend(out.pressure_pa);
    for (column, name) in columns.iter_mut().zip(COLUMNS) {
        let size = noise(name);
        column.iter_mut().for_each(|value| *value += size * draw.normal());
    }
    columns.extend((0..HOLDS_S.len()).map(|valve| {
        let signal = |t: &f64| f64::from(u8::from(is_open(*t)[valve]));
        time_s.iter().map(signal).collect()
    }));
    Ok(Recording {
        name: name.to_owned(),
        time_s,
        columns,
        notes: Vec::new(),
    })
}
