//! The controller's CAN bus: message contracts, signals, end-to-end protection and bus load.
//!
//! `oleo.dbc`, beside this crate's manifest, is the database other people's tools read. This module is the same thing in
//! Rust, for both ends of the bus (the plant side of a simulation uses it too); the tests read the database with
//! an independent reader and hold every constant and every bit here against it.
//!
//! ```text
//!   [contract]  ids, periods, data ids, time-outs           one table
//!   [signals]   struct <-> 52 payload bits                  no meaning of faults here
//!   [e2e]       8-bit CRC and 4-bit counter in bytes 0, 1   AUTOSAR profile 2
//!   [plant_end] what sits opposite the controller           sensors out, valve command in
//!   [bus_load]  computed from the table at compile time
//! ```

pub mod bus_load;
mod contract;
mod e2e;
mod frame;
mod plant_end;
pub mod signals;

pub use contract::{COMMAND, Contract, DISPLACEMENT, MESSAGES, PRESSURE, STATUS, sensor_message};
pub use e2e::{CheckStatus, Checker, Protector};
pub use frame::{FRAME_BYTES, Frame};
pub use plant_end::PlantEnd;
pub use signals::{CommandMessage, DisplacementMessage, PressureMessage, StatusMessage};
