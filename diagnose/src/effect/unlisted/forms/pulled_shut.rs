//! A value that multiplies what is believed: `1 / (1 + (a dp)^k)`, a poppet that its flow pulls shut.

use super::form::{ClosedForm, Form, Grid};
use crate::parameter::Parameter;

pub struct PulledShut;

impl Form for PulledShut {
    fn closed(&self) -> Option<ClosedForm> {
        Some(ClosedForm {
            equation: "y = 1 / (1 + (a |x|)^k)",
            symbols: &["a", "k"],
        })
    }

    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        vec![
            Parameter::amount("inverse_pressure_1_Pa", grid.visible, grid.most()),
            Parameter::linear("exponent", 1.0, 0.1, (0.3, 4.0)),
        ]
    }

    fn starts(&self, _grid: &Grid) -> Vec<Vec<f64>> {
        vec![vec![3e-7, 1.0], vec![1e-6, 1.0]]
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        let &[inverse, exponent] = fitted else {
            return vec![1.0; grid.knots.len()];
        };
        (grid.knots.iter())
            .map(|dp| 1.0 / (1.0 + libm::pow(inverse * dp, exponent)))
            .collect()
    }
}
