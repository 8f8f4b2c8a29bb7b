//! The oil column of line 2 rings after a stop. Its period is that of a mass between two springs, in closed form, and does
//! not depend on how far apart the samples of the motion are.

use oleo_interface::StrutValves;
use oleo_plant_sim::strut::*;

const INERTANCE_KG_M4: f64 = 2e7;
const BULK_MODULUS_PA: f64 = 1.25e9;
/// Speed before the stop, m/s, and how long the stop takes, s.
const SPEED_M_S: f64 = 0.1;
const STOP_S: f64 = 0.02;
/// When the stop begins and when the recording ends, s.
const MOVING_S: f64 = 0.4;
const END_S: f64 = 1.4;

/// A strut whose path 1 is as good as blocked and whose path 2 damps as little as it can.
fn model() -> StrutModel {
    let mut model = StrutModel::defender110(8000.0);
    model.effects = Effects::default();
    model.effects.oil_compressibility = Some(OilCompressibility {
        bulk_modulus_pa: BULK_MODULUS_PA,
        counted_at: OilCount::Chamber,
    });
    model.effects.line_inertance = Some(LineInertance {
        inertance_2_kg_m4: INERTANCE_KG_M4,
    });
    model.damper[0] = model.damper[0].scaled(1e9);
    model
}

/// Displacement and speed: at constant speed, then a stop at constant deceleration.
fn motion(t: f64) -> (f64, f64) {
    let stopping = (t - MOVING_S).clamp(0.0, STOP_S);
    let way = SPEED_M_S * (t.min(MOVING_S) + stopping - 0.5 * stopping * stopping / STOP_S);
    (way, SPEED_M_S * (1.0 - stopping / STOP_S))
}

/// p1, Pa, at the samples of an interval, and the displacement at which the strut stops.
fn p1_pa(interval_s: f64) -> Vec<f64> {
    let signals = StrutValves::new(false, true, true);
    let mut strut = Strut::at_rest(&model(), signals).unwrap();
    let samples = (END_S / interval_s).round() as usize;
    (0..samples)
        .map(|k| {
            let (from, to) = (interval_s * k as f64, interval_s * (k + 1) as f64);
            let ((_, from_m_s), (to_m, to_m_s)) = (motion(from), motion(to));
            strut
                .advance_with_speeds(to_m, from_m_s, to_m_s, interval_s, signals)
                .pressure_pa[0]
        })
        .collect()
}

#[test]
fn the_column_rings_with_the_period_of_a_mass_between_two_springs() {
    let interval = 5e-4;
    let p1 = p1_pa(interval);
    let after = ((MOVING_S + STOP_S) / interval) as usize;
    let settled = p1.last().unwrap();
    // Upward passages through the level that it settles to, in samples.
    let passages: Vec<f64> = (after..p1.len() - 1)
        .filter(|&k| p1[k] < *settled && p1[k + 1] >= *settled)
        .map(|k| k as f64 + (settled - p1[k]) / (p1[k + 1] - p1[k]))
        .take(4)
        .collect();
    let period = interval * (passages[3] - passages[0]) / 3.0;
    let model = model();
    let stopped_m = motion(END_S).0;
    let oil = (model.cylinder.oil_volume_m3 - model.piston_area_m2() * stopped_m) / BULK_MODULUS_PA;
    // Boyle's law: without a thermal time constant the gas stays at ambient temperature.
    let static_pa = model.cylinder.static_pressure_pa + 101_325.0;
    let content = static_pa * model.accumulator[1].static_gas_volume_m3;
    let pressure = settled + 101_325.0;
    let gas = content / (pressure * pressure);
    let undamped = std::f64::consts::TAU * (INERTANCE_KG_M4 / (1.0 / oil + 1.0 / gas)).sqrt();
    assert!((period / undamped - 1.0).abs() < 0.01, "{period} s for {undamped} s");
}

#[test]
fn samples_far_apart_show_the_same_ringing() {
    let fine = p1_pa(5e-4);
    for interval in [2e-3, 4e-3, 2e-2] {
        let coarse = p1_pa(interval);
        let every = (interval / 5e-4).round() as usize;
        let worst = (coarse.iter().enumerate())
            .map(|(k, p)| (p - fine[every * (k + 1) - 1]).abs())
            .fold(0.0, f64::max);
        let swing = fine
            .iter()
            .map(|p| (p - fine[fine.len() - 1]).abs())
            .fold(0.0, f64::max);
        // The integrator is behind by a quarter per cent of the phase, which adds up over the twenty periods.
        assert!(worst < 0.05 * swing, "{interval} s: {worst} of {swing} Pa");
    }
}
