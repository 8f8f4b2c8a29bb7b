//! A value that multiplies what is believed: one at rest, fitted as logarithmic rises.

use oleo_plant_sim::strut::UnlistedLaw;

use super::form::{Form, Grid};
use super::rises;
use crate::parameter::Parameter;

/// Largest logarithm of the factor from knot to knot.
const MOST: f64 = 3.0;
/// Least factor of another form that is followed.
const LEAST: f64 = 1e-3;

pub struct Factor;

impl Form for Factor {
    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        rises::parameters(grid, |key| Parameter {
            // A weak prior for no change keeps knots in order where no recording goes.
            prior: true,
            ..Parameter::departure(format!("log_{key}"), grid.visible, (-MOST, MOST))
        })
    }

    fn near(&self, grid: &Grid, law: &UnlistedLaw) -> Option<Vec<f64>> {
        let logarithm = |factor: f64| libm::log(factor.max(LEAST));
        let values = rises::at(grid, law);
        Some(values.windows(2).map(|w| logarithm(w[1]) - logarithm(w[0])).collect())
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        rises::values(grid, fitted).into_iter().map(libm::exp).collect()
    }
}
