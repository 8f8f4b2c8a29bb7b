//! Time-outs of the nodes: for the handshake with their partner, and for each other during the run.

use std::time::Duration;

use oleo_interface::tick::TICK_MS;

use crate::scenario::Scenario;

/// Longest time for which a node looks for its partner.
pub const PATIENCE: Duration = Duration::from_secs(60);
/// Time from the plant's deadline to the controller's, in real time.
pub const CONTROLLER_PHASE: Duration = Duration::from_micros(2500);
/// Period of a tick.
pub const TICK: Duration = Duration::from_millis(TICK_MS as u64);

/// Longest silence of a partner before it is taken to be gone.
pub fn partner_timeout(scenario: &Scenario) -> Duration {
    Duration::from_secs_f64(scenario.partner_timeout_s)
}
