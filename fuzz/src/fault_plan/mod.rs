//! Plans of faults: bytes become a sequence of events on the healthy frames of a vehicle that drives, and rules say what the
//! controller and the output stage must hold in every tick, whatever the plan is.
//!
//! Random frames never leave start-up, because no check value is right. A plan begins with a vehicle whose frames are all right, and
//! spoils what it likes: readings, frames in both directions, valves, the controller itself.
//!
//! | file | what it holds |
//! |---|---|
//! | `plan` | bytes to events |
//! | `vehicle` | struts whose pressures follow from motion, load and valves |
//! | `readings` | what a faulty sensor says |
//! | `bus` | what happens to frames on their way |
//! | `drive` | one run of a plan, tick by tick |
//! | `rules` | what must hold, and which of it did not |
//!
//! The fuzz target `fault_plan`, `tests/hostile_bytes.rs` of the root package, and tests and example `fault_plans` of the controller
//! use it.
#![allow(dead_code, unused_imports, reason = "each of the programs uses its part")]

mod bus;
mod drive;
mod plan;
mod readings;
mod rules;
mod vehicle;

pub use drive::{Reached, drive};
pub use plan::{BYTES_OF_EVENT, BYTES_OF_HEADER, Plan};
pub use rules::{Broken, Observation, Rule};
