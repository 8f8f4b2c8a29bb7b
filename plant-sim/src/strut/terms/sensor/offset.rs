//! `sensor_offset`: an instrument whose zero is off, `y = x + b`. It is calibration within `[tolerance]`, never physics.

use crate::model_file::{Quantity, Range};
use crate::strut::terms::equation::Equation;

/// Offset of a column, `b`, in the column's unit.
pub const SIZE: Quantity = Quantity {
    key: "sensor_offset",
    range: Range::FromTo(-1e12, 1e12),
    unit: "of the column's unit",
};

/// What the instrument shows, `y`, of the truth `x`.
pub const EQUATION: Equation = Equation {
    text: "y = x + b",
    source: "definition of the recordings",
};
