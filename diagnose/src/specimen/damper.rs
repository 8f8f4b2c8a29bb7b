//! A damper on a dynamometer: force against motion. Believed is a viscous coefficient; what may be missing is friction, with
//! and without hysteresis, a force that saturates with speed, springs, a gap, a mass, and the faults of the load cell, of which a
//! late force is the great impostor of a hysteresis.

use oleo_plant_sim::model_file::InvalidValue;
use oleo_plant_sim::specimen::{DamperModel, SmoothedMotion};

use super::channel::{Channel, StateSeries};
use super::contract::{BelievedModel, Specimen};
use super::drawing::Drawing;
use super::folding::Folding;
use super::hypothesis::Hypothesis;
use super::mechanism;
use super::portrait::Portrait;
use super::single_output::{SingleOutput, SingleOutputSpecimen};
use crate::effect::Candidate;
use crate::error::DiagnoseError;
use crate::excitation::{self, Channels};
use crate::parameter::Parameter;
use crate::recording::{ColumnKind, ColumnSpec, GapPolicy, Recording};
use crate::vocabulary::{Column, Place, Site, SpecimenKind, State};

/// Relative tolerance of the viscous coefficient where the model states none.
const VISCOUS_TOLERANCE: f64 = 0.1;
/// Least offset of the force that counts as a tolerance, N.
const LEAST_OFFSET_N: f64 = 1e-6;

/// What is believed of a damper, and the smoothed motion of each recording.
struct Damper {
    model: DamperModel,
    motions: Vec<SmoothedMotion>,
    /// The motions with noise of the displacement once more.
    jittered: Vec<SmoothedMotion>,
}

impl BelievedModel for DamperModel {
    fn columns(&self) -> Vec<ColumnSpec> {
        vec![
            ColumnSpec::new("displacement_m", ColumnKind::Input),
            ColumnSpec::new("force_N", ColumnKind::Output),
        ]
    }

    fn check_noise(&self) -> Result<(), InvalidValue> {
        self.check_noise_is_complete()
    }

    fn gap_policy(&self) -> GapPolicy {
        GapPolicy::Cut
    }

    fn with_recordings(self: Box<Self>, recordings: Vec<Recording>) -> Result<Box<dyn Specimen>, DiagnoseError> {
        let motions: Vec<SmoothedMotion> = (recordings.iter())
            .map(|r| Self::motion(&r.time_s, &r.columns[0]))
            .collect();
        let channels = Channels {
            site: Site::Damper,
            force: 1,
            motion: 0,
            compared: Column::FORCE,
            motion_noise_m: self.noise.get("displacement_m").copied().unwrap_or(0.0),
            begins_with_instrument: false,
            mass_kg: 0.0,
        };
        let excitation = excitation::Mechanism::of(channels, &recordings, &motions);
        let channel =
            Channel::of(Column::FORCE, &self.noise).map_err(|invalid| DiagnoseError::Model(invalid.to_string()))?;
        Ok(Box::new(SingleOutputSpecimen {
            calibration: calibration(&self),
            candidates: mechanism::candidates(&self.effects, &excitation),
            kind: Damper {
                jittered: jittered(&self, &recordings, &motions),
                model: *self,
                motions,
            },
            recordings,
            channel,
        }))
    }
}

/// The motions with noise of the displacement once more.
fn jittered(model: &DamperModel, recordings: &[Recording], motions: &[SmoothedMotion]) -> Vec<SmoothedMotion> {
    let noise = model.noise.get("displacement_m").copied().unwrap_or(0.0);
    (recordings.iter().zip(motions))
        .map(|(r, motion)| DamperModel::motion(&r.time_s, &mechanism::jittered(motion, noise)))
        .collect()
}

/// Parameters of the calibration, in the order of [`calibrate`].
fn calibration(model: &DamperModel) -> Vec<Parameter> {
    let tolerance = |key: &str, otherwise: f64| model.tolerance.get(key).copied().unwrap_or(otherwise);
    vec![
        // Beside friction nothing viscous may be left.
        Parameter::calibration_down_to("viscous", tolerance("viscous", VISCOUS_TOLERANCE), -1.0),
        Parameter::calibration("offset_N", tolerance("offset_N", 0.0).max(LEAST_OFFSET_N)),
    ]
}

/// Puts deviations into a model.
fn calibrate(model: &mut DamperModel, deviations: &[f64]) {
    model.damper.viscous_n_s_m *= 1.0 + deviations[0];
    model.damper.offset_n += deviations[1];
}

impl SingleOutput for Damper {
    type Model = DamperModel;

    fn kind(&self) -> SpecimenKind {
        SpecimenKind::Damper
    }

    fn inputs_in_words(&self) -> &'static str {
        "displacement"
    }

    fn applied(&self, candidates: &[Candidate], hypothesis: &Hypothesis) -> DamperModel {
        let mut model = self.model.clone();
        calibrate(&mut model, &hypothesis.calibration);
        mechanism::put(&mut model.effects, candidates, hypothesis);
        model
    }

    fn output(&self, model: &DamperModel, _recording: &Recording, index: usize) -> Result<Vec<f64>, String> {
        model.force_n(&self.motions[index])
    }

    fn shown(&self, model: &DamperModel, time_s: &[f64], output: Vec<f64>) -> Vec<f64> {
        model.shown(time_s, output)
    }

    fn to_toml(&self, model: &DamperModel) -> Result<String, String> {
        model.to_toml()
    }

    fn states(&self, _recording: &Recording, index: usize) -> Vec<StateSeries> {
        mechanism::states(&self.motions[index])
    }

    fn remarks(&self, _recordings: &[Recording]) -> Vec<String> {
        vec![]
    }

    fn drawing(&self, found: &[&Place]) -> String {
        let mut d = Drawing::new(900, 150, found);
        d.block((60, 55, 90, 40), "actuator", false);
        d.line("150,75 330,75", false);
        d.sensor((240, 50), "x", Column::DISPLACEMENT);
        d.site((330, 30, 300, 90), "damper", Site::Damper);
        d.line("630,75 720,75", false);
        d.site((720, 55, 110, 40), "load cell F", Site::Sensor(Column::FORCE));
        d.svg()
    }

    fn noise_floor(&self, model: &DamperModel, _recordings: &[Recording], noise: f64) -> f64 {
        let predictions: Vec<(Vec<f64>, Vec<f64>)> = (self.motions.iter().zip(&self.jittered))
            .filter_map(|(motion, jittered)| Some((model.force_n(motion).ok()?, model.force_n(jittered).ok()?)))
            .collect();
        mechanism::floor(&predictions, noise)
    }

    fn folding(&self) -> Folding {
        Folding::WholeRecordings
    }

    fn portrait(&self) -> Option<Portrait> {
        Some(Portrait::Loops(&[State::Speed, State::Displacement]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::specimen::ModelFile;

    #[test]
    fn every_place_where_something_may_be_missing_is_drawn() {
        let time_s: Vec<f64> = (0..400).map(|k| 0.005 * f64::from(k)).collect();
        let displacement: Vec<f64> = time_s.iter().map(|t| 0.01 * libm::sin(6.0 * t)).collect();
        let force: Vec<f64> = time_s.iter().map(|t| 60.0 * libm::cos(6.0 * t)).collect();
        let recording = Recording {
            name: "sine".into(),
            time_s,
            columns: vec![displacement, force],
            notes: vec![],
        };
        let text = "[specimen]\nname = \"a\"\nkind = \"damper\"\n[damper]\nviscous_N_s_m = 1000.0\noffset_N = 0.0\n\
                    [noise]\ndisplacement_m = 1e-5\nforce_N = 1.0\n";
        let specimen = (ModelFile::read(text, "model.toml").expect("a model").model)
            .with_recordings(vec![recording])
            .expect("a specimen");
        assert!(specimen.candidates().len() > 15);
        for candidate in specimen.candidates() {
            let drawing = specimen.drawing(&[&candidate.place]).expect("a drawing");
            assert!(drawing.contains("found\""), "{}", candidate.name());
        }
    }
}
