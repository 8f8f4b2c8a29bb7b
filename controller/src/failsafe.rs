//! The mode machine: what the controller is allowed to do, given what is broken.
//!
//! It is a pure function of the health of the inputs, counted in ticks, and it has the last word: whatever a strategy wants passes
//! through [`permitted`]. De-energised (all valves closed: stiff spring, high damping) is the safe state, so every doubt
//! ends there. Closing is never delayed: a fault that is seen in a tick shapes the command of that tick.
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
//! *Severe*: readings are missing on both axles. *One axle affected*: any reading of one axle is missing.
//! From `StartUp` a severe fault leads to `Safe` only after it was once healthy: before the first complete set of sensors
//! the machine just waits, with the valves closed. `Latched` ends only with a new [`State`], that is a restart.
//!
//! | mode | springs (valve 3) | bypass valves 1, 2 |
//! |---|---|---|
//! | Normal | strategy | strategy |
//! | Degraded | closed, all four: roll stiffness and balance of the safe state | strategy on the healthy axle, closed on the other |
//! | StartUp, Safe, Latched | closed | closed |

use oleo_interface::{Axles, Corners, Valve};
use strum::{FromRepr, IntoStaticStr, VariantArray};

use crate::timing::ticks;
use crate::valves::ValveCommand;

/// Ticks of health from `StartUp` to `Normal`.
pub const START_UP_TICKS: u16 = ticks(100);
/// Ticks of health from `Degraded` to `Normal` and from `Safe` to `StartUp`.
pub const RECOVERY_TICKS: u16 = ticks(1_000);
/// Ticks in `Safe` after which it latches.
pub const LATCH_TICKS: u16 = ticks(10_000);
/// Entry into `Safe` that latches.
pub const LATCH_ENTRIES: u8 = 3;

/// What the controller is doing. The numbers are those on the bus; in words a mode is `start-up`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, FromRepr, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "kebab-case")]
#[repr(u8)]
pub enum Mode {
    /// Waiting for a complete and plausible set of sensors. Valves closed.
    #[default]
    StartUp = 0,
    /// The strategy decides.
    Normal = 1,
    /// One axle's sensors are incomplete: springs stiff, dampers by strategy on the other axle.
    Degraded = 2,
    /// Valves closed; recovers when everything is healthy again.
    Safe = 3,
    /// Valves closed until restart.
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

/// What was found to be wrong. The first cause of leaving `Normal` (or of not reaching it) is kept until all is well. The
/// numbers are those on the bus; the graver of two faults has the higher one. In words a fault is `sensor-range`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, FromRepr, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "kebab-case")]
#[repr(u8)]
pub enum FaultCode {
    /// Nothing.
    #[default]
    None = 0,
    /// A reading is flagged by its sensor, not finite, or outside its range.
    SensorRange = 1,
    /// A reading changes faster than the hardware can.
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
    /// The controller's own arithmetic gave no number.
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

/// Health of one tick's inputs, as the plausibility checks leave it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Health {
    /// Corners with at least one reading that may not be used.
    pub affected: Corners<bool>,
    /// Why (the gravest cause present), [`FaultCode::None`] if healthy.
    pub cause: FaultCode,
}

/// Whether either corner of each axle is affected.
fn affected_axles(affected: Corners<bool>) -> Axles<bool> {
    affected.by_axle().map(|(left, right)| left || right)
}

/// Memory of the mode machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct State {
    mode: Mode,
    first_cause: FaultCode,
    /// Healthy ticks in a row.
    healthy: u16,
    /// Ticks in `Safe`.
    dwell: u16,
    safe_entries: u8,
    was_normal: bool,
}

impl State {
    /// Present mode.
    pub const fn mode(&self) -> Mode {
        self.mode
    }

    /// Whether `Normal` was ever reached.
    pub const fn was_normal(&self) -> bool {
        self.was_normal
    }

    /// First cause of the present trouble; `None` in `Normal`.
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

    /// One tick.
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

/// The part of a wanted command that a mode permits. `affected` as in [`Health`].
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
