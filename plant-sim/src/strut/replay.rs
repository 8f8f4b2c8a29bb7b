//! Simulates the inputs of a recording with a model, and returns the predicted readings.

use crate::model_file::InvalidValue;

use super::beginning::Beginning;
use super::inputs::Inputs;
use super::model::StrutModel;
use super::prediction::Prediction;
use super::rod_course::RodCourse;
use super::run::{Replayed, Run};

/// Simulate a recording's inputs with a model, from rest. O(samples); the same bits every time.
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
    replay_from(model, inputs, &Beginning::AtRest)
}

/// The same for a recording that may begin in the middle of a drive.
///
/// # Errors
/// Impossible values in the model.
pub fn replay_from(model: &StrutModel, inputs: &Inputs, begins: &Beginning) -> Result<Prediction, InvalidValue> {
    let mut run = Run::begin(model, inputs, begins)?;
    run.go_on_to_the_end();
    Ok(run.into_replayed().prediction)
}

/// The same with what the rod went through, which takes about 200 bytes a sample.
///
/// # Errors
/// Impossible values in the model.
pub fn replay_with_course(model: &StrutModel, inputs: &Inputs) -> Result<(Prediction, RodCourse), InvalidValue> {
    let mut run = Run::begin(model, inputs, &Beginning::AtRest)?.with_course();
    run.go_on_to_the_end();
    let Replayed { prediction, course } = run.into_replayed();
    Ok((prediction, course.unwrap_or_default()))
}
