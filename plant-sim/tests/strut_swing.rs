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

/// Period of the column without damping, s, at the place where the strut stops and the pressure (Pa) that it settles to.
fn period_s(settled_pa: f64) -> f64 {
    let model = model();
    let stopped_m = motion(END_S).0;
    let oil = (model.cylinder.oil_volume_m3 - model.piston_area_m2() * stopped_m) / BULK_MODULUS_PA;
    // Boyle's law: without a thermal time constant the gas stays at ambient temperature.
    let static_pa = model.cylinder.static_pressure_pa + 101_325.0;
    let content = static_pa * model.accumulator[1].static_gas_volume_m3;
    let pressure = settled_pa + 101_325.0;
    let gas = content / (pressure * pressure);
    std::f64::consts::TAU * (INERTANCE_KG_M4 / (1.0 / oil + 1.0 / gas)).sqrt()
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
    let undamped = period_s(*settled);
    assert!((period / undamped - 1.0).abs() < 0.01, "{period} s for {undamped} s");
}

/// SDIRK2 with steps of a quarter of a radian: phase of its amplification factor `(1 + (1 - 2 gamma) i h) / (1 - gamma i h)^2`
/// less the angle, over the angle.
const LOST_PHASE: f64 = 0.0025;
/// Pressure below which the column counts as at rest, Pa, and is not followed.
const AT_REST_PA: f64 = 300.0;

/// The steps of samples far apart differ from those of 0.5 ms by what the integrator loses of the phase, and by no more.
#[test]
fn samples_far_apart_show_the_same_ringing() {
    let fine_s = 5e-4;
    let fine = p1_pa(fine_s);
    let period = period_s(fine[fine.len() - 1]);
    // Amplitude about a sample: half of what is between the extremes of a period.
    let half = (0.5 * period / fine_s).ceil() as usize;
    let amplitude_pa = |at: usize| {
        let about = &fine[at.saturating_sub(half)..(at + half + 1).min(fine.len())];
        let (low, high) = (about.iter()).fold((f64::MAX, f64::MIN), |(low, high), p| (low.min(*p), high.max(*p)));
        0.5 * (high - low)
    };
    for interval in [2e-3, 4e-3, 2e-2] {
        let every = (interval / fine_s).round() as usize;
        for (k, p) in p1_pa(interval).iter().enumerate() {
            let at = every * (k + 1) - 1;
            // It has rung from the start, where the strut begins to move at once.
            let lost_rad = LOST_PHASE * std::f64::consts::TAU * fine_s * (at + 1) as f64 / period;
            let bound_pa = amplitude_pa(at) * lost_rad + 2.0 * AT_REST_PA;
            let off_pa = (p - fine[at]).abs();
            assert!(
                off_pa < bound_pa,
                "{interval} s, sample {k}: {off_pa} Pa of {bound_pa} Pa"
            );
        }
    }
}
