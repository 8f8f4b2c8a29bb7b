//! Ride mode or handling mode, by which acceleration is larger, with a roll-over guard.
//!
//! | | springs | dampers |
//! |---|---|---|
//! | ride mode | soft | by the damper policy |
//! | handling mode, or roll-over guard | stiff | high |

use oleo_interface::StrutValves;

use super::demand::{Decide, Demand, Urgency};
use super::parts::{rollover_guard, running_rms, semi_active};
use crate::estimate::Estimate;
use crate::plausibility::Trusted;
use crate::range::ConfigurationError;
use crate::valves::ValveCommand;
use crate::vehicle::VehicleDescription;

/// Tuning of the three parts. See [`strategy::Tuning`](super::Tuning) for an example.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tuning {
    /// When handling mode begins and ends.
    pub running_rms: running_rms::Tuning,
    /// When the roll-over guard acts.
    pub rollover_guard: rollover_guard::Tuning,
    /// How dampers are switched in ride mode.
    pub dampers: semi_active::Tuning,
}

/// Parameters of the strategy. See [`Decide`] for an example of a strategy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RideHandling {
    running_rms: running_rms::Parameters,
    rollover_guard: rollover_guard::Tuning,
    dampers: semi_active::Parameters,
}

/// What the three parts remember. See [`strategy::State`](super::State) for an example.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct State {
    mode: running_rms::State,
    guard: rollover_guard::State,
    dampers: semi_active::State,
}

impl Decide for RideHandling {
    type Tuning = Tuning;
    type State = State;
    const INITIAL: State = State {
        mode: running_rms::State::INITIAL,
        guard: rollover_guard::State::INITIAL,
        dampers: semi_active::State::INITIAL,
    };

    fn check(tuning: &Tuning) -> Result<(), ConfigurationError> {
        tuning.running_rms.check()?;
        tuning.rollover_guard.check([
            "tuning.strategy.ride_handling.rollover_guard.roll_rad",
            "tuning.strategy.ride_handling.rollover_guard.lateral_m_s2",
        ])?;
        tuning.dampers.check()
    }

    fn new(vehicle: &VehicleDescription, tuning: &Tuning) -> Self {
        Self {
            running_rms: running_rms::Parameters::new(&tuning.running_rms),
            rollover_guard: tuning.rollover_guard,
            dampers: semi_active::Parameters::new(vehicle, &tuning.dampers),
        }
    }

    fn step(&self, state: &mut State, estimate: &Estimate, trusted: &Trusted) -> Demand {
        let rollover_guard = state.guard.step(&self.rollover_guard, estimate);
        let handling = state.mode.step(&self.running_rms, estimate);
        let low_damping = state.dampers.step(&self.dampers, estimate, trusted);
        let valves = if handling || rollover_guard {
            ValveCommand::SAFE
        } else {
            ValveCommand::from_corners(low_damping.map(|low| StrutValves::new(low, low, true)))
        };
        let urgency = if rollover_guard {
            Urgency::Emergency
        } else if handling {
            Urgency::Handling
        } else {
            Urgency::Comfort
        };
        Demand {
            valves,
            urgency,
            handling,
            rollover_guard,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lateral::{Bands, Lateral};

    /// Running RMS of the lateral acceleration, and whether the body leans by 6 degrees to the outside of a bend of 4 m/s2.
    fn demand(lateral_rms: f32, leans: bool) -> Demand {
        let strategy = RideHandling::new(&VehicleDescription::default(), &Tuning::default());
        let acceleration = if leans { 4.0 } else { 0.0 };
        let estimate = Estimate {
            lateral_mean_square: lateral_rms * lateral_rms,
            roll_rad: if leans { 0.105 } else { 0.0 },
            lateral: Lateral {
                acceleration_m_s2: Bands {
                    quick: acceleration,
                    slow: acceleration,
                },
                ..Lateral::default()
            },
            ..Estimate::default()
        };
        strategy.step(&mut { RideHandling::INITIAL }, &estimate, &Trusted::default())
    }

    #[test]
    fn either_handling_or_the_guard_closes_and_the_guard_at_once() {
        let closes = |demand: Demand| {
            (
                demand.valves == ValveCommand::SAFE,
                demand.urgency,
                demand.handling,
                demand.rollover_guard,
            )
        };
        assert_eq!(closes(demand(0.0, false)), (false, Urgency::Comfort, false, false));
        assert_eq!(closes(demand(2.0, false)), (true, Urgency::Handling, true, false));
        assert_eq!(closes(demand(0.0, true)), (true, Urgency::Emergency, false, true));
        assert_eq!(closes(demand(2.0, true)), (true, Urgency::Emergency, true, true));
    }
}
