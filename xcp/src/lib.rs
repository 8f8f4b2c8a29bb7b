//! XCP on CAN for the controller: a calibration tool reads what the controller sees, estimates and decides, in step with its tick,
//! and may change its tuning where the build and the user say so.
//!
//! ```text
//!   oleo_controller::Node --- copies, after each tick ---> Sample
//!                                                            |
//!        measurement (table) --> memory: one image of bytes --+--> daq: lists that are sent every tick
//!        calibration (table) -->   a tool reads by address    |
//!                                          |                  |
//!   frames 0x3F0 --> slave: one command a tick, one answer <--+--> frames 0x3F1, a bounded number a tick
//! ```
//!
//! | file | what it holds |
//! |---|---|
//! | [`bus`] | identifiers, and how many frames a tick the bus has room for |
//! | [`packet`] | codes of commands and errors, and the frames that are sent |
//! | [`quantity`] | what a table says of a quantity: name, unit, type, place |
//! | [`measurement`] | the table of what can be measured |
//! | [`calibration`] | the table of what can be calibrated, and the rule by which a written value is accepted |
//! | `memory` | the addresses that a tool sees |
//! | `daq` | lists of measurements that are sent by themselves |
//! | `a2l` | the description file for tools, of the same tables (feature `a2l`) |
//! | [`slave`] | the state machine of the protocol |
//!
//! Source: ASAM MCD-1 XCP, protocol layer specification (commands, errors, DAQ) and transport layer specification for CAN, versions
//! 1.0 to 1.4, *recalled*; `tests/xcp` of the project lets an independent master (pyxcp) speak with this slave.
//!
//! **Off the safety path.** The slave gets copies of inputs and outputs after a tick is over. Nothing flows back to the controller,
//! except, with the feature `calibration` and where the caller asks for it, a configuration that has passed
//! [`Builder::build`](oleo_controller::Builder::build), and that [`Node::reconfigure`](oleo_controller::Node) takes only while all
//! valves are closed. The work of a tick is bounded: one command, and at most [`slave::MOST_SENT`] frames.
//!
//! The crate needs no std (but for the feature `a2l`), no heap and no clock, and never panics (`tests/hostile_frames.rs`). The image for the board does not
//! contain it: see `docs/xcp.md`.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(feature = "a2l")]
extern crate std;

#[cfg(feature = "a2l")]
pub mod a2l;

pub mod bus;
pub mod calibration;
mod daq;
pub mod measurement;
mod memory;
pub mod packet;
pub mod quantity;
pub mod slave;

pub use bus::{Budget, REQUEST_ID, RESPONSE_ID};
pub use measurement::Sample;
pub use memory::{IDENTITY_ADDRESS, identity};
pub use slave::Slave;
