//! `sensor_drift`: an instrument whose zero moves evenly, `y = x + r t`.

use crate::model_file::{Quantity, Range};
use crate::strut::terms::equation::Equation;

/// Drift of a column, `r`, in the column's unit per second.
pub const SIZE: Quantity = Quantity {
    key: "sensor_drift",
    range: Range::FromTo(-1e12, 1e12),
    unit: "of the column's unit per second",
};

/// What the instrument shows, `y`, of the truth `x`.
pub const EQUATION: Equation = Equation {
    text: "y = x + r t",
    source: "definition of the recordings",
};

/// What the instrument shows too much after a time (s) from the first sample, in the column's unit.
pub fn shift(rate_per_s: f64, since_begin_s: f64) -> f64 {
    rate_per_s * since_begin_s
}

#[cfg(test)]
mod tests {
    #[test]
    fn grows_with_time() {
        assert_eq!(super::shift(2.0, 0.0), 0.0);
        assert_eq!(super::shift(2.0, 1.5), 3.0);
    }
}
