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
//! and masses only), so Newton's method with a bounded step finds the one solution: one round in four stages of five, since
//! the start is predicted ([`Guess`]) and the last step is taken linearly as soon as its square does not matter.

use super::characteristic::Characteristic;
use super::effects::EntrainedAir;
use super::gas::{Departure, Gas, GasState};
use super::laws::{PathLaws, throttled};
use super::model::ATMOSPHERE_PA;
use super::orifice::{unit_drop, unit_flow};

/// One path as the solver sees it.
#[derive(Debug, Clone)]
pub(super) struct Path {
    pub pack: Characteristic,
    pub valve_coefficient: f64,
    pub leak_coefficient: f64,
    pub resistance: f64,
    pub gas: Gas,
    pub static_gas_m3: f64,
    pub piston_friction_pa: f64,
    pub piston_presliding_m3: f64,
    pub fade_per_j: f64,
    pub laws: PathLaws,
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
    pub volume_law: Option<Characteristic>,
    pub loss_law: Option<Characteristic>,
    pub valve3_law: Option<Characteristic>,
    /// Some path or the chamber has a law without a name, read from a table.
    pub has_unlisted: bool,
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
    /// Part by which the oil and air of the chamber have given way beyond constant stiffness, as `held` a state of its own:
    /// what the recordings' equation multiplies by the chamber as it is now.
    pub squeezed: f64,
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
            squeezed: mix(self.squeezed, other.squeezed),
            q2: mix(self.q2, other.q2),
            shear: [mix(self.shear[0], other.shear[0]), mix(self.shear[1], other.shear[1])],
            heat: [mix(self.heat[0], other.heat[0]), mix(self.heat[1], other.heat[1])],
        }
    }
}

/// When and where a stage ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moment {
    /// Length of the stage, s.
    pub h: f64,
    /// Time since the end of the stage solved before, s.
    pub since: f64,
    pub displacement_m: f64,
    pub speed_m_s: f64,
    pub opening: [f64; 3],
}

/// The last solution and how it moves: what the next solve starts from. The result does not depend on it beyond the
/// solver's tolerance.
///
/// Drops follow the piston's flow within a millisecond, so they are predicted by the last Jacobian's answer to the change of
/// that flow, which is known; what the flow does not explain (gas and chamber filling) goes on at its last rate.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Guess {
    pub drop: [f64; 2],
    pub flow: [f64; 2],
    segment: [usize; 2],
    real: [Departure; 2],
    /// Flow that the piston supplied, m3/s.
    supply: f64,
    /// Derivative of the drops by it, Pa s/m3.
    gain: [f64; 2],
    /// Their rate beside it, Pa/s.
    drift: [f64; 2],
}

/// Result of a stage.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stage {
    pub store: Store,
    pub pressure: [f64; 4],
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
    squeezed: f64,
    squeezed_slope: f64,
}

/// What a Newton step that is taken without another look may neglect in a pressure drop, Pa. All quantities follow the step
/// linearly, volumes included, so nothing is lost; the error is that of the curved laws, about `step^2 / (2 (|d| + p_t))`
/// for an orifice and `step^2 / p` for gas and bubbles.
const NEGLECTED_PA: f64 = 5.0;
/// The same where only a kink of a table is in question: the step across it.
const ACROSS_KINK_PA: f64 = 50.0;
/// And where the table is a law without a name, whose kinks are not looked for.
const UNLISTED_STEP_PA: f64 = 300.0;
/// A Newton step longer than this is not trusted, Pa.
const LONGEST_STEP_PA: f64 = 2e6;
/// No state has been seen that needs more than a third of this many rounds.
const MOST_ROUNDS: u32 = 40;

/// Where one path starts from in a stage.
struct Setting<'a> {
    h: f64,
    gas: GasState,
    shear: f64,
    /// What the pack's drop is divided by.
    fade: f64,
    /// Flow coefficient beside the pack: bypass valve, leaks and grooves.
    valve: f64,
    /// The bypass valve's part of it.
    through: f64,
    transition: f64,
    real: &'a Departure,
}

impl Path {
    #[inline(always)]
    fn setting<'a>(&self, base: &Store, i: usize, at: &Moment, transition: f64, real: &'a Departure) -> Setting<'a> {
        let through = at.opening[i] * self.valve_coefficient;
        Setting {
            h: at.h,
            gas: base.gas[i],
            shear: base.shear[i],
            fade: (1.0 + self.fade_per_j * base.heat[i]) * self.laws.weakening(at.displacement_m),
            valve: through + self.leak_coefficient + self.laws.bypass(at.displacement_m),
            through,
            transition,
            real,
        }
    }

    #[inline(always)]
    fn branch(&self, at: &Setting, drop: f64, segment: &mut usize) -> Branch {
        let (mut flow, mut flow_slope) = self.pack.at(drop * at.fade, segment);
        flow_slope *= at.fade;
        if at.valve > 0.0 {
            let (unit, slope) = unit_flow(drop, at.transition);
            let coefficient = at.valve - at.through * self.laws.throttled_away(drop);
            flow += coefficient * unit;
            flow_slope += coefficient * slope;
        }
        if let Some(law) = &self.laws.parallel {
            let (q, s) = law.at(drop, &mut 0);
            flow += q;
            flow_slope += s;
        }
        self.behind(at, flow, flow_slope)
    }

    /// Whether a step from `drop` may be taken linearly as far as pack, orifice and piston seal go.
    #[inline(always)]
    fn is_straight(&self, at: &Setting, branch: &Branch, drop: f64, step: f64, segment: usize) -> bool {
        let curved = step * step <= 2.0 * NEGLECTED_PA * (at.transition + drop.abs());
        let kink = step.abs() > ACROSS_KINK_PA && !self.pack.on_segment((drop + step) * at.fade, segment);
        let sheared = self.piston_friction_pa * branch.shear_slope * branch.flow_slope * step;
        curved && !kink && sheared * sheared <= NEGLECTED_PA * self.piston_friction_pa
    }

    /// The part of the branch that follows from its flow.
    #[inline(always)]
    fn behind(&self, at: &Setting, flow: f64, flow_slope: f64) -> Branch {
        let step = self.gas.implicit(at.gas, at.h, flow, at.real);
        let (mut oil, mut oil_slope) = (step.pressure_pa - ATMOSPHERE_PA, step.pressure_by_flow);
        if let Some(law) = &self.laws.gas {
            let factor = law.value(step.state.volume_m3 / self.static_gas_m3).max(0.1);
            oil = factor * step.pressure_pa - ATMOSPHERE_PA;
            oil_slope *= factor;
        }
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
        if let Some(law) = &self.laws.series {
            let (p, s) = law.at(flow, &mut 0);
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
            volume += oil * y * (1.0 + y * (0.5 + y * (1.0 / 6.0)));
            slope += oil * self.inverse_bulk_modulus * (1.0 + y * (1.0 + 0.5 * y));
        }
        if let Some(air) = self.air.as_ref().filter(|_| self.conserves_oil) {
            let (left, thinning) = bubbles(air, p1);
            volume -= self.oil_volume_m3 * left;
            slope += self.oil_volume_m3 * thinning;
        }
        if let Some(law) = self.volume_law.as_ref().filter(|_| self.conserves_oil) {
            let (v, s) = law.at(p1, &mut 0);
            volume += v;
            slope += s;
        }
        (volume, slope)
    }

    /// Part by which the chamber's content has given way at a gauge pressure, beyond what constant stiffness makes of it,
    /// and its derivative, 1/Pa: undissolved air, and a law without a name, counted as the recordings' equation counts oil.
    #[inline(always)]
    pub fn squeezed(&self, p1: f64) -> (f64, f64) {
        let (mut part, mut slope) = (0.0, 0.0);
        if !self.conserves_oil {
            if let Some(air) = &self.air {
                let (left, thinning) = bubbles(air, p1);
                part -= left;
                slope += thinning;
            }
            if let Some(law) = &self.volume_law {
                let (volume, by_pressure) = law.at(p1, &mut 0);
                part += volume / self.oil_volume_m3;
                slope += by_pressure / self.oil_volume_m3;
            }
        }
        (part, slope)
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
        }
        let (squeezed, squeezed_slope) = self.squeezed(p1);
        if squeezed_slope != 0.0 {
            let chamber = self.oil_volume_m3 - self.area_m2 * displacement_m;
            volume += chamber * (squeezed - base.squeezed);
            slope += chamber * squeezed_slope;
        }
        GivenWay {
            volume,
            slope,
            held,
            held_slope,
            squeezed,
            squeezed_slope,
        }
    }

    /// Solve one stage from `base`.
    pub fn stage(&self, base: &Store, at: &Moment, guess: &mut Guess) -> Stage {
        let c3 = at.opening[2] * self.valve3_coefficient + self.valve3_leak;
        if c3 > 0.0 {
            self.solve::<true>(base, at, 1.0 / c3, guess)
        } else {
            self.solve::<false>(base, at, 0.0, guess)
        }
    }

    /// `CONNECTED`: valve 3 lets oil through; `inverse_c3` is the inverse of its flow coefficient as far as it is open.
    fn solve<const CONNECTED: bool>(&self, base: &Store, at: &Moment, inverse_c3: f64, guess: &mut Guess) -> Stage {
        let mut supply = self.area_m2 * at.speed_m_s;
        if let Some(law) = &self.loss_law {
            supply -= law.value(base.p1);
        }
        let [path1, path2] = &self.paths;
        let Guess { segment, real, .. } = guess;
        path1.gas.refresh(&mut real[0], base.gas[0], at.h, guess.flow[0]);
        path2.gas.refresh(&mut real[1], base.gas[1], at.h, guess.flow[1]);
        let first = path1.setting(base, 0, at, self.transition_pa, &real[0]);
        let second = path2.setting(base, 1, at, self.transition_pa, &real[1]);
        let inverse_h = 1.0 / at.h;
        let inertia = self.inertance * inverse_h;

        // What the change of supply explains, and what it does not.
        let change = supply - guess.supply;
        let explained = |i: usize| guess.drop[i] + bounded(guess.gain[i] * change);
        let explained = [explained(0), if CONNECTED { explained(1) } else { 0.0 }];
        let mut d1 = explained[0] + bounded(guess.drift[0] * at.since);
        let mut d2 = if CONNECTED {
            explained[1] + bounded(guess.drift[1] * at.since)
        } else {
            0.0
        };
        let mut round = 0;
        loop {
            let one = path1.branch(&first, d1, &mut segment[0]);
            let p1 = one.oil + one.line + d1;
            let p1_slope = 1.0 + (one.oil_slope + one.line_slope) * one.flow_slope;
            let given = self.given_way(base, p1, at.displacement_m);
            let (stored, c) = (given.volume * inverse_h, given.slope * inverse_h);
            let two = if CONNECTED {
                path2.branch(&second, d2, &mut segment[1])
            } else {
                path2.behind(&second, 0.0, 0.0)
            };
            let (d3, d3_by, step1, step2, gain);
            if CONNECTED {
                let continuity = supply - stored - one.flow - two.flow;
                let c_d1 = -c * p1_slope - one.flow_slope;
                let behind = p1 - d2 - two.line - inertia * (two.flow - base.q2) - two.oil;
                let behind_d2 = -1.0 - (two.line_slope + inertia + two.oil_slope) * two.flow_slope;
                let (mesh, m_d1, m_d2);
                if let Some(law) = &self.valve3_law {
                    // A flow that falls with its drop cannot be solved for the drop: the loop is closed in flows. The
                    // slope leaves the law's own fall out; it is then too steep, never of the wrong sign.
                    let through = throttled(law, behind) / inverse_c3;
                    let (unit, unit_slope) = unit_flow(behind, self.transition_pa);
                    mesh = two.flow - through * unit;
                    m_d1 = -through * unit_slope * p1_slope;
                    m_d2 = two.flow_slope - through * unit_slope * behind_d2;
                    (d3, d3_by) = (behind, [p1_slope, behind_d2]);
                } else {
                    let (drop, slope) = unit_drop(two.flow * inverse_c3, self.transition_pa);
                    mesh = behind - drop;
                    m_d1 = p1_slope;
                    m_d2 = behind_d2 - slope * inverse_c3 * two.flow_slope;
                    (d3, d3_by) = (drop, [0.0, slope * inverse_c3 * two.flow_slope]);
                }
                let inverse = 1.0 / (c_d1 * m_d2 + two.flow_slope * m_d1);
                gain = [-m_d2 * inverse, m_d1 * inverse];
                step1 = gain[0] * continuity - two.flow_slope * inverse * mesh;
                step2 = gain[1] * continuity - c_d1 * inverse * mesh;
            } else {
                (d3, d3_by) = (0.0, [0.0; 2]);
                gain = [1.0 / (c * p1_slope + one.flow_slope), 0.0];
                step1 = gain[0] * (supply - stored - one.flow);
                step2 = 0.0;
            }
            round += 1;
            let p1_step = p1_slope * step1;
            let d3_step = d3_by[0] * step1 + d3_by[1] * step2;
            let least = if p1 + ATMOSPHERE_PA > LEAST_BUBBLE_PA {
                p1 + ATMOSPHERE_PA
            } else {
                LEAST_BUBBLE_PA
            };
            let straight = p1_step * p1_step <= NEGLECTED_PA * least
                && path1.is_straight(&first, &one, d1, step1, segment[0])
                && (!CONNECTED
                    || (path2.is_straight(&second, &two, d2, step2, segment[1])
                        && d3_step * d3_step <= 2.0 * NEGLECTED_PA * (self.transition_pa + d3.abs())))
                && (!self.has_unlisted || step1.abs().max(step2.abs()) <= UNLISTED_STEP_PA);
            if straight || round == MOST_ROUNDS {
                let (p1, one) = (p1 + p1_step, one.moved(step1, at.h));
                let (d3, two) = (d3 + d3_step, two.moved(step2, at.h));
                guess.drop = [d1 + step1, d2 + step2];
                guess.drift = [0, 1].map(|i| (guess.drop[i] - explained[i]) / at.since);
                guess.flow = [one.flow, two.flow];
                (guess.supply, guess.gain) = (supply, gain);
                let mut heat = base.heat;
                for (i, q) in guess.flow.iter().enumerate() {
                    if self.paths[i].fade_per_j > 0.0 {
                        heat[i] += at.h * guess.drop[i] * q;
                    }
                }
                return Stage {
                    store: Store {
                        p1,
                        held: given.held + given.held_slope * p1_step,
                        squeezed: given.squeezed + given.squeezed_slope * p1_step,
                        gas: [one.gas, two.gas],
                        q2: two.flow,
                        shear: [one.shear, two.shear],
                        heat,
                    },
                    pressure: [p1, one.oil, if CONNECTED { two.oil + d3 } else { p1 }, two.oil],
                };
            }
            // Near vacuum the chamber is soft on one side and hard on the other; an unbounded step leaps the gap. Kinks of
            // the tables can make full Newton steps cycle between two lines: after eight rounds the steps are halved, which
            // monotone residuals cannot resist.
            let relax = if round < 8 { 1.0 } else { 0.5 };
            d1 += relax * bounded(step1);
            d2 += relax * bounded(step2);
        }
    }
}

/// A change of a drop that is trusted.
#[inline(always)]
#[expect(clippy::manual_clamp, reason = "clamp's care of NaN costs three times as much")]
fn bounded(step: f64) -> f64 {
    if step > LONGEST_STEP_PA {
        LONGEST_STEP_PA
    } else if step < -LONGEST_STEP_PA {
        -LONGEST_STEP_PA
    } else {
        step
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
    let held = if absolute > LEAST_BUBBLE_PA {
        absolute
    } else {
        LEAST_BUBBLE_PA
    };
    let inverse = 1.0 / held;
    let ratio = ATMOSPHERE_PA * inverse;
    let n = air.polytropic_exponent;
    // Isothermal bubbles, the usual choice, need no power function.
    let (power, thinner) = if n == 1.0 {
        (ratio, inverse)
    } else {
        (libm::pow(ratio, 1.0 / n), inverse / n)
    };
    let volume = air.volume_fraction * power;
    let thinning = volume * thinner;
    (volume + thinning * (held - absolute), thinning)
}
