//! How long the nodes of a run wait: for their partner, and for each other.

use std::time::Duration;

use oleo_interface::tick::TICK_MS;

use crate::scenario::Scenario;

/// How long a node looks for its partner.
pub const PATIENCE: Duration = Duration::from_secs(60);
/// Between the plant's deadline and the controller's in real time.
pub const CONTROLLER_PHASE: Duration = Duration::from_micros(2500);
/// Period of a tick.
pub const TICK: Duration = Duration::from_millis(TICK_MS as u64);

/// How long a partner that was there may be silent before it is gone.
pub fn partner_timeout(scenario: &Scenario) -> Duration {
    Duration::from_secs_f64(scenario.partner_timeout_s)
}
