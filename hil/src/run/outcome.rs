//! How a run ended, for the plant and for a controller alone.

use oleo_controller::{FaultCode, Mode};

use crate::clock::Lateness;
use crate::plant_node::PlantResult;
use crate::sync::Role;

/// What a run with a plant leaves behind.
#[derive(Debug)]
pub struct Outcome {
    /// Samples, frames, counters.
    pub plant: PlantResult,
    /// Wall-clock time of the loop alone, s.
    pub wall_s: f64,
    /// How the plant's and (where it ran here) the controller's deadlines were met, in real time.
    pub lateness: Vec<(Role, Lateness)>,
    /// Tick in which the controller was given up.
    pub controller_lost_at: Option<u32>,
    /// Somebody asked to stop.
    pub interrupted: bool,
}

/// How a controller node's run ended.
#[derive(Debug)]
pub struct ControllerOutcome {
    /// Words commanded, one a tick.
    pub words: Vec<u16>,
    /// Modes entered: tick, mode, first cause.
    pub account: Vec<(u32, Mode, FaultCode)>,
    /// If the plant went silent: its last tick, and the ticks from there to a safe mode (`None`: not reached).
    pub plant_lost: Option<(u32, Option<u32>)>,
    /// Frames that failed their end-to-end check.
    pub e2e_errors: u64,
    /// Frames that did not arrive.
    pub frames_lost: u64,
    /// How deadlines were met, in real time.
    pub lateness: Option<Lateness>,
    /// Wall-clock time of the loop alone, s.
    pub wall_s: f64,
}
