//! The suspension controller: four displacements and sixteen pressures in, twelve valve positions out, every 5 ms.
//!
//! ```text
//!  frames --> node --> tick:  plausibility --> estimate --> strategy --> failsafe --> node --> frames
//!             (can)                                                                   \--> solenoids
//! ```
//!
//! [`tick`] is a pure function of an immutable [`Configuration`], a [`State`] and [`Inputs`]; the caller owns time. [`Node`] wraps it
//! with the CAN bus, [`can`] is the bus's database in Rust. No heap, no panic, no clock, no std; f32 only, with the same `libm`
//! on every machine, so that the sequence of valve words is the same on a desk computer and in the vehicle.
#![no_std]
#![forbid(unsafe_code)]

pub mod can;
pub mod configuration;
pub mod dwell;
pub mod estimate;
pub mod failsafe;
pub mod filter;
pub mod node;
pub mod plausibility;
pub mod port;
pub mod reading;
pub mod solenoids;
pub mod spring;
pub mod strategy;
pub mod tick;
pub mod timing;
pub mod valves;

pub use configuration::Configuration;
pub use estimate::Estimate;
pub use failsafe::{FaultCode, Mode};
pub use node::Node;
pub use reading::{Inputs, Reading};
pub use solenoids::Solenoids;
pub use strategy::{DamperPolicy, Strategy};
pub use tick::{Outputs, State, tick};
pub use valves::ValveCommand;
