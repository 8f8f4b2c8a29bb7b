//! A value that is added, a polynomial of second degree over its argument, which is never negative: `a + b x + c x^2`. The value may be of any
//! sign, or it may not be negative either.

use super::form::{ClosedForm, Form, Grid};
use crate::parameter::Parameter;

/// The keys of its three numbers.
pub struct Parabola(pub [&'static str; 3]);

/// A value that is never negative; the keys of its three numbers.
pub struct LevelParabola(pub [&'static str; 3]);

impl Form for LevelParabola {
    fn closed(&self) -> Option<ClosedForm> {
        Parabola(self.0).closed()
    }

    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        Parabola(self.0).parameters(grid)
    }

    fn starts(&self, grid: &Grid) -> Vec<Vec<f64>> {
        grid.larger().map(|level| vec![level, 0.0, 0.0]).to_vec()
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        (Parabola(self.0).values(grid, fitted).into_iter())
            .map(|value| value.max(0.0))
            .collect()
    }
}

impl Form for Parabola {
    fn closed(&self) -> Option<ClosedForm> {
        Some(ClosedForm {
            equation: "y = a + b x + c x^2",
            symbols: &["a", "b", "c"],
        })
    }

    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        let largest = grid.knots.last().copied().unwrap_or(1.0);
        let mut power = 1.0;
        self.0
            .map(|key| {
                // A number is visible if what it adds at the largest argument is.
                let (visible, most) = (grid.visible / power, grid.most() / power);
                power *= largest;
                Parameter::departure(key, visible, (-most, most))
            })
            .to_vec()
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        let &[a, b, c] = fitted else {
            return vec![0.0; grid.knots.len()];
        };
        grid.knots.iter().map(|x| a + x * (b + x * c)).collect()
    }
}
