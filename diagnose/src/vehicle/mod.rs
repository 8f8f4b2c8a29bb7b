//! A vehicle: the four struts of its corners, diagnosed from what its bus carried while it drove.
//!
//! ```text
//!   model.toml + four strut files --> VehicleModel ---+
//!                                                     +--> VehicleCampaign: a strut with recordings at every corner
//!   drives (from whatever log) --> usable stretches --+                |
//!                                                       the search for each corner on its own
//!                                                                      |
//!                         effects with their corner, and what is common to all four --> report.json, page, model files
//! ```
//!
//! A corner is a strut as on a test rig, with three differences: no force is recorded, readings are rounded to the steps of the
//! bus, and some are missing. What is common to all four is decided afterwards, from the four estimates and their intervals; what some corners show
//! of the oil, the gas or the design is tried at the others.
//!
//! This module knows nothing of CAN: a [`Drive`] may come from any log.
//!
//! | file | what it holds |
//! |---|---|
//! | `model` | the model files of a vehicle |
//! | `drive` | what a drive recorded |
//! | `body` | the balance of the body, where drives have an inertial unit |
//! | `bridge` | missing readings: what stays missing, and what no longer counts |
//! | `stretch` | the parts of the drives that are used, and why |
//! | `command_timing` | when a logged command acts on the valves |
//! | `oil_count` | whether the struts keep their oil |
//! | `share` | which of two simulations a recording follows, for both |
//! | `campaign` | model and drives put together |
//! | `sharing` | effects that some corners show, tried at the others |
//! | `common` | effects that all four corners have with one value |
//! | `pooling` | the common value of several estimates |
//! | `diagnosis` | the diagnosis of the vehicle |
//! | `driven` | what the driver feels of what was found |
//! | `report` | `report.json` |
//! | `page` | `report.html` |

mod body;
mod bridge;
mod campaign;
mod command_timing;
mod common;
mod diagnosis;
mod drive;
mod driven;
mod model;
mod oil_count;
mod page;
mod pooling;
mod report;
mod share;
mod sharing;
mod stretch;

pub use campaign::VehicleCampaign;
pub use diagnosis::{VehicleDiagnosis, VehicleEffect};
pub use drive::{Drive, InertialSamples, Resolution, StrutSamples};
pub use driven::{DRIVES, Driven, Felt, driven_in_words};
pub use model::{BodyModel, VEHICLE, VehicleModel, is_vehicle};
pub use page::{effects_table, headline, page};
pub use report::report;
