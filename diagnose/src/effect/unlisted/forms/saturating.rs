//! A value that is added, rises with its argument and comes to an end: `a x / (b + x)`. A volume of gas under pressure does so (Boyle), and so
//! does what yields up to a stop.

use super::form::{ClosedForm, Form, Grid};
use crate::parameter::Parameter;

/// The key of its end value, and that of the argument at which half of it is reached.
pub struct Saturating(pub &'static str, pub &'static str);

/// Arguments at which half of the end value is reached that are tried first, as parts of the largest argument.
const STARTS: [f64; 3] = [0.01, 0.1, 1.0];

fn largest(grid: &Grid) -> f64 {
    grid.knots.last().copied().unwrap_or(1.0)
}

impl Form for Saturating {
    fn closed(&self) -> Option<ClosedForm> {
        Some(ClosedForm {
            equation: "y = a x / (b + x)",
            symbols: &["a", "b"],
        })
    }

    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        let largest = largest(grid);
        vec![
            Parameter::amount(self.0, grid.visible, grid.most()),
            Parameter::log(self.1, STARTS[1] * largest, (1e-3 * largest, 100.0 * largest)),
        ]
    }

    fn starts(&self, grid: &Grid) -> Vec<Vec<f64>> {
        (STARTS.iter())
            .flat_map(|half| [1.0, 30.0, 1000.0].map(|size| vec![size * grid.visible, half * largest(grid)]))
            .collect()
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        let &[end, half] = fitted else {
            return vec![0.0; grid.knots.len()];
        };
        grid.knots.iter().map(|x| end * x / (half + x)).collect()
    }
}
