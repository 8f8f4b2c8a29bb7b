//! Settings of one suspension compared on the same drives, without a bus between.
//!
//! ```text
//!   Plan: groups of drive cases (road, speed, manoeuvre, seed) --+          +--> Figures --> Means --> Scores
//!   Setting (as sold, fixed valves, oracle, controlled) ---------+--> drive +
//!   Bench (vehicle, handling, struts, sensors) ------------------+          +--> History
//! ```
//!
//! The controller gets what its sensors would say: true values with the sensors' errors, in the steps of the CAN signals.

mod bench;
mod case;
mod compare;
mod drive;
mod figures;
mod history;
mod plan;
mod robust;
mod scores;
mod sensors;
mod setting;
mod witness;

pub use bench::Bench;
pub use case::DriveCase;
pub use compare::{CompareError, Job, Results, by_group, compare, jobs, settings, with_beginnings};
pub use drive::{ComparisonError, beginning_s, drive, estimates};
pub use figures::{Figures, SCORED_FROM_S};
pub use history::{History, history};
pub use plan::{Extent, Group, groups};
pub use robust::{DRIVES, VariedResult, robust};
pub use scores::{Goal, Means, Row, Scores, VALVE_LIFE_CHANGES, mean_ratio, scores};
pub use sensors::Sensors;
pub use setting::Setting;
