//! How a run ended, for the plant and for a controller alone.

use oleo_controller::{FaultCode, Mode};

use super::controller_loop::PlantLost;
use crate::bus::BusError;
use crate::clock::Lateness;
use crate::plant_node::PlantResult;
use crate::sync::Role;

/// Result of a run with a plant.
#[derive(Debug)]
pub struct Outcome {
    /// Samples, frames and counters of the plant's node.
    pub plant: PlantResult,
    /// Wall-clock time of the loop alone, s.
    pub wall_s: f64,
    /// In real time: how the deadlines of each node that ran in this process were met.
    pub lateness: Vec<(Role, Lateness)>,
    /// Tick in which the controller was taken to be gone.
    pub controller_lost_at: Option<u32>,
    /// Whether the run was stopped from outside.
    pub interrupted: bool,
    /// How the bus failed, if that has ended the run.
    pub bus_failure: Option<BusError>,
}

/// Result of a run of the controller's node alone.
#[derive(Debug)]
pub struct ControllerOutcome {
    /// Valve words that were commanded, one for each tick.
    pub words: Vec<u16>,
    /// Each change of the mode: its tick, the mode and its first cause.
    pub account: Vec<(u32, Mode, FaultCode)>,
    /// How the plant was lost, if it was.
    pub plant_lost: Option<PlantLost>,
    /// Number of frames that failed their end-to-end check.
    pub e2e_errors: u64,
    /// Number of frames that were sent and did not arrive.
    pub frames_lost: u64,
    /// In real time: how the deadlines were met.
    pub lateness: Option<Lateness>,
    /// Wall-clock time of the loop alone, s.
    pub wall_s: f64,
}
