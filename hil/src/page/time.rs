//! The time axis that the pictures of a page share.

use oleo_interface::tick::TICK_S;
use oleo_report::{Axis, Curves};

use crate::run::Outcome;
use crate::scenario::Scenario;
use crate::scenario::fault::{Fault, FaultKind};
use crate::sync::Role;

/// Figures with this link zoom their time axes together.
const LINK: &str = "time";

/// The common time axis, and the faults that are marked on it.
pub(super) struct Time<'a> {
    /// Time of each tick, s.
    pub s: Vec<f64>,
    faults: &'a [Fault],
}

impl<'a> Time<'a> {
    /// The time axis of a run.
    pub fn of(scenario: &'a Scenario, outcome: &Outcome) -> Self {
        let s = (0..outcome.plant.recording.samples.len())
            .map(|tick| tick as f64 * TICK_S)
            .collect();
        Self {
            s,
            faults: &scenario.faults,
        }
    }

    /// An empty picture over time.
    pub fn curves(&self, title: &str) -> Curves {
        let mut curves = Curves::new(title, Axis::new("Time", "s"));
        curves.link(LINK);
        curves
    }

    /// Marks the faults in the panel that was added last.
    pub fn mark(&self, curves: &mut Curves) {
        let end_s = self.s.last().copied().unwrap_or(0.0);
        for fault in self.faults {
            let (from_s, until_s) = (
                f64::from(fault.from_tick) * TICK_S,
                f64::from(fault.until_tick) * TICK_S,
            );
            curves.region(from_s, until_s.min(end_s), fault_label(fault));
        }
    }
}

fn fault_label(fault: &Fault) -> &'static str {
    match fault.kind {
        FaultKind::Message { .. } => "messages disturbed",
        FaultKind::NodeKilled(Role::Plant) => "plant silent",
        FaultKind::NodeKilled(Role::Controller) => "controller silent",
        FaultKind::ControllerRestarted => "controller in reset",
        FaultKind::Sensor { .. } | FaultKind::SensorsSwapped { .. } => "sensor fault",
        FaultKind::SolenoidStuck { .. } => "solenoid stuck",
    }
}
