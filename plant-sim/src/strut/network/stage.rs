//! One implicit stage of the network: given where each state came from, the pressures and flows at the stage's end.
//!
//! Two unknowns whatever the terms: the pressure drops `d1`, `d2` across damper packs 1 and 2. Everything else follows
//! from them without a further loop, because each element gives its flow or its drop in closed form:
//!
//! * `Q_i(d_i)`: pack, bypass valve and leak in parallel;
//! * the accumulator's pressure from `V - h Q` and the energy equation;
//! * `p1 = p2 + d1 + R1 Q1`;
//! * the drop `d3` across valve 3 from `Q2` by the inverse orifice law.
//!
//! Two residuals: continuity of the main chamber, `A x' - C dp1/dt - Q1 - Q2 = 0`, and the loop of path 2,
//! `p1 - d2 - R2 Q2 - I dQ2/dt - d3 - p4 = 0`. Both rise or fall monotonically in both unknowns (resistances, springs and
//! masses only), so Newton's method with a bounded step finds the one solution. It needs one round in four stages of five,
//! since the start is predicted ([`LastSolution`]) and the last step is taken linearly as soon as its square does not
//! matter.

use oleo_interface::{Gauge, Valve};

use super::bounded::bounded;
use super::last_solution::LastSolution;
use super::layout::Network;
use super::path::{NEGLECTED_PA, PathAnswer};
use super::stage_end::StageEnd;
use super::state::State;
use crate::strut::flow_path::FlowPath;
use crate::strut::orifice::{unit_drop, unit_flow};
use crate::strut::terms::{LEAST_BUBBLE_PRESSURE, OilColumn, passed, throttled};

/// The longest Newton step in the drops, Pa, that is taken linearly where the model has unmodelled laws: the kinks of
/// their tables are not looked for.
const UNLISTED_STEP_PA: f64 = 300.0;
/// No state has been seen that needs more than a third of this many rounds.
const MOST_ROUNDS: u32 = 40;
/// Kinks of the tables can make full Newton steps cycle between two lines. After this many rounds the steps are halved,
/// which monotone residuals cannot resist.
const FULL_STEP_ROUNDS: u32 = 8;
/// Result of a stage.
#[derive(Debug, Clone, Copy)]
pub(in crate::strut) struct Stage {
    /// State at its end.
    pub state: State,
    /// Gauge pressures p1 to p4, Pa.
    pub pressure_pa: [f64; 4],
}

/// The loop of path 2 at a trial: what is left over in it, and the drop across valve 3; each with its derivatives by `d1`
/// and `d2`.
struct SecondLoop {
    residual: f64,
    by_d1: f64,
    by_d2: f64,
    drop: f64,
    drop_by: [f64; 2],
}

impl Network {
    /// Solve one stage from `base`. The result does not depend on `last` beyond the solver's tolerance.
    pub fn stage(&self, base: &State, at: &StageEnd, last: &mut LastSolution) -> Stage {
        let mut open = at.opening[Valve::Spring] * self.valve3_coefficient;
        if self.has_unlisted_laws {
            open *= passed(&self.valve3_in_time, at.time_s);
        }
        let mut c3 = open + self.valve3_leak;
        if self.has_unlisted_laws {
            c3 += self.beside_valve3(at);
        }
        if c3 > 0.0 {
            self.solve::<true>(base, at, 1.0 / c3, last)
        } else {
            self.solve::<false>(base, at, 0.0, last)
        }
    }

    /// Flow coefficient of an unmodelled opening beside valve 3, m3/s/sqrt(Pa).
    #[cold]
    fn beside_valve3(&self, at: &StageEnd) -> f64 {
        [at.displacement_m, at.time_s]
            .into_iter()
            .zip(&self.beside_valve3)
            .filter_map(|(argument, law)| Some(law.as_ref()?.value(argument).max(0.0)))
            .sum()
    }

    /// `CONNECTED`: valve 3 lets oil through. `inverse_c3` is one over its flow coefficient as far as it is open.
    fn solve<const CONNECTED: bool>(
        &self,
        base: &State,
        at: &StageEnd,
        inverse_c3: f64,
        last: &mut LastSolution,
    ) -> Stage {
        let supply = self.chamber.supply_m3_s(at.speed_m_s, base.p1_pa, at.time_s);
        let explained = last.explained::<CONNECTED>(supply);
        let [mut d1, mut d2] = last.predicted::<CONNECTED>(explained, at.since_last_s);
        let [path1, path2] = &self.paths;
        let LastSolution { segment, real, .. } = last;
        path1
            .gas
            .refresh(&mut real[0], base.gas[0], at.duration_s, last.flow[0]);
        path2
            .gas
            .refresh(&mut real[1], base.gas[1], at.duration_s, last.flow[1]);
        let first = path1.start(FlowPath::One, base, at, self.transition_pa, &real[0]);
        let second = path2.start(FlowPath::Two, base, at, self.transition_pa, &real[1]);
        let inverse_duration = 1.0 / at.duration_s;
        let column = OilColumn::during(self.inertance_kg_m4, inverse_duration);

        let mut round = 0;
        loop {
            let one = path1.answer(&first, d1, &mut segment[0]);
            let p1 = one.oil_pa + one.line_pa + d1;
            let p1_slope = 1.0 + (one.oil_slope + one.line_slope) * one.flow_slope;
            let chamber = self.chamber.taken_up(base, p1, at.displacement_m);
            let (stored, c) = (chamber.volume_m3 * inverse_duration, chamber.slope * inverse_duration);
            let two = if CONNECTED {
                path2.answer(&second, d2, &mut segment[1])
            } else {
                path2.answer_to_flow(&second, 0.0, 0.0)
            };
            let (d3, d3_by, step1, step2, gain);
            if CONNECTED {
                let continuity = supply - stored - one.flow - two.flow;
                let c_d1 = -c * p1_slope - one.flow_slope;
                let second_loop = self.second_loop(p1, p1_slope, d2, &two, column, base.q2_m3_s, inverse_c3);
                let SecondLoop {
                    residual, by_d1, by_d2, ..
                } = second_loop;
                (d3, d3_by) = (second_loop.drop, second_loop.drop_by);
                let inverse = 1.0 / (c_d1 * by_d2 + two.flow_slope * by_d1);
                gain = [-by_d2 * inverse, by_d1 * inverse];
                step1 = gain[0] * continuity - two.flow_slope * inverse * residual;
                step2 = gain[1] * continuity - c_d1 * inverse * residual;
            } else {
                (d3, d3_by) = (0.0, [0.0; 2]);
                gain = [1.0 / (c * p1_slope + one.flow_slope), 0.0];
                step1 = gain[0] * (supply - stored - one.flow);
                step2 = 0.0;
            }
            round += 1;
            let p1_step = p1_slope * step1;
            let d3_step = d3_by[0] * step1 + d3_by[1] * step2;
            let least = if Gauge(p1).absolute() > LEAST_BUBBLE_PRESSURE {
                Gauge(p1).absolute()
            } else {
                LEAST_BUBBLE_PRESSURE
            };
            let nearly_linear = p1_step * p1_step <= NEGLECTED_PA * least.pa()
                && path1.is_nearly_linear(&first, &one, d1, step1, segment[0])
                && (!CONNECTED
                    || (path2.is_nearly_linear(&second, &two, d2, step2, segment[1])
                        && d3_step * d3_step <= 2.0 * NEGLECTED_PA * (self.transition_pa + d3.abs())))
                && (!self.has_unlisted_laws || step1.abs().max(step2.abs()) <= UNLISTED_STEP_PA);
            if nearly_linear || round == MOST_ROUNDS {
                let (p1, one) = (p1 + p1_step, one.moved(step1, at.duration_s));
                let (d3, two) = (d3 + d3_step, two.moved(step2, at.duration_s));
                last.drop = [d1 + step1, d2 + step2];
                last.drift = [0, 1].map(|i| (last.drop[i] - explained[i]) / at.since_last_s);
                last.flow = [one.flow, two.flow];
                (last.supply, last.gain) = (supply, gain);
                let heat = |i: usize| {
                    let fade = &self.paths[i].fade;
                    fade.heated(base.heat_j[i], at.duration_s, last.drop[i], last.flow[i])
                };
                return Stage {
                    state: State {
                        p1_pa: p1,
                        held_m3: chamber.held_m3 + chamber.held_slope * p1_step,
                        compressed: chamber.compressed + chamber.compressed_slope * p1_step,
                        gas: [one.gas, two.gas],
                        q2_m3_s: two.flow,
                        shear: [one.shear, two.shear],
                        heat_j: [heat(0), heat(1)],
                        mean_volume: [one.mean_volume, two.mean_volume],
                    },
                    pressure_pa: [p1, one.oil_pa, if CONNECTED { two.oil_pa + d3 } else { p1 }, two.oil_pa],
                };
            }
            let relax = if round < FULL_STEP_ROUNDS { 1.0 } else { 0.5 };
            d1 += relax * bounded(step1);
            d2 += relax * bounded(step2);
        }
    }

    /// The loop of path 2 at a trial: from the main chamber through pack 2, line 2 and valve 3 to accumulator 2.
    #[inline(always)]
    #[expect(
        clippy::too_many_arguments,
        reason = "the trial's numbers, of which no two belong together"
    )]
    fn second_loop(
        &self,
        p1: f64,
        p1_slope: f64,
        d2: f64,
        two: &PathAnswer,
        column: OilColumn,
        q2_before: f64,
        inverse_c3: f64,
    ) -> SecondLoop {
        let behind = p1 - d2 - two.line_pa - column.drop(q2_before, two.flow) - two.oil_pa;
        let behind_d2 = -1.0 - (two.line_slope + column.slope + two.oil_slope) * two.flow_slope;
        if let Some(law) = &self.valve3_throttle {
            // A flow that falls with its drop cannot be solved for the drop: the loop is closed in flows. The slope leaves
            // the law's own fall out; it is then too steep, never of the wrong sign.
            let through = throttled(law, behind) / inverse_c3;
            let (unit, unit_slope) = unit_flow(behind, self.transition_pa);
            SecondLoop {
                residual: two.flow - through * unit,
                by_d1: -through * unit_slope * p1_slope,
                by_d2: two.flow_slope - through * unit_slope * behind_d2,
                drop: behind,
                drop_by: [p1_slope, behind_d2],
            }
        } else {
            let (drop, slope) = unit_drop(two.flow * inverse_c3, self.transition_pa);
            SecondLoop {
                residual: behind - drop,
                by_d1: p1_slope,
                by_d2: behind_d2 - slope * inverse_c3 * two.flow_slope,
                drop,
                drop_by: [0.0, slope * inverse_c3 * two.flow_slope],
            }
        }
    }
}
