//! The default strategy with a rule of the literature for the dampers: what such a rule earns, the rest being alike.
//!
//! | | springs | dampers |
//! |---|---|---|
//! | smooth road, or cornering | stiff | high |
//! | rough road | soft | by the damper policy |
//!
//! Springs, urgency and the decision on bends are those of [`super::road_and_cornering`]. On a rough road, where that strategy holds the
//! dampers at one setting, a policy switches them at each corner ([`super::parts::semi_active`]). With `low` nothing but the setting for
//! a body that heaves is missing.

use oleo_interface::{Corner, StrutValves, Valve};

use super::demand::{Decide, Demand};
use super::parts::semi_active;
use super::road_and_cornering::{self, RoadAndCornering};
use crate::estimate::Estimate;
use crate::plausibility::Trusted;
use crate::range::ConfigurationError;
use crate::valves::ValveCommand;
use crate::vehicle::VehicleDescription;

/// Tuning of both parts. See [`strategy::Tuning`](super::Tuning) for an example.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tuning {
    /// Road and bends.
    pub road: road_and_cornering::Tuning,
    /// How dampers are switched on a rough road.
    pub dampers: semi_active::Tuning,
}

/// Parameters of the strategy. See [`Decide`] for an example of a strategy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoadAndDampers {
    road: RoadAndCornering,
    dampers: semi_active::Parameters,
}

/// What both parts remember. See [`strategy::State`](super::State) for an example.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct State {
    road: road_and_cornering::State,
    dampers: semi_active::State,
}

impl Decide for RoadAndDampers {
    type Tuning = Tuning;
    type State = State;
    const INITIAL: State = State {
        road: RoadAndCornering::INITIAL,
        dampers: semi_active::State::INITIAL,
    };

    fn check(tuning: &Tuning) -> Result<(), ConfigurationError> {
        RoadAndCornering::check(&tuning.road)?;
        tuning.dampers.check()
    }

    fn new(vehicle: &VehicleDescription, tuning: &Tuning) -> Self {
        Self {
            road: RoadAndCornering::new(vehicle, &tuning.road),
            dampers: semi_active::Parameters::new(vehicle, &tuning.dampers),
        }
    }

    fn step(&self, state: &mut State, estimate: &Estimate, trusted: &Trusted) -> Demand {
        let demand = self.road.step(&mut state.road, estimate, trusted);
        // The filters of the policy go on while the vehicle is stiff.
        let low_damping = state.dampers.step(&self.dampers, estimate, trusted);
        let soft = demand.valves.is_open(Corner::FrontLeft, Valve::Spring);
        let valves = ValveCommand::from_corners(low_damping.map(|low| StrutValves::new(low, low, true)));
        Demand {
            valves: if soft { valves } else { demand.valves },
            ..demand
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lateral::Bands;
    use crate::strategy::Urgency;
    use oleo_interface::Side;

    /// After ten seconds on a road with this vertical RMS, m/s2, with the front left strut near its stop, and a lateral acceleration, m/s2.
    fn demand(policy: semi_active::DamperPolicy, vertical_rms: f32, lateral_m_s2: f32) -> Demand {
        let mut tuning = Tuning::default();
        tuning.dampers.policy = policy;
        let strategy = RoadAndDampers::new(&VehicleDescription::default(), &tuning);
        let mut state = RoadAndDampers::INITIAL;
        let mut estimate = Estimate {
            vertical_mean_square: vertical_rms * vertical_rms,
            ..Estimate::default()
        };
        estimate.strut_speed_m_s[Corner::FrontLeft] = 0.3;
        let mut trusted = Trusted::default();
        trusted.displacement_m[Corner::FrontLeft] = 0.07;
        for _ in 0..2_000 {
            strategy.step(&mut state, &estimate, &trusted);
        }
        estimate.lateral.acceleration_m_s2 = Bands {
            quick: lateral_m_s2,
            slow: lateral_m_s2,
        };
        strategy.step(&mut state, &estimate, &trusted)
    }

    #[test]
    fn the_policy_decides_on_dampers_of_soft_struts_only() {
        let policy = semi_active::DamperPolicy::Low;
        assert_eq!(demand(policy, 0.1, 0.0).valves, ValveCommand::SAFE);
        let bend = demand(policy, 2.0, 3.5);
        assert_eq!(
            (bend.valves, bend.urgency, bend.handling),
            (ValveCommand::SAFE, Urgency::Bend { outer: Side::Right }, true)
        );
        let mut expected = ValveCommand::SOFT;
        for valve in [Valve::Bypass1, Valve::Bypass2] {
            expected = expected.with(Corner::FrontLeft, valve, false);
        }
        for vertical_rms in [0.5, 2.0] {
            assert_eq!(
                demand(policy, vertical_rms, 0.0).valves,
                expected,
                "high near the stop alone"
            );
        }
    }

    #[test]
    fn every_value_has_its_range() {
        assert_eq!(RoadAndDampers::check(&Tuning::default()), Ok(()));
        let name = |change: fn(&mut Tuning)| {
            let mut tuning = Tuning::default();
            change(&mut tuning);
            RoadAndDampers::check(&tuning).map_err(|error| error.name)
        };
        assert_eq!(
            name(|tuning| tuning.road.rough_m_s2.begin = 11.0),
            Err("tuning.strategy.road_and_cornering.rough_m_s2")
        );
        assert_eq!(
            name(|tuning| tuning.dampers.body_acceleration_share = -1.0),
            Err("tuning.strategy.ride_handling.dampers.body_acceleration_share")
        );
    }
}
