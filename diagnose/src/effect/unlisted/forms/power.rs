//! A value that is added and follows a power of its argument with its sign: `a |x|^n sgn(x)`. A line resists so: laminar flow by the first
//! power, turbulent flow by about the second.

use super::form::{ClosedForm, Form, Grid};
use crate::parameter::Parameter;

/// The key of its value at the largest argument of the table.
pub struct Power(pub &'static str);

/// Exponents that are tried first.
const STARTS: [f64; 2] = [1.0, 2.0];

impl Form for Power {
    fn closed(&self) -> Option<ClosedForm> {
        Some(ClosedForm {
            equation: "y = a |x / x_end|^n sgn(x)",
            symbols: &["a", "n"],
        })
    }

    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        vec![
            Parameter::amount(self.0, grid.visible, grid.most()),
            Parameter::linear("exponent", STARTS[0], 0.1, (0.4, 3.0)),
        ]
    }

    fn starts(&self, grid: &Grid) -> Vec<Vec<f64>> {
        STARTS.map(|exponent| vec![grid.visible, exponent]).to_vec()
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        let &[at_end, exponent] = fitted else {
            return vec![0.0; grid.knots.len()];
        };
        let end = grid.knots.last().copied().unwrap_or(1.0);
        (grid.knots.iter())
            .map(|x| match *x == 0.0 {
                true => 0.0,
                false => (at_end * libm::pow((x / end).abs(), exponent)).copysign(*x),
            })
            .collect()
    }
}
