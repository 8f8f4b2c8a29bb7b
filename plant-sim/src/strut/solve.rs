//! One implicit stage of the network: given where each state came from, the pressures and flows at the stage's end.
//!
//! Two unknowns whatever the terms: the pressure drops across damper packs 1 and 2. Everything else follows from them
//! without a further loop, because each element gives its flow or its drop in closed form:
//!
//! * `Q_i(d_i)`: pack, bypass valve and leak in parallel;
//! * accumulator pressure from `V - h Q` and the energy equation (`gas`);
//! * `p1 = p2 + d1 + R1 Q1`;
//! * the drop across valve 3 from `Q2` by the inverse orifice law.
//!
//! Residuals: continuity of the main chamber, `A x' - C dp1/dt - Q1 - Q2 = 0`, and the loop of path 2,
//! `p1 - d2 - R2 Q2 - I dQ2/dt - d3 - p4 = 0`. Both rise or fall monotonically in both unknowns (resistances, springs
//! and masses only), so Newton's method with a bounded step finds the one solution; two or three rounds from the last one.

use super::damper::Pack;
use super::effects::{EntrainedAir, UnlistedLaw};
use super::gas::{Gas, GasState};
use super::model::ATMOSPHERE_PA;
use super::orifice::{unit_drop, unit_flow};

/// Oil volume that shears an accumulator piston's seal from rest to sliding, m3: 0.05 mm of a 50 mm piston. *Assumed.*
const PISTON_PRESLIDING_M3: f64 = 1e-7;

/// One path as the solver sees it.
#[derive(Debug, Clone)]
pub(super) struct Path {
    pub pack: Pack,
    pub valve_coefficient: f64,
    pub leak_coefficient: f64,
    pub resistance: f64,
    pub gas: Gas,
    pub piston_friction_pa: f64,
    pub fade_per_j: f64,
    pub series_law: Option<Pack>,
    pub parallel_law: Option<Pack>,
}

/// What does not change from step to step.
#[derive(Debug, Clone)]
pub(super) struct Parameters {
    pub area_m2: f64,
    pub oil_volume_m3: f64,
    pub inverse_bulk_modulus: f64,
    pub air: Option<EntrainedAir>,
    /// `A^2 / k` of the mount, m3/Pa; 0 for a rigid one.
    pub mount_compliance: f64,
    /// Inverse of the mount's stiffness, m/N.
    pub mount_flexibility: f64,
    pub volume_law: Option<Pack>,
    pub paths: [Path; 2],
    pub valve3_coefficient: f64,
    pub valve3_leak: f64,
    pub inertance: f64,
    pub transition_pa: f64,
}

/// The differential states; all pressures gauge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Store {
    pub p1: f64,
    pub gas: [GasState; 2],
    pub q2: f64,
    /// Seal shear of the accumulator pistons, -1 to 1.
    pub shear: [f64; 2],
    /// Heat held by the dampers' oil, J.
    pub heat: [f64; 2],
}

impl Store {
    /// `self + w (other - self)`, state by state: the recombination the Runge-Kutta stages need.
    #[inline]
    pub fn blend(&self, other: &Self, w: f64) -> Self {
        let mix = |a: f64, b: f64| a + w * (b - a);
        let gas = |i: usize| GasState {
            volume_m3: mix(self.gas[i].volume_m3, other.gas[i].volume_m3),
            temperature_k: mix(self.gas[i].temperature_k, other.gas[i].temperature_k),
        };
        Self {
            p1: mix(self.p1, other.p1),
            gas: [gas(0), gas(1)],
            q2: mix(self.q2, other.q2),
            shear: [mix(self.shear[0], other.shear[0]), mix(self.shear[1], other.shear[1])],
            heat: [mix(self.heat[0], other.heat[0]), mix(self.heat[1], other.heat[1])],
        }
    }
}

/// Unknowns and what is worth remembering from one solve to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Guess {
    pub drop: [f64; 2],
    pub segment: [usize; 2],
}

/// Result of a stage.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stage {
    pub store: Store,
    pub pressure: [f64; 4],
    pub flow: [f64; 2],
}

/// What one path answers to a trial drop.
struct Branch {
    flow: f64,
    flow_slope: f64,
    /// Pressure behind pack and line, i.e. at the accumulator's oil side (path 1) or behind valve 3 (path 2).
    oil: f64,
    oil_slope: f64,
    line: f64,
    line_slope: f64,
    gas: GasState,
    shear: f64,
}

impl Path {
    #[inline(always)]
    fn branch(
        &self,
        base: &Store,
        i: usize,
        h: f64,
        opening: f64,
        transition: f64,
        drop: f64,
        segment: &mut usize,
    ) -> Branch {
        let fade = 1.0 + self.fade_per_j * base.heat[i];
        let (mut flow, mut flow_slope) = self.pack.flow(drop * fade, segment);
        flow_slope *= fade;
        let coefficient = opening * self.valve_coefficient + self.leak_coefficient;
        if coefficient > 0.0 {
            let (unit, slope) = unit_flow(drop, transition);
            flow += coefficient * unit;
            flow_slope += coefficient * slope;
        }
        if let Some(law) = &self.parallel_law {
            let (q, s) = law.flow(drop, &mut 0);
            flow += q;
            flow_slope += s;
        }
        self.behind(base, i, h, flow, flow_slope)
    }

    /// The part of the branch that follows from its flow.
    #[inline(always)]
    fn behind(&self, base: &Store, i: usize, h: f64, flow: f64, flow_slope: f64) -> Branch {
        let (gas, absolute, gas_slope) = self.gas.implicit(base.gas[i], h, flow, base.gas[i].temperature_k);
        let (mut oil, mut oil_slope, mut shear) = (absolute - ATMOSPHERE_PA, gas_slope, base.shear[i]);
        if self.piston_friction_pa > 0.0 {
            let k = h / PISTON_PRESLIDING_M3;
            let divisor = 1.0 + k * flow.abs();
            shear = (base.shear[i] + k * flow) / divisor;
            oil += self.piston_friction_pa * shear;
            oil_slope += self.piston_friction_pa * k * (1.0 - base.shear[i] * flow.signum()) / (divisor * divisor);
        }
        let (mut line, mut line_slope) = (self.resistance * flow, self.resistance);
        if let Some(law) = &self.series_law {
            let (p, s) = law.flow(flow, &mut 0);
            line += p;
            line_slope += s;
        }
        Branch {
            flow,
            flow_slope,
            oil,
            oil_slope,
            line,
            line_slope,
            gas,
            shear,
        }
    }
}

impl Parameters {
    /// Compliance of the main chamber and what hangs on it at a gauge pressure and strut displacement, m3/Pa.
    #[inline(always)]
    fn compliance(&self, p1: f64, displacement_m: f64) -> f64 {
        let volume = self.oil_volume_m3 - self.area_m2 * displacement_m;
        let mut c = volume * self.inverse_bulk_modulus + self.mount_compliance;
        if let Some(air) = &self.air {
            let absolute = (p1 + ATMOSPHERE_PA).max(1e4);
            let n = air.polytropic_exponent;
            c += volume * air.volume_fraction * libm::pow(ATMOSPHERE_PA / absolute, 1.0 / n) / (n * absolute);
        }
        if let Some(law) = &self.volume_law {
            c += law.flow(p1, &mut 0).1;
        }
        c
    }

    /// Solve one stage of length `h` that ends at strut displacement `displacement_m` with speed `speed_m_s`.
    pub fn stage(
        &self,
        base: &Store,
        h: f64,
        displacement_m: f64,
        speed_m_s: f64,
        opening: [f64; 3],
        guess: &mut Guess,
    ) -> Stage {
        let supply = self.area_m2 * speed_m_s;
        let c3 = opening[2] * self.valve3_coefficient + self.valve3_leak;
        let connected = c3 > 0.0;
        let inertia = self.inertance / h;
        let mut c = self.compliance(base.p1, displacement_m) / h;
        let [mut d1, mut d2] = guess.drop;
        if !connected {
            d2 = 0.0;
        }
        let mut round = 0;
        loop {
            let one = self.paths[0].branch(base, 0, h, opening[0], self.transition_pa, d1, &mut guess.segment[0]);
            let p1 = one.oil + one.line + d1;
            let p1_slope = 1.0 + (one.oil_slope + one.line_slope) * one.flow_slope;
            if self.air.is_some() || self.volume_law.is_some() {
                c = self.compliance(0.5 * (p1 + base.p1), displacement_m) / h;
            }
            let stored = c * (p1 - base.p1);
            let (step1, step2, two, d3);
            if connected {
                let b = self.paths[1].branch(base, 1, h, opening[1], self.transition_pa, d2, &mut guess.segment[1]);
                let (unit, unit_slope) = unit_drop(b.flow / c3, self.transition_pa);
                let continuity = supply - stored - one.flow - b.flow;
                let mesh = p1 - d2 - b.line - inertia * (b.flow - base.q2) - unit - b.oil;
                let c_d1 = -c * p1_slope - one.flow_slope;
                let c_d2 = -b.flow_slope;
                let m_d2 = -1.0 - (b.line_slope + inertia + unit_slope / c3 + b.oil_slope) * b.flow_slope;
                let determinant = c_d1 * m_d2 - c_d2 * p1_slope;
                step1 = (c_d2 * mesh - m_d2 * continuity) / determinant;
                step2 = (p1_slope * continuity - c_d1 * mesh) / determinant;
                (two, d3) = (b, unit);
            } else {
                let b = self.paths[1].behind(base, 1, h, 0.0, 0.0);
                step1 = (supply - stored - one.flow) / (c * p1_slope + one.flow_slope);
                step2 = 0.0;
                d3 = 0.0;
                two = b;
            }
            round += 1;
            // 0.1 Pa is a hundred-thousandth of the sensors' noise. Kinks of the tables can make full Newton steps cycle
            // between two lines: after eight rounds the steps are halved, which monotone residuals cannot resist.
            let done = step1.abs() < 0.1 && step2.abs() < 0.1;
            if done || round == 40 {
                guess.drop = [d1 + step1, d2 + step2];
                let p3 = if connected { two.oil + d3 } else { p1 };
                let dissipated = [d1 * one.flow, d2 * two.flow];
                let mut heat = base.heat;
                for i in 0..2 {
                    if self.paths[i].fade_per_j > 0.0 {
                        heat[i] += h * dissipated[i];
                    }
                }
                return Stage {
                    store: Store {
                        p1,
                        gas: [one.gas, two.gas],
                        q2: two.flow,
                        shear: [one.shear, two.shear],
                        heat,
                    },
                    pressure: [p1, one.oil, p3, two.oil],
                    flow: [one.flow, two.flow],
                };
            }
            let relax = if round < 8 { 1.0 } else { 0.5 };
            d1 += relax * step1;
            d2 += relax * step2;
        }
    }
}

/// The table of a law without a name at a place, if the model has one.
pub(super) fn law_at(laws: &[UnlistedLaw], place: super::effects::LawPlace) -> Option<Pack> {
    laws.iter()
        .find(|l| l.place == place)
        .map(|l| Pack::through(&l.argument, &l.value))
}
