//! Stiff on a smooth road, soft on a rough one, stiff again as soon as the vehicle corners.
//!
//! ```text
//!   cornering   |a_y| > max(floor, k sigma)       until |a_y| stays below a part of it for the hold time
//!   smooth      running RMS of z'' < its bound    with hysteresis; not left while the vehicle corners
//!
//!                      | springs | dampers
//!   cornering, smooth  | stiff   | high
//!   rough              | soft    | by the road's level: damper 1 high or low
//! ```
//!
//! `a_y` is the lateral acceleration of [`crate::estimate`], reconstructed from forces and roll, and `sigma` its running RMS
//! over the last seconds in which the vehicle did not corner: the part of it that the road makes. On a smooth road nothing has to be
//! decided in time, because the vehicle is stiff already; on a rough one the decision comes as soon as the lateral acceleration
//! stands out of what the road does.
//!
//! Damper 1 stays high in the rough up to a level of the road, and damper 2 low: that is better than both low on most roads
//! (`docs/controller.md`).

use oleo_interface::{Corners, StrutValves};

use super::demand::{Decide, Demand, Urgency};
use super::parts::rollover_guard;
use crate::estimate::Estimate;
use crate::filter::{LowPass, at_least};
use crate::plausibility::Trusted;
use crate::range::{ConfigurationError, Hysteresis, within};
use crate::timing::ticks;
use crate::valves::ValveCommand;
use crate::vehicle::VehicleDescription;

/// Time for which the lateral acceleration must stay low before cornering is over: a lane change crosses zero in between.
const HOLD_TICKS: u16 = ticks(1_500);
/// Time before the road is known well enough to tell a bend from it.
const LEARNING_TICKS: u16 = ticks(2_000);
/// Shortest time that the road counts as rough, or as smooth.
const ROAD_DWELL_TICKS: u16 = ticks(1_000);

/// Thresholds. See [`strategy::Tuning`](super::Tuning) for an example.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuning {
    /// Lateral acceleration above which the vehicle corners on a road that makes none itself, m/s2, 0.1 to 5.
    pub cornering_floor_m_s2: f32,
    /// Multiple of the running RMS of the lateral acceleration that counts as cornering, 1 to 20.
    pub cornering_multiple: f32,
    /// Part of the threshold below which cornering ends, 0.05 to 1.
    pub release_share: f32,
    /// Time constant of the running RMS of the lateral acceleration, s, 0.5 to 60.
    pub lateral_memory_s: f32,
    /// Running RMS of the vertical acceleration at which damper 1 begins to be high (`begin`), and low again (`end`), m/s2, 0.01 to 20.
    pub very_rough_m_s2: Hysteresis,
    /// Running RMS of the vertical acceleration at which a smooth road begins to count as rough (`begin`) and at which a rough
    /// one begins to count as smooth (`end`), m/s2, 0.01 to 10. The first is felt with stiff springs, the second with soft.
    pub rough_m_s2: Hysteresis,
    /// When the roll-over guard acts.
    pub rollover_guard: rollover_guard::Tuning,
}

impl Default for Tuning {
    fn default() -> Self {
        Self {
            cornering_floor_m_s2: 0.8,
            cornering_multiple: 3.5,
            release_share: 0.6,
            lateral_memory_s: 6.0,
            very_rough_m_s2: Hysteresis { begin: 1.3, end: 1.0 },
            rough_m_s2: Hysteresis { begin: 0.30, end: 0.10 },
            rollover_guard: rollover_guard::Tuning::default(),
        }
    }
}

/// Parameters of the strategy. See [`Decide`] for an example of a strategy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoadAndCornering {
    floor_2: f32,
    multiple_2: f32,
    release_share_2: f32,
    lateral_memory: LowPass,
    lateral_memory_in_bends: LowPass,
    first_memory: LowPass,
    slow: LowPass,
    rough_2: Hysteresis,
    very_rough_2: Hysteresis,
    guard: rollover_guard::Tuning,
}

/// What the strategy remembers. See [`strategy::State`](super::State) for an example.
#[derive(Clone, Copy, Debug, Default)]
pub struct State {
    /// Mean square of the lateral acceleration outside of bends, m2/s4.
    lateral_mean_square: f32,
    /// Ticks for which cornering is held yet.
    cornering: u16,
    rough: bool,
    very_rough: bool,
    slow_m_s2: f32,
    known: u16,
    /// Ticks before the road may be judged again.
    dwell: u16,
    guard: rollover_guard::State,
}

impl Decide for RoadAndCornering {
    type Tuning = Tuning;
    type State = State;

    fn check(tuning: &Tuning) -> Result<(), ConfigurationError> {
        let within = |name, value, least, most| within(name, value, least, most);
        within("tuning.strategy.road_and_cornering.cornering_floor_m_s2", tuning.cornering_floor_m_s2, 0.1, 5.0)?;
        within("tuning.strategy.road_and_cornering.cornering_multiple", tuning.cornering_multiple, 1.0, 20.0)?;
        within("tuning.strategy.road_and_cornering.release_share", tuning.release_share, 0.05, 1.0)?;
        within("tuning.strategy.road_and_cornering.lateral_memory_s", tuning.lateral_memory_s, 0.5, 60.0)?;
        tuning
            .rough_m_s2
            .check("tuning.strategy.road_and_cornering.rough_m_s2", 0.01, 10.0)?;
        tuning.rollover_guard.check()
    }

    fn new(_: &VehicleDescription, tuning: &Tuning) -> Self {
        let square = |x: f32| x * x;
        Self {
            floor_2: square(tuning.cornering_floor_m_s2),
            multiple_2: square(tuning.cornering_multiple),
            release_share_2: square(tuning.release_share),
            lateral_memory: LowPass::from_time_constant_s(tuning.lateral_memory_s),
            lateral_memory_in_bends: LowPass::from_time_constant_s(5.0 * tuning.lateral_memory_s),
            first_memory: LowPass::from_time_constant_s(0.7),
            slow: LowPass::from_time_constant_s(0.4),
            very_rough_2: tuning.very_rough_m_s2.squared(),
            rough_2: tuning.rough_m_s2.squared(),
            guard: tuning.rollover_guard,
        }
    }

    fn step(&self, state: &mut State, estimate: &Estimate, _: &Trusted) -> Demand {
        let rollover_guard = state.guard.step(&self.guard, estimate);
        let entered = state.cornering == 0;
        let cornering = self.corners(state, estimate);
        if !cornering {
            self.judge_road(state, estimate.vertical_mean_square);
        }
        let valves = if cornering || rollover_guard || !state.rough {
            ValveCommand::SAFE
        } else {
            ValveCommand::from_corners(Corners::splat(StrutValves::new(!state.very_rough, true, true)))
        };
        let urgency = if rollover_guard || (cornering && entered) {
            Urgency::Emergency
        } else if cornering {
            Urgency::Handling
        } else {
            Urgency::Comfort
        };
        Demand {
            valves,
            urgency,
            handling: cornering,
            rollover_guard,
        }
    }
}

impl RoadAndCornering {
    /// Whether the vehicle corners.
    fn corners(&self, state: &mut State, estimate: &Estimate) -> bool {
        let lateral = estimate.lateral_acceleration_m_s2;
        let slow = self.slow.step(&mut state.slow_m_s2, lateral);
        let (square, slow_2) = (lateral * lateral, slow * slow);
        let threshold_2 = at_least(self.multiple_2 * state.lateral_mean_square, self.floor_2);
        state.known = state.known.saturating_add(1);
        if state.known > LEARNING_TICKS && square > threshold_2 {
            state.cornering = HOLD_TICKS;
        } else if state.cornering > 0 && slow_2 < self.release_share_2 * threshold_2 {
            state.cornering -= 1;
        }
        let memory = if state.known <= LEARNING_TICKS {
            &self.first_memory
        } else if state.cornering == 0 {
            &self.lateral_memory
        } else {
            &self.lateral_memory_in_bends
        };
        memory.step(&mut state.lateral_mean_square, square);
        state.cornering > 0
    }

    /// Whether the road is rough, by what the body feels of it.
    fn judge_road(&self, state: &mut State, vertical_mean_square: f32) {
        state.dwell = state.dwell.saturating_sub(1);
        let changes = if state.rough {
            vertical_mean_square < self.rough_2.end
        } else {
            vertical_mean_square > self.rough_2.begin
        };
        if state.very_rough {
            state.very_rough = vertical_mean_square > self.very_rough_2.end;
        } else {
            state.very_rough = vertical_mean_square > self.very_rough_2.begin;
        }
        if changes && state.dwell == 0 {
            state.rough = !state.rough;
            state.dwell = ROAD_DWELL_TICKS;
        }
    }
}
