//! The response time of a valve depends on the pressure difference across it.
//!
//! `total = c0 + c1 dP + c2 dP^2`, dP in MPa at the edge of the switching signal (report, figure 25). The model's own
//! `[valve_timing]` has the same law; this term replaces its polynomial.

use super::equation::Equation;
use serde::{Deserialize, Serialize};

use crate::model_file::{Checked, InvalidValue, Limit, Range};

/// The valves respond by a polynomial of their own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ValveDelay {
    /// `[c0, c1, c2]` in s, s/MPa and s/MPa2. The total response is usually 0.02 to 0.1 s.
    pub response_polynomial_s: [f64; 3],
}

impl Checked for ValveDelay {
    const LIMITS: &'static [Limit<Self>] = &[Limit::list("response_polynomial_s", COEFFICIENT, "s", |t| {
        &t.response_polynomial_s
    })];

    fn check_together(&self) -> Result<(), InvalidValue> {
        check_constant(&self.response_polynomial_s)
    }
}

/// A coefficient of a response polynomial.
pub(in crate::strut) const COEFFICIENT: Range = Range::FromTo(-10.0, 10.0);

/// Refuse a response polynomial whose response without a pressure difference is negative.
pub(in crate::strut) fn check_constant(polynomial: &[f64]) -> Result<(), InvalidValue> {
    match polynomial.first() {
        Some(constant) if *constant < 0.0 => {
            let what = format!("is {constant}: must be 0 or more, the response without a pressure difference");
            Err(InvalidValue::new(0, what).inside("response_polynomial_s"))
        }
        _ => Ok(()),
    }
}

/// Response time; `dP` is in MPa.
pub const EQUATION: Equation = Equation {
    text: "total = c0 + c1 dP + c2 dP^2",
    source: "Theron & Els, final report 2002, figures 24 and 25",
};

/// Time from the edge of the switching signal to 95 % of the movement, s, for a pressure difference (Pa) at the edge.
/// A polynomial that falls below zero gives no response time below zero.
pub(in crate::strut) fn total_response_s(polynomial: [f64; 3], difference_pa: f64) -> f64 {
    let mega = 1e-6 * difference_pa.abs();
    let [c0, c1, c2] = polynomial;
    (c0 + mega * (c1 + mega * c2)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_the_polynomial_in_megapascals_and_never_negative() {
        let total = |pa: f64| total_response_s([0.04, 0.0022, 0.00006], pa);
        assert!((total(0.0) - 0.04).abs() < 1e-15);
        assert!((total(-16e6) - (0.04 + 16.0 * 0.0022 + 256.0 * 0.00006)).abs() < 1e-15);
        assert_eq!(total_response_s([0.01, -0.01, 0.0], 5e6), 0.0);
    }

    #[test]
    fn a_negative_constant_is_refused() {
        let term = ValveDelay {
            response_polynomial_s: [-0.01, 0.0, 0.0],
        };
        let complaint = term.check().unwrap_err().to_string();
        assert!(
            complaint.starts_with("response_polynomial_s, entry 1, is -0.01"),
            "{complaint}"
        );
    }
}
