//! A value that is added and is proportional to its argument: one number, of any sign or never negative.

use super::form::{ClosedForm, Form, Grid};
use crate::parameter::Parameter;

/// The key of its number. `visible` and this number are the value at an argument of one.
pub struct Proportional(pub &'static str);

impl Form for Proportional {
    fn closed(&self) -> Option<ClosedForm> {
        Some(ClosedForm {
            equation: "y = a x",
            symbols: &["a"],
        })
    }

    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        let most = grid.most();
        vec![Parameter::departure(self.0, grid.visible, (-most, most))]
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        line(grid, fitted)
    }
}

/// The same, never negative.
pub struct ProportionalAmount(pub &'static str);

impl Form for ProportionalAmount {
    fn closed(&self) -> Option<ClosedForm> {
        Some(ClosedForm {
            equation: "y = a x",
            symbols: &["a"],
        })
    }

    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        vec![Parameter::amount(self.0, grid.visible, grid.most())]
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        line(grid, fitted)
    }
}

fn line(grid: &Grid, fitted: &[f64]) -> Vec<f64> {
    let slope = fitted.first().copied().unwrap_or(0.0);
    grid.knots.iter().map(|x| slope * x).collect()
}
