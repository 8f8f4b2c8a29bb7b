//! A value that is added around one argument: `c exp(-((x - x0) / w)^2)`, a groove or a step at one position.

use super::form::{ClosedForm, Form, Grid};
use crate::parameter::Parameter;

/// Part of the height below which a flank is zero: a model file does not hold a groove that is 1e-80 deep.
const NOTHING: f64 = 1e-9;

pub struct Bell;

impl Form for Bell {
    fn closed(&self) -> Option<ClosedForm> {
        Some(ClosedForm {
            equation: "y = y_0 exp(-((x - x_0) / w)^2)",
            symbols: &["y_0", "x_0", "w"],
        })
    }

    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        vec![
            Parameter::amount("flow_coefficient", grid.visible, grid.most()),
            Parameter::linear("position_m", 0.0, 0.004, (-0.09, 0.09)),
            Parameter::log("half_width_m", 0.012, (0.002, 0.1)),
        ]
    }

    fn starts(&self, _grid: &Grid) -> Vec<Vec<f64>> {
        [-0.03, 0.0, 0.03].map(|x| vec![3e-7, x, 0.012]).to_vec()
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        let &[height, at, width] = fitted else {
            return vec![0.0; grid.knots.len()];
        };
        let part = |x: &f64| {
            let off = (x - at) / width;
            let part = libm::exp(-off * off);
            if part < NOTHING { 0.0 } else { part }
        };
        grid.knots.iter().map(|x| height * part(x)).collect()
    }
}
