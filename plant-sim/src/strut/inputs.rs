//! What a recording says was done to a strut.

use oleo_interface::StrutValves;

use super::motion::Motion;
use super::smoothing::{smooth_displacement, smooth_uneven_displacement};

/// Inputs of a recording: time, actuator motion, switching signals.
#[derive(Debug, Clone, PartialEq)]
pub struct Inputs {
    /// Sample times, s, increasing.
    pub time_s: Vec<f64>,
    /// Motion between the samples.
    pub motion: Motion,
    /// Switching signals at each sample, true for open; an edge acts from its sample on.
    pub signals: Vec<StrutValves<bool>>,
}

impl Inputs {
    /// Inputs from recorded columns of equal length. The displacement (m) is smoothed by the standard deviation of its
    /// noise (m); 0 leaves it nearly as it is.
    #[must_use]
    pub fn from_recording(time_s: &[f64], displacement_m: &[f64], signals: &[StrutValves<bool>], noise_m: f64) -> Self {
        Self {
            time_s: time_s.to_vec(),
            motion: smooth_displacement(displacement_m, mean_interval_s(time_s), noise_m),
            signals: signals.to_vec(),
        }
    }

    /// The same where the samples of the displacement have different noise, `noise_m` (m) one each.
    #[must_use]
    pub fn from_uneven_recording(
        time_s: &[f64],
        displacement_m: &[f64],
        signals: &[StrutValves<bool>],
        noise_m: &[f64],
    ) -> Self {
        Self {
            time_s: time_s.to_vec(),
            motion: smooth_uneven_displacement(displacement_m, mean_interval_s(time_s), noise_m),
            signals: signals.to_vec(),
        }
    }
}

/// Mean distance of the sample times, s; 1 where there is none.
fn mean_interval_s(time_s: &[f64]) -> f64 {
    let intervals = time_s.len().saturating_sub(1).max(1) as f64;
    match (time_s.first(), time_s.last()) {
        (Some(a), Some(b)) if b > a => (b - a) / intervals,
        _ => 1.0,
    }
}
