//! The mode machine: what the controller may do, given what is broken.
//!
//! It is a pure function of the health of the inputs, counted in ticks. It decides last: everything that a strategy wants passes
//! through [`permitted`]. The safe state is de-energised, with all valves closed, which is a stiff spring and high damping; a
//! doubt always leads there. A closing is never delayed: a fault that is seen in a tick changes the command of that tick.
//!
//! ```text
//!                    healthy for 20 ticks
//!     +----------+ -----------------------> +--------+ <------------------------+
//!     | StartUp  |                          | Normal |   healthy for 200 ticks  |
//!     +----------+ <---------+              +--------+ -----------------> +----------+
//!       |  | severe          |                |  |     one axle affected  | Degraded |
//!       |  +--------->+------+--+ <-----------+  |                        +----------+
//!       |             |  Safe   | <--------------|----------------------------+  |
//!       |             +---------+    severe      |           severe              |
//!       |  healthy for  |   | third entry, or    |                               |
//!       |  200 ticks:   |   | 2000 ticks in Safe |                               |
//!       |  to StartUp   |   v                    v                               v
//!       +-------------------> Latched  <---- solenoid or internal fault (from anywhere)
//! ```
//!
//! A fault is *severe* if readings are missing on both axles; *one axle is affected* if any of its readings is missing. From
//! `StartUp` a severe fault leads to `Safe` only if the vehicle was healthy before: until the first complete set of readings
//! the machine waits with closed valves. `Latched` ends only with a new [`State`], which is a restart.
//!
//! | mode | springs (valve 3) | bypass valves 1, 2 |
//! |---|---|---|
//! | Normal | strategy | strategy |
//! | Degraded | closed at all four, for the roll stiffness and balance of the safe state | strategy on the healthy axle, closed on the other |
//! | StartUp, Safe, Latched | closed | closed |

use oleo_interface::{Axles, Corners, Valve};
use strum::{FromRepr, IntoStaticStr, VariantArray};

use crate::timing::ticks;
use crate::valves::ValveCommand;

/// Number of healthy ticks in a row that lead from `StartUp` to `Normal`.
pub const START_UP_TICKS: u16 = ticks(100);
/// Number of healthy ticks in a row that lead from `Degraded` to `Normal` and from `Safe` to `StartUp`.
pub const RECOVERY_TICKS: u16 = ticks(1_000);
/// Number of ticks in `Safe` after which the machine latches.
pub const LATCH_TICKS: u16 = ticks(10_000);
/// Number of entries into `Safe` at which the machine latches.
pub const LATCH_ENTRIES: u8 = 3;

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
pub enum Mode {
    /// The controller waits for a complete and plausible set of readings. All valves are closed.
    #[default]
    StartUp = 0,
    /// The strategy decides.
    Normal = 1,
    /// Readings of one axle are missing. All springs are stiff, and only the other axle's dampers follow the strategy.
    Degraded = 2,
    /// Readings of both axles are missing. All valves are closed; the machine recovers when everything is healthy again.
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
pub enum FaultCode {
    /// Nothing is wrong.
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
    /// A sensor message is late or not trustworthy.
    MessageLost = 6,
    /// No sensor message arrives any more.
    BusSilent = 7,
    /// A solenoid could not be switched.
    Solenoid = 8,
    /// The controller's own arithmetic gave something that is not a finite number.
    Internal = 9,
}

impl FaultCode {
    /// Number on the bus, 0 to 9.
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
pub struct Health {
    /// Whether each corner has at least one reading that may not be used.
    pub affected: Corners<bool>,
    /// The gravest cause present, [`FaultCode::None`] if all readings are healthy.
    pub cause: FaultCode,
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
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct State {
    mode: Mode,
    first_cause: FaultCode,
    /// Number of healthy ticks in a row; it saturates.
    healthy: u16,
    /// Number of ticks in `Safe`; it saturates.
    dwell: u16,
    safe_entries: u8,
    was_normal: bool,
}

impl State {
    /// Whether the mode was ever [`Mode::Normal`].
    pub const fn was_normal(&self) -> bool {
        self.was_normal
    }

    /// First cause of leaving [`Mode::Normal`], or of not reaching it; [`FaultCode::None`] in [`Mode::Normal`].
    pub const fn first_cause(&self) -> FaultCode {
        self.first_cause
    }

    fn enter_safe(&mut self) {
        self.dwell = 0;
        self.safe_entries = self.safe_entries.saturating_add(1);
        self.mode = if self.safe_entries >= LATCH_ENTRIES {
            Mode::Latched
        } else {
            Mode::Safe
        };
    }

    /// One tick; returns the mode that holds for it.
    pub fn step(&mut self, health: &Health) -> Mode {
        if self.mode == Mode::Latched {
            return self.mode;
        }
        let Axles { front, rear } = affected_axles(health.affected);
        let terminal = matches!(health.cause, FaultCode::Solenoid | FaultCode::Internal);
        let severe = front && rear;
        let healthy = !front && !rear && !terminal;
        self.healthy = if healthy { self.healthy.saturating_add(1) } else { 0 };
        if !healthy && self.first_cause == FaultCode::None {
            self.first_cause = health.cause;
        }
        if terminal {
            self.first_cause = health.cause;
            self.mode = Mode::Latched;
            return self.mode;
        }
        match self.mode {
            Mode::StartUp => {
                if severe && self.was_normal {
                    self.enter_safe();
                } else if self.healthy >= START_UP_TICKS {
                    self.become_normal();
                }
            }
            Mode::Normal => {
                if severe {
                    self.enter_safe();
                } else if !healthy {
                    self.mode = Mode::Degraded;
                }
            }
            Mode::Degraded => {
                if severe {
                    self.enter_safe();
                } else if self.healthy >= RECOVERY_TICKS {
                    self.become_normal();
                }
            }
            Mode::Safe => {
                self.dwell = self.dwell.saturating_add(1);
                if self.healthy >= RECOVERY_TICKS {
                    self.mode = Mode::StartUp;
                    self.healthy = 0;
                } else if self.dwell >= LATCH_TICKS {
                    self.mode = Mode::Latched;
                }
            }
            Mode::Latched => {}
        }
        self.mode
    }

    fn become_normal(&mut self) {
        self.mode = Mode::Normal;
        self.first_cause = FaultCode::None;
        self.was_normal = true;
    }
}

/// The part of a wanted command that a mode permits, with the corners that [`Health`] calls affected.
///
/// ```
/// use oleo_controller::failsafe::permitted;
/// use oleo_controller::{Corners, Mode, ValveCommand};
/// let healthy = Corners::splat(false);
/// assert_eq!(permitted(Mode::Normal, healthy, ValveCommand::SOFT), ValveCommand::SOFT);
/// assert_eq!(permitted(Mode::Safe, healthy, ValveCommand::SOFT), ValveCommand::SAFE);
/// ```
pub fn permitted(mode: Mode, affected: Corners<bool>, wanted: ValveCommand) -> ValveCommand {
    match mode {
        Mode::Normal => wanted,
        Mode::Degraded => {
            let axles = affected_axles(affected);
            ValveCommand::from_fn(|corner, valve| {
                valve != Valve::Spring && !axles[corner.axle()] && wanted.is_open(corner, valve)
            })
        }
        Mode::StartUp | Mode::Safe | Mode::Latched => ValveCommand::SAFE,
    }
}
