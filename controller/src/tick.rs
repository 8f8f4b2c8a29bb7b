//! One period of the controller: inputs to valve command.
//!
//! The order is the data flow: trust the readings, estimate the motion, decide, and let the mode machine strike out what it
//! does not permit. Nothing else may keep state between ticks.

use oleo_interface::{Corners, StrutValves, Valve};

use crate::configuration::Configuration;
use crate::dwell::Dwell;
use crate::estimate::{self, Estimate};
use crate::failsafe::{self, FaultCode, Health, Mode};
use crate::plausibility;
use crate::reading::Inputs;
use crate::spring::Springs;
use crate::strategy::{self, Urgency};
use crate::valves::ValveCommand;

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
    pub trapped_shift_m: Corners<f32>,
    /// Estimated motion.
    pub estimate: Estimate,
}

/// One tick. Call it every [`TICK_MS`](oleo_interface::tick::TICK_MS); the caller owns time.
pub fn tick(c: &Configuration, state: &mut State, inputs: &Inputs) -> Outputs {
    let context = plausibility::Context {
        spring_settled_open: state.springs.settled_open(),
        learning: !state.failsafe.was_normal(),
    };
    let trusted = state.plausibility.step(&c.plausibility, inputs, &context);
    let mut health = trusted.health;

    // Before the first complete set of sensors there is nothing to estimate from, and the filters must not start at zero load.
    let mut estimate = Estimate::default();
    if state.failsafe.was_normal() || health == Health::default() {
        estimate = state.estimate.step(&c.estimate, &trusted);
        if !estimate.is_finite() {
            health.cause = FaultCode::Internal;
            estimate = Estimate::default();
        }
    }

    let mode = state.failsafe.step(&health);
    let demand = state.strategy.step(&c.strategy, &estimate, &trusted);
    let springs = if mode == Mode::Normal {
        let wanted = demand.valves.corners().map(|strut| strut[Valve::Spring]);
        let load_n = &estimate.static_load_n;
        state.springs.step(&c.spring, &trusted, load_n, wanted, demand.urgency)
    } else {
        state.springs.forced_closed(&c.spring, &trusted);
        Corners::splat(false)
    };
    let bypass = state.dwell.step(demand.valves, demand.urgency == Urgency::Emergency);

    // Valve 2 has no effect behind a closed valve 3: de-energised, it does not wear.
    let valve_2 = springs
        .zip(state.springs.throttled())
        .map(|(open, throttled)| open && !throttled);
    let struts = bypass
        .corners()
        .zip(springs.zip(valve_2))
        .map(|(bypass, (spring, valve_2))| {
            StrutValves::new(bypass[Valve::Bypass1], bypass[Valve::Bypass2] && valve_2, spring)
        });
    let command = failsafe::permitted(mode, health.affected, ValveCommand::from_corners(struts));
    Outputs {
        command,
        mode,
        fault: state.failsafe.first_cause(),
        handling: demand.handling,
        rollover_guard: demand.rollover_guard,
        invalid_readings: trusted.invalid_readings,
        trapped_shift_m: state.springs.trapped_shift_m(),
        estimate,
    }
}
