//! A value that multiplies what is believed: one at rest, fitted as logarithmic rises.

use super::form::{Form, Grid};
use super::rises;
use crate::parameter::Parameter;

/// Largest logarithm of the factor from knot to knot.
const MOST: f64 = 3.0;

pub struct Factor;

impl Form for Factor {
    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        rises::parameters(grid, |key| Parameter {
            // A weak prior for no change keeps knots in order where no recording goes.
            prior: true,
            ..Parameter::departure(format!("log_{key}"), grid.visible, (-MOST, MOST))
        })
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        rises::values(grid, fitted).into_iter().map(libm::exp).collect()
    }
}
