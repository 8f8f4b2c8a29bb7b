//! A strut written the plain way, from the equations in the recordings' README: five differential states, p3 where the flows of
//! pack 2 and of valve 3 are equal, and no shared code with the strut but the damper table's lookup. Solvers of libraries take it
//! through time. The tests hold the strut against it, and `benches/solvers` times both.
#![allow(dead_code, reason = "each program uses its part")]

use std::cell::Cell;
use std::f64::consts::PI;

use oleo_interface::{Absolute, StrutValves};
use oleo_plant_sim::strut::*;

/// Sampling interval of the comparison, s: that of the recordings.
pub const INTERVAL_S: f64 = 2e-3;
/// Number of samples that are compared.
pub const SAMPLES: usize = 1500;
/// Constant response of the valves, s, so that the plain strut knows when they move.
const RESPONSE_S: f64 = 0.05;

/// What is driven through the common motion.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    pub name: &'static str,
    /// Whether valves 1 and 2 are open.
    pub dampers_open: bool,
    /// When the signal of valve 3 opens, s; minus infinity where it is open from the start.
    pub valve3_from_s: f64,
}

pub const CASES: [Case; 3] = [
    Case {
        name: "soft, low damping",
        dampers_open: true,
        valve3_from_s: f64::NEG_INFINITY,
    },
    Case {
        name: "soft, high damping",
        dampers_open: false,
        valve3_from_s: f64::NEG_INFINITY,
    },
    Case {
        name: "stiff, then valve 3 opens",
        dampers_open: true,
        valve3_from_s: 1.5,
    },
];

/// Pressures p1 to p4 at every sample, Pa.
pub type Pressures = Vec<[f64; 4]>;

/// The preset with the terms that the plain strut has.
pub fn model() -> StrutModel {
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
    model
}

/// Displacement, m, and speed, m/s: half a second to fade in; 1 to 9 Hz, peak speed about 0.6 m/s.
pub fn displacement(t: f64) -> (f64, f64) {
    let mut x = (0.0, 0.0);
    let (ramp, slope) = if t < 0.5 {
        (t / 0.5 * (t / 0.5) * (3.0 - 2.0 * t / 0.5), 24.0 * t * (1.0 - 2.0 * t))
    } else {
        (1.0, 0.0)
    };
    for (amplitude, hertz, phase) in [(0.02, 1.1, 0.3), (0.008, 3.7, 1.1), (0.003, 8.9, 2.0)] {
        let w = 2.0 * PI * hertz;
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

/// Times of all samples, s.
pub fn times() -> Vec<f64> {
    (1..=SAMPLES).map(|i| INTERVAL_S * i as f64).collect()
}

/// How p3 is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Middle {
    /// Eighty halvings: nothing that could go wrong.
    Bisection,
    /// Newton's method kept between bounds: as a program is written that is to be fast.
    Newton,
}

/// The strut's differential equations. States: p1 in MPa; gas volume in 0.1 l and temperature in K of both accumulators.
pub struct PlainStrut<'a> {
    model: &'a StrutModel,
    case: Case,
    middle: Middle,
    piston_m2: f64,
    bulk_modulus_pa: f64,
    time_constant_s: [f64; 2],
    mass_times_r: [f64; 2],
    packs: [Characteristic; 2],
    valves: [f64; 3],
    calls: Cell<u64>,
}

impl<'a> PlainStrut<'a> {
    pub fn of(model: &'a StrutModel, case: Case, middle: Middle) -> Self {
        let heat = model.effects.gas_heat_transfer.clone().unwrap();
        Self {
            model,
            case,
            middle,
            piston_m2: model.piston_area_m2(),
            bulk_modulus_pa: model.effects.oil_compressibility.as_ref().unwrap().bulk_modulus_pa,
            time_constant_s: [heat.time_constant_1_s, heat.time_constant_2_s],
            mass_times_r: [0, 1].map(|i| {
                model.static_pressure().absolute().pa() * model.accumulator[i].static_gas_volume_m3
                    / model.gas.temperature_k
            }),
            packs: [0, 1].map(|i| model.damper[i].characteristic()),
            valves: [0, 1, 2].map(|i| model.valve[i].total_flow_coefficient()),
            calls: Cell::new(0),
        }
    }

    /// Number of times that the derivatives were asked for.
    pub fn calls(&self) -> u64 {
        self.calls.get()
    }

    fn orifice(&self, d: f64) -> f64 {
        d / (d.abs() + self.model.orifice.transition_pressure_pa).sqrt()
    }

    /// Derivative of [`Self::orifice`].
    fn orifice_slope(&self, d: f64) -> f64 {
        let a = d.abs() + self.model.orifice.transition_pressure_pa;
        (0.5 * d.abs() + self.model.orifice.transition_pressure_pa) / (a * a.sqrt())
    }

    fn bypass(&self, i: usize) -> f64 {
        f64::from(u8::from(self.case.dampers_open)) * self.valves[i]
    }

    /// Flow through pack and bypass valve 2, and its derivative.
    fn through_2(&self, d: f64, segment: &mut usize) -> (f64, f64) {
        let (flow, slope) = self.packs[1].at(d, segment);
        let valve = self.bypass(1);
        (flow + valve * self.orifice(d), slope + valve * self.orifice_slope(d))
    }

    /// p3 between p1 and p4, where what comes through damper 2 goes through valve 3.
    fn p3(&self, p1: f64, p4: f64, opening: f64) -> f64 {
        let c3 = opening * self.valves[2];
        let (mut low, mut high) = (p1.min(p4), p1.max(p4));
        let mut segment = 0;
        let mut left_over = |m: f64| {
            let (flow, slope) = self.through_2(p1 - m, &mut segment);
            let left = flow - c3 * self.orifice(m - p4);
            (left, -slope - c3 * self.orifice_slope(m - p4))
        };
        match self.middle {
            Middle::Bisection => {
                for _ in 0..80 {
                    let m = 0.5 * (low + high);
                    if left_over(m).0 > 0.0 { low = m } else { high = m }
                }
                0.5 * (low + high)
            }
            Middle::Newton => {
                let mut m = 0.5 * (low + high);
                for _ in 0..60 {
                    let (left, slope) = left_over(m);
                    if left > 0.0 {
                        low = m
                    } else {
                        high = m
                    }
                    let newton = m - left / slope;
                    let next = if newton > low && newton < high {
                        newton
                    } else {
                        0.5 * (low + high)
                    };
                    // A tenth of a pascal in some megapascals.
                    if (next - m).abs() < 1e-1 {
                        return next;
                    }
                    m = next;
                }
                m
            }
        }
    }

    fn flows(&self, t: f64, y: &[f64]) -> (f64, f64, [f64; 4]) {
        let p1 = 1e6 * y[0];
        let gas = |i: usize| {
            Absolute(self.mass_times_r[i] * y[2 + 2 * i] / (1e-4 * y[1 + 2 * i]))
                .gauge()
                .pa()
        };
        let (p2, p4) = (gas(0), gas(1));
        let q1 = self.packs[0].value(p1 - p2) + self.bypass(0) * self.orifice(p1 - p2);
        let u3 = opening(t, self.case.valve3_from_s);
        let p3 = if u3 > 0.0 { self.p3(p1, p4, u3) } else { p1 };
        let q2 = if u3 > 0.0 {
            self.through_2(p1 - p3, &mut 0).0
        } else {
            0.0
        };
        (q1, q2, [p1, p2, p3, p4])
    }

    /// The derivatives of the states.
    pub fn derivative(&self, t: f64, y: &[f64], out: &mut [f64]) {
        self.calls.set(self.calls.get() + 1);
        let (x, v) = displacement(t);
        let (q1, q2, _) = self.flows(t, y);
        let oil_m3 = self.model.cylinder.oil_volume_m3 - self.piston_m2 * x;
        out[0] = 1e-6 * self.bulk_modulus_pa / oil_m3 * (self.piston_m2 * v - q1 - q2);
        for (i, q) in [(0, q1), (1, q2)] {
            let (volume, temperature) = (1e-4 * y[1 + 2 * i], y[2 + 2 * i]);
            out[1 + 2 * i] = -1e4 * q;
            out[2 + 2 * i] = temperature * NITROGEN_R_J_KG_K / volume * q / NITROGEN_CV_J_KG_K
                - (temperature - self.model.gas.temperature_k) / self.time_constant_s[i];
        }
    }

    /// The states at rest.
    pub fn start(&self) -> [f64; 5] {
        let gas = |i: usize| 1e4 * self.model.accumulator[i].static_gas_volume_m3;
        let ambient_k = self.model.gas.temperature_k;
        [
            1e-6 * self.model.cylinder.static_pressure_pa,
            gas(0),
            ambient_k,
            gas(1),
            ambient_k,
        ]
    }

    /// The pressures in a state, Pa.
    pub fn pressures(&self, t: f64, y: &[f64]) -> [f64; 4] {
        self.flows(t, y).2
    }
}

/// The pressures of the strut at all samples, each interval in so many equal steps.
pub fn of_strut(model: &StrutModel, case: Case, steps: usize) -> Pressures {
    let (open, edge3) = (case.dampers_open, case.valve3_from_s);
    let mut strut = Strut::at_rest(model, StrutValves::new(open, open, edge3 < 0.0)).unwrap();
    let step_s = INTERVAL_S / steps as f64;
    let mut speed_before = displacement(0.0).1;
    let one = |sample: usize| {
        let mut out = strut.output();
        for step in 0..steps {
            let from = INTERVAL_S * sample as f64 + step_s * step as f64;
            let signals = StrutValves::new(open, open, from >= edge3 - 1e-9);
            let (at, speed) = displacement(from + step_s);
            out = strut.advance_with_speeds(at, speed_before, speed, step_s, signals);
            speed_before = speed;
        }
        out.pressure_pa
    };
    (0..SAMPLES).map(one).collect()
}

/// Largest relative deviations of p1 to p4.
pub fn deviations(pressures: &Pressures, exact: &Pressures) -> [f64; 4] {
    let mut worst = [0.0_f64; 4];
    for (found, exact) in pressures.iter().zip(exact) {
        for i in 0..4 {
            worst[i] = worst[i].max((found[i] / exact[i] - 1.0).abs());
        }
    }
    worst
}
