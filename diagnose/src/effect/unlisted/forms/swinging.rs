//! Values that swing at one frequency about what is believed: `a sin(2 pi f t + phi)`, added or as a part of it. The time counts from the
//! start of each recording.

use std::f64::consts::{PI, TAU};

use oleo_report::significant;

use super::form::{ClosedForm, Form, Grid};
use crate::parameter::Parameter;

/// Key of the phase at the start of a recording.
const PHASE: &str = "phase_rad";
/// Key of the frequency.
const FREQUENCY: &str = "frequency_Hz";
/// Key of the amplitude of a factor, a part of what is believed.
const PART: &str = "amplitude";
/// Frequencies that a law may have, Hz.
const FREQUENCIES_HZ: (f64, f64) = (1e-3, 100.0);
/// A phase that would be visible, rad.
const VISIBLE_PHASE: f64 = 0.3;
/// A change of the frequency that would be visible, in turns over the longest recording.
const VISIBLE_TURNS: f64 = 0.3;
/// Largest amplitude of a factor: what is believed does not change its sign.
const LARGEST_PART: f64 = 0.95;

/// Digits of a number in an equation; its interval is given beside it.
const DIGITS: usize = 4;

/// A value that is added.
pub struct SwingingAdded {
    /// Key of its amplitude.
    pub key: &'static str,
    /// Unit of its amplitude.
    pub unit: &'static str,
}

/// A value that multiplies what is believed.
pub struct SwingingFactor;

/// The numbers in the order in which the search expects them of an oscillation ([`crate::effect::Candidate::oscillates`]).
fn parameters(amplitude: Parameter, grid: &Grid) -> Vec<Parameter> {
    vec![
        amplitude,
        // Wider than one turn: a fit that begins near an end goes on beyond it.
        Parameter::linear(PHASE, 0.0, VISIBLE_PHASE, (-1.5 * TAU, 1.5 * TAU)),
        Parameter::linear(FREQUENCY, 1.0, VISIBLE_TURNS / grid.longest_s, FREQUENCIES_HZ),
    ]
}

fn swing(grid: &Grid, fitted: &[f64]) -> Vec<f64> {
    let &[amplitude, phase, _] = fitted else {
        return vec![0.0; grid.knots.len()];
    };
    let at_points = amplitude / swing_of_chords(grid.knots.len() - 1);
    (grid.knots.iter())
        .map(|turns| at_points * libm::sin(TAU * turns + phase))
        .collect()
}

/// Amplitude at which straight lines between points of a sine swing, over that of the sine: the square of `sin(x) / x` with half a part of a turn as `x`.
fn swing_of_chords(parts: usize) -> f64 {
    let half_part = PI / parts as f64;
    let ratio = libm::sin(half_part) / half_part;
    ratio * ratio
}

/// `sin(2 pi f t + phi)` with its numbers.
fn sine(phase: f64, frequency_hz: f64) -> String {
    let sign = if phase < 0.0 { '-' } else { '+' };
    let (phase, frequency) = (significant(phase.abs(), DIGITS), significant(frequency_hz, DIGITS));
    format!("sin(2 pi {frequency} Hz t {sign} {phase})")
}

impl Form for SwingingAdded {
    fn closed(&self) -> Option<ClosedForm> {
        Some(ClosedForm {
            equation: "y = a sin(2 pi f t + phi)",
            symbols: &["a", "phi", "f"],
        })
    }

    fn equation(&self, quantity: &str, fitted: &[f64]) -> Option<String> {
        let &[amplitude, phase, frequency_hz] = fitted else {
            return None;
        };
        let amplitude = significant(amplitude, DIGITS);
        Some(format!(
            "{quantity} = believed + {amplitude} {} {}",
            self.unit,
            sine(phase, frequency_hz)
        ))
    }

    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        parameters(Parameter::amount(self.key, grid.visible, grid.most()), grid)
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        swing(grid, fitted)
    }

    fn frequency_hz(&self, fitted: &[f64]) -> Option<f64> {
        fitted.get(2).copied()
    }
}

impl Form for SwingingFactor {
    fn closed(&self) -> Option<ClosedForm> {
        Some(ClosedForm {
            equation: "y = 1 + a sin(2 pi f t + phi)",
            symbols: &["a", "phi", "f"],
        })
    }

    fn equation(&self, quantity: &str, fitted: &[f64]) -> Option<String> {
        let &[amplitude, phase, frequency_hz] = fitted else {
            return None;
        };
        let amplitude = significant(amplitude, DIGITS);
        Some(format!(
            "{quantity} = believed x (1 + {amplitude} {})",
            sine(phase, frequency_hz)
        ))
    }

    fn parameters(&self, grid: &Grid) -> Vec<Parameter> {
        parameters(Parameter::amount(PART, grid.visible, LARGEST_PART), grid)
    }

    fn values(&self, grid: &Grid, fitted: &[f64]) -> Vec<f64> {
        swing(grid, fitted).into_iter().map(|part| 1.0 + part).collect()
    }

    fn frequency_hz(&self, fitted: &[f64]) -> Option<f64> {
        fitted.get(2).copied()
    }
}
