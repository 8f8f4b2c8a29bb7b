//! What of a gas spring's model may be off within its tolerance.

use oleo_plant_sim::specimen::GasSpringModel;

use crate::parameter::Parameter;
use crate::recording::Recording;

/// A piston that has moved this far ...
const MOVED_M: f64 = 0.005;
/// ... within this time of the first sample was not at rest.
const SETTLED_S: f64 = 3.0;
/// Temperature change of an adiabatic stroke by a third of the volume, K.
const STROKE_TEMPERATURE_K: f64 = 50.0;

/// Parameters of the calibration, in the order of [`calibrate`].
pub fn parameters(model: &GasSpringModel, recordings: &[Recording]) -> Vec<Parameter> {
    let tolerance = |key: &str, otherwise: f64| model.tolerance.get(key).copied().unwrap_or(otherwise);
    // A recording that begins in the middle of a stroke begins with gas that has just been compressed or let out: by how
    // much nobody knows, at most as much as an adiabatic stroke makes of it.
    let initial_temperature = if recordings.iter().any(begins_in_motion) {
        STROKE_TEMPERATURE_K
    } else {
        tolerance("temperature_K", 5.0)
    };
    let mut parameters = vec![
        Parameter::calibration("volume_at_zero", tolerance("volume_at_zero", 0.02)),
        Parameter::calibration("initial_pressure", tolerance("initial_pressure", 0.01)),
        Parameter::calibration("initial_temperature_difference_K", initial_temperature),
    ];
    if model.effects.gas_heat_transfer.is_some() {
        parameters.push(Parameter::calibration(
            "time_constant",
            tolerance("time_constant", 0.08),
        ));
    }
    parameters
}

/// Puts deviations into a model.
pub fn calibrate(model: &mut GasSpringModel, deviations: &[f64]) {
    let gas = &mut model.gas;
    model.chamber.volume_at_zero_m3 *= 1.0 + deviations[0];
    gas.initial_pressure_error = (1.0 + gas.initial_pressure_error) * (1.0 + deviations[1]) - 1.0;
    gas.initial_temperature_difference_k += deviations[2];
    if let (Some(heat), Some(error)) = (&mut model.effects.gas_heat_transfer, deviations.get(3)) {
        heat.time_constant_s *= 1.0 + error;
    }
}

fn begins_in_motion(recording: &Recording) -> bool {
    let x = &recording.columns[0];
    let early = x.iter().take_while(|v| (*v - x[0]).abs() < MOVED_M).count();
    early < recording.len() && recording.time_s[early] - recording.time_s[0] < SETTLED_S
}
