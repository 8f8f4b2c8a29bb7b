//! `sensor_gain`: an instrument whose scale is wrong, `y = (1 + e) x`.

use crate::model_file::{Quantity, Range};
use crate::strut::terms::equation::Equation;

/// Relative error of a column's scale, `e`: 0.02 reads 2 % high. It is counted from zero, not from the value at rest.
pub const SIZE: Quantity = Quantity {
    key: "sensor_gain",
    range: Range::FromTo(-0.99, 1e6),
    unit: "",
};

/// What the instrument shows, `y`, of the truth `x`.
pub const EQUATION: Equation = Equation {
    text: "y = (1 + e) x",
    source: "definition of the recordings",
};

/// What the truth is multiplied by.
pub fn factor(relative_error: f64) -> f64 {
    1.0 + relative_error
}

#[cfg(test)]
mod tests {
    #[test]
    fn two_per_cent_high_is_a_factor_of_one_point_zero_two() {
        assert_eq!(super::factor(0.02), 1.02);
        assert_eq!(super::factor(0.0), 1.0);
    }
}
