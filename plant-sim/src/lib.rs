//! The plant: struts, vehicles, roads, driver, test rig, ride and handling measures, design studies.
//!
//! ```text
//!   model_file --> strut --> specimen      road --> vehicle, handling --> course --> study
//!                    |                                  ^                            ^
//!                    +--> rig, strut_first              |                 measures --+
//!                    +----------------------------------+
//! ```
//!
//! Start with [`strut`] to use the strut alone; `examples/force_displacement.rs` shows how. Start with [`course`] to drive a vehicle
//! through a manoeuvre with valves of your own; `examples/handling_speed.rs` shows how.

pub mod course;
pub mod handling;
mod lanes;
pub mod measures;
pub mod model_file;
pub mod rig;
pub mod road;
pub mod specimen;
pub mod strut;
pub mod strut_first;
pub mod study;
pub mod variation;
pub mod vehicle;
