//! Settings of one suspension compared on the same drives, without a bus between.
//!
//! ```text
//!   Drive case (road, speed, manoeuvre, seed) --+
//!   Setting (as sold, fixed valves, controlled) +--> drive --> Figures
//!   Bench (vehicle, handling)  -----------------+
//! ```
//!
//! The controller gets what its sensors would say: true values with the sensors' noise, in the steps of the CAN signals.

mod bench;
mod case;
mod drive;
mod figures;
pub mod sensors;
mod setting;

pub use bench::{Bench, describe};
pub use case::DriveCase;
pub use drive::{ComparisonError, beginning_s, drive};
pub use figures::Figures;
pub use sensors::Sensors;
pub use setting::Setting;
