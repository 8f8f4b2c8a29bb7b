//! A value that is added over a stretch and runs out linearly at both of its ends: a groove that was milled, or a tube that is worn over a part of the travel.

use super::form::{ClosedForm, Form, Grid};
use crate::parameter::Parameter;

pub struct Groove;

impl Form for Groove {
    fn closed(&self) -> Option<ClosedForm> {
        Some(ClosedForm {
            equation: "y = y_0 min(1, max(0, 1 / 2 + (w - |x - x_0|) / (2 s w)))",
            symbols: &["y_0", "x_0", "w", "s"],
        })
    }

    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        vec![
            Parameter::amount("flow_coefficient", grid.visible, grid.most()),
            Parameter::linear("position_m", 0.0, 0.004, (-0.09, 0.09)),
            Parameter::log("half_width_m", 0.015, (0.002, 0.1)),
            // Beyond one there would be no bottom, and its depth would not show.
            Parameter::linear("run_out_over_width", 0.5, 0.1, (0.02, 1.0)),
        ]
    }

    fn starts(&self, _grid: &Grid) -> Vec<Vec<f64>> {
        [-0.03, -0.015, 0.0, 0.015, 0.03]
            .map(|x| vec![5e-7, x, 0.018, 0.5])
            .to_vec()
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        let &[depth, at, half_width, run_out_over_width] = fitted else {
            return vec![0.0; grid.knots.len()];
        };
        let part =
            |x: &f64| (0.5 + (half_width - (x - at).abs()) / (2.0 * run_out_over_width * half_width)).clamp(0.0, 1.0);
        grid.knots.iter().map(|x| depth * part(x)).collect()
    }
}
