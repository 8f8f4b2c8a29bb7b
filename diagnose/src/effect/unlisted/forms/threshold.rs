//! A value that is added beyond a threshold of its argument, in proportion to what is beyond it: a valve that lifts, a gap that opens, a seal that gives
//! way.

use super::form::{ClosedForm, Form, Grid};
use crate::parameter::Parameter;

/// Sizes that are tried, over one that would be visible over the distance of the thresholds.
const SIZES: [f64; 2] = [3.0, 30.0];

/// A value that rises with its argument beyond a threshold.
pub struct Threshold {
    /// Key of its rise.
    pub slope: &'static str,
    /// Key of the threshold.
    pub threshold: &'static str,
    /// Whether it may fall instead.
    pub any_sign: bool,
}

/// Largest argument of the table.
fn end(grid: &Grid) -> f64 {
    grid.knots.last().copied().unwrap_or(1.0)
}

/// A rise by what would be visible, over the whole table.
fn visible(grid: &Grid) -> f64 {
    grid.visible / end(grid)
}

impl Form for Threshold {
    fn closed(&self) -> Option<ClosedForm> {
        Some(ClosedForm {
            equation: "y = a max(x - x_0, 0)",
            symbols: &["a", "x_0"],
        })
    }

    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        let end = end(grid);
        let most = grid.most() / end;
        vec![
            if self.any_sign {
                Parameter::departure(self.slope, visible(grid), (-most, most))
            } else {
                Parameter::amount(self.slope, visible(grid), most)
            },
            Parameter::linear(self.threshold, 0.3 * end, 0.02 * end, (0.0, end)),
        ]
    }

    fn starts(&self, grid: &Grid) -> Vec<Vec<f64>> {
        let thresholds = grid.knots.iter().copied().filter(|x| *x >= 0.0 && *x < end(grid));
        thresholds
            .flat_map(|x| SIZES.map(|size| vec![size * visible(grid), x]))
            .collect()
    }

    /// The threshold with a point on either side: the table is linear beyond its points.
    fn argument(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        let threshold = fitted.get(1).copied().unwrap_or(0.0);
        vec![threshold - end(grid), threshold, threshold + end(grid)]
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        let slope = fitted.first().copied().unwrap_or(0.0);
        vec![0.0, 0.0, slope * end(grid)]
    }
}
