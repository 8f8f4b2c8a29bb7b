//! What the dampers of a strut turn into heat, as its pressures show it without a model of the dampers.

use oleo_plant_sim::strut::{ATMOSPHERE_PA, StrutModel};

use super::channels::{Layout, P1, P2, P3, P4};
use crate::recording::Recording;

/// Before and behind each damper, and the gas that the oil which flows through it compresses.
const PATHS: [[usize; 3]; 2] = [[P1, P2, P2], [P1, P3, P4]];

/// Mean power that the oil of each path loses in its damper and beside it, W: what flows is what the gas behind it gives way, at ambient temperature. A third
/// more or less, by which warm gas is stiffer, does not matter here. Errors of offset and gain add work that oil gives back, and cancel.
pub fn of_dampers_w(recording: &Recording, layout: Layout, model: &StrutModel) -> [f64; 2] {
    let static_pa = model.cylinder.static_pressure_pa + ATMOSPHERE_PA;
    std::array::from_fn(|path| {
        let [before, behind, gas] = PATHS[path].map(|channel| recording.columns[layout.column(channel)].as_slice());
        let charge_j = static_pa * model.accumulator[path].static_gas_volume_m3;
        let gas_m3 = |k: usize| charge_j / (gas[k] + ATMOSPHERE_PA);
        let drop_pa = |k: usize| before[k] - behind[k];
        let (mut work_j, mut time_s) = (0.0, 0.0);
        for k in 1..recording.len() {
            let done_j = 0.5 * (drop_pa(k - 1) + drop_pa(k)) * (gas_m3(k - 1) - gas_m3(k));
            if done_j.is_finite() {
                work_j += done_j;
                time_s += recording.time_s[k] - recording.time_s[k - 1];
            }
        }
        if time_s > 0.0 { (work_j / time_s).max(0.0) } else { 0.0 }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::TAU;

    #[test]
    fn the_work_of_a_linear_damper_is_found_whatever_its_sensors_add() {
        let model = StrutModel::defender110(6000.0);
        let static_pa = model.cylinder.static_pressure_pa + ATMOSPHERE_PA;
        let volume_m3 = model.accumulator[0].static_gas_volume_m3;
        // Oil swings with an amplitude of 20 cm3 at 2 Hz; the damper takes 1 MPa for each litre per second: R (a w)^2 / 2.
        let (amplitude, w, resistance) = (2e-5, 2.0 * TAU, 1e9);
        let power = 0.5 * resistance * amplitude * w * amplitude * w;
        let time_s: Vec<f64> = (0..=2000).map(|k| 0.005 * f64::from(k)).collect();
        let gas = |t: f64| static_pa * volume_m3 / (volume_m3 - amplitude * libm::sin(w * t)) - ATMOSPHERE_PA;
        let chamber = |t: f64| 1.1 * (gas(t) + resistance * amplitude * w * libm::cos(w * t)) + 3e5;
        let mut columns = vec![vec![0.0; time_s.len()]];
        columns.push(time_s.iter().map(|&t| chamber(t)).collect());
        columns.extend([P2, P3, P4].map(|_| time_s.iter().map(|&t| gas(t)).collect::<Vec<f64>>()));
        columns[1][700] = f64::NAN;
        let recording = Recording {
            name: "a".into(),
            time_s,
            columns,
            notes: vec![],
        };
        let [first, _] = of_dampers_w(&recording, Layout::VEHICLE, &model);
        assert!((first / (1.1 * power) - 1.0).abs() < 0.02, "{first} W of {power} W");
    }
}
