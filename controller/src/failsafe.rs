//! The mode machine: it decides which valves the controller may open, given the faults.
//!
//! It is a pure function of the health of the inputs, counted in ticks. It decides last: everything that a strategy wants passes
//! through [`permitted`]. The safe state is de-energised, with all valves closed, which is a stiff spring and high damping; a
//! doubt always leads there. A closing is never delayed: a fault that is seen in a tick changes the command of that tick.
//!
//! Each axle is *restricted* from the tick in which a reading of it is missing until it has been healthy for its recovery time, and
//! the mode says how many axles are:
//!
//! ```text
//!     +---------+  healthy for 20 ticks  +--------+   one axle    +----------+   both axles   +------+
//!     | StartUp | ---------------------> | Normal | <-----------> | Degraded | <------------> | Safe |
//!     +---------+                        +--------+               +----------+                +------+
//!          |                                  ^                         |                      ^  |
//!          |                                  +-------------------------|----------------------+  |
//!          |  solenoid or internal fault                                |                         | fifth entry, or a severe
//!          +---------------------------> +---------+ <------------------+                         | fault for 2000 ticks
//!                 (from anywhere)        | Latched | <--------------------------------------------+
//!                                        +---------+
//! ```
//!
//! Until the first complete set of readings the machine waits in `StartUp` with closed valves. `Latched` ends only with a new
//! [`State`], which is a restart.
//!
//! | mode | springs (valve 3) | bypass valves 1, 2 |
//! |---|---|---|
//! | Normal | strategy | strategy |
//! | Degraded | closed at all four, for the roll stiffness and balance of the safe state | strategy on the healthy axle, closed on the other |
//! | StartUp, Safe, Latched | closed | closed |
//!
//! # Faults that come and go
//!
//! The recovery time of an axle is 1 s after its first fault, and four times as long after each further one, up to 64 s: a fault
//! that comes back was not gone. A minute without a restriction takes one step back. So within a minute an axle can become
//! restricted four times (recoveries of 1, 4 and 16 s lie between) and recover three times. Two axles together change the mode at
//! most 14 times, and with the start and the end that makes [`MODE_CHANGES_A_MINUTE`]. Entries into `Safe` decay in the same way:
//! the fifth one latches if each came within a minute of the one before.

use oleo_interface::{Axles, Corners};
use strum::{FromRepr, IntoStaticStr, VariantArray};

use crate::timing::ticks;
use crate::valves::{BYPASS_BITS, ValveCommand};

/// Number of healthy ticks in a row that lead from `StartUp` to `Normal`.
pub const START_UP_TICKS: u16 = ticks(100);
/// Number of healthy ticks in a row that end the first restriction of an axle.
pub const RECOVERY_TICKS: u16 = ticks(1_000);
/// Most times by which the recovery time of an axle grows fourfold.
const LONGEST_RECOVERY_LEVEL: u8 = 3;
/// Number of ticks without a fault after which one fault of the past is forgotten.
const FORGET_TICKS: u16 = ticks(60_000);
/// Number of ticks of a severe fault in `Safe` after which the machine latches.
pub const LATCH_TICKS: u16 = ticks(10_000);
/// Number of entries into `Safe`, less those that are forgotten, at which the machine latches.
pub const LATCH_ENTRIES: u8 = 5;
/// Most changes of the mode within any minute, whatever the inputs.
pub const MODE_CHANGES_A_MINUTE: usize = 16;

/// What the controller is doing. The numbers are those on the bus.
///
/// ```
/// use oleo_controller::Mode;
/// assert_eq!((Mode::StartUp.raw(), Mode::StartUp.name()), (0, "start-up"));
/// assert_eq!(Mode::from_repr(4), Some(Mode::Latched));
/// assert_eq!(Mode::from_repr(5), None);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, FromRepr, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "kebab-case")]
#[repr(u8)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Mode {
    /// The controller waits for its first complete and plausible set of readings. All valves are closed.
    #[default]
    StartUp = 0,
    /// The vehicle is healthy, and the strategy sets all valves.
    Normal = 1,
    /// Readings of one axle are missing. All springs are stiff, and only the other axle's dampers follow the strategy.
    Degraded = 2,
    /// Readings of both axles are missing. All valves are closed; each axle recovers by itself.
    Safe = 3,
    /// All valves are closed until a restart.
    Latched = 4,
}

impl Mode {
    /// Number on the bus, 0 to 4.
    pub const fn raw(self) -> u8 {
        self as u8
    }

    /// Name in logs, tables and scenario files.
    pub fn name(self) -> &'static str {
        self.into()
    }
}

/// What was found to be wrong. The numbers are those on the bus; the graver of two faults has the higher one.
///
/// ```
/// use oleo_controller::FaultCode;
/// assert_eq!((FaultCode::SensorRange.raw(), FaultCode::SensorRange.name()), (1, "sensor-range"));
/// assert!(FaultCode::BusSilent > FaultCode::MessageLost);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, FromRepr, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "kebab-case")]
#[repr(u8)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum FaultCode {
    /// There is no fault.
    #[default]
    None = 0,
    /// A reading is flagged by its sensor, not finite, or outside its range.
    SensorRange = 1,
    /// A reading changes faster than the hardware can move.
    SensorRate = 2,
    /// A reading does not change while its neighbours do.
    SensorStuck = 3,
    /// One pressure of a strut disagrees with the others at rest.
    SensorVote = 4,
    /// Displacement and gas volumes of a strut disagree.
    OilBalance = 5,
    /// Oil moves through a valve 3 that is commanded closed.
    ValveStuck = 6,
    /// A sensor message is late or not trustworthy.
    MessageLost = 7,
    /// No sensor message arrives any more.
    BusSilent = 8,
    /// Somebody else sends under an identifier of the controller.
    ForeignSender = 9,
    /// A solenoid could not be switched.
    Solenoid = 10,
    /// The controller's own arithmetic gave something that is not a finite number.
    Internal = 11,
}

impl FaultCode {
    /// Number on the bus, 0 to 11.
    pub const fn raw(self) -> u8 {
        self as u8
    }

    /// Name in logs, tables and scenario files.
    pub fn name(self) -> &'static str {
        self.into()
    }
}

/// Health of the inputs of one tick, as the plausibility checks found it. See [`State`] for an example.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Health {
    /// Whether each corner has at least one reading that may not be used.
    pub affected: Corners<bool>,
    /// The gravest cause present, [`FaultCode::None`] if all readings are healthy.
    pub cause: FaultCode,
}

impl Health {
    pub(crate) const GOOD: Self = Self {
        affected: Corners::splat(false),
        cause: FaultCode::None,
    };

    /// Whether nothing is wrong.
    pub fn is_good(&self) -> bool {
        self.cause == FaultCode::None && self.affected == Corners::splat(false)
    }
}

/// Whether either corner of each axle is affected.
fn affected_axles(affected: Corners<bool>) -> Axles<bool> {
    affected.by_axle().map(|(left, right)| left || right)
}

/// Memory of the mode machine.
///
/// ```
/// use oleo_controller::failsafe::{Health, START_UP_TICKS, State};
/// use oleo_controller::{Corner, FaultCode, Mode};
/// let mut state = State::default();
/// let healthy = Health::default();
/// assert!((1..START_UP_TICKS).all(|_| state.step(&healthy) == Mode::StartUp));
/// assert_eq!(state.step(&healthy), Mode::Normal);
///
/// let mut broken = Health { cause: FaultCode::SensorStuck, ..healthy };
/// broken.affected[Corner::RearLeft] = true;
/// assert_eq!(state.step(&broken), Mode::Degraded);
/// broken.affected[Corner::FrontLeft] = true;
/// assert_eq!(state.step(&broken), Mode::Safe);
/// assert_eq!(state.first_cause(), FaultCode::SensorStuck);
/// // The front axle is healthy again for a second: its dampers may follow the strategy.
/// broken.affected[Corner::FrontLeft] = false;
/// assert_eq!((0..200).map(|_| state.step(&broken)).last(), Some(Mode::Degraded));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct State {
    mode: Mode,
    first_cause: FaultCode,
    axles: Axles<AxleState>,
    /// Number of ticks in a row in which both axles were healthy; it saturates.
    healthy: u16,
    /// Number of ticks of a severe fault since `Safe` was entered; it saturates.
    severe: u16,
    safe_entries: Recurrence,
    was_normal: bool,
}

/// How often something has happened, where a minute without it takes one away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Recurrence {
    count: u8,
    calm: u16,
}

impl Recurrence {
    const INITIAL: Self = Self { count: 0, calm: 0 };

    /// Counts one more occurrence.
    fn happens(&mut self) {
        self.count = self.count.saturating_add(1);
        self.calm = 0;
    }

    /// A tick; `quiet` says whether nothing of the kind is present.
    fn step(&mut self, quiet: bool) {
        if self.count == 0 {
            return;
        }
        self.calm = if quiet { self.calm.saturating_add(1) } else { 0 };
        if self.calm >= FORGET_TICKS {
            self.calm = 0;
            self.count = self.count.saturating_sub(1);
        }
    }
}

/// Whether an axle is restricted, and for how long after its last fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct AxleState {
    restricted: bool,
    /// Number of healthy ticks in a row while restricted.
    healthy: u16,
    faults: Recurrence,
}

impl AxleState {
    const INITIAL: Self = Self {
        restricted: false,
        healthy: 0,
        faults: Recurrence::INITIAL,
    };

    /// One tick; returns whether the axle is restricted.
    #[inline(never)]
    fn step(&mut self, affected: bool) -> bool {
        if affected {
            self.healthy = 0;
            if !self.restricted {
                self.restricted = true;
                self.faults.happens();
            }
        } else if self.restricted {
            self.healthy = self.healthy.saturating_add(1);
            // The first fault has the shortest recovery.
            let level = self.faults.count.saturating_sub(1).min(LONGEST_RECOVERY_LEVEL);
            self.restricted = self.healthy < RECOVERY_TICKS << (2 * level);
        }
        self.faults.step(!self.restricted);
        self.restricted
    }
}

impl Default for State {
    fn default() -> Self {
        Self::INITIAL
    }
}

impl State {
    pub(crate) const INITIAL: Self = Self {
        mode: Mode::StartUp,
        first_cause: FaultCode::None,
        axles: Axles::splat(AxleState::INITIAL),
        healthy: 0,
        severe: 0,
        safe_entries: Recurrence::INITIAL,
        was_normal: false,
    };

    /// A machine that is latched from its first tick on, for a fault before a restart.
    pub fn latched(cause: FaultCode) -> Self {
        Self {
            mode: Mode::Latched,
            first_cause: cause,
            ..Self::INITIAL
        }
    }

    /// Whether the mode was ever [`Mode::Normal`].
    pub const fn was_normal(&self) -> bool {
        self.was_normal
    }

    /// First cause of leaving [`Mode::Normal`], or of not reaching it; [`FaultCode::None`] in [`Mode::Normal`].
    pub const fn first_cause(&self) -> FaultCode {
        self.first_cause
    }

    /// Axles that may not follow the strategy.
    pub fn restricted(&self) -> Axles<bool> {
        self.axles.map(|axle| axle.restricted)
    }

    /// One tick; returns the mode that holds for it.
    pub fn step(&mut self, health: &Health) -> Mode {
        if self.mode == Mode::Latched {
            return self.mode;
        }
        // Most ticks end here: nothing is wrong, and nothing of the past is remembered.
        if self.mode == Mode::Normal && health.is_good() && self.is_unburdened() {
            self.healthy = self.healthy.saturating_add(1);
            return self.mode;
        }
        let affected = affected_axles(health.affected);
        let terminal = matches!(health.cause, FaultCode::Solenoid | FaultCode::Internal);
        let healthy = affected == Axles::splat(false) && !terminal;
        self.healthy = if healthy { self.healthy.saturating_add(1) } else { 0 };
        if !healthy && self.first_cause == FaultCode::None {
            self.first_cause = health.cause;
        }
        self.mode = if terminal {
            self.first_cause = health.cause;
            Mode::Latched
        } else if self.was_normal {
            self.after_start(affected)
        } else if self.healthy >= START_UP_TICKS {
            Mode::Normal
        } else {
            Mode::StartUp
        };
        if self.mode == Mode::Normal {
            self.was_normal = true;
            self.first_cause = FaultCode::None;
        }
        self.mode
    }

    /// Whether no fault is remembered, so that a healthy tick has nothing to forget.
    fn is_unburdened(&self) -> bool {
        let Axles { front, rear } = &self.axles;
        front.faults.count == 0 && rear.faults.count == 0 && self.safe_entries.count == 0
    }

    /// The mode once the vehicle has been healthy.
    fn after_start(&mut self, affected: Axles<bool>) -> Mode {
        let Axles { front, rear } = &mut self.axles;
        let restricted = Axles::new(front.step(affected.front), rear.step(affected.rear));
        self.safe_entries.step(self.mode != Mode::Safe);
        match (restricted.front, restricted.rear) {
            (false, false) => Mode::Normal,
            (true, true) => self.safe(affected.front && affected.rear),
            _ => Mode::Degraded,
        }
    }

    fn safe(&mut self, severe: bool) -> Mode {
        if self.mode != Mode::Safe {
            self.severe = 0;
            self.safe_entries.happens();
        }
        self.severe = self.severe.saturating_add(u16::from(severe));
        if self.safe_entries.count >= LATCH_ENTRIES || self.severe > LATCH_TICKS {
            Mode::Latched
        } else {
            Mode::Safe
        }
    }
}

/// The part of a command that a mode permits wherever a fault is: what a receiver of the command may expect.
///
/// ```
/// use oleo_controller::failsafe::permitted_in;
/// use oleo_controller::{Mode, ValveCommand};
/// assert_eq!(permitted_in(Mode::Normal, ValveCommand::SOFT), ValveCommand::SOFT);
/// assert_eq!(permitted_in(Mode::Degraded, ValveCommand::SOFT).word(), 0b011_011_011_011);
/// assert_eq!(permitted_in(Mode::Latched, ValveCommand::SOFT), ValveCommand::SAFE);
/// ```
pub const fn permitted_in(mode: Mode, wanted: ValveCommand) -> ValveCommand {
    match mode {
        Mode::Normal => wanted,
        Mode::Degraded => ValveCommand::from_word(wanted.word() & BYPASS_BITS),
        Mode::StartUp | Mode::Safe | Mode::Latched => ValveCommand::SAFE,
    }
}

/// The part of a wanted command that a mode permits, with the axles that are [restricted](State::restricted).
///
/// ```
/// use oleo_controller::failsafe::permitted;
/// use oleo_controller::interface::Axles;
/// use oleo_controller::{Mode, ValveCommand};
/// let none = Axles::splat(false);
/// assert_eq!(permitted(Mode::Normal, none, ValveCommand::SOFT), ValveCommand::SOFT);
/// assert_eq!(permitted(Mode::Safe, none, ValveCommand::SOFT), ValveCommand::SAFE);
/// ```
pub fn permitted(mode: Mode, restricted: Axles<bool>, wanted: ValveCommand) -> ValveCommand {
    let permitted = permitted_in(mode, wanted);
    if mode != Mode::Degraded {
        return permitted;
    }
    ValveCommand::from_fn(|corner, valve| !restricted[corner.axle()] && permitted.is_open(corner, valve))
}

#[cfg(test)]
mod tests;
