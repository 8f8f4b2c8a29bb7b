//! The fixed-step strut against a library's stiff solver (diffsol's BDF, relative tolerance 1e-8).
//!
//! The reference is written the plain way, from the equations in the recordings' README: five differential states, p3
//! found by bisection, no shared code but the damper table's lookup. The strut runs at the recordings' own 2 ms.
//! Asked: 0.1 % of the pressure.

use diffsol::{MatrixCommon, NalgebraLU, NalgebraMat, OdeBuilder, OdeSolverMethod};
use oleo_interface::{Absolute, StrutValves};
use oleo_plant_sim::strut::*;

const H: f64 = 2e-3;
const SAMPLES: usize = 1500;
/// Constant response of the valves, s, so that the reference knows when they move.
const RESPONSE_S: f64 = 0.05;

fn displacement(t: f64) -> (f64, f64) {
    let mut x = (0.0, 0.0);
    // Half a second to fade in; 1 to 9 Hz, peak speed about 0.6 m/s.
    let (ramp, slope) = if t < 0.5 {
        (t / 0.5 * (t / 0.5) * (3.0 - 2.0 * t / 0.5), 24.0 * t * (1.0 - 2.0 * t))
    } else {
        (1.0, 0.0)
    };
    for (amplitude, hertz, phase) in [(0.02, 1.1, 0.3), (0.008, 3.7, 1.1), (0.003, 8.9, 2.0)] {
        let w = 2.0 * std::f64::consts::PI * hertz;
        let (s, c) = (libm::sin(w * t + phase), libm::cos(w * t + phase));
        let s0 = libm::sin(phase);
        x.0 += amplitude * (s - s0) * ramp;
        x.1 += amplitude * (w * c * ramp + (s - s0) * slope);
    }
    x
}

/// Opening of a valve whose signal opened at `edge` s (never: infinite).
fn opening(t: f64, edge: f64) -> f64 {
    let (d, total) = (0.4 * RESPONSE_S, RESPONSE_S);
    (0.05 + 0.9 * (t - edge - d) / (total - d)).clamp(0.0, 1.0)
}

fn reference(model: &StrutModel, edge3: f64, dampers: f64) -> Vec<[f64; 4]> {
    let a = model.piston_area_m2();
    let beta = model.effects.oil_compressibility.as_ref().unwrap().bulk_modulus_pa;
    let heat = model.effects.gas_heat_transfer.clone().unwrap();
    let tau = [heat.time_constant_1_s, heat.time_constant_2_s];
    let ambient = model.gas.temperature_k;
    let p0 = model.cylinder.static_pressure_pa;
    let mr =
        [0, 1].map(|i| model.static_pressure().absolute().pa() * model.accumulator[i].static_gas_volume_m3 / ambient);
    let packs = [0, 1].map(|i| model.damper[i].characteristic());
    let orifice = |d: f64| d / (d.abs() + model.orifice.transition_pressure_pa).sqrt();
    let gas = move |i: usize, v: f64, t: f64| Absolute(mr[i] * t / v).gauge().pa();
    let c = [0, 1, 2].map(|i| model.valve[i].total_flow_coefficient());
    let through2 = |d: f64| packs[1].value(d) + dampers * c[1] * orifice(d);
    // p3 between p1 and p4, where what comes through damper 2 goes through valve 3.
    let middle = |p1: f64, p4: f64, u3: f64| {
        let (mut low, mut high) = (p1.min(p4), p1.max(p4));
        for _ in 0..80 {
            let m = 0.5 * (low + high);
            if through2(p1 - m) > u3 * c[2] * orifice(m - p4) {
                low = m
            } else {
                high = m
            }
        }
        0.5 * (low + high)
    };
    let flows = |t: f64, y: &[f64]| {
        let p1 = 1e6 * y[0];
        let (p2, p4) = (gas(0, 1e-4 * y[1], y[2]), gas(1, 1e-4 * y[3], y[4]));
        let q1 = packs[0].value(p1 - p2) + dampers * c[0] * orifice(p1 - p2);
        let u3 = opening(t, edge3);
        let p3 = if u3 > 0.0 { middle(p1, p4, u3) } else { p1 };
        let q2 = if u3 > 0.0 { through2(p1 - p3) } else { 0.0 };
        (q1, q2, [p1, p2, p3, p4])
    };
    let derivative = |t: f64, y: &[f64], out: &mut [f64]| {
        let (x, v) = displacement(t);
        let (q1, q2, _) = flows(t, y);
        out[0] = 1e-6 * beta / (model.cylinder.oil_volume_m3 - a * x) * (a * v - q1 - q2);
        for (i, q) in [(0, q1), (1, q2)] {
            let (volume, temperature) = (1e-4 * y[1 + 2 * i], y[2 + 2 * i]);
            out[1 + 2 * i] = -1e4 * q;
            out[2 + 2 * i] =
                temperature * NITROGEN_R_J_KG_K / volume * q / NITROGEN_CV_J_KG_K - (temperature - ambient) / tau[i];
        }
    };
    let problem = OdeBuilder::<NalgebraMat<f64>>::new()
        .rtol(1e-8)
        .atol([1e-8])
        .h0(1e-6)
        .rhs_implicit(
            |y: &[f64], _p: &[f64], t: f64, out: &mut [f64]| derivative(t, y, out),
            |y: &[f64], _p: &[f64], t: f64, direction: &[f64], out: &mut [f64]| {
                // Central difference along the direction.
                let e = 1e-6;
                let shifted = |s: f64| -> Vec<f64> { y.iter().zip(direction).map(|(y, d)| y + s * e * d).collect() };
                let (mut up, mut down) = (vec![0.0; 5], vec![0.0; 5]);
                derivative(t, &shifted(1.0), &mut up);
                derivative(t, &shifted(-1.0), &mut down);
                out.iter_mut()
                    .zip(up.iter().zip(&down))
                    .for_each(|(o, (u, d))| *o = (u - d) / (2.0 * e));
            },
        )
        .init(
            |_p: &[f64], _t: f64, y: &mut [f64]| {
                y.copy_from_slice(&[
                    1e-6 * p0,
                    1e4 * model.accumulator[0].static_gas_volume_m3,
                    ambient,
                    1e4 * model.accumulator[1].static_gas_volume_m3,
                    ambient,
                ]);
            },
            5,
        )
        .build()
        .unwrap();
    let times: Vec<f64> = (1..=SAMPLES).map(|i| H * i as f64).collect();
    let mut solver = problem.bdf::<NalgebraLU<f64>>().unwrap();
    let (states, _) = solver.solve_dense(&times).unwrap();
    assert_eq!(states.ncols(), SAMPLES);
    times
        .iter()
        .enumerate()
        .map(|(k, t)| flows(*t, states.inner().column(k).as_slice()).2)
        .collect()
}

fn compare(dampers: bool, edge3: f64) {
    let mut model = StrutModel::defender110(8000.0);
    model.effects.seal_friction = None;
    model.effects.bump_stop = None;
    model.effects.real_gas = None;
    model.effects.entrained_air = None;
    model.effects.oil_compressibility = Some(OilCompressibility {
        bulk_modulus_pa: 1.5e9,
        counted_at: OilCount::Chamber,
    });
    model.valve_timing.response_polynomial_s = vec![RESPONSE_S];
    let exact = reference(&model, edge3, f64::from(u8::from(dampers)));
    let mut strut = Strut::at_rest(&model, StrutValves::new(dampers, dampers, edge3 < 0.0)).unwrap();
    let mut worst = [0.0_f64; 4];
    for (k, exact) in exact.iter().enumerate() {
        let (from, to) = (H * k as f64, H * (k + 1) as f64);
        let signals = StrutValves::new(dampers, dampers, from >= edge3 - 1e-9);
        let out = strut.advance_with_speeds(displacement(to).0, displacement(from).1, displacement(to).1, H, signals);
        for i in 0..4 {
            worst[i] = worst[i].max((out.pressure_pa[i] / exact[i] - 1.0).abs());
        }
    }
    println!("dampers open {dampers}, valve 3 from {edge3} s: largest relative deviations of p1..p4 {worst:?}");
    assert!(worst.iter().all(|w| *w < 1e-3), "{worst:?}");
}

#[test]
fn soft_and_low_damping() {
    compare(true, f64::NEG_INFINITY);
}

#[test]
fn soft_and_high_damping() {
    compare(false, f64::NEG_INFINITY);
}

#[test]
fn stiff_then_valve_3_opens_away_from_the_static_position() {
    compare(true, 1.5);
}
