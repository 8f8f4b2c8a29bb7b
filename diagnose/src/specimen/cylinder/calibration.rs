//! What of a cylinder's model may be off within its tolerance.

use oleo_plant_sim::specimen::CylinderModel;

use crate::excitation;
use crate::parameter::Parameter;
use crate::vocabulary::Column;

/// Key of the presliding stiffness, the last parameter of the calibration: one seal has one, whichever part of its friction
/// is there, and without friction it does nothing.
const PRESLIDING: &str = "presliding_stiffness_N_m";

/// Parameters of the calibration: offset of the force, areas of the chambers, presliding stiffness.
pub fn parameters(model: &CylinderModel, excitation: &excitation::Cylinder) -> Vec<Parameter> {
    let tolerance = |key: &str, otherwise: f64| model.tolerance.get(key).copied().unwrap_or(otherwise);
    // An offset of a pressure is one of the force: in the balance only their sum shows.
    let offsets = (model.chamber.iter())
        .map(|c| c.area_m2 * tolerance("pressure_offset_Pa", 0.0))
        .fold(tolerance("force_offset_N", 0.0), libm::hypot);
    let mut parameters = vec![Parameter::calibration("force_offset_N", offsets.max(1e-9))];
    for chamber in &model.chamber {
        let key = format!("area of {}", chamber.column);
        parameters.push(Parameter::calibration(key, tolerance("area", 0.01)));
    }
    let stiffness = excitation.force_n / excitation.stroke_m;
    parameters.push(Parameter::log(
        PRESLIDING,
        30.0 * excitation.force_n / excitation.stroke_m,
        (stiffness, 1e9),
    ));
    parameters
}

/// Puts deviations into a model.
pub fn calibrate(model: &mut CylinderModel, deviations: &[f64]) {
    let offset = model.effects.sensor_offset.get_or_insert_default();
    *offset.entry(Column::FORCE.to_string()).or_default() += deviations[0];
    for (chamber, error) in model.chamber.iter_mut().zip(&deviations[1..]) {
        chamber.area_m2 *= 1.0 + error;
    }
}

/// The presliding stiffness among the values of the calibration, N/m.
pub fn presliding_stiffness(calibration: &[f64]) -> f64 {
    calibration.last().copied().unwrap_or(f64::INFINITY)
}
