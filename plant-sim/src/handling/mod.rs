//! The vehicle that steers, slides and may roll over: seed report 3.1, table 1, the DADS model's fourteen unconstrained
//! degrees of freedom, with nonlinear tyres, anti-roll bars, stops and body torsion. Who drives it where is in [`crate::course`].
//!
//! ```text
//!  parameters (two files) --> masses, axles --+
//!  road --> ground (plane) --> wheel <-- magic_formula      dynamics (accelerations) --> model (fixed step)
//!  controls (steer, drive, brake) ------------+                         |
//!  signals --> suspension elements -----------+               motion, wheels, seats
//! ```
//!
//! World axes: x ahead along the track, y to the left, z up. Angles as in the ride model: roll left side up positive,
//! pitch nose down positive; yaw and steer to the left positive.

mod assembly;
mod attitude;
mod axle;
mod axle_place;
mod dynamics;
mod ground;
mod guide;
mod magic_formula;
mod model;
mod motion;
mod parameters;
mod steering;
mod wheel;

pub use axle_place::AxleCoordinates;
pub use magic_formula::{LoadedTyre, MagicFormula, TyreForces};
pub use model::{HandlingModel, HandlingVehicle, VehicleSnapshot};
pub use motion::{Controls, HandlingMotion};
pub use parameters::{Drive, DriverParameters, Frame, Ground, HandlingAxle, HandlingParameters, Outline, Steering};
pub use wheel::WheelState;
