//! A force that is added and stiffens with the displacement: `k x + c x^3`, as an air spring or a rubber boot does (Duffing 1918). Either number may be negative.

use super::form::{ClosedForm, Form, Grid};
use crate::parameter::Parameter;

pub struct Stiffening;

/// The displacement over the largest at which each part has the visible force.
const SEEN_AT: f64 = 0.5;

impl Form for Stiffening {
    fn closed(&self) -> Option<ClosedForm> {
        Some(ClosedForm {
            equation: "y = k x + c x^3",
            symbols: &["k", "c"],
        })
    }

    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        let seen_at = SEEN_AT * grid.knots.last().copied().unwrap_or(1.0);
        let departure = |key: &str, displacement: f64| {
            let most = grid.most() / displacement;
            Parameter::departure(key, grid.visible / displacement, (-most, most))
        };
        vec![
            departure("stiffness_N_m", seen_at),
            departure("stiffening_N_m3", seen_at * seen_at * seen_at),
        ]
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        let &[stiffness, stiffening] = fitted else {
            return vec![0.0; grid.knots.len()];
        };
        (grid.knots.iter())
            .map(|x| x * (stiffness + stiffening * x * x))
            .collect()
    }
}
