//! A value that is added, grows from the start at a constant rate and stays from a time on: a crack that opens and then is as long as it can be.

use super::form::{ClosedForm, Form, Grid};
use super::settling::SIZED_AT_S;
use crate::parameter::Parameter;

/// Durations of the growth that are tried first, s.
const STARTS_S: [f64; 3] = [3.0, 15.0, 50.0];

/// The key of its value after a minute.
pub struct Ramp(pub &'static str);

impl Form for Ramp {
    fn closed(&self) -> Option<ClosedForm> {
        Some(ClosedForm {
            equation: "y = y_60 min(x, T) / min(60, T)",
            symbols: &["y_60", "T"],
        })
    }

    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        vec![
            Parameter::amount(self.0, grid.visible, grid.most()),
            Parameter::log("grows_for_s", STARTS_S[1], (0.1, 3000.0)),
        ]
    }

    fn starts(&self, grid: &Grid) -> Vec<Vec<f64>> {
        STARTS_S.map(|t| vec![3.0 * grid.visible, t]).to_vec()
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        let &[after_a_minute, grows_for_s] = fitted else {
            return vec![0.0; grid.knots.len()];
        };
        let grown = |t: f64| t.min(grows_for_s);
        (grid.knots.iter())
            .map(|t| after_a_minute * grown(*t) / grown(SIZED_AT_S))
            .collect()
    }
}
