//! The time axis that the pictures of a page share. It begins at the first fault, where there is one: what matters takes less
//! than a second of most runs.

use oleo_interface::tick::TICK_S;
use oleo_report::{Axis, Curves};

use crate::run::Outcome;
use crate::scenario::Scenario;
use crate::scenario::fault::{Fault, FaultKind};
use crate::sync::Role;

/// Figures with this link zoom their time axes together.
pub(super) const LINK: &str = "time";
/// What is shown before the first fault, of it, and behind it, s.
const BEFORE_S: f64 = 0.5;
const MOST_OF_FAULT_S: f64 = 3.0;
const BEHIND_S: f64 = 1.5;

/// The common time axis, and the faults that are marked on it.
pub(super) struct Time<'a> {
    /// Time of each tick, s.
    pub s: Vec<f64>,
    faults: &'a [Fault],
    /// From the first fault to its end or to what fits on a page, with some time around it, s.
    shown_s: Option<(f64, f64)>,
}

impl<'a> Time<'a> {
    /// The time axis of a run.
    pub fn of(scenario: &'a Scenario, outcome: &Outcome) -> Self {
        let s: Vec<f64> = (0..outcome.plant.recording.samples.len())
            .map(|tick| tick as f64 * TICK_S)
            .collect();
        let end_s = s.last().copied().unwrap_or(0.0);
        let first = scenario.faults.iter().min_by_key(|fault| fault.from_tick);
        let shown_s = first.map(spans_s).filter(|(from_s, _)| *from_s < end_s);
        Self {
            s,
            faults: &scenario.faults,
            shown_s: shown_s.map(|(from_s, until_s)| {
                let until_s = until_s.min(from_s + MOST_OF_FAULT_S) + BEHIND_S;
                ((from_s - BEFORE_S).max(0.0), until_s.min(end_s))
            }),
        }
    }

    /// The axis, zoomed to the first fault.
    pub fn axis(&self) -> Axis {
        let axis = Axis::new("Time", "s");
        match self.shown_s {
            Some((from_s, until_s)) => axis.range(from_s, until_s),
            None => axis,
        }
    }

    /// Where what matters begins, s: the first fault.
    pub fn begin_s(&self) -> f64 {
        self.shown_s.map_or(0.0, |(from_s, _)| from_s)
    }

    /// Whether the axis shows less than the whole run.
    pub fn is_zoomed(&self) -> bool {
        self.shown_s.is_some()
    }

    /// An empty picture over time.
    pub fn curves(&self, title: &str) -> Curves {
        let mut curves = Curves::new(title, self.axis());
        curves.link(LINK);
        curves
    }

    /// Marks the faults in the panel that was added last.
    pub fn mark(&self, curves: &mut Curves) {
        let end_s = self.s.last().copied().unwrap_or(0.0);
        for fault in self.faults {
            let (from_s, until_s) = spans_s(fault);
            curves.region(from_s, until_s.min(end_s), fault_label(fault));
        }
    }
}

/// Begin and end of a fault, s.
pub(super) fn spans_s(fault: &Fault) -> (f64, f64) {
    (
        f64::from(fault.from_tick) * TICK_S,
        f64::from(fault.until_tick) * TICK_S,
    )
}

/// A fault in two words.
pub(super) fn fault_label(fault: &Fault) -> &'static str {
    match fault.kind {
        FaultKind::Message { .. } => "messages disturbed",
        FaultKind::NodeKilled(Role::Plant) => "plant silent",
        FaultKind::NodeKilled(Role::Controller) => "controller silent",
        FaultKind::ControllerRestarted => "controller in reset",
        FaultKind::Sensor { .. } | FaultKind::SensorsSwapped { .. } => "sensor fault",
        FaultKind::SolenoidStuck { .. } => "solenoid stuck",
    }
}
