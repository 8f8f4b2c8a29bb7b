//! One period of the controller: inputs to valve command.
//!
//! The order is the data flow: trust the readings, estimate the motion, decide, and let the mode machine strike out what it
//! does not permit. Nothing else may keep state between ticks.

use crate::can::StatusMessage;
use crate::configuration::Configuration;
use crate::estimate::Estimate;
use crate::failsafe::{self, FaultCode, Health, Mode};
use crate::reading::{Inputs, MessageSet};
use crate::valves::ValveCommand;

/// All memory of the controller.
#[derive(Clone, Debug)]
pub struct State {
    failsafe: failsafe::State,
}

impl State {
    /// Before the first tick: valves closed, mode start-up.
    pub fn new(_configuration: &Configuration) -> Self {
        Self {
            failsafe: failsafe::State::default(),
        }
    }
}

/// What a tick decided, and what it saw.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outputs {
    /// Valve positions to drive.
    pub command: ValveCommand,
    /// Mode of the controller.
    pub mode: Mode,
    /// First cause of a mode other than normal.
    pub fault: FaultCode,
    /// The strategy is in handling mode (stiff).
    pub handling: bool,
    /// The roll-over guard is active.
    pub rollover_guard: bool,
    /// Readings that may not be used at present.
    pub invalid_readings: u8,
    /// Estimated motion.
    pub estimate: Estimate,
}

impl Outputs {
    /// The status message's content.
    pub fn status(&self, lost_messages: MessageSet) -> StatusMessage {
        StatusMessage {
            mode: self.mode,
            fault: self.fault,
            handling: self.handling,
            rollover_guard: self.rollover_guard,
            lateral_rms_m_s2: libm::sqrtf(self.estimate.lateral_mean_square),
            vertical_rms_m_s2: libm::sqrtf(self.estimate.vertical_mean_square),
            invalid_readings: self.invalid_readings,
            lost_messages,
        }
    }
}

/// One tick. Call it every [`crate::timing::TICK_MS`]; the caller owns time.
pub fn tick(_configuration: &Configuration, state: &mut State, _inputs: &Inputs) -> Outputs {
    let health = Health::default();
    let mode = state.failsafe.step(&health);
    let command = failsafe::permitted(mode, &health.affected, ValveCommand::SAFE);
    Outputs {
        command,
        mode,
        fault: state.failsafe.first_cause(),
        ..Outputs::default()
    }
}
