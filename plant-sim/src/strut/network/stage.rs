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
use super::law_memory::LawMemory;
use super::layout::Network;
use super::path::{NEGLECTED_PA, PathAnswer};
use super::stage_end::StageEnd;
use super::state::State;
use crate::lanes::{Mask, Number};
use crate::strut::flow_path::FlowPath;
use crate::strut::orifice::{unit_drop, unit_flow};
use crate::strut::pressure::absolute;
use crate::strut::terms::{LEAST_BUBBLE_PRESSURE, OilColumn, passed, throttled};

/// No state has been seen that needs more than a third of this many rounds.
const MOST_ROUNDS: u32 = 40;
/// Kinks of the tables can make full Newton steps cycle between two lines. After this many rounds the steps are halved,
/// which monotone residuals cannot resist.
const FULL_STEP_ROUNDS: u32 = 8;

/// Valve 3 lets oil through in all lanes, in none, or in some.
const CONNECTED: u8 = 0;
const CLOSED: u8 = 1;
const MIXED: u8 = 2;

/// Result of a stage.
#[derive(Debug, Clone, Copy)]
pub(in crate::strut) struct Stage<N = f64> {
    /// State at its end.
    pub state: State<N>,
    /// Gauge pressures p1 to p4, Pa.
    pub pressure_pa: [N; 4],
}

/// The loop of path 2 at a trial: what is left over in it, and the drop across valve 3; each with its derivatives by `d1`
/// and `d2`.
struct SecondLoop<N> {
    residual: N,
    by_d1: N,
    by_d2: N,
    drop: N,
    drop_by: [N; 2],
}

impl<N: Number> Network<N> {
    /// Flow coefficient of all that lets oil through between path 2 and its accumulator, m3/s/sqrt(Pa).
    #[inline(always)]
    fn valve3_passes<const LAWS: bool>(&self, at: &StageEnd<N>) -> N {
        let mut open = at.opening[Valve::Spring] * self.valve3_coefficient;
        if !LAWS {
            return open + self.valve3_leak;
        }
        if let Some(factor) = passed(&self.valve3_in_time, at.time_s) {
            open = open * factor;
        }
        let mut passes = open + self.valve3_leak;
        let [over_displacement, over_time] = &self.beside_valve3;
        if let Some(beside) = over_displacement.opening(at.displacement_m) {
            passes = passes + beside;
        }
        if let Some(beside) = over_time.opening(at.time_s) {
            passes = passes + beside;
        }
        passes
    }

    /// Solve one stage from `base`. The result does not depend on `last` beyond the solver's tolerance. `LAWS` says whether laws without a name are
    /// looked for.
    #[inline(always)]
    pub fn stage<const LAWS: bool>(&self, base: &State<N>, at: &StageEnd<N>, last: &mut LastSolution<N>) -> Stage<N> {
        let passes = self.valve3_passes::<LAWS>(at);
        let connected = passes.above(passes.of(0.0));
        if connected.all() {
            self.solve::<CONNECTED, LAWS>(base, at, passes, last)
        } else if N::IS_SINGLE || !connected.any() {
            self.solve::<CLOSED, LAWS>(base, at, passes, last)
        } else {
            self.solve::<MIXED, LAWS>(base, at, passes, last)
        }
    }

    /// `VALVE_3` says in which lanes it lets oil through, `passes` its flow coefficient (m3/s/sqrt(Pa)).
    #[inline(always)]
    fn solve<const VALVE_3: u8, const LAWS: bool>(
        &self,
        base: &State<N>,
        at: &StageEnd<N>,
        passes: N,
        last: &mut LastSolution<N>,
    ) -> Stage<N> {
        let zero = passes.of(0.0);
        let connected = if VALVE_3 == CLOSED {
            zero.above(zero)
        } else {
            passes.above(zero)
        };
        let inverse_c3 = match VALVE_3 {
            CONNECTED => passes.recip(),
            CLOSED => zero,
            _ => N::choose(connected, passes.recip(), zero),
        };
        let supply = self.chamber.supply_m3_s::<LAWS>(at.speed_m_s, base.p1_pa, at.time_s);
        let mut explained = last.explained(supply);
        let [mut d1, mut d2] = last.predicted(explained, at.since_last_s);
        if VALVE_3 != CONNECTED {
            explained[1] = N::choose(connected, explained[1], zero);
            d2 = N::choose(connected, d2, zero);
        }
        let [path1, path2] = &self.paths;
        let LastSolution { segment, real, .. } = last;
        path1
            .gas
            .refresh(&mut real[0], base.gas[0], at.duration_s, last.flow[0]);
        path2
            .gas
            .refresh(&mut real[1], base.gas[1], at.duration_s, last.flow[1]);
        let first = path1.start::<LAWS>(FlowPath::One, base, at, self.transition_pa, &real[0]);
        let second = path2.start::<LAWS>(FlowPath::Two, base, at, self.transition_pa, &real[1]);
        let mut line1 = path1.line(&segment[0], zero);
        let mut line2 = path2.line(&segment[1], zero);
        let inverse_duration = at.duration_s.recip();
        let column = OilColumn::during(self.inertance_kg_m4, inverse_duration);

        let mut round = 0;
        // A lane that is done is given the same trial again until all are: the same answer, to the bit.
        let mut done = zero.above(zero);
        let mut is_prediction = true;
        loop {
            let one = path1.answer::<LAWS>(&first, d1, &mut segment[0], &mut line1);
            let p1 = one.oil_pa + one.line_pa + d1;
            let p1_slope = (one.oil_slope + one.line_slope) * one.flow_slope + 1.0;
            let chamber = self.chamber.taken_up::<LAWS>(base, p1, at.displacement_m);
            let (stored, c) = (chamber.volume_m3 * inverse_duration, chamber.slope * inverse_duration);
            let (mut flow2, mut flow2_slope) = (zero, zero);
            if VALVE_3 != CLOSED {
                (flow2, flow2_slope) = path2.flow::<LAWS>(&second, d2, &mut segment[1], &mut line2);
            }
            if VALVE_3 == MIXED {
                flow2 = N::choose(connected, flow2, zero);
                flow2_slope = N::choose(connected, flow2_slope, zero);
            }
            let two = path2.answer_to_flow::<LAWS>(&second, flow2, flow2_slope);
            if is_prediction {
                is_prediction = false;
                // A rate that was seen for an instant may predict more oil than an accumulator holds. From there Newton's method would take
                // hundreds of rounds; from drops of zero it takes a few.
                let hopeless = path1.gas.is_full(one.gas) | path2.gas.is_full(two.gas);
                if hopeless.any() {
                    d1 = N::choose(hopeless, zero, d1);
                    d2 = N::choose(hopeless, zero, d2);
                    continue;
                }
            }
            let (mut d3, mut d3_by) = (zero, [zero; 2]);
            let (mut step1, mut step2, mut gain) = (zero, zero, [zero; 2]);
            if VALVE_3 != CLOSED {
                let continuity = supply - stored - one.flow - two.flow;
                let c_d1 = -c * p1_slope - one.flow_slope;
                let second_loop = self.second_loop::<LAWS>(p1, p1_slope, d2, &two, column, base.q2_m3_s, inverse_c3);
                let SecondLoop {
                    residual, by_d1, by_d2, ..
                } = second_loop;
                (d3, d3_by) = (second_loop.drop, second_loop.drop_by);
                let inverse = (c_d1 * by_d2 + two.flow_slope * by_d1).recip();
                gain = [-by_d2 * inverse, by_d1 * inverse];
                step1 = gain[0] * continuity - two.flow_slope * inverse * residual;
                step2 = gain[1] * continuity - c_d1 * inverse * residual;
            }
            if VALVE_3 != CONNECTED {
                let gain1 = (c * p1_slope + one.flow_slope).recip();
                gain = [
                    N::choose(connected, gain[0], gain1),
                    N::choose(connected, gain[1], zero),
                ];
                step1 = N::choose(connected, step1, gain1 * (supply - stored - one.flow));
                step2 = N::choose(connected, step2, zero);
                d3 = N::choose(connected, d3, zero);
                d3_by = [
                    N::choose(connected, d3_by[0], zero),
                    N::choose(connected, d3_by[1], zero),
                ];
            }
            round += 1;
            let p1_step = p1_slope * step1;
            let d3_step = d3_by[0] * step1 + d3_by[1] * step2;
            let least = absolute(Gauge(p1)).pa().at_least(p1.of(LEAST_BUBBLE_PRESSURE.pa()));
            let mut nearly_linear = (p1_step * p1_step).up_to(least * NEGLECTED_PA)
                & path1.is_nearly_linear(&first, &one, d1, step1, &line1);
            if VALVE_3 != CLOSED {
                let behind = path2.is_nearly_linear(&second, &two, d2, step2, &line2)
                    & (d3_step * d3_step).up_to((self.transition_pa + d3.abs()) * (2.0 * NEGLECTED_PA));
                nearly_linear = nearly_linear & (behind | passes.up_to(zero));
            }
            if LAWS {
                let longest = self.longest_step_pa;
                nearly_linear = nearly_linear & step1.abs().up_to(longest) & step2.abs().up_to(longest);
            }
            done = done | nearly_linear;
            if done.all() || round == MOST_ROUNDS {
                let (p1, one) = (p1 + p1_step, one.moved(step1, at.duration_s));
                let (d3, two) = (d3 + d3_step, two.moved(step2, at.duration_s));
                last.drop = [d1 + step1, d2 + step2];
                let [explained1, explained2] = explained;
                let [drop1, drop2] = last.drop;
                last.drift = [
                    (drop1 - explained1) / at.since_last_s,
                    (drop2 - explained2) / at.since_last_s,
                ];
                last.flow = [one.flow, two.flow];
                (last.supply, last.gain) = (supply, gain);
                let [heat1, heat2] = base.heat_j;
                let [pack1, pack2] = base.laws.pack_j;
                return Stage {
                    state: State {
                        p1_pa: p1,
                        held_m3: chamber.held_m3 + chamber.held_slope * p1_step,
                        compressed: chamber.compressed + chamber.compressed_slope * p1_step,
                        gas: [one.gas, two.gas],
                        q2_m3_s: two.flow,
                        shear: [one.shear, two.shear],
                        heat_j: [
                            path1.fade.heated(heat1, at.duration_s, drop1, one.flow),
                            path2.fade.heated(heat2, at.duration_s, drop2, two.flow),
                        ],
                        laws: LawMemory {
                            mean_volume: [one.mean_volume, two.mean_volume],
                            gas_energy: [one.gas_energy, two.gas_energy],
                            pack_j: [
                                path1.pack_j::<LAWS>(pack1, at.duration_s, drop1, one.flow),
                                path2.pack_j::<LAWS>(pack2, at.duration_s, drop2, two.flow),
                            ],
                        },
                    },
                    pressure_pa: [p1, one.oil_pa, N::choose(connected, two.oil_pa + d3, p1), two.oil_pa],
                };
            }
            let relax = if round < FULL_STEP_ROUNDS { 1.0 } else { 0.5 };
            d1 = N::choose(done, d1, d1 + bounded(step1) * relax);
            d2 = N::choose(done, d2, d2 + bounded(step2) * relax);
        }
    }

    /// The loop of path 2 at a trial: from the main chamber through pack 2, line 2 and valve 3 to accumulator 2.
    #[inline(always)]
    #[expect(
        clippy::too_many_arguments,
        reason = "the trial's numbers, of which no two belong together"
    )]
    fn second_loop<const LAWS: bool>(
        &self,
        p1: N,
        p1_slope: N,
        d2: N,
        two: &PathAnswer<N>,
        column: OilColumn<N>,
        q2_before: N,
        inverse_c3: N,
    ) -> SecondLoop<N> {
        let behind = p1 - d2 - two.line_pa - column.drop(q2_before, two.flow) - two.oil_pa;
        let behind_d2 = -((two.line_slope + column.slope + two.oil_slope) * two.flow_slope) - 1.0;
        if LAWS && let Some(factor) = throttled(&self.valve3_throttle, behind) {
            // A flow that falls with its drop cannot be solved for the drop: the loop is closed in flows. The slope leaves
            // the law's own fall out; it is then too steep, never of the wrong sign.
            let through = factor / inverse_c3;
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
                drop_by: [two.flow.of(0.0), slope * inverse_c3 * two.flow_slope],
            }
        }
    }
}
