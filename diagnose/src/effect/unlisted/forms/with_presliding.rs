//! A table of free points of the friction of a floating piston, which is reached once a volume of oil has sheared its seal.

use oleo_plant_sim::strut::UnlistedLaw;

use super::form::{Form, Grid};
use super::level::Level;
use super::shearing::{RANGE_M3, STARTS_M3};
use crate::parameter::Parameter;

/// The levels, and then the volume.
pub struct WithPresliding;

impl Form for WithPresliding {
    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        let mut parameters = Level.parameters(grid);
        parameters.push(Parameter::log("presliding_volume_m3", STARTS_M3[0], RANGE_M3));
        parameters
    }

    fn presliding_volume_m3(&self, fitted: &[f64]) -> Option<f64> {
        fitted.last().copied()
    }

    fn near(&self, grid: &Grid, law: &UnlistedLaw) -> Option<Vec<f64>> {
        let mut fitted = Level.near(grid, law)?;
        fitted.push(law.presliding_volume_m3?);
        Some(fitted)
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        Level.values(grid, fitted.split_last().map_or(&[], |(_, table)| table))
    }
}
