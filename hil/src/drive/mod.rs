//! Drives a vehicle through a manoeuvre without a bus: with one model of the vehicle or both, with one suspension or several.
//!
//! ```text
//!   Request --> Plan (course, track, vehicle, struts) --> drive --> Driven: a run of samples --> columns, measures
//! ```
//!
//! The controller is called directly, with readings as exact as the simulation; [`crate::run`] puts it behind a bus.

mod choice;
mod columns;
mod driven;
mod measures;
mod plan;
mod request;
mod suspension;

pub use choice::{Kind, Model, Setting};
pub use columns::{COLUMNS, Signal, column, open_valves, series};
pub use driven::{Driven, drive};
pub use measures::{Measure, measures};
pub use plan::Plan;
pub use request::Request;
