//! A value that is added: zero at rest, fitted as rises of any sign.

use oleo_plant_sim::strut::UnlistedLaw;

use super::form::{Form, Grid};
use super::rises;
use crate::parameter::Parameter;

pub struct Added;

impl Form for Added {
    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        let most = grid.most();
        rises::parameters(grid, |key| Parameter::departure(key, grid.visible, (-most, most)))
    }

    fn near(&self, grid: &Grid, law: &UnlistedLaw) -> Option<Vec<f64>> {
        Some(rises::of(grid, law))
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        rises::values(grid, fitted)
    }
}
