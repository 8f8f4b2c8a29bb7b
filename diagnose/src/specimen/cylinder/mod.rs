//! A cylinder: force against pressures on areas. What may be missing is friction (constant, or growing with pressure),
//! mass, viscous drag, and the faults of the instruments, of which a late force is the great impostor of viscous drag.

mod balance;
mod calibration;

use oleo_plant_sim::model_file::InvalidValue;
use oleo_plant_sim::specimen::{CylinderModel, SmoothedMotion, smooth_motion};

use super::channel::{Channel, StateSeries};
use super::contract::{BelievedModel, Specimen};
use super::drawing::Drawing;
use super::hypothesis::Hypothesis;
use super::single_output::{SingleOutput, SingleOutputSpecimen};
use crate::effect::{ALL, Candidate, of, sensor};
use crate::error::DiagnoseError;
use crate::excitation::{self, pressing};
use crate::recording::{ColumnKind, ColumnSpec, GapPolicy, Recording};
use crate::vocabulary::SpecimenKind;
use crate::vocabulary::{Column, EffectId, Place, Site, State};

/// Half window over which the motion is smoothed, in samples.
const SMOOTHING_SAMPLES: f64 = 5.0;

/// What is believed of a cylinder, and the smoothed motion of each recording.
pub struct Cylinder {
    model: CylinderModel,
    motions: Vec<SmoothedMotion>,
}

impl BelievedModel for CylinderModel {
    fn columns(&self) -> Vec<ColumnSpec> {
        let mut specs = vec![
            ColumnSpec::new("displacement_m", ColumnKind::Input),
            ColumnSpec::new("force_N", ColumnKind::Output),
        ];
        specs.extend((self.chamber.iter()).map(|c| ColumnSpec::new(&c.column, ColumnKind::Output)));
        specs
    }

    fn check_noise(&self) -> Result<(), InvalidValue> {
        self.check_noise_is_complete()
    }

    fn gap_policy(&self) -> GapPolicy {
        GapPolicy::Keep
    }

    fn with_recordings(self: Box<Self>, recordings: Vec<Recording>) -> Result<Box<dyn Specimen>, DiagnoseError> {
        let motions: Vec<SmoothedMotion> = (recordings.iter())
            .map(|r| smooth_motion(&r.time_s, &r.columns[0], SMOOTHING_SAMPLES * r.interval_s()))
            .collect();
        let excitation = excitation::Cylinder::of(&self, &recordings, &motions);
        let channel =
            Channel::of(Column::FORCE, &self.noise).map_err(|invalid| DiagnoseError::Model(invalid.to_string()))?;
        Ok(Box::new(SingleOutputSpecimen {
            calibration: calibration::parameters(&self, &excitation),
            candidates: candidates(&self, &excitation),
            kind: Cylinder { model: *self, motions },
            recordings,
            channel,
        }))
    }
}

/// Everything that a cylinder's model may lack: physics, laws without a name, then the instruments column by column.
fn candidates(model: &CylinderModel, excitation: &excitation::Cylinder) -> Vec<Candidate> {
    let of_effect = |id: EffectId| of(id).in_cylinder().map_or(vec![], |e| e.candidates(model, excitation));
    let physics = ALL.iter().filter(|id| id.is_physics()).flat_map(|&id| of_effect(id));
    let nameless = of_effect(EffectId::Unlisted);
    let mut faults: Vec<Candidate> = sensor::IN_ORDER.into_iter().flat_map(of_effect).collect();
    let load_cell = Column::FORCE;
    let columns: Vec<&str> = (std::iter::once(load_cell.as_str()))
        .chain(model.chamber.iter().map(|c| c.column.as_str()))
        .collect();
    faults.sort_by_key(|fault| (columns.iter()).position(|name| fault.place.sensor().is_some_and(|c| c == name)));
    (physics.chain(nameless).chain(faults))
        .map(|candidate| candidate.testable_unless(excitation.still.clone()))
        .collect()
}

impl SingleOutput for Cylinder {
    type Model = CylinderModel;

    fn kind(&self) -> SpecimenKind {
        SpecimenKind::Cylinder
    }

    fn inputs_in_words(&self) -> &'static str {
        "displacement and the pressures"
    }

    fn applied(&self, candidates: &[Candidate], hypothesis: &Hypothesis) -> CylinderModel {
        let mut model = self.model.clone();
        calibration::calibrate(&mut model, &hypothesis.calibration);
        let believed = model.effects.seal_friction.is_some();
        for (index, values) in &hypothesis.effects {
            let candidate = &candidates[*index];
            if let Some(effect) = of(candidate.id).in_cylinder() {
                effect.put(&mut model, candidate, values);
            }
        }
        if let (false, Some(seal)) = (believed, &mut model.effects.seal_friction) {
            seal.presliding_stiffness_n_m = calibration::presliding_stiffness(&hypothesis.calibration);
        }
        model
    }

    fn output(&self, model: &CylinderModel, recording: &Recording, index: usize) -> Result<Vec<f64>, String> {
        Ok(model.force_n(&recording.time_s, &self.motions[index], &recording.columns[2..]))
    }

    fn shown(&self, model: &CylinderModel, time_s: &[f64], output: Vec<f64>) -> Vec<f64> {
        model.shown(time_s, output)
    }

    fn to_toml(&self, model: &CylinderModel) -> Result<String, String> {
        model.to_toml()
    }

    fn states(&self, recording: &Recording, index: usize) -> Vec<StateSeries> {
        let motion = &self.motions[index];
        vec![
            StateSeries::new(State::Displacement, motion.displacement_m.clone()),
            StateSeries::new(State::Speed, motion.speed_m_s.clone()),
            StateSeries::new(State::Acceleration, motion.acceleration_m_s2.clone()),
            StateSeries::new(State::PressingForce, pressing(&self.model, recording)),
        ]
    }

    fn remarks(&self, recordings: &[Recording]) -> Vec<String> {
        (recordings.iter().zip(&self.motions))
            .flat_map(|(recording, motion)| balance::remarks(&self.model, recording, &motion.speed_m_s))
            .collect()
    }

    fn drawing(&self, found: &[&Place]) -> String {
        let mut d = Drawing::new(900, 150, found);
        d.site((60, 55, 90, 40), "load cell", Site::Sensor(Column::FORCE));
        d.line("150,75 290,75", false);
        d.site((290, 40, 60, 70), "rod seal", Site::MainSeal);
        d.block((350, 30, 320, 90), "chambers under pressure", false);
        d.sensor((220, 50), "x", Column::DISPLACEMENT);
        d.sensor((220, 105), "F", Column::FORCE);
        d.line("670,75 740,75", false);
        let pressures: Vec<Site> = (self.model.chamber.iter())
            .map(|c| Site::Sensor(Column::named(c.column.clone())))
            .collect();
        let found = d.found_at(&pressures);
        d.block((742, 64, 36, 22), "p", found);
        d.svg()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_place_where_something_may_be_missing_is_drawn() {
        let wave = |size: f64| {
            (0..200)
                .map(|k| size * libm::sin(0.1 * f64::from(k)))
                .collect::<Vec<f64>>()
        };
        let recording = Recording {
            name: "strokes".into(),
            time_s: (0..200).map(|k| 0.01 * f64::from(k)).collect(),
            columns: vec![wave(0.1), wave(500.0), wave(1e6)],
            notes: vec![],
        };
        let text = "[specimen]\nname = \"a\"\nkind = \"cylinder\"\n[[chamber]]\ncolumn = \"p_Pa\"\narea_m2 = 4.9e-4\n";
        let model = CylinderModel::from_toml(text, "model.toml").expect("a model");
        let motions = vec![smooth_motion(&recording.time_s, &recording.columns[0], 0.05)];
        let all = candidates(&model, &excitation::Cylinder::of(&model, &[recording], &motions));
        let cylinder = Cylinder { model, motions };
        assert!(all.len() > 8 && !cylinder.drawing(&[]).contains("found\""));
        for candidate in all {
            assert!(
                cylinder.drawing(&[&candidate.place]).contains("found\""),
                "{}",
                candidate.name()
            );
        }
    }
}
