//! A drive: position against force. Believed are a mass and a viscous friction; what may be missing is dry friction, a constant
//! force, a force that saturates with speed, springs, a gap, and the faults of the position sensor.

use oleo_plant_sim::model_file::InvalidValue;
use oleo_plant_sim::specimen::{DriveModel, SmoothedMotion};

use super::channel::{Channel, StateSeries};
use super::contract::{BelievedModel, Specimen};
use super::drawing::Drawing;
use super::hypothesis::Hypothesis;
use super::mechanism;
use super::portrait::Portrait;
use super::single_output::{SingleOutput, SingleOutputSpecimen};
use crate::effect::Candidate;
use crate::error::DiagnoseError;
use crate::excitation::{self, Channels};
use crate::parameter::Parameter;
use crate::recording::{ColumnKind, ColumnSpec, GapPolicy, Recording};
use crate::vocabulary::{Column, Place, Site, SpecimenKind};

/// Relative tolerances of mass and viscous friction where the model states none.
const TOLERANCE: f64 = 0.1;

/// What is believed of a drive, and the measured motion of each recording, freed of noise.
struct Drive {
    model: DriveModel,
    motions: Vec<SmoothedMotion>,
    /// The same with noise of the position once more.
    jittered: Vec<SmoothedMotion>,
}

impl BelievedModel for DriveModel {
    fn columns(&self) -> Vec<ColumnSpec> {
        vec![
            ColumnSpec::new("force_N", ColumnKind::Input),
            ColumnSpec::new("position_m", ColumnKind::Output),
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
            .map(|r| Self::motion(&r.time_s, &r.columns[1]))
            .collect();
        let channel =
            Channel::of(Column::POSITION, &self.noise).map_err(|invalid| DiagnoseError::Model(invalid.to_string()))?;
        let channels = Channels {
            site: Site::Drive,
            force: 0,
            motion: 1,
            compared: Column::POSITION,
            motion_noise_m: channel.noise,
            begins_with_instrument: true,
            mass_kg: self.drive.mass_kg,
        };
        let excitation = excitation::Mechanism::of(channels, &recordings, &motions);
        Ok(Box::new(SingleOutputSpecimen {
            calibration: calibration(&self),
            candidates: mechanism::candidates(&self.effects, &excitation),
            kind: Drive {
                jittered: jittered(&recordings, &motions, channel.noise),
                model: *self,
                motions,
            },
            recordings,
            channel,
        }))
    }
}

/// The measured motions with noise of the position, m, once more.
fn jittered(recordings: &[Recording], motions: &[SmoothedMotion], noise_m: f64) -> Vec<SmoothedMotion> {
    (recordings.iter().zip(motions))
        .map(|(r, motion)| DriveModel::motion(&r.time_s, &mechanism::jittered(motion, noise_m)))
        .collect()
}

/// Parameters of the calibration, in the order of [`calibrate`].
fn calibration(model: &DriveModel) -> Vec<Parameter> {
    let tolerance = |key: &str| model.tolerance.get(key).copied().unwrap_or(TOLERANCE);
    vec![
        Parameter::calibration("mass", tolerance("mass")),
        // Beside friction nothing viscous may be left.
        Parameter::calibration_down_to("viscous", tolerance("viscous"), -1.0),
    ]
}

/// Puts deviations into a model.
fn calibrate(model: &mut DriveModel, deviations: &[f64]) {
    model.drive.mass_kg *= 1.0 + deviations[0];
    model.drive.viscous_n_s_m *= 1.0 + deviations[1];
}

impl SingleOutput for Drive {
    type Model = DriveModel;

    fn kind(&self) -> SpecimenKind {
        SpecimenKind::Drive
    }

    fn inputs_in_words(&self) -> &'static str {
        "the force, and the measured position and speed once every 2.5 s,"
    }

    fn applied(&self, candidates: &[Candidate], hypothesis: &Hypothesis) -> DriveModel {
        let mut model = self.model.clone();
        calibrate(&mut model, &hypothesis.calibration);
        mechanism::put(&mut model.effects, candidates, hypothesis);
        model
    }

    fn output(&self, model: &DriveModel, recording: &Recording, index: usize) -> Result<Vec<f64>, String> {
        model.position_m(&recording.time_s, &recording.columns[0], &self.motions[index])
    }

    fn shown(&self, model: &DriveModel, time_s: &[f64], output: Vec<f64>) -> Vec<f64> {
        model.shown(time_s, output)
    }

    fn to_toml(&self, model: &DriveModel) -> Result<String, String> {
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
        d.block((60, 55, 90, 40), "motor F", false);
        d.line("150,75 330,75", false);
        d.site((330, 30, 300, 90), "carriage and guides", Site::Drive);
        d.line("630,75 720,75", false);
        d.sensor((760, 75), "x", Column::POSITION);
        d.svg()
    }

    /// The speed at the start of a window is known as well as the position's noise allows, and its error grows over the window.
    fn noise_floor(&self, model: &DriveModel, recordings: &[Recording], noise: f64) -> f64 {
        let predictions: Vec<(Vec<f64>, Vec<f64>)> = (recordings.iter().zip(&self.motions).zip(&self.jittered))
            .filter_map(|((r, motion), jittered)| {
                let run = |motion| model.position_m(&r.time_s, &r.columns[0], motion).ok();
                Some((run(motion)?, run(jittered)?))
            })
            .collect();
        mechanism::floor(&predictions, noise)
    }

    fn portrait(&self) -> Option<Portrait> {
        Some(Portrait::OverTime)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::specimen::ModelFile;

    #[test]
    fn every_place_where_something_may_be_missing_is_drawn() {
        let time_s: Vec<f64> = (0..400).map(|k| 0.005 * f64::from(k)).collect();
        let force: Vec<f64> = time_s.iter().map(|t| 60.0 * libm::cos(6.0 * t)).collect();
        let position: Vec<f64> = time_s.iter().map(|t| 0.01 * libm::sin(6.0 * t)).collect();
        let recording = Recording {
            name: "sine".into(),
            time_s,
            columns: vec![force, position],
            notes: vec![],
        };
        let text = "[specimen]\nname = \"a\"\nkind = \"drive\"\n[drive]\nmass_kg = 100.0\nviscous_N_s_m = 10.0\n\
                    [noise]\nposition_m = 1e-5\nforce_N = 0.0\n";
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
