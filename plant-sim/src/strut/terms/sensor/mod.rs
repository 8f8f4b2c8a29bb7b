//! Faults of the instruments: one file for each, with its size, what it makes of a true signal, and how it is undone.
//!
//! | file | fault | what the instrument shows of `x` |
//! |---|---|---|
//! | `lag` | `sensor_lag` | `tau dy/dt + y = x` |
//! | `skew` | `sensor_skew` | `y(t) = x(t - s)` |
//! | `gain` | `sensor_gain` | `y = (1 + e) x` |
//! | `sign` | `sensor_sign` | `y = -x` |
//! | `drift` | `sensor_drift` | `y = x + r t` |
//! | `offset` | `sensor_offset` | `y = x + b` |
//!
//! `columns` holds the columns that may be faulty. The faults of one column are put together in `strut::instruments`.

mod columns;
pub mod drift;
pub mod gain;
mod interpolate;
pub mod lag;
pub mod offset;
pub mod sign;
pub mod skew;

pub use columns::{COLUMNS, SensorEffect, check_columns};

pub(super) use columns::check_sizes;
