//! An inertial unit on the sprung mass that sends what it reads on the bus of the suspension, for whoever logs it.
//!
//! ```text
//!   settings (scenario) --> unit: mounting, noise --> message --> two frames a tick
//!                            ^                           |
//!   vehicle: body axes ------+                           +--> logs, decoded by `drive_log` and by `imu.dbc`
//! ```
//!
//! It is no part of the controller's contract: its messages are in a database of their own (`hil/imu.dbc`), the controller's node ignores
//! them, no injected fault disturbs them, and a run commands the same with and without it.

mod contract;
mod message;
mod settings;
mod unit;

pub use contract::{LOAD_1M_PERMILLE, LOAD_500K_PERMILLE, MESSAGES, of_unit};
pub use message::{InertialReadings, RATE_STEP_RAD_S, SPECIFIC_FORCE_STEP_M_S2, decode_axes, encode_axes};
pub use settings::ImuSettings;
pub use unit::Unit;

/// The database of the unit's messages.
pub const DBC: &str = include_str!("../../imu.dbc");
