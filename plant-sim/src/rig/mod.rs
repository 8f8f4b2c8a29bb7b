//! The test rig of the report's section 3.5, with the simulated strut in it: what was measured there is measured here by the
//! same definitions, and compared with a closed form where there is one.
//!
//! | measurement | file | figures of the report |
//! |---|---|---|
//! | load cell against pressure, isothermal spring characteristics | `spring` | 18, 19, 20, 22 |
//! | oil-only compression | `bulk_modulus` | 21 |
//! | damping characteristics | `damping` | 23 |
//! | valve response times | `valve_response` | 24, 25 |
//! | illustrative run and comparison of the generations | `generations` | 31 to 34 |
//! | design specifications i to vii of section 3.3 | `limits` | - |
//!
//! `programme` is the actuator: what displacement and switching signals it plays. `isothermal` is the prediction that spring
//! measurements are held against. `recording` reads recordings, and `column_map` makes them of other programs' files.

mod bulk_modulus;
mod column_map;
mod damping;
mod generations;
mod isothermal;
mod limits;
mod parabola;
mod plausible;
mod programme;
mod recording;
mod spring;
mod units;
mod valve_response;

pub use bulk_modulus::{OilCompression, compress_oil};
pub use column_map::{ColumnMap, ColumnMapError, Source};
pub use damping::{DampingPoint, DampingState, measure_damping};
pub use generations::{FirstGenerationRun, demonstration, run_first_generation, spring_comparison};
pub use isothermal::{Isothermal, Oil};
pub use limits::{Limit, check_limits};
pub use parabola::Parabola;
pub use plausible::implausible;
pub use programme::{Programme, Record, play};
pub use recording::{Columns, RecordedStrut, RecordingError, other_separator, wrong_separator};
pub use spring::{SpringCharacteristic, SpringTest, side_loaded, test_spring};
pub use units::{other_units, unit_size};
pub use valve_response::{ValveResponse, measure_valve_response, measure_valve_responses};
