//! Values that follow what is remembered of a quantity for one time constant: an energy that is held, or a change of a reading.

use super::form::{ClosedForm, Form, Grid};
use crate::parameter::Parameter;

/// Time constants that a heated thing is tried with first, s.
const STARTS_S: [f64; 4] = [0.5, 5.0, 50.0, 500.0];
/// The same of what an instrument still remembers.
const STARTS_OF_INSTRUMENT_S: [f64; 4] = [0.003, 0.03, 0.3, 3.0];
/// Largest part of a recent change that an instrument adds or leaves out, and largest factor on an energy.
const LARGEST_PART: f64 = 10.0;

/// A factor that grows or falls with the energy held: `1 + a x`. A gas that is heated by its compression has a pressure that does so.
pub struct Heated;

/// A factor that falls with the energy held: `1 / (1 + a x)`. Oil that warms is thinner.
pub struct Fading;

/// A value that is added and in proportion to what has changed lately: `a x`. An instrument that lags adds `a = -1`, one that creeps `a < 0` over
/// minutes, one that overshoots `a > 0`.
pub struct Lingering;

fn time_constant_s(fitted: &[f64]) -> Option<f64> {
    fitted.get(1).copied()
}

impl Form for Heated {
    fn closed(&self) -> Option<ClosedForm> {
        Some(ClosedForm {
            equation: "y = 1 + a x, dx/dt = P - x / T",
            symbols: &["a", "T"],
        })
    }

    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        vec![
            Parameter::departure("factor_per_energy", grid.visible, (-LARGEST_PART, LARGEST_PART)),
            Parameter::log("time_constant_s", STARTS_S[1], (0.05, 3000.0)),
        ]
    }

    fn starts(&self, grid: &Grid) -> Vec<Vec<f64>> {
        STARTS_S.map(|t| vec![3.0 * grid.visible, t]).to_vec()
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        let slope = fitted.first().copied().unwrap_or(0.0);
        grid.knots.iter().map(|x| 1.0 + slope * x).collect()
    }

    fn time_constant_s(&self, fitted: &[f64]) -> Option<f64> {
        time_constant_s(fitted)
    }
}

impl Form for Fading {
    fn closed(&self) -> Option<ClosedForm> {
        Some(ClosedForm {
            equation: "y = 1 / (1 + a x), dx/dt = P - x / T",
            symbols: &["a", "T"],
        })
    }

    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        vec![
            Parameter::amount("fade_per_J", grid.visible, grid.most()),
            Parameter::log("time_constant_s", STARTS_S[2], (0.5, 3000.0)),
        ]
    }

    fn starts(&self, grid: &Grid) -> Vec<Vec<f64>> {
        STARTS_S[1..].iter().map(|t| vec![3.0 * grid.visible, *t]).collect()
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        let fade = fitted.first().copied().unwrap_or(0.0);
        grid.knots.iter().map(|x| 1.0 / (1.0 + fade * x)).collect()
    }

    fn time_constant_s(&self, fitted: &[f64]) -> Option<f64> {
        time_constant_s(fitted)
    }
}

impl Form for Lingering {
    fn closed(&self) -> Option<ClosedForm> {
        Some(ClosedForm {
            equation: "y = a x, dx/dt = dr/dt - x / T",
            symbols: &["a", "T"],
        })
    }

    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        vec![
            Parameter::departure("part", grid.visible, (-LARGEST_PART, LARGEST_PART)),
            Parameter::log("time_constant_s", STARTS_OF_INSTRUMENT_S[1], (1e-3, 100.0)),
        ]
    }

    fn starts(&self, grid: &Grid) -> Vec<Vec<f64>> {
        STARTS_OF_INSTRUMENT_S.map(|t| vec![grid.visible, t]).to_vec()
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        let part = fitted.first().copied().unwrap_or(0.0);
        grid.knots.iter().map(|x| part * x).collect()
    }

    fn time_constant_s(&self, fitted: &[f64]) -> Option<f64> {
        time_constant_s(fitted)
    }
}
