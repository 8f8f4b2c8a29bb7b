//! A value that is added and never negative, fitted knot by knot.

use oleo_plant_sim::strut::UnlistedLaw;

use super::form::{Form, Grid};
use super::rises;
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

    fn near(&self, grid: &Grid, law: &UnlistedLaw) -> Option<Vec<f64>> {
        Some(rises::at(grid, law).into_iter().map(|level| level.max(0.0)).collect())
    }

    fn values(&self, _grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        fitted.to_vec()
    }
}
