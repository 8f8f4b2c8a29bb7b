//! A value that is added and never falls with its argument: the order that a resistance or a compliance needs is a bound.

use oleo_plant_sim::strut::UnlistedLaw;

use super::form::{Form, Grid};
use super::rises;
use crate::parameter::Parameter;

pub struct Rising;

impl Form for Rising {
    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        rises::parameters(grid, |key| Parameter::amount(key, grid.visible, grid.most()))
    }

    fn near(&self, grid: &Grid, law: &UnlistedLaw) -> Option<Vec<f64>> {
        Some(rises::of(grid, law).into_iter().map(|rise| rise.max(0.0)).collect())
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        rises::values(grid, fitted)
    }
}
