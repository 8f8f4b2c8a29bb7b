//! Stiff on a smooth road, soft on a rough one, stiff again as soon as the vehicle corners.
//!
//! | | springs | dampers |
//! |---|---|---|
//! | smooth road, or cornering | stiff | high |
//! | rough road | soft | low |
//! | very rough road | soft | damper 1 high, damper 2 low |
//!
//! On a smooth road nothing has to be decided in time, because the vehicle is stiff already. On a rough one it becomes stiff as
//! soon as the lateral acceleration stands out of what the road does ([`super::parts::cornering`]), and at once: a lean that the closing
//! springs trap is smaller than the one that a later closing would find. It stays so while the gas says that it leans
//! (`parts::load_transfer`). How rough the road is is told by the running RMS of the body's vertical acceleration, which is not
//! judged while the vehicle corners, and does not begin to count as rough while the lateral acceleration has the greater RMS: a bend
//! that is not recognised, on a vehicle whose sensors are off, must not open the springs. Which damper level is best on which road is
//! measured in `docs/controller.md`.

use oleo_interface::{Corners, StrutValves};

use super::demand::{Decide, Demand, Urgency};
use super::parts::{cornering, load_transfer, rollover_guard};
use crate::estimate::Estimate;
use crate::plausibility::Trusted;
use crate::range::{ConfigurationError, Hysteresis};
use crate::timing::ticks;
use crate::valves::ValveCommand;
use crate::vehicle::VehicleDescription;

/// Shortest time that the road counts as rough, or as smooth.
const ROAD_DWELL_TICKS: u16 = ticks(1_000);

/// Thresholds. See [`strategy::Tuning`](super::Tuning) for an example.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuning {
    /// When the vehicle corners.
    pub cornering: cornering::Tuning,
    /// Running RMS of the vertical acceleration at which a smooth road begins to count as rough (`begin`) and at which a rough
    /// one begins to count as smooth (`end`), m/s2, 0.01 to 10. The first is felt with stiff springs, the second with soft.
    pub rough_m_s2: Hysteresis,
    /// Running RMS of the vertical acceleration at which damper 1 begins to be high (`begin`), and low again (`end`), m/s2,
    /// 0.01 to 20.
    pub very_rough_m_s2: Hysteresis,
    /// When the roll-over guard acts.
    pub rollover_guard: rollover_guard::Tuning,
}

impl Default for Tuning {
    fn default() -> Self {
        Self {
            cornering: cornering::Tuning::default(),
            rough_m_s2: Hysteresis { begin: 0.25, end: 0.06 },
            very_rough_m_s2: Hysteresis { begin: 1.3, end: 1.0 },
            rollover_guard: rollover_guard::Tuning::default(),
        }
    }
}

/// Parameters of the strategy. See [`Decide`] for an example of a strategy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoadAndCornering {
    cornering: cornering::Parameters,
    load_transfer: load_transfer::Parameters,
    rough_2: Hysteresis,
    very_rough_2: Hysteresis,
    guard: rollover_guard::Tuning,
}

/// What the strategy remembers. See [`strategy::State`](super::State) for an example.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct State {
    cornering: cornering::State,
    load_transfer: load_transfer::State,
    corners: bool,
    rough: bool,
    very_rough: bool,
    /// Ticks before the road may be judged again.
    dwell: u16,
    guard: rollover_guard::State,
}

impl Decide for RoadAndCornering {
    type Tuning = Tuning;
    type State = State;
    const INITIAL: State = State {
        cornering: cornering::State::INITIAL,
        load_transfer: load_transfer::State::INITIAL,
        corners: false,
        rough: false,
        very_rough: false,
        dwell: 0,
        guard: rollover_guard::State::INITIAL,
    };

    fn check(tuning: &Tuning) -> Result<(), ConfigurationError> {
        tuning.cornering.check()?;
        tuning
            .rough_m_s2
            .check("tuning.strategy.road_and_cornering.rough_m_s2", 0.01, 10.0)?;
        tuning
            .very_rough_m_s2
            .check("tuning.strategy.road_and_cornering.very_rough_m_s2", 0.01, 20.0)?;
        tuning.rollover_guard.check([
            "tuning.strategy.road_and_cornering.rollover_guard.roll_rad",
            "tuning.strategy.road_and_cornering.rollover_guard.lateral_m_s2",
        ])
    }

    fn new(vehicle: &VehicleDescription, tuning: &Tuning) -> Self {
        Self {
            cornering: cornering::Parameters::new(&tuning.cornering),
            load_transfer: load_transfer::Parameters::new(vehicle),
            rough_2: tuning.rough_m_s2.squared(),
            very_rough_2: tuning.very_rough_m_s2.squared(),
            guard: tuning.rollover_guard,
        }
    }

    fn step(&self, state: &mut State, estimate: &Estimate, trusted: &Trusted) -> Demand {
        let rollover_guard = state.guard.step(&self.guard, estimate);
        let leans = (state.load_transfer).step(
            &self.load_transfer,
            trusted.load_to_right_m,
            estimate.roll_rad,
            state.corners,
        );
        let corners = state.cornering.step(&self.cornering, estimate, leans);
        state.corners = corners;
        if !corners {
            self.judge_road(state, estimate);
        }
        let valves = if corners || rollover_guard || !state.rough {
            ValveCommand::SAFE
        } else {
            ValveCommand::from_corners(Corners::splat(StrutValves::new(!state.very_rough, true, true)))
        };
        // At once, whatever lean that traps.
        let urgency = if rollover_guard || corners {
            Urgency::Emergency
        } else {
            Urgency::Comfort
        };
        Demand {
            valves,
            urgency,
            handling: corners,
            rollover_guard,
        }
    }
}

impl RoadAndCornering {
    /// Whether the road is rough or very rough, by what the body feels of it.
    fn judge_road(&self, state: &mut State, estimate: &Estimate) {
        let (vertical_mean_square, lateral_mean_square) = (estimate.vertical_mean_square, estimate.lateral_mean_square);
        state.dwell = state.dwell.saturating_sub(1);
        let changes = if state.rough {
            vertical_mean_square < self.rough_2.end
        } else {
            vertical_mean_square > self.rough_2.begin && vertical_mean_square > lateral_mean_square
        };
        if changes && state.dwell == 0 {
            state.rough = !state.rough;
            state.dwell = ROAD_DWELL_TICKS;
        }
        let bound = if state.very_rough {
            self.very_rough_2.end
        } else {
            self.very_rough_2.begin
        };
        state.very_rough = vertical_mean_square > bound;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lateral::Bands;

    fn opens(vertical_rms: f32, lateral_rms: f32) -> bool {
        let strategy = RoadAndCornering::new(&VehicleDescription::default(), &Tuning::default());
        let estimate = Estimate {
            vertical_mean_square: vertical_rms * vertical_rms,
            lateral_mean_square: lateral_rms * lateral_rms,
            ..Estimate::default()
        };
        let demand = strategy.step(&mut { RoadAndCornering::INITIAL }, &estimate, &Trusted::default());
        demand.valves != ValveCommand::SAFE
    }

    #[test]
    fn a_road_is_rough_by_its_vertical_motion_unless_the_lateral_one_is_greater() {
        assert!(!opens(0.24, 0.0));
        assert!(opens(0.26, 0.0) && opens(0.26, 0.25) && opens(2.0, 1.9));
        // A bend that is not recognised shakes the body a little, too.
        assert!(!opens(0.26, 0.27) && !opens(2.0, 2.1));
    }

    #[test]
    fn a_rough_road_stays_rough_whatever_the_lateral_motion() {
        let strategy = RoadAndCornering::new(&VehicleDescription::default(), &Tuning::default());
        let mut state = RoadAndCornering::INITIAL;
        let mut rough = Estimate {
            vertical_mean_square: 0.3,
            ..Estimate::default()
        };
        strategy.step(&mut state, &rough, &Trusted::default());
        rough.lateral_mean_square = 2.0;
        for _ in 0..2 * ROAD_DWELL_TICKS {
            let demand = strategy.step(&mut state, &rough, &Trusted::default());
            assert_ne!(demand.valves, ValveCommand::SAFE);
        }
    }

    /// A strategy that has known a road of this vertical RMS for ten seconds, m/s2, and what it then wants with a lateral acceleration and
    /// a lean, m/s2 and rad.
    fn on(vertical_rms: f32, lateral_m_s2: f32, roll_rad: f32) -> Demand {
        let strategy = RoadAndCornering::new(&VehicleDescription::default(), &Tuning::default());
        let mut state = RoadAndCornering::INITIAL;
        let mut estimate = Estimate {
            vertical_mean_square: vertical_rms * vertical_rms,
            ..Estimate::default()
        };
        for _ in 0..2_000 {
            strategy.step(&mut state, &estimate, &Trusted::default());
        }
        estimate.roll_rad = roll_rad;
        estimate.lateral.acceleration_m_s2 = Bands {
            quick: lateral_m_s2,
            slow: lateral_m_s2,
        };
        strategy.step(&mut state, &estimate, &Trusted::default())
    }

    #[test]
    fn what_each_road_gets() {
        let soft = ValveCommand::SOFT;
        let firm = ValveCommand::from_corners(Corners::splat(StrutValves::new(false, true, true)));
        for (vertical_rms, valves) in [(0.1, ValveCommand::SAFE), (0.5, soft), (1.2, soft), (1.4, firm)] {
            let demand = on(vertical_rms, 0.0, 0.0);
            assert_eq!(
                (demand.valves, demand.urgency, demand.handling),
                (valves, Urgency::Comfort, false),
                "{vertical_rms} m/s2"
            );
            // A bend closes all valves at once on every road.
            let demand = on(vertical_rms, 3.5, 0.0);
            assert_eq!(
                (demand.valves, demand.urgency, demand.handling, demand.rollover_guard),
                (ValveCommand::SAFE, Urgency::Emergency, true, false)
            );
            // And so does the guard, in the same bend.
            let demand = on(vertical_rms, 3.5, 0.1);
            assert_eq!(
                (demand.valves, demand.urgency, demand.rollover_guard),
                (ValveCommand::SAFE, Urgency::Emergency, true)
            );
        }
    }

    /// With hysteresis: rough from 0.25 and smooth below 0.06 m/s2; very rough from 1.3 and no longer below 1.0 m/s2.
    #[test]
    fn a_road_stays_what_it_is_between_the_thresholds() {
        let strategy = RoadAndCornering::new(&VehicleDescription::default(), &Tuning::default());
        let mut state = RoadAndCornering::INITIAL;
        for (vertical_rms, rough, very_rough) in [
            (0.2, false, false),
            (0.3, true, false),
            (0.07, true, false),
            (1.2, true, false),
            (1.4, true, true),
            (1.1, true, true),
            (0.9, true, false),
            (0.05, false, false),
        ] {
            let estimate = Estimate {
                vertical_mean_square: vertical_rms * vertical_rms,
                ..Estimate::default()
            };
            for _ in 0..=2 * ROAD_DWELL_TICKS {
                strategy.step(&mut state, &estimate, &Trusted::default());
            }
            assert_eq!(
                (state.rough, state.very_rough),
                (rough, very_rough),
                "{vertical_rms} m/s2"
            );
        }
    }
}
