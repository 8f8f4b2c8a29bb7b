//! A factor that follows what has changed lately and relaxes with one time constant: `1 + a (x - mean of x)`. It stands for a hidden state that
//! is driven by the argument, such as a temperature.

use super::form::{ClosedForm, Form, Grid};
use crate::parameter::Parameter;

/// Largest size of the factor's slope.
const STEEPEST: f64 = 3.0;

pub struct Relaxing;

impl Form for Relaxing {
    fn closed(&self) -> Option<ClosedForm> {
        Some(ClosedForm {
            equation: "y = 1 + a x, dx/dt = dv/dt - x / T",
            symbols: &["a", "T"],
        })
    }

    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        vec![
            Parameter::departure("slope", grid.visible, (-STEEPEST, STEEPEST)),
            Parameter::log("time_constant_s", 5.0, (0.05, 1000.0)),
        ]
    }

    fn starts(&self, grid: &Grid) -> Vec<Vec<f64>> {
        [0.5, 5.0, 50.0].map(|t| vec![-10.0 * grid.visible, t]).to_vec()
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        let slope = fitted.first().copied().unwrap_or(0.0);
        grid.knots.iter().map(|x| 1.0 + slope * x).collect()
    }

    fn time_constant_s(&self, fitted: &[f64]) -> Option<f64> {
        fitted.get(1).copied()
    }
}
