//! `sensor_sign`: an instrument that is connected the wrong way round, `y = -x`.

use crate::model_file::{Quantity, Range};
use crate::strut::terms::equation::Equation;

/// Sign of a column: -1 for the wrong one, 1 for the right one.
pub const SIZE: Quantity = Quantity {
    key: "sensor_sign",
    range: Range::OneOf(&[-1.0, 1.0]),
    unit: "",
};

/// What the instrument shows, `y`, of the truth `x`.
pub const EQUATION: Equation = Equation {
    text: "y = -x",
    source: "definition of the recordings",
};
