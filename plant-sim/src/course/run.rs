//! A drive from start to end, and the record of it.

use oleo_interface::Corners;
use oleo_interface::tick::TICK_S;

use super::Ending;
use super::drive::{Drive, NotFinite};
use super::sample::{Sample, Signals};
use crate::handling::HandlingModel;
use crate::vehicle::suspension::SuspensionElement;

/// What is kept of a drive.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// How the run ended, and when.
    pub ending: Ending,
    /// A sample at every tick, from the start.
    pub history: Vec<Sample>,
    /// Smallest clearance to the cones, m; negative if one was hit; `None` without cones.
    pub cone_margin_m: Option<f64>,
    /// Largest body roll, rad; a roll-over counts as it ended.
    pub max_roll_rad: f64,
    /// Largest lateral acceleration, m/s2.
    pub max_lateral_m_s2: f64,
    /// Time that any wheel was off the ground, s.
    pub wheel_lift_s: f64,
}

impl Run {
    /// An empty run with memory for `ticks` samples.
    pub fn with_capacity(ticks: usize) -> Self {
        Self {
            ending: Ending::Completed,
            history: Vec::with_capacity(ticks + 1),
            cone_margin_m: None,
            max_roll_rad: 0.0,
            max_lateral_m_s2: 0.0,
            wheel_lift_s: 0.0,
        }
    }

    /// Adds a sample, and the clearance to the cones at that time.
    pub fn note(&mut self, sample: Sample, cone_margin_m: Option<f64>) {
        self.max_roll_rad = self.max_roll_rad.max(sample.roll_rad.abs());
        self.max_lateral_m_s2 = self.max_lateral_m_s2.max(sample.lateral_acceleration_m_s2.abs());
        if !self.history.is_empty() && sample.wheel_load_n.values().any(|load| *load <= 0.0) {
            self.wheel_lift_s += TICK_S;
        }
        if let Some(margin) = cone_margin_m {
            self.cone_margin_m = Some(self.cone_margin_m.map_or(margin, |worst| worst.min(margin)));
        }
        self.history.push(sample);
    }
}

impl<E: SuspensionElement> Drive<E> {
    /// Drives to the end. `decide` is asked at every tick for the suspension's signals and for the valves' signals to
    /// record; `every_step` sees each integration step.
    ///
    /// # Errors
    /// [`NotFinite`].
    pub fn to_end(
        mut self,
        mut decide: impl FnMut(&HandlingModel<E>) -> (Corners<E::Signal>, Signals),
        mut every_step: impl FnMut(&HandlingModel<E>),
    ) -> Result<Run, NotFinite> {
        let mut run = Run::with_capacity(self.most_ticks() as usize);
        loop {
            let (signals, valves) = decide(self.model());
            run.note(self.sample(valves), self.cone_margin_m());
            if let Some(ending) = self.ending() {
                run.ending = ending;
                return Ok(run);
            }
            self.tick(signals, &mut every_step)?;
        }
    }
}
