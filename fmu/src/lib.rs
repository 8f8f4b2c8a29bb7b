//! Strut, vehicle and controller as functional mock-up units (FMU): FMI 2.0 and 3.0, co-simulation.
//!
//! ```text
//!   oleo fmu strut --out strut.fmu                        a tool opens strut.fmu
//!        |                                                        |
//!   resources (model files) --> definition: one table      boundary: fmi2*, fmi3*    (C, the only unsafe code)
//!                               of variables   |                  |
//!                                  |           +----------> instance: order of the calls, values, time
//!                               description (XML)                 |
//!                                  |                        model: strut, controller, vehicle
//!                               archive (zip)  <-- this library
//! ```
//!
//! | module | what it holds |
//! |---|---|
//! | `complaint` | what is wrong, in one line |
//! | `variable` | a variable as every tool sees it: name, kind, causality, unit, range |
//! | `definition` | the table of all variables of an FMU, and the token that binds a file to a library |
//! | `numbers` | the numbers of a model file as parameters |
//! | `model` | what every simulated model has: begin, step, outputs, save, load |
//! | `strut`, `controller`, `vehicle` | the models |
//! | `raised_road` | a road with a height of its own under each wheel |
//! | `resources` | the files inside an FMU from which its model is made |
//! | `instance` | one running model: which call is permitted when, values, time, states |
//! | `boundary` | the functions that tools call |
//! | `description`, `archive` | the file that tools open (feature `pack`) |
//!
//! The table of variables is written once. The functions find values in it by their reference, and `modelDescription.xml` is printed from it.

#[cfg(feature = "pack")]
mod archive;
mod boundary;
mod complaint;
mod controller;
mod definition;
#[cfg(feature = "pack")]
mod description;
mod instance;
mod model;
mod numbers;
mod raised_road;
mod resources;
mod strut;
mod variable;
mod vehicle;

#[cfg(feature = "pack")]
pub use archive::{Packed, SharedLibrary, pack};
pub use complaint::Complaint;
#[cfg(feature = "pack")]
pub use description::FmiVersion;
pub use resources::Resources;
pub use vehicle::Start;
