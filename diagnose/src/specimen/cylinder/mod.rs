//! A cylinder: force against pressures on areas. What may be missing is friction (constant, or growing with pressure),
//! mass, viscous drag, and the faults of the instruments, of which a late force is the great impostor of viscous drag.

mod balance;
mod candidates;

use oleo_plant_sim::specimen::{CylinderModel, SmoothedMotion, smooth_motion};

use super::candidate::{Candidate, Hypothesis};
use super::channel::{Channel, StateSeries, stated};
use super::contract::{BelievedModel, Specimen};
use super::drawing::Drawing;
use super::extent::Extent;
use super::kind::SpecimenKind;
use super::single_output::{SingleOutput, SingleOutputSpecimen};
use crate::error::DiagnoseError;
use crate::recording::{ColumnKind, ColumnSpec, GapPolicy, Recording};
use crate::vocabulary::{Column, Place, Site, State};
use candidates::Excitation;

/// Noise assumed where the model file states none, as a fraction of the force range.
const DEFAULT_NOISE_FRACTION: f64 = 1e-3;
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

    fn gap_policy(&self) -> GapPolicy {
        GapPolicy::Keep
    }

    fn with_recordings(self: Box<Self>, recordings: Vec<Recording>) -> Result<Box<dyn Specimen>, DiagnoseError> {
        let motions: Vec<SmoothedMotion> = (recordings.iter())
            .map(|r| smooth_motion(&r.time_s, &r.columns[0], SMOOTHING_SAMPLES * r.interval_s()))
            .collect();
        let extent = Extent::of(&recordings);
        let excitation = Excitation::of(&self, &recordings, &motions, &extent);
        let noise = stated(&self.noise, Column::FORCE.as_str()).unwrap_or(DEFAULT_NOISE_FRACTION * excitation.force_n);
        Ok(Box::new(SingleOutputSpecimen {
            calibration: candidates::calibration(&self, &excitation),
            candidates: candidates::candidates(&self, &excitation, &extent),
            kind: Cylinder { model: *self, motions },
            recordings,
            channel: Channel {
                column: Column::FORCE,
                noise,
            },
        }))
    }
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
        candidates::calibrate(&mut model, &hypothesis.calibration);
        let presliding = candidates::presliding_stiffness(&hypothesis.calibration);
        for (index, values) in &hypothesis.effects {
            candidates::apply(&mut model.effects, &candidates[*index], values, presliding);
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
            StateSeries::new(State::PressingForce, balance::pressing(&self.model, recording)),
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
