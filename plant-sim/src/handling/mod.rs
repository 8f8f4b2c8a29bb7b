//! The vehicle that steers, slides and may roll over: seed report 3.1, table 1, the DADS model's fourteen unconstrained
//! degrees of freedom, with nonlinear tyres, anti-roll bars, stops, body torsion and the report's preview driver.
//!
//! ```text
//!  parameters (two files) --> masses, axles --+
//!  road --> ground (plane) --> wheel <-- magic_formula      dynamics (accelerations) --> model (fixed step)
//!  track --> driver --> steer, drive ---------+                         |
//!  signals --> suspension elements -----------+        manoeuvre (runs, outcome, history) --> drive command, study
//! ```
//!
//! World axes: x ahead along the track, y to the left, z up. Angles as in the ride model: roll left side up positive,
//! pitch nose down positive; yaw and steer to the left positive.

mod assembly;
mod attitude;
mod axle;
mod driver;
mod dynamics;
mod ground;
mod guide;
mod magic_formula;
mod manoeuvre;
mod model;
mod motion;
mod parameters;
mod steering;
mod track;
mod wheel;

pub use axle::AxleCoordinates;
pub use driver::Driver;
pub use magic_formula::{LoadedTyre, MagicFormula, TyreForces};
pub use manoeuvre::{Ending, History, Manoeuvre, NotFinite, Run, Sample, Signals};
pub use model::{HandlingModel, HandlingVehicle};
pub use motion::{Controls, HandlingMotion};
pub use parameters::{Drive, DriverParameters, Frame, Ground, HandlingAxle, HandlingParameters, Outline, Steering};
pub use track::{Gate, Track};
pub use wheel::WheelState;
