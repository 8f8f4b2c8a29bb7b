//! `sensor_sign`: an instrument that is connected the wrong way round, `y = -x`.

use crate::model_file::{Quantity, Range};

/// Sign of a column: -1 for the wrong one, 1 for the right one.
pub const SIZE: Quantity = Quantity {
    key: "sensor_sign",
    range: Range::OneOf(&[-1.0, 1.0]),
    unit: "",
};
