//! `sensor_offset`: an instrument whose zero is off, `y = x + b`. It is calibration within `[tolerance]`, never physics.

use crate::model_file::{Quantity, Range};

/// Offset of a column, `b`, in the column's unit.
pub const SIZE: Quantity = Quantity {
    key: "sensor_offset",
    range: Range::FromTo(-1e12, 1e12),
    unit: "of the column's unit",
};
