//! A table of free points over what is remembered of a quantity for one time constant.

use oleo_plant_sim::strut::UnlistedLaw;

use super::form::{Form, Grid};
use crate::parameter::Parameter;

/// Time constants that are possible, s.
const RANGE_S: (f64, f64) = (1e-3, 3000.0);
/// The one beside which a law has none.
const USUAL_S: f64 = 5.0;

/// The table, and then its time constant.
pub struct WithMemory<F>(pub F);

impl<F: Form> Form for WithMemory<F> {
    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        let mut parameters = self.0.parameters(grid);
        parameters.push(Parameter::log("time_constant_s", USUAL_S, RANGE_S));
        parameters
    }

    fn time_constant_s(&self, fitted: &[f64]) -> Option<f64> {
        fitted.last().copied()
    }

    fn near(&self, grid: &Grid, law: &UnlistedLaw) -> Option<Vec<f64>> {
        let mut fitted = self.0.near(grid, law)?;
        fitted.push(law.time_constant_s?);
        Some(fitted)
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        self.0.values(grid, fitted.split_last().map_or(&[], |(_, table)| table))
    }
}
