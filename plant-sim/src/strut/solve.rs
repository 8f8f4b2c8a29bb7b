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
use super::gas::{Departure, Gas, GasState};
use super::model::ATMOSPHERE_PA;
use super::orifice::{unit_drop, unit_flow};

/// One path as the solver sees it.
#[derive(Debug, Clone)]
pub(super) struct Path {
    pub pack: Pack,
    pub valve_coefficient: f64,
    pub leak_coefficient: f64,
    pub resistance: f64,
    pub gas: Gas,
    pub piston_friction_pa: f64,
    pub piston_presliding_m3: f64,
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
    /// Oil is counted at its static density, so that none is gained or lost.
    pub conserves_oil: bool,
    pub static_pa: f64,
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
    /// Volume that the main chamber has given way since static pressure and that it gives back, m3. A state of its own
    /// beside p1: stages must blend volumes, since pressure is anything but linear in them near vacuum.
    pub held: f64,
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
            held: mix(self.held, other.held),
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
    pub flow: [f64; 2],
    pub segment: [usize; 2],
    pub real: [Departure; 2],
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
    shear_slope: f64,
    /// Temperature by flow, K s/m3.
    warming: f64,
}

impl Branch {
    /// The branch after its pack's drop has changed by a little.
    #[inline(always)]
    fn moved(mut self, step: f64, h: f64) -> Self {
        let flow = self.flow_slope * step;
        self.flow += flow;
        self.oil += self.oil_slope * flow;
        self.shear += self.shear_slope * flow;
        self.gas.temperature_k += self.warming * flow;
        self.gas.volume_m3 -= h * flow;
        self
    }
}

/// Answer of the main chamber to a trial pressure: volume given way since the base, m3, volume held then, and both
/// derivatives, m3/Pa.
struct GivenWay {
    volume: f64,
    slope: f64,
    held: f64,
    held_slope: f64,
}

/// A Newton step of at most this much is taken without another look, Pa: all quantities follow it linearly, volumes
/// included, and what that neglects in the drop is about step^2 / transition pressure, 5 Pa.
const LAST_STEP_PA: f64 = 300.0;
/// And one longer than this is not trusted, Pa.
const LONGEST_STEP_PA: f64 = 2e6;

/// Where one path starts from in a stage.
struct Setting {
    h: f64,
    gas: GasState,
    shear: f64,
    heat: f64,
    real: Departure,
}

impl Path {
    #[inline(always)]
    fn setting(&self, base: &Store, i: usize, h: f64, guess: &mut Guess) -> Setting {
        let gas = base.gas[i];
        self.gas.refresh(&mut guess.real[i], gas, h, guess.flow[i]);
        Setting {
            h,
            gas,
            shear: base.shear[i],
            heat: base.heat[i],
            real: guess.real[i],
        }
    }

    #[inline(always)]
    fn branch(&self, at: &Setting, opening: f64, transition: f64, drop: f64, segment: &mut usize) -> Branch {
        let fade = 1.0 + self.fade_per_j * at.heat;
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
        self.behind(at, flow, flow_slope)
    }

    /// The part of the branch that follows from its flow.
    #[inline(always)]
    fn behind(&self, at: &Setting, flow: f64, flow_slope: f64) -> Branch {
        let step = self.gas.implicit(at.gas, at.h, flow, &at.real);
        let (mut oil, mut oil_slope) = (step.pressure_pa - ATMOSPHERE_PA, step.pressure_by_flow);
        let (mut shear, mut shear_slope) = (at.shear, 0.0);
        if self.piston_friction_pa > 0.0 {
            let k = at.h / self.piston_presliding_m3;
            let divisor = 1.0 + k * flow.abs();
            shear = (at.shear + k * flow) / divisor;
            oil += self.piston_friction_pa * shear;
            shear_slope = k * (1.0 - at.shear * flow.signum()) / (divisor * divisor);
            oil_slope += self.piston_friction_pa * shear_slope;
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
            gas: step.state,
            shear,
            shear_slope,
            warming: step.temperature_by_flow,
        }
    }
}

impl Parameters {
    /// Volume that the chamber holds at a gauge pressure beyond what it holds at static pressure, and its derivative.
    #[inline(always)]
    pub fn held(&self, p1: f64, displacement_m: f64) -> (f64, f64) {
        let over = p1 - self.static_pa;
        let (mut volume, mut slope) = (self.mount_compliance * over, self.mount_compliance);
        if self.conserves_oil {
            // exp(y) - 1 of the density at constant bulk modulus, y at most a few per cent: to y^4/24, 1e-8.
            let oil = self.oil_volume_m3 - self.area_m2 * displacement_m;
            let y = over * self.inverse_bulk_modulus;
            volume += oil * y * (1.0 + y * (0.5 + y / 6.0));
            slope += oil * self.inverse_bulk_modulus * (1.0 + y * (1.0 + 0.5 * y));
        }
        if let Some(air) = self.air.as_ref().filter(|_| self.conserves_oil) {
            let (left, thinning) = bubbles(air, p1);
            volume -= self.oil_volume_m3 * left;
            slope += self.oil_volume_m3 * thinning;
        }
        if let Some(law) = &self.volume_law {
            let (v, s) = law.flow(p1, &mut 0);
            volume += v;
            slope += s;
        }
        (volume, slope)
    }

    /// What the chamber does from `base` to gauge pressure `p1`. Differences of volumes: exact however far it moves.
    #[inline(always)]
    fn given_way(&self, base: &Store, p1: f64, displacement_m: f64) -> GivenWay {
        let (held, held_slope) = self.held(p1, displacement_m);
        let (mut volume, mut slope) = (held - base.held, held_slope);
        if !self.conserves_oil {
            let oil = (self.oil_volume_m3 - self.area_m2 * displacement_m) * self.inverse_bulk_modulus;
            volume += oil * (p1 - base.p1);
            slope += oil;
            // The recordings' equation counts air as it counts oil: both give way in the chamber as it is now.
            if let Some(air) = &self.air {
                let chamber = self.oil_volume_m3 - self.area_m2 * displacement_m;
                let ((before, _), (left, thinning)) = (bubbles(air, base.p1), bubbles(air, p1));
                volume += chamber * (before - left);
                slope += chamber * thinning;
            }
        }
        GivenWay {
            volume,
            slope,
            held,
            held_slope,
        }
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
        let [mut d1, mut d2] = guess.drop;
        if !connected {
            d2 = 0.0;
        }
        let first = self.paths[0].setting(base, 0, h, guess);
        let second = self.paths[1].setting(base, 1, h, guess);
        let mut round = 0;
        loop {
            let one = self.paths[0].branch(&first, opening[0], self.transition_pa, d1, &mut guess.segment[0]);
            let p1 = one.oil + one.line + d1;
            let p1_slope = 1.0 + (one.oil_slope + one.line_slope) * one.flow_slope;
            let given = self.given_way(base, p1, displacement_m);
            let (stored, c) = (given.volume / h, given.slope / h);
            let (step1, step2, two, d3, d3_slope);
            if connected {
                let b = self.paths[1].branch(&second, opening[1], self.transition_pa, d2, &mut guess.segment[1]);
                let (unit, unit_slope) = unit_drop(b.flow / c3, self.transition_pa);
                let continuity = supply - stored - one.flow - b.flow;
                let mesh = p1 - d2 - b.line - inertia * (b.flow - base.q2) - unit - b.oil;
                let c_d1 = -c * p1_slope - one.flow_slope;
                let c_d2 = -b.flow_slope;
                let m_d2 = -1.0 - (b.line_slope + inertia + unit_slope / c3 + b.oil_slope) * b.flow_slope;
                let determinant = c_d1 * m_d2 - c_d2 * p1_slope;
                step1 = (c_d2 * mesh - m_d2 * continuity) / determinant;
                step2 = (p1_slope * continuity - c_d1 * mesh) / determinant;
                (two, d3, d3_slope) = (b, unit, unit_slope / c3);
            } else {
                let b = self.paths[1].behind(&second, 0.0, 0.0);
                step1 = (supply - stored - one.flow) / (c * p1_slope + one.flow_slope);
                step2 = 0.0;
                (two, d3, d3_slope) = (b, 0.0, 0.0);
            }
            round += 1;
            // Kinks of the tables can make full Newton steps cycle between two lines: after eight rounds the steps are
            // halved, which monotone residuals cannot resist.
            if (step1.abs() < LAST_STEP_PA && step2.abs() < LAST_STEP_PA) || round == 40 {
                let (p1, one) = (p1 + p1_slope * step1, one.moved(step1, h));
                let (d3, two) = (d3 + d3_slope * two.flow_slope * step2, two.moved(step2, h));
                guess.drop = [d1 + step1, d2 + step2];
                guess.flow = [one.flow, two.flow];
                let mut heat = base.heat;
                for (i, q) in guess.flow.iter().enumerate() {
                    if self.paths[i].fade_per_j > 0.0 {
                        heat[i] += h * guess.drop[i] * q;
                    }
                }
                return Stage {
                    store: Store {
                        p1,
                        held: given.held + given.held_slope * p1_slope * step1,
                        gas: [one.gas, two.gas],
                        q2: two.flow,
                        shear: [one.shear, two.shear],
                        heat,
                    },
                    pressure: [p1, one.oil, if connected { two.oil + d3 } else { p1 }, two.oil],
                    flow: guess.flow,
                };
            }
            // Near vacuum the chamber is soft on one side and hard on the other; an unbounded step leaps the gap.
            let relax = if round < 8 { 1.0 } else { 0.5 };
            d1 += relax * step1.clamp(-LONGEST_STEP_PA, LONGEST_STEP_PA);
            d2 += relax * step2.clamp(-LONGEST_STEP_PA, LONGEST_STEP_PA);
        }
    }
}

/// Pressure below which bubbles are continued by their tangent, Pa absolute: a tenth of the least that oil shows.
const LEAST_BUBBLE_PA: f64 = 2e3;

/// Volume of the undissolved air over that of the oil at a gauge pressure, and minus its derivative, 1/Pa.
///
/// `a (p_atm/p)^(1/n)`. As the pressure nears vacuum the bubbles take over the whole flow: this is also what keeps a
/// strut in violent rebound from pulling on its oil.
#[inline]
fn bubbles(air: &EntrainedAir, gauge_pa: f64) -> (f64, f64) {
    let absolute = gauge_pa + ATMOSPHERE_PA;
    let held = absolute.max(LEAST_BUBBLE_PA);
    let ratio = ATMOSPHERE_PA / held;
    let n = air.polytropic_exponent;
    // Isothermal bubbles, the usual choice, need no power function.
    let power = if n == 1.0 { ratio } else { libm::pow(ratio, 1.0 / n) };
    let volume = air.volume_fraction * power;
    let thinning = volume / (n * held);
    (volume + thinning * (held - absolute), thinning)
}

/// The table of a law without a name at a place, if the model has one.
pub(super) fn law_at(laws: &[UnlistedLaw], place: super::effects::LawPlace) -> Option<Pack> {
    laws.iter()
        .find(|l| l.place == place)
        .map(|l| Pack::through(&l.argument, &l.value))
}
