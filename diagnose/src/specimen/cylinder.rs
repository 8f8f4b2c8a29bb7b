//! A cylinder: force against pressures on areas. What may be missing is friction (constant, or growing with pressure),
//! mass, viscous drag, and the faults of the instruments, of which a late force is the great impostor of viscous drag.

use oleo_plant_sim::specimen::{CylinderEffects, CylinderModel, CylinderSeal, SmoothedMotion, smooth_motion};
use oleo_plant_sim::strut::{SensorEffect, SideLoadFriction};

use super::{Candidate, Channel, Hypothesis, Series, Specimen, StateSeries, instrument};
use crate::parameter::Parameter;
use crate::recording::{ColumnKind, ColumnSpec, Recording};
use crate::vocabulary::{Column, EffectId, Site, State};

/// Noise assumed where the model file states none, as a part of the force range.
const DEFAULT_NOISE_PART: f64 = 1e-3;
/// Half window of the motion's smoothing, in samples.
const SMOOTHING_SAMPLES: f64 = 5.0;
/// Key of the presliding stiffness.
const PRESLIDING: &str = "presliding_stiffness_N_m";

/// A cylinder with its recordings.
pub struct Cylinder {
    model: CylinderModel,
    recordings: Vec<Recording>,
    motions: Vec<SmoothedMotion>,
    channels: Vec<Channel>,
    calibration: Vec<Parameter>,
    candidates: Vec<Candidate>,
}

/// Columns of a cylinder's recording.
#[must_use]
pub fn columns(model: &CylinderModel) -> Vec<ColumnSpec> {
    let mut specs = vec![
        ColumnSpec {
            name: "displacement_m".into(),
            kind: ColumnKind::Input,
        },
        ColumnSpec {
            name: "force_N".into(),
            kind: ColumnKind::Output,
        },
    ];
    specs.extend(model.chamber.iter().map(|c| ColumnSpec {
        name: c.column.clone(),
        kind: ColumnKind::Output,
    }));
    specs
}

impl Cylinder {
    /// Puts model and recordings together.
    #[must_use]
    pub fn new(model: CylinderModel, recordings: Vec<Recording>) -> Self {
        let tolerance = |key: &str, otherwise: f64| model.tolerance.get(key).copied().unwrap_or(otherwise);
        let spread = |c: usize| {
            recordings
                .iter()
                .map(|r| {
                    let (low, high) = r.columns[c]
                        .iter()
                        .fold((f64::MAX, f64::MIN), |(a, b), &v| (a.min(v), b.max(v)));
                    high - low
                })
                .fold(0.0, f64::max)
        };
        // An offset of a pressure is one of the force: in the balance only their sum shows.
        let offsets = (model.chamber.iter())
            .map(|c| c.area_m2 * tolerance("pressure_offset_Pa", 0.0))
            .fold(tolerance("force_offset_N", 0.0), libm::hypot);
        let mut calibration = vec![Parameter::calibration("force_offset_N", offsets.max(1e-9))];
        for chamber in &model.chamber {
            calibration.push(Parameter::calibration(
                format!("area of {}", chamber.column),
                tolerance("area", 0.01),
            ));
        }
        let motions: Vec<SmoothedMotion> = recordings
            .iter()
            .map(|r| smooth_motion(&r.time_s, &r.columns[0], SMOOTHING_SAMPLES * r.interval_s()))
            .collect();
        let force = spread(1).max(1e-6);
        let noise = model
            .noise
            .get("force_N")
            .copied()
            .filter(|n| *n > 0.0)
            .unwrap_or(DEFAULT_NOISE_PART * force);
        let x_noise = model.noise.get("displacement_m").copied().unwrap_or(0.0);
        let still = (spread(0) < 20.0 * x_noise.max(1e-9))
            .then(|| "the piston does not move; record strokes both ways".to_owned());
        let speed = motions
            .iter()
            .flat_map(|m| &m.speed_m_s)
            .fold(0.0_f64, |a, v| a.max(v.abs()))
            .max(1e-9);
        let acceleration = motions
            .iter()
            .flat_map(|m| &m.acceleration_m_s2)
            .fold(0.0_f64, |a, v| a.max(v.abs()))
            .max(1e-9);
        let duration = recordings
            .iter()
            .map(|r| r.time_s[r.len() - 1] - r.time_s[0])
            .fold(0.0, f64::max);
        let interval = recordings.iter().map(Recording::interval_s).fold(0.0, f64::max);
        let levels: Vec<f64> = recordings.iter().map(|r| mean_pressing(&model, r)).collect();
        let (low, high) = levels
            .iter()
            .fold((f64::MAX, f64::MIN), |(a, b), &v| (a.min(v), b.max(v)));
        let within = recordings
            .iter()
            .map(|r| pressing_spread(&model, r))
            .fold(0.0, f64::max);
        let one_pressure = (high - low + within < 0.3 * high)
            .then(|| "one pressure only; record the same strokes at half and at twice the pressure".to_owned());
        let free = |id, label: &str, parameters: Vec<Parameter>, untestable: &Option<String>| Candidate {
            id,
            place: Site::MainSeal.into(),
            label: label.to_owned(),
            parameters,
            starts: vec![],
            group: None,
            untestable: untestable.clone(),
        };
        // One seal, one presliding stiffness, whichever part of its friction is there; without friction it does nothing.
        calibration.push(Parameter::log(
            PRESLIDING,
            30.0 * force / spread(0).max(1e-9),
            (force / spread(0).max(1e-9), 1e9),
        ));
        let mut candidates = Vec::new();
        let e = &model.effects;
        if e.seal_friction.is_none() {
            candidates.push(free(
                EffectId::SealFriction,
                "",
                vec![Parameter::linear(
                    "coulomb_force_N",
                    0.02 * force,
                    0.01 * force,
                    (0.0, force),
                )],
                &still,
            ));
        }
        if e.side_load_friction.is_none() {
            let level = high.max(1e-9);
            let untestable = still.clone().or(one_pressure);
            candidates.push(free(
                EffectId::SideLoadFriction,
                "",
                vec![Parameter::linear(
                    "coefficient",
                    0.02 * force / level,
                    0.01 * force / level,
                    (0.0, 1.0),
                )],
                &untestable,
            ));
        }
        let signed = |key: &str, most: f64| vec![Parameter::linear(key, 0.0, 0.02 * most, (-most, most))];
        candidates.push(free(
            EffectId::Unlisted,
            "moving mass",
            signed("moving_mass_kg", force / acceleration),
            &still,
        ));
        candidates.push(free(
            EffectId::Unlisted,
            "viscous friction",
            signed("viscous_friction_N_s_m", force / speed),
            &still,
        ));
        candidates.push(free(
            EffectId::Unlisted,
            "parallel stiffness",
            signed("parallel_stiffness_N_m", force / spread(0).max(1e-9)),
            &still,
        ));
        for (k, column) in std::iter::once(Column::FORCE)
            .chain(model.chamber.iter().map(|c| Column::named(c.column.clone())))
            .enumerate()
        {
            for mut fault in instrument::faults(&column, spread(1 + k), duration, interval) {
                // A lagging input cannot be undone without amplifying its noise; late is tested instead.
                if k == 0 || fault.id != EffectId::SensorLag {
                    fault.parameters.iter_mut().for_each(|p| p.instrument_only = false);
                    fault.untestable.clone_from(&still);
                    candidates.push(fault);
                }
            }
        }
        let channels = vec![Channel {
            column: Column::FORCE,
            noise,
        }];
        Self {
            model,
            recordings,
            motions,
            channels,
            calibration,
            candidates,
        }
    }

    fn applied(&self, hypothesis: &Hypothesis) -> CylinderModel {
        let mut model = self.model.clone();
        let offset = model.effects.sensor_offset.get_or_insert_default();
        *offset.entry("force_N".into()).or_default() += hypothesis.calibration[0];
        for (chamber, error) in model.chamber.iter_mut().zip(&hypothesis.calibration[1..]) {
            chamber.area_m2 *= 1.0 + error;
        }
        let presliding = hypothesis.calibration.last().copied().unwrap_or(f64::INFINITY);
        for (index, values) in &hypothesis.effects {
            let candidate = &self.candidates[*index];
            let e = &mut model.effects;
            let sensor = |effect: &mut Option<SensorEffect>| {
                if let Some(column) = candidate.place.sensor() {
                    effect.get_or_insert_default().insert(column.to_string(), values[0]);
                }
            };
            match (candidate.id, candidate.label.as_str()) {
                (EffectId::SealFriction, _) => seal(e, presliding).coulomb_force_n = values[0],
                (EffectId::SideLoadFriction, _) => {
                    e.side_load_friction = Some(SideLoadFriction {
                        coefficient: values[0],
                        overlap_growth_1_m: 0.0,
                    });
                    seal(e, presliding);
                }
                (EffectId::Unlisted, "moving mass") => e.moving_mass_kg = Some(values[0]),
                (EffectId::Unlisted, "viscous friction") => e.viscous_friction_n_s_m = Some(values[0]),
                (EffectId::Unlisted, _) => e.parallel_stiffness_n_m = Some(values[0]),
                (EffectId::SensorLag, _) => sensor(&mut e.sensor_lag),
                (EffectId::SensorSkew, _) => sensor(&mut e.sensor_skew),
                (EffectId::SensorGain, _) => sensor(&mut e.sensor_gain),
                _ => sensor(&mut e.sensor_drift),
            }
        }
        model
    }
}

/// The seal of a model, made with no Coulomb friction where there is none yet.
fn seal(effects: &mut CylinderEffects, presliding_stiffness_n_m: f64) -> &mut CylinderSeal {
    effects.seal_friction.get_or_insert(CylinderSeal {
        coulomb_force_n: 0.0,
        presliding_stiffness_n_m,
    })
}

fn pressing(model: &CylinderModel, recording: &Recording) -> Vec<f64> {
    (0..recording.len())
        .map(|k| {
            model
                .chamber
                .iter()
                .zip(&recording.columns[2..])
                .map(|(c, p)| (c.area_m2 * p[k].max(0.0)).abs())
                .sum()
        })
        .collect()
}

fn mean_pressing(model: &CylinderModel, recording: &Recording) -> f64 {
    pressing(model, recording).iter().sum::<f64>() / recording.len() as f64
}

fn pressing_spread(model: &CylinderModel, recording: &Recording) -> f64 {
    let (low, high) = pressing(model, recording)
        .iter()
        .fold((f64::MAX, f64::MIN), |(a, b), &v| (a.min(v), b.max(v)));
    high - low
}

impl Specimen for Cylinder {
    fn kind(&self) -> &'static str {
        "cylinder"
    }
    fn is_cheap(&self) -> bool {
        true
    }
    fn channels(&self) -> &[Channel] {
        &self.channels
    }
    fn recordings(&self) -> usize {
        self.recordings.len()
    }
    fn recording_name(&self, recording: usize) -> &str {
        &self.recordings[recording].name
    }
    fn time_s(&self, recording: usize) -> &[f64] {
        &self.recordings[recording].time_s
    }
    fn measured(&self, recording: usize, _channel: usize) -> &[f64] {
        &self.recordings[recording].columns[1]
    }
    fn calibration(&self) -> &[Parameter] {
        &self.calibration
    }
    fn candidates(&self) -> &[Candidate] {
        &self.candidates
    }
    fn simulate(&self, hypothesis: &Hypothesis, recording: usize) -> Result<Series, String> {
        let r = &self.recordings[recording];
        Ok(vec![self.applied(hypothesis).force_n(
            &r.time_s,
            &self.motions[recording],
            &r.columns[2..],
        )])
    }
    fn observe(&self, hypothesis: &Hypothesis, recording: usize, truth: &Series) -> Series {
        vec![
            self.applied(hypothesis)
                .shown(&self.recordings[recording].time_s, truth[0].clone()),
        ]
    }
    fn model_toml(&self, hypothesis: &Hypothesis) -> Result<String, String> {
        self.applied(hypothesis).to_toml()
    }
    fn states(&self, recording: usize) -> Vec<StateSeries> {
        let motion = &self.motions[recording];
        vec![
            StateSeries::new(State::Displacement, motion.displacement_m.clone()),
            StateSeries::new(State::Speed, motion.speed_m_s.clone()),
            StateSeries::new(State::Acceleration, motion.acceleration_m_s2.clone()),
            StateSeries::new(State::PressingForce, pressing(&self.model, &self.recordings[recording])),
        ]
    }
}
