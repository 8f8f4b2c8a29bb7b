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
mod configuration;
mod dwell;
pub mod estimate;
pub mod failsafe;
pub mod filter;
pub mod node;
pub mod plausibility;
pub mod port;
mod range;
mod reading;
mod receiver;
mod sensor_message;
mod solenoids;
pub mod spring;
pub mod strategy;
pub mod tick;
mod timing;
mod valves;
mod vehicle;

pub use configuration::{Builder, Configuration, Tuning};
pub use estimate::Estimate;
pub use failsafe::{FaultCode, Mode};
pub use node::Node;
pub use oleo_interface as interface;
pub use oleo_interface::{
    Absolute, Axle, Axles, Corner, Corners, Gauge, PressurePoint, Side, StrutPressures, StrutValves, Valve,
};
pub use range::{ConfigurationError, Hysteresis};
pub use reading::{Inputs, Reading};
pub use sensor_message::{MessageSet, SensorMessage};
pub use solenoids::{SolenoidError, Solenoids};
pub use strategy::{DamperPolicy, Strategy};
pub use tick::{Outputs, State, tick};
pub use valves::ValveCommand;
pub use vehicle::VehicleDescription;
