//! Simulates the inputs of a recording with a model, and returns the predicted readings.

use oleo_interface::StrutValves;

use crate::model_file::InvalidValue;

use super::integrator::StrutOutput;
use super::model::StrutModel;
use super::motion::Motion;
use super::rod_course::RodCourse;
use super::run::{Replayed, Run};
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

/// Predicted columns, one value a sample.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Prediction {
    /// Force of the load cell, N.
    pub force_n: Vec<f64>,
    /// Gauge pressures p1 to p4, Pa.
    pub pressure_pa: [Vec<f64>; 4],
}

impl Prediction {
    pub(super) fn with_capacity(samples: usize) -> Self {
        Self {
            force_n: Vec::with_capacity(samples),
            pressure_pa: std::array::from_fn(|_| Vec::with_capacity(samples)),
        }
    }

    #[inline(always)]
    pub(super) fn push(&mut self, output: StrutOutput) {
        self.force_n.push(output.force_n);
        for (column, pressure) in self.pressure_pa.iter_mut().zip(output.pressure_pa) {
            column.push(pressure);
        }
    }
}

/// Simulate a recording's inputs with a model. O(samples); the same bits every time.
///
/// ```
/// use oleo_interface::StrutValves;
/// use oleo_plant_sim::strut::{Inputs, StrutModel, replay};
/// // 20 mm of jounce within 2 s, at 100 Hz, on the stiff spring with low damping.
/// let time_s: Vec<f64> = (0..=200).map(|k| 0.01 * f64::from(k)).collect();
/// let displacement_m: Vec<f64> = time_s.iter().map(|t| 0.01 * t).collect();
/// let signals = vec![StrutValves::new(true, true, false); 201];
/// let inputs = Inputs::from_recording(&time_s, &displacement_m, &signals, 5.0e-6);
/// let predicted = replay(&StrutModel::defender110(8000.0), &inputs)?;
/// assert_eq!(predicted.force_n.len(), 201);
/// assert!(predicted.force_n[200] > 11_000.0 && predicted.pressure_pa[0][200] > 5.5e6);
/// # Ok::<(), oleo_plant_sim::model_file::InvalidValue>(())
/// ```
///
/// # Errors
/// Impossible values in the model.
pub fn replay(model: &StrutModel, inputs: &Inputs) -> Result<Prediction, InvalidValue> {
    let mut run = Run::begin(model, inputs)?;
    run.go_on_to_the_end();
    Ok(run.into_replayed().prediction)
}

/// The same with what the rod went through, which takes about 200 bytes a sample.
///
/// # Errors
/// Impossible values in the model.
pub fn replay_with_course(model: &StrutModel, inputs: &Inputs) -> Result<(Prediction, RodCourse), InvalidValue> {
    let mut run = Run::begin(model, inputs)?.with_course();
    run.go_on_to_the_end();
    let Replayed { prediction, course } = run.into_replayed();
    Ok((prediction, course.unwrap_or_default()))
}
