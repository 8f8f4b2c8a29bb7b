//! A value that is added and never negative, fitted knot by knot.

use super::form::{Form, Grid};
use crate::parameter::Parameter;

pub struct Level;

impl Form for Level {
    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        (grid.knots.iter())
            .map(|x| Parameter::amount(format!("at_{x:.3e}"), grid.visible, grid.most()))
            .collect()
    }

    fn starts(&self, grid: &Grid) -> Vec<Vec<f64>> {
        grid.larger().map(|level| vec![level; grid.knots.len()]).to_vec()
    }

    fn values(&self, _grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        fitted.to_vec()
    }
}
