//! The controller's CAN bus: message contracts, signals, end-to-end protection and bus load.
//!
//! `oleo.dbc`, beside this crate's manifest, is the database that other tools read. This module is the same in Rust, for both
//! ends of the bus. The tests read the database with an independent reader and compare every constant and every bit with it.
//!
//! | file | what it holds |
//! |---|---|
//! | `contract` | identifiers, periods, data identifiers and time-outs of all messages, in one table |
//! | `board` | the message about the board itself |
//! | `signals` | a struct for each kind of message, to and from the 52 bits of its payload |
//! | `e2e` | end-to-end protection: an 8-bit CRC and a 4-bit counter in bytes 0 and 1 (AUTOSAR profile 2) |
//! | `state_machine` | whether a message may be trusted, from its last sixteen periods (AUTOSAR's E2E state machine) |
//! | [`bus_load`] | worst-case load of the bus, computed from the table at compile time |

mod board;
pub mod bus_load;
mod contract;
mod e2e;
mod frame;
mod signals;
mod state_machine;

pub use board::{BoardMessage, BusState, ClockSource, ImageState};
pub use contract::{BOARD, COMMAND, Contract, DISPLACEMENT, MESSAGES, PRESSURE, STATUS, sensor_message};
pub use e2e::{CheckStatus, Checker, Protector};
pub(crate) use e2e::{Counter, Sequence};
pub use frame::{FRAME_BYTES, Frame};
pub use signals::{
    ACCELERATION_STEP_M_S2, CommandMessage, DISPLACEMENT_STEP_M, DisplacementMessage, PRESSURE_OFFSET_PA,
    PRESSURE_RAW_ERROR, PRESSURE_RAW_MAX, PRESSURE_STEP_PA, PressureMessage, StatusMessage,
};
pub(crate) use state_machine::{Period, StateMachine};
