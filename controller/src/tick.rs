//! One period of the controller: inputs to valve command.
//!
//! The order is the data flow: trust the readings, estimate the motion, decide, and let the mode machine strike out what it
//! does not permit. Nothing else may keep state between ticks.

use crate::can::StatusMessage;
use crate::configuration::Configuration;
use crate::dwell::Dwell;
use crate::estimate::{self, Estimate};
use crate::failsafe::{self, FaultCode, Health, Mode};
use crate::plausibility;
use crate::reading::{Inputs, MessageSet};
use crate::spring::Springs;
use crate::strategy::{self, Urgency};
use crate::valves::{CORNERS, VALVES, ValveCommand};

/// All memory of the controller.
#[derive(Clone, Debug, Default)]
pub struct State {
    plausibility: plausibility::State,
    estimate: estimate::State,
    strategy: strategy::State,
    springs: Springs,
    dwell: Dwell,
    failsafe: failsafe::State,
}

impl State {
    /// Before the first tick: valves closed, mode start-up.
    pub fn new() -> Self {
        Self::default()
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
    /// Shift of the ride height by the oil behind valve 3, m, lower positive (see [`crate::spring`]).
    pub trapped_shift_m: [f32; CORNERS],
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
pub fn tick(c: &Configuration, state: &mut State, inputs: &Inputs) -> Outputs {
    let context = plausibility::Context {
        spring_settled_open: state.springs.settled_open(),
        learning: !state.failsafe.was_normal(),
    };
    let trusted = state.plausibility.step(c, inputs, &context);
    let mut health = trusted.health;

    // Before the first complete set of sensors there is nothing to estimate from, and the filters must not start at zero load.
    let mut estimate = Estimate::default();
    if state.failsafe.was_normal() || health == Health::default() {
        estimate = state.estimate.step(c, &trusted);
        if !estimate.is_finite() {
            health.cause = FaultCode::Internal;
            estimate = Estimate::default();
        }
    }

    let mode = state.failsafe.step(&health);
    let wish = state.strategy.step(c, &estimate, &trusted);
    let soft = if mode == Mode::Normal {
        state
            .springs
            .step(c, &trusted, &estimate.static_load_n, wish.soft_spring, wish.urgency)
    } else {
        state.springs.forced_closed(c, &trusted);
        [false; CORNERS]
    };
    let low = state.dwell.step(wish.low_damping, wish.urgency == Urgency::Emergency);

    let mut corners = [[false; VALVES]; CORNERS];
    for (((valves, soft), low), throttled) in corners.iter_mut().zip(soft).zip(low).zip(state.springs.throttled()) {
        // Valve 2 has no effect behind a closed valve 3: de-energised, it does not wear.
        *valves = [low, low && soft && !throttled, soft];
    }
    let command = failsafe::permitted(mode, &health.affected, ValveCommand::from_corners(corners));
    Outputs {
        command,
        mode,
        fault: state.failsafe.first_cause(),
        handling: wish.handling,
        rollover_guard: wish.rollover_guard,
        invalid_readings: trusted.invalid_readings,
        trapped_shift_m: state.springs.trapped_shift_m(),
        estimate,
    }
}
