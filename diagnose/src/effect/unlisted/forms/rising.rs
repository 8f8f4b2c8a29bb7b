//! A value that is added and never falls with its argument: the order that a resistance or a compliance needs is a bound.

use super::form::{Form, Grid};
use super::rises;
use crate::parameter::Parameter;

pub struct Rising;

impl Form for Rising {
    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        rises::parameters(grid, |key| Parameter::amount(key, grid.visible, grid.most()))
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        rises::values(grid, fitted)
    }
}
