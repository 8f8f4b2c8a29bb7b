//! A value that is added around one argument: `c exp(-((x - x0) / w)^2)`, a groove or a step at one position.

use super::form::{Form, Grid};
use crate::parameter::Parameter;

pub struct Bell;

impl Form for Bell {
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
        let off = |x: &f64| (x - at) / width;
        (grid.knots.iter())
            .map(|x| height * libm::exp(-off(x) * off(x)))
            .collect()
    }
}
