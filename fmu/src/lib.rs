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
//! | `ls_bus` | a CAN network as bytes: bus operations, the peripheral of a node, the terminal (FMI-LS-BUS) |
//! | `definition` | the table of all variables of an FMU, and the token that binds a file to a library |
//! | `numbers` | the numbers of a model file as parameters |
//! | `model` | what every simulated model has: begin, step, outputs, save, load |
//! | `decision`, `controller_parameters` | what a controller has decided, and what it is told before it starts |
//! | `strut`, `controller`, `can_controller`, `vehicle` | the models |
//! | `raised_road` | a road with a height of its own under each wheel |
//! | `resources` | the files inside an FMU from which its model is made |
//! | `exchange` | bus operations and clocks between a node on a network and a tool |
//! | `phase`, `asked`, `saved_state` | where an instance is in its life, the types of values, the state as bytes |
//! | `instance` | one running model: which call is permitted when, values, time, states |
//! | `boundary` | the functions that tools call |
//! | `description`, `archive` | the file that tools open (feature `pack`) |
//!
//! The table of variables is written once. The functions find values in it by their reference, and `modelDescription.xml` is printed from it.

#[cfg(feature = "pack")]
mod archive;
mod asked;
mod boundary;
mod can_controller;
mod complaint;
mod controller;
mod controller_parameters;
mod decision;
mod definition;
#[cfg(feature = "pack")]
mod description;
mod exchange;
mod instance;
pub mod ls_bus;
mod model;
mod numbers;
mod phase;
mod raised_road;
mod resources;
mod saved_state;
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
