//! A value that is nothing up to a threshold in either direction and rises beyond it: `a (x - x_a)^n` above `x_a`, `-b (-x - x_b)^n` below
//! `-x_b`. A stop acts so.

use super::form::{ClosedForm, Form, Grid};
use crate::parameter::Parameter;

/// Travel beyond a threshold for which the values are stated, m.
const BEYOND_M: f64 = 0.01;
/// Thresholds that are tried first, m.
const STARTS_M: [f64; 4] = [0.03, 0.045, 0.06, 0.075];

pub struct Stops;

impl Form for Stops {
    fn closed(&self) -> Option<ClosedForm> {
        Some(ClosedForm {
            equation: "y = a ((x - x_a)/0.01)^n, y = -b ((-x - x_b)/0.01)^n",
            symbols: &["a", "b", "x_a", "x_b", "n"],
        })
    }

    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        let threshold = |key| Parameter::linear(key, STARTS_M[2], 0.004, (0.0, 0.12));
        vec![
            Parameter::amount("jounce_force_10_mm_beyond_N", grid.visible, grid.most()),
            Parameter::amount("rebound_force_10_mm_beyond_N", grid.visible, grid.most()),
            threshold("jounce_threshold_m"),
            threshold("rebound_threshold_m"),
            Parameter::linear("exponent", 1.0, 0.1, (1.0, 4.0)),
        ]
    }

    fn starts(&self, _grid: &Grid) -> Vec<Vec<f64>> {
        (STARTS_M.iter())
            .flat_map(|jounce| STARTS_M.map(|rebound| vec![0.0, 0.0, *jounce, rebound, 1.0]))
            .collect()
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        let &[jounce, rebound, above, below, exponent] = fitted else {
            return vec![0.0; grid.knots.len()];
        };
        let rise = |beyond: f64| match beyond > 0.0 {
            true => libm::pow(beyond / BEYOND_M, exponent),
            false => 0.0,
        };
        (grid.knots.iter())
            .map(|x| jounce * rise(x - above) - rebound * rise(-x - below))
            .collect()
    }
}
