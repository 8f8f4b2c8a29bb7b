//! The suspension controller: every 5 ms it reads four displacements and sixteen pressures and sets twelve valves.
//!
//! ```text
//!  frames --> Node --> tick:  plausibility --> estimate --> strategy --> spring, dwell --> failsafe --> Node --> frames
//!             (can)           which readings   motion       desired      how springs       which valves        \-> Solenoids
//!                             may be used                   valves       may change        may open
//! ```
//!
//! | task | use |
//! |---|---|
//! | run one period without a bus | [`tick`], a pure function of [`Configuration`], [`State`] and [`Inputs`] |
//! | run one period with CAN frames | [`Node::receive`] any number of times, then [`Node::tick`] |
//! | run it on a CAN peripheral | [`Port`], over `embedded_can::nb::Can` |
//! | switch the valves | [`Solenoids`], over `embedded_hal::digital::OutputPin` |
//! | obey the command at the other end of a bus | [`OutputStage`] |
//! | configure another vehicle or another tuning | [`Builder`] |
//! | simulate the other end of the bus | [`PlantEnd`] |
//!
//! The caller determines the time: one call is one period, and the crate reads no clock. The crate has no heap, needs no std and
//! never panics. It computes in `f32` with the same `libm` on every machine, so that the sequence of valve commands is the
//! same, bit for bit, on a desk computer and in the vehicle.
//!
//! `docs/api-controller.md` lists all public items on one page, with units, ranges and errors. The examples `readings` and
//! `frames` of this crate show how to use it without and with a bus.
#![no_std]
#![forbid(unsafe_code)]

pub mod can;
mod configuration;
mod dwell;
pub mod estimate;
pub mod failsafe;
mod filter;
mod freshness;
pub mod lateral;
mod node;
mod output_stage;
mod plant_end;
pub mod plausibility;
mod port;
mod range;
mod reading;
mod receiver;
mod sensor_message;
mod solenoids;
pub mod spring;
pub mod strategy;
mod switching;
mod tick;
mod timing;
mod valves;
mod vehicle;
mod wheelbase;

pub use configuration::{Builder, Configuration, Tuning};
pub use estimate::Estimate;
pub use failsafe::{FaultCode, Mode};
pub use node::{BusCounters, MAX_SENT, Node};
pub use oleo_interface as interface;
pub use oleo_interface::{
    Absolute, Axle, Axles, Corner, Corners, Gauge, PressurePoint, Side, StrutPressures, StrutValves, Valve,
};
pub use output_stage::OutputStage;
pub use plant_end::PlantEnd;
pub use port::{Port, PortCounters};
pub use range::{ConfigurationError, Hysteresis};
pub use reading::{Inputs, Reading};
pub use sensor_message::{MessageSet, SensorMessage};
pub use solenoids::{SolenoidError, Solenoids};
#[cfg(feature = "comparison")]
pub use strategy::DamperPolicy;
pub use strategy::Strategy;
pub use tick::{Outputs, State, tick};
pub use valves::ValveCommand;
pub use vehicle::VehicleDescription;
