//! One recording, read from CSV or from columns in memory, and made safe to simulate.
//!
//! Everything that could silently spoil a diagnosis is caught here: a column in another unit, time that stands still,
//! a value that is not a number. What can be used soundly is used and said in a note: a recording with a hole is cut at
//! the hole, because nobody knows the state after it; one with more samples than needed is thinned while it is read, so
//! that memory stays bounded whatever its length.

mod columns;
mod reader;
mod rows;
mod series;
mod table;
mod thinning;

pub use columns::{ColumnKind, ColumnSpec, GapPolicy};
pub use reader::{parse, read, read_by};
pub use rows::MIN_SAMPLES;
pub use series::Recording;
pub use table::{NamedColumn, of_table};
pub use thinning::MAX_SAMPLES;
