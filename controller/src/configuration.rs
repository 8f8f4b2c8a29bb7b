//! What the controller believes about its vehicle, and the thresholds it decides by.

use crate::strategy::Strategy;

/// Immutable while running.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Configuration {
    /// How valves are decided.
    pub(crate) strategy: Strategy,
}

impl Configuration {
    /// The Land Rover Defender 110 of the report with the ride/handling strategy.
    pub fn defender110() -> Self {
        Self {
            strategy: Strategy::RideHandling,
        }
    }

    /// The same with another strategy.
    pub fn with_strategy(self, strategy: Strategy) -> Self {
        Self { strategy }
    }
}
