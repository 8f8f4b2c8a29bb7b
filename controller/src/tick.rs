//! One period of the controller, from inputs to valve command.
//!
//! The order of the calls is the flow of data: find out which readings may be used, estimate the motion from them, decide what
//! is wanted, let the mode machine take out what it does not permit, and limit how often valves switch. Nothing else keeps state
//! between ticks.

use oleo_interface::Corners;

use crate::configuration::Configuration;
use crate::dwell::Dwell;
use crate::estimate::{self, Estimate};
use crate::failsafe::{self, FaultCode, Mode};
use crate::plausibility;
use crate::reading::Inputs;
use crate::spring::Springs;
use crate::strategy::{self, Demand};
use crate::switching::SwitchingLimit;
use crate::valves::ValveCommand;

/// All memory of the controller. One belongs to one vehicle; a new one is a restart.
///
/// ```
/// use oleo_controller::{Configuration, Inputs, Mode, State, tick};
/// let mut state = State::new();
/// let outputs = tick(&Configuration::defender110(), &mut state, &Inputs::default());
/// assert_eq!(outputs.mode, Mode::StartUp); // no reading is valid yet
/// ```
#[derive(Clone, Debug)]
// In the order of the declaration: the checks of the readings come first, where one instruction of a Cortex-M4F reaches them.
#[repr(C)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct State {
    plausibility: plausibility::State,
    estimate: estimate::State,
    strategy: strategy::State,
    springs: Springs,
    dwell: Dwell,
    failsafe: failsafe::State,
    switching: SwitchingLimit,
}

impl Default for State {
    fn default() -> Self {
        Self::INITIAL
    }
}

impl State {
    /// Every bit of it is zero, so that neither a table of it nor code that makes it is in the flash of a board: memory is cleared. Each
    /// part has such a state.
    const INITIAL: Self = Self {
        plausibility: plausibility::State::INITIAL,
        estimate: estimate::State::INITIAL,
        strategy: strategy::State::INITIAL,
        springs: Springs::INITIAL,
        dwell: Dwell::INITIAL,
        failsafe: failsafe::State::INITIAL,
        switching: SwitchingLimit::INITIAL,
    };

    /// Before the first tick: valves closed, mode start-up.
    #[inline]
    pub fn new() -> Self {
        Self::INITIAL
    }

    /// Latches the safe state: from the next tick on all valves stay closed, for this cause. A restart that must not end the latched
    /// mode begins with it.
    ///
    /// ```
    /// use oleo_controller::{Configuration, FaultCode, Inputs, Mode, State, tick};
    /// let mut state = State::new();
    /// state.latch(FaultCode::Solenoid);
    /// let outputs = tick(&Configuration::defender110(), &mut state, &Inputs::default());
    /// assert_eq!((outputs.mode, outputs.fault), (Mode::Latched, FaultCode::Solenoid));
    /// ```
    #[inline]
    pub fn latch(&mut self, cause: FaultCode) {
        self.failsafe = failsafe::State::latched(cause);
    }
}

/// What a tick decided, and what it was decided from.
///
/// ```
/// use oleo_controller::{FaultCode, Mode, Outputs, ValveCommand};
/// let before_the_first_tick = Outputs::default();
/// assert_eq!(before_the_first_tick.command, ValveCommand::SAFE);
/// assert_eq!((before_the_first_tick.mode, before_the_first_tick.fault), (Mode::StartUp, FaultCode::None));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outputs {
    /// Positions to which the valves are to be driven.
    pub command: ValveCommand,
    /// Mode of the controller.
    pub mode: Mode,
    /// First cause of a mode other than [`Mode::Normal`].
    pub fault: FaultCode,
    /// Whether the strategy is in handling mode: stiff springs and high damping.
    pub handling: bool,
    /// Whether the roll-over guard is active.
    pub rollover_guard: bool,
    /// Number of readings that may not be used at present, 0 to 20.
    pub invalid_readings: u8,
    /// Shift of the ride height by the oil that is trapped behind valve 3, m, positive where the corner is lower (see
    /// [`crate::spring`]).
    pub trapped_shift_m: Corners<f32>,
    /// Estimated motion of body and struts.
    pub estimate: Estimate,
}

/// One period: decides the twelve valves from one set of readings. Call it every
/// [`TICK_MS`](oleo_interface::tick::TICK_MS); the caller owns time.
///
/// The function is pure: the same configuration, state and inputs give the same outputs, bit for bit. It never fails; what is
/// wrong with the inputs is in [`Outputs::mode`] and [`Outputs::fault`].
///
/// ```
/// use oleo_controller::{Configuration, Corners, Gauge, Inputs, Mode, State, StrutPressures, ValveCommand, tick};
/// let configuration = Configuration::defender110();
/// let mut state = State::new();
/// // A vehicle at rest: every strut at its static position and under 2 MPa.
/// let inputs = Inputs::from_values(Corners::splat(0.0), Corners::splat(StrutPressures::splat(Gauge(2.0e6))));
/// // Readings are believed after 12 ticks, and the mode is normal after 20 healthy ones.
/// let modes: [Mode; 31] = core::array::from_fn(|_| tick(&configuration, &mut state, &inputs).mode);
/// assert_eq!((modes[29], modes[30]), (Mode::StartUp, Mode::Normal));
/// // On a smooth road the vehicle is stiff: all valves stay closed.
/// let outputs = core::iter::repeat_with(|| tick(&configuration, &mut state, &inputs)).nth(100);
/// assert_eq!(outputs.map(|outputs| outputs.command), Some(ValveCommand::SAFE));
/// ```
#[inline(never)]
pub fn tick(c: &Configuration, state: &mut State, inputs: &Inputs) -> Outputs {
    let compared = state.plausibility.turn();
    let context = plausibility::Context {
        spring_settled_open: state.springs.is_settled_open(compared),
        commanded_open: state.switching.command().strut(compared),
        learning: !state.failsafe.was_normal(),
    };
    let trusted = state.plausibility.step(&c.plausibility, inputs, &context);
    let mut health = trusted.health;

    // Before the first complete sets of readings there is nothing to learn from.
    if !state.failsafe.was_normal() {
        state.estimate = estimate::State::INITIAL;
    }
    let mut estimate = state.estimate.step(&c.estimate, trusted);
    if !estimate.is_finite() {
        health.cause = FaultCode::Internal;
        estimate = Estimate::default();
    }

    let mode = state.failsafe.step(&health);
    let demand = if state.failsafe.was_normal() {
        state.strategy.step(&c.strategy, &estimate, trusted)
    } else {
        Demand::default()
    };
    if mode == Mode::Normal {
        let (load_n, wanted) = (state.estimate.static_load_n(), demand.valves);
        state.springs.step(&c.spring, trusted, load_n, wanted, demand.urgency);
    } else {
        state.springs.forced_closed(&c.spring, trusted);
    }
    let bypass = state.dwell.step(demand.valves, demand.urgency.closes_at_once());
    let decided = state.springs.applied_to(bypass);
    let permitted = failsafe::permitted(mode, state.failsafe.restricted(), decided);
    let command = state.switching.step(permitted);
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

#[cfg(test)]
mod tests {
    use super::*;
    use oleo_interface::{Corner, Gauge, StrutPressures};

    /// No input leads to a number that is not finite, so the memory is damaged by hand.
    #[test]
    fn arithmetic_that_is_not_finite_latches_in_the_same_tick() {
        let (configuration, mut state) = (Configuration::defender110(), State::default());
        let inputs = Inputs::from_values(Corners::splat(0.0), Corners::splat(StrutPressures::splat(Gauge(2.0e6))));
        for _ in 0..200 {
            tick(&configuration, &mut state, &inputs);
        }
        state.estimate = estimate::State::damaged();
        for _ in 0..400 {
            let outputs = tick(&configuration, &mut state, &inputs);
            assert_eq!(
                (outputs.mode, outputs.fault, outputs.command),
                (Mode::Latched, FaultCode::Internal, ValveCommand::SAFE)
            );
            assert!(outputs.estimate.is_finite(), "nothing else leaves the controller");
            state.estimate = estimate::State::default();
        }
    }

    /// The vehicle leans to one side within half a second, on four struts of 0.5 l of gas at 2 MPa with all valves open.
    #[cfg(feature = "comparison")]
    fn leaning(tick: u32) -> Inputs {
        use oleo_interface::Side;
        let lean_m = 0.06 * (tick as f32 / 100.0).min(1.0);
        let displacement_m = Corners::from_fn(|corner| match corner.side() {
            Side::Left => -lean_m,
            Side::Right => lean_m,
        });
        let pressure = displacement_m.map(|x| {
            let absolute_pa = 2.101_325e6 * 5.0e-4 / (5.0e-4 - 1.963_495_4e-3 * x);
            StrutPressures::splat(Gauge(absolute_pa - 101_325.0))
        });
        Inputs::from_values(displacement_m, pressure)
    }

    /// Bypass valves rest for 100 ms after a change. The roll-over guard closes them without that rest.
    #[cfg(feature = "comparison")]
    #[test]
    fn an_emergency_closes_bypass_valves_that_have_just_opened() {
        let configuration = Configuration::defender110().with_strategy(crate::strategy::Strategy::RideHandling);
        let mut state = State::new();
        for _ in 0..200 {
            tick(&configuration, &mut state, &leaning(0));
        }
        let guard_at = {
            let mut state = state.clone();
            let guarded = |n: &u32| tick(&configuration, &mut state, &leaning(*n)).rollover_guard;
            (1..200).find(guarded).expect("it leans far enough")
        };
        for n in 1..guard_at {
            tick(&configuration, &mut state, &leaning(n));
        }
        let all_open = ValveCommand::from_word(crate::valves::BYPASS_BITS);
        state.dwell = Dwell::INITIAL;
        while state.dwell.step(all_open, false) != all_open {}
        let outputs = tick(&configuration, &mut state, &leaning(guard_at));
        assert!(outputs.rollover_guard);
        assert_eq!((outputs.mode, outputs.command), (Mode::Normal, ValveCommand::SAFE));
    }

    /// A missing reading is replaced, and the estimate goes on.
    #[test]
    fn the_estimate_goes_on_in_degraded_mode() {
        let (configuration, mut state) = (Configuration::defender110(), State::new());
        let pressure = Corners::splat(StrutPressures::splat(Gauge(2.0e6)));
        let mut inputs = Inputs::from_values(Corners::splat(0.0), pressure);
        for _ in 0..200 {
            tick(&configuration, &mut state, &inputs);
        }
        inputs.displacement[Corner::RearLeft] = crate::reading::Reading::INVALID;
        for n in 1..=20 {
            let outputs = tick(&configuration, &mut state, &inputs);
            assert_eq!(outputs.mode == Mode::Degraded, n >= 3);
            for load_n in outputs.estimate.static_load_n.values() {
                assert!((load_n - 2.0e6 * 1.963_495_4e-3).abs() < 1.0, "{load_n} N");
            }
        }
    }
}
