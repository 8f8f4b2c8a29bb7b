//! A value that multiplies what is believed: `(1 + (a dp)^k)^(-1 / (2 k))`. With it the flow of an orifice, which grows with the root of the drop, approaches
//! a largest one, as it does where the orifice cavitates. The sharper the bend, the larger is *k*.

use super::form::{ClosedForm, Form, Grid};
use crate::parameter::Parameter;

pub struct Choke;

impl Form for Choke {
    fn closed(&self) -> Option<ClosedForm> {
        Some(ClosedForm {
            equation: "y = (1 + (a |x|)^k)^(-1 / (2 k))",
            symbols: &["a", "k"],
        })
    }

    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        vec![
            Parameter::amount("inverse_pressure_1_Pa", grid.visible, grid.most()),
            Parameter::log("sharpness", 1.0, (0.4, 10.0)),
        ]
    }

    fn starts(&self, _grid: &Grid) -> Vec<Vec<f64>> {
        vec![vec![3e-7, 1.0], vec![3e-6, 1.0]]
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        let &[inverse, sharpness] = fitted else {
            return vec![1.0; grid.knots.len()];
        };
        (grid.knots.iter())
            .map(|dp| libm::pow(1.0 + libm::pow(inverse * dp.abs(), sharpness), -0.5 / sharpness))
            .collect()
    }
}
