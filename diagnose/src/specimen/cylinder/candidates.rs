//! What of a cylinder's model may be off, and what it may lack.

use oleo_plant_sim::specimen::{CylinderEffects, CylinderModel, CylinderSeal, SmoothedMotion};
use oleo_plant_sim::strut::SideLoadFriction;

use super::balance::pressing;
use crate::parameter::Parameter;
use crate::recording::Recording;
use crate::specimen::candidate::Candidate;
use crate::specimen::extent::{Extent, range, spread};
use crate::specimen::instrument::{self, FaultTables};
use crate::vocabulary::{Column, EffectId, Site};

/// Key of the presliding stiffness, the last parameter of the calibration: one seal has one, whichever part of its friction
/// is there, and without friction it does nothing.
const PRESLIDING: &str = "presliding_stiffness_N_m";
/// Labels of the laws without a name.
const MOVING_MASS: &str = "moving mass";
/// As [`MOVING_MASS`].
const VISCOUS_FRICTION: &str = "viscous friction";
/// As [`MOVING_MASS`].
const PARALLEL_STIFFNESS: &str = "parallel stiffness";
/// The piston must move by this many times the displacement's noise before anything can be tested.
const LEAST_MOVE: f64 = 20.0;
/// Pressing forces must differ by this fraction of the largest before growth with pressure can be tested.
const LEAST_PRESSURES: f64 = 0.3;

/// What the recordings excite.
pub struct Excitation {
    /// Range of the force, N.
    pub force_n: f64,
    /// Range of the displacement, m.
    stroke_m: f64,
    speed_m_s: f64,
    acceleration_m_s2: f64,
    /// Largest mean pressing force of a recording, N.
    pressing_n: f64,
    /// Why nothing can be tested.
    still: Option<String>,
    /// Why growth with pressure cannot be tested.
    one_pressure: Option<String>,
}

impl Excitation {
    /// Goes through all recordings once.
    pub fn of(model: &CylinderModel, recordings: &[Recording], motions: &[SmoothedMotion], extent: &Extent) -> Self {
        let largest = |of: fn(&SmoothedMotion) -> &Vec<f64>| {
            (motions.iter().flat_map(of))
                .fold(0.0_f64, |a, v| a.max(v.abs()))
                .max(1e-9)
        };
        let pressing: Vec<Vec<f64>> = recordings.iter().map(|r| pressing(model, r)).collect();
        let means: Vec<f64> = pressing
            .iter()
            .map(|p| p.iter().sum::<f64>() / p.len() as f64)
            .collect();
        let (low, high) = range(&means);
        let within = pressing.iter().map(|p| spread(p)).fold(0.0, f64::max);
        let x_noise = model.noise.get("displacement_m").copied().unwrap_or(0.0);
        let still = extent.spread(0) < LEAST_MOVE * x_noise.max(1e-9);
        let one_pressure = high - low + within < LEAST_PRESSURES * high;
        Self {
            force_n: extent.spread(1).max(1e-6),
            stroke_m: extent.spread(0).max(1e-9),
            speed_m_s: largest(|m| &m.speed_m_s),
            acceleration_m_s2: largest(|m| &m.acceleration_m_s2),
            pressing_n: high.max(1e-9),
            still: still.then(|| "the piston does not move; record strokes both ways".to_owned()),
            one_pressure: one_pressure
                .then(|| "one pressure only; record the same strokes at half and at twice the pressure".to_owned()),
        }
    }
}

/// Parameters of the calibration: offset of the force, areas of the chambers, presliding stiffness.
pub fn calibration(model: &CylinderModel, excitation: &Excitation) -> Vec<Parameter> {
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

/// Everything that the model may lack.
pub fn candidates(model: &CylinderModel, excitation: &Excitation, extent: &Extent) -> Vec<Candidate> {
    let still = &excitation.still;
    let at_seal = |id, label: &str, parameter: Parameter| Candidate {
        id,
        place: Site::MainSeal.into(),
        label: label.to_owned(),
        parameters: vec![parameter],
        starts: vec![],
        group: None,
        untestable: still.clone(),
    };
    let force = excitation.force_n;
    let mut all = Vec::new();
    if model.effects.seal_friction.is_none() {
        let coulomb = Parameter::linear("coulomb_force_N", 0.02 * force, 0.01 * force, (0.0, force));
        all.push(at_seal(EffectId::SealFriction, "", coulomb));
    }
    if model.effects.side_load_friction.is_none() {
        let pressing = excitation.pressing_n;
        let coefficient = Parameter::linear(
            "coefficient",
            0.02 * force / pressing,
            0.01 * force / pressing,
            (0.0, 1.0),
        );
        all.push(Candidate {
            untestable: still.clone().or_else(|| excitation.one_pressure.clone()),
            ..at_seal(EffectId::SideLoadFriction, "", coefficient)
        });
    }
    let signed = |key: &str, most: f64| Parameter::linear(key, 0.0, 0.02 * most, (-most, most));
    for (label, parameter) in [
        (
            MOVING_MASS,
            signed("moving_mass_kg", force / excitation.acceleration_m_s2),
        ),
        (
            VISCOUS_FRICTION,
            signed("viscous_friction_N_s_m", force / excitation.speed_m_s),
        ),
        (
            PARALLEL_STIFFNESS,
            signed("parallel_stiffness_N_m", force / excitation.stroke_m),
        ),
    ] {
        all.push(at_seal(EffectId::Unlisted, label, parameter));
    }
    let pressures = model.chamber.iter().map(|c| Column::named(c.column.clone()));
    for (k, column) in std::iter::once(Column::FORCE).chain(pressures).enumerate() {
        for mut fault in instrument::faults(&column, extent.spread(1 + k), extent.duration_s, extent.interval_s) {
            // A lagging input cannot be undone without amplifying its noise; late is tested instead.
            if k == 0 || fault.id != EffectId::SensorLag {
                fault.parameters.iter_mut().for_each(|p| p.instrument_only = false);
                fault.untestable.clone_from(still);
                all.push(fault);
            }
        }
    }
    all
}

/// Puts a candidate with its values into a model.
pub fn apply(e: &mut CylinderEffects, candidate: &Candidate, values: &[f64], presliding_stiffness_n_m: f64) {
    // The seal, made without Coulomb friction where there is none yet.
    let no_friction = CylinderSeal {
        coulomb_force_n: 0.0,
        presliding_stiffness_n_m,
    };
    let value = values[0];
    match (candidate.id, candidate.label.as_str()) {
        (EffectId::SealFriction, _) => e.seal_friction.get_or_insert(no_friction).coulomb_force_n = value,
        (EffectId::SideLoadFriction, _) => {
            e.side_load_friction = Some(SideLoadFriction {
                coefficient: value,
                overlap_growth_1_m: 0.0,
            });
            e.seal_friction.get_or_insert(no_friction);
        }
        (EffectId::Unlisted, MOVING_MASS) => e.moving_mass_kg = Some(value),
        (EffectId::Unlisted, VISCOUS_FRICTION) => e.viscous_friction_n_s_m = Some(value),
        (EffectId::Unlisted, PARALLEL_STIFFNESS) => e.parallel_stiffness_n_m = Some(value),
        _ => FaultTables {
            lag: &mut e.sensor_lag,
            skew: &mut e.sensor_skew,
            gain: &mut e.sensor_gain,
            drift: &mut e.sensor_drift,
        }
        .put(candidate, value),
    }
}
