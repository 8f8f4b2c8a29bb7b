//! Values that settle with one time constant from what is believed: `a (1 - exp(-t / T)) / (1 - exp(-60 s / T))`, added or as the logarithm of a
//! factor. With a time constant far beyond the recording this is a drift at a constant rate, of which the value after a minute says as much as it says of
//! one that has settled by then.

use super::form::{ClosedForm, Form, Grid};
use crate::parameter::Parameter;

/// Time constants that are tried first, s.
const STARTS_S: [f64; 4] = [1.0, 10.0, 100.0, 1000.0];
/// When the value has the fitted size, s.
pub(super) const SIZED_AT_S: f64 = 60.0;
/// Largest logarithm of a factor after this time.
const MOST_LOG: f64 = 3.0;

/// A value that is added; the key of its value after a minute.
pub struct SettlingAdded(pub &'static str);

/// A value that is added and never negative; the key of its value after a minute.
pub struct SettlingLevel(pub &'static str);

/// A value that multiplies what is believed.
pub struct SettlingFactor;

fn time_constant() -> Parameter {
    Parameter::log("time_constant_s", 10.0, (0.1, 3000.0))
}

fn settled(grid: &Grid, fitted: &[f64]) -> Vec<f64> {
    let &[after_a_minute, time_constant_s] = fitted else {
        return vec![0.0; grid.knots.len()];
    };
    let risen = |t: f64| -libm::expm1(-t / time_constant_s);
    (grid.knots.iter())
        .map(|t| after_a_minute * risen(*t) / risen(SIZED_AT_S))
        .collect()
}

fn starts(grid: &Grid) -> Vec<Vec<f64>> {
    STARTS_S.map(|t| vec![3.0 * grid.visible, t]).to_vec()
}

impl Form for SettlingAdded {
    fn closed(&self) -> Option<ClosedForm> {
        Some(ClosedForm {
            equation: "y = y_60 (1 - exp(-x / T)) / (1 - exp(-60 / T))",
            symbols: &["y_60", "T"],
        })
    }

    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        let most = grid.most();
        vec![
            Parameter::departure(self.0, grid.visible, (-most, most)),
            time_constant(),
        ]
    }

    fn starts(&self, grid: &Grid) -> Vec<Vec<f64>> {
        starts(grid)
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        settled(grid, fitted)
    }
}

impl Form for SettlingLevel {
    fn closed(&self) -> Option<ClosedForm> {
        Some(ClosedForm {
            equation: "y = y_60 (1 - exp(-x / T)) / (1 - exp(-60 / T))",
            symbols: &["y_60", "T"],
        })
    }

    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        vec![Parameter::amount(self.0, grid.visible, grid.most()), time_constant()]
    }

    fn starts(&self, grid: &Grid) -> Vec<Vec<f64>> {
        starts(grid)
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        settled(grid, fitted)
    }
}

impl Form for SettlingFactor {
    fn closed(&self) -> Option<ClosedForm> {
        Some(ClosedForm {
            equation: "y = exp(a (1 - exp(-x / T)) / (1 - exp(-60 / T)))",
            symbols: &["a", "T"],
        })
    }

    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        vec![
            Parameter::departure("log_factor_after_a_minute", grid.visible, (-MOST_LOG, MOST_LOG)),
            time_constant(),
        ]
    }

    fn starts(&self, grid: &Grid) -> Vec<Vec<f64>> {
        starts(grid)
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        settled(grid, fitted).into_iter().map(libm::exp).collect()
    }
}
