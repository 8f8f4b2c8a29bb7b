//! A factor that follows what has changed lately and relaxes with one time constant: `(1 + x)^a`, where `x` is the argument less its mean. It
//! stands for a hidden state that is driven by the argument, such as a temperature.
//!
//! A gas that exchanges heat with a wall is the reason for the power. What changes fast is an adiabatic change of state, over which the pressure
//! changes by a power of the volume ratio; a straight line would be right for small changes only.

use super::form::{ClosedForm, Form, Grid};
use crate::parameter::Parameter;

/// Largest size of the exponent.
const STEEPEST: f64 = 3.0;
/// Least value of `1 + x`: a gas is not compressed to nothing.
const LEAST_RATIO: f64 = 0.05;

pub struct Relaxing;

impl Form for Relaxing {
    fn closed(&self) -> Option<ClosedForm> {
        Some(ClosedForm {
            equation: "y = (1 + x)^a, dx/dt = dv/dt - x / T",
            symbols: &["a", "T"],
        })
    }

    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        vec![
            Parameter::departure("exponent", grid.visible, (-STEEPEST, STEEPEST)),
            Parameter::log("time_constant_s", 5.0, (0.05, 1000.0)),
        ]
    }

    fn starts(&self, grid: &Grid) -> Vec<Vec<f64>> {
        [0.5, 5.0, 50.0].map(|t| vec![-10.0 * grid.visible, t]).to_vec()
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        let exponent = fitted.first().copied().unwrap_or(0.0);
        grid.knots
            .iter()
            .map(|x| libm::pow((1.0 + x).max(LEAST_RATIO), exponent))
            .collect()
    }

    fn time_constant_s(&self, fitted: &[f64]) -> Option<f64> {
        fitted.get(1).copied()
    }
}
