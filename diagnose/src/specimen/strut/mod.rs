//! The two-stage hydropneumatic strut: the belief as a [`StrutModel`], five compared channels, and the vocabulary.

mod apply;
mod excitation;
mod floor;
mod laws;
mod vocabulary;

use oleo_plant_sim::strut::{COLUMNS, Effects, Inputs, StrutModel, record_column, replay};

pub use excitation::Excitation;
pub use vocabulary::TERMS;

use super::{Candidate, Channel, Hypothesis, Series, Specimen, StateSeries};
use std::sync::OnceLock;

use rayon::prelude::*;

use crate::parameter::Parameter;
use crate::recording::{ColumnKind, ColumnSpec, Recording};
use crate::vocabulary::{Column, EffectId, State};

/// Columns of the channels, in their order.
pub const CHANNELS: [&str; 5] = ["force_N", "p1_Pa", "p2_Pa", "p3_Pa", "p4_Pa"];
/// Noise assumed where the model file states none.
const DEFAULT_NOISE: [f64; 5] = [12.0, 4e3, 4e3, 4e3, 4e3];

/// A strut with its recordings.
pub struct TwoStageStrut {
    model: StrutModel,
    recordings: Vec<Recording>,
    inputs: Vec<Inputs>,
    channels: Vec<Channel>,
    calibration: Vec<Calibration>,
    parameters: Vec<Parameter>,
    candidates: Vec<Candidate>,
    excitation: Excitation,
    /// The inputs with displacement noise once more; made when somebody asks for the floor.
    jittered: OnceLock<Vec<Inputs>>,
}

/// What a calibration parameter changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Calibration {
    GasVolume(usize),
    StaticPressure,
    OilVolume,
    Flow(usize),
    BulkModulus,
    TimeConstant(usize),
    Temperature,
    /// Offset of `COLUMNS[i]`.
    Offset(usize),
}

/// Columns of a strut's recording: displacement, the five channels, the three switching signals.
#[must_use]
pub fn columns() -> Vec<ColumnSpec> {
    let mut specs = vec![ColumnSpec {
        name: "displacement_m".into(),
        kind: ColumnKind::Input,
    }];
    specs.extend(CHANNELS.map(|c| ColumnSpec {
        name: c.into(),
        kind: ColumnKind::Output,
    }));
    specs.extend(["valve1", "valve2", "valve3"].map(|c| ColumnSpec {
        name: c.into(),
        kind: ColumnKind::Switch,
    }));
    specs
}

impl TwoStageStrut {
    /// Puts model and recordings together.
    ///
    /// # Errors
    /// A model whose numbers are impossible.
    pub fn new(model: StrutModel, recordings: Vec<Recording>) -> Result<Self, String> {
        let noise = |column: &str, otherwise: f64| {
            model
                .noise
                .get(column)
                .copied()
                .filter(|n| *n > 0.0)
                .unwrap_or(otherwise)
        };
        let channels: Vec<Channel> = CHANNELS
            .iter()
            .zip(DEFAULT_NOISE)
            .map(|(c, n)| Channel {
                column: Column::known(c),
                noise: noise(c, n),
            })
            .collect();
        let displacement_noise = noise("displacement_m", 0.0);
        let inputs: Vec<Inputs> = recordings
            .iter()
            .map(|r| {
                let signals: Vec<[bool; 3]> = (0..r.len())
                    .map(|k| [6, 7, 8].map(|c: usize| r.columns[c][k] > 0.5))
                    .collect();
                Inputs::from_recording(&r.time_s, &r.columns[0], &signals, displacement_noise)
            })
            .collect();
        let excitation = Excitation::of(&recordings, &inputs, &channels, displacement_noise);
        let (calibration, parameters) = calibration(&model);
        let candidates = vocabulary::candidates(&model, &excitation);
        let strut = Self {
            model,
            recordings,
            inputs,
            channels,
            calibration,
            parameters,
            candidates,
            excitation,
            jittered: OnceLock::new(),
        };
        // A model that cannot even stand still is refused here, with the model's own words.
        strut.simulate(
            &Hypothesis {
                calibration: vec![0.0; strut.parameters.len()],
                effects: vec![],
            },
            0,
        )?;
        Ok(strut)
    }

    /// Takes a term out of the search, to see what is said of it without its name (self-test).
    pub fn leave_out(&mut self, id: EffectId) {
        for candidate in self.candidates.iter_mut().filter(|c| c.id == id) {
            candidate.untestable = Some("left out of the search".to_owned());
        }
    }

    /// The model as given.
    #[must_use]
    pub fn model(&self) -> &StrutModel {
        &self.model
    }

    /// What the recordings excite.
    #[must_use]
    pub fn excitation(&self) -> &Excitation {
        &self.excitation
    }

    /// Inputs of a recording, smoothed.
    #[must_use]
    pub fn inputs(&self, recording: usize) -> &Inputs {
        &self.inputs[recording]
    }

    /// The model under a hypothesis, instruments included.
    #[must_use]
    pub fn applied(&self, hypothesis: &Hypothesis) -> StrutModel {
        let mut model = self.model.clone();
        for (what, &value) in self.calibration.iter().zip(&hypothesis.calibration) {
            let e = &mut model.effects;
            match *what {
                Calibration::GasVolume(i) => model.accumulator[i].static_gas_volume_m3 *= 1.0 + value,
                Calibration::StaticPressure => model.cylinder.static_pressure_pa *= 1.0 + value,
                Calibration::OilVolume => model.cylinder.oil_volume_m3 *= 1.0 + value,
                Calibration::Flow(i) => model.valve[i].flow_coefficient *= 1.0 + value,
                Calibration::BulkModulus => {
                    e.oil_compressibility
                        .iter_mut()
                        .for_each(|o| o.bulk_modulus_pa *= 1.0 + value);
                }
                Calibration::TimeConstant(i) => e.gas_heat_transfer.iter_mut().for_each(|h| {
                    let tau = if i == 0 {
                        &mut h.time_constant_1_s
                    } else {
                        &mut h.time_constant_2_s
                    };
                    *tau *= 1.0 + value;
                }),
                Calibration::Temperature => model.gas.temperature_k += value,
                Calibration::Offset(i) => {
                    *e.sensor_offset
                        .get_or_insert_default()
                        .entry(COLUMNS[i].into())
                        .or_default() += value;
                }
            }
        }
        for (index, values) in &hypothesis.effects {
            apply::apply(&mut model.effects, &self.candidates[*index], values);
        }
        model
    }
}

/// A valve or a pressure has settled after this time, s: three times the slowest valve of the report.
const SETTLED_S: f64 = 0.3;

impl TwoStageStrut {
    fn settled(&self, recording: usize) -> usize {
        (SETTLED_S / self.recordings[recording].interval_s().max(1e-6)).ceil() as usize
    }

    fn held(&self, recording: usize, sample: usize, valve: usize, open: bool) -> bool {
        let from = sample.saturating_sub(self.settled(recording));
        self.inputs[recording].signals[from..=sample]
            .iter()
            .all(|s| s[valve] == open)
    }

    /// Time since the last switching edge, s; the time itself before the first.
    fn since_edge(&self, recording: usize) -> Option<Vec<f64>> {
        let (time, signals) = (&self.recordings[recording].time_s, &self.inputs[recording].signals);
        signals.windows(2).any(|w| w[0] != w[1]).then(|| {
            let mut edge = f64::NEG_INFINITY;
            (0..time.len())
                .map(|k| {
                    if k > 0 && signals[k] != signals[k - 1] {
                        edge = time[k];
                    }
                    (time[k] - edge).min(9.0)
                })
                .collect()
        })
    }
}

fn calibration(model: &StrutModel) -> (Vec<Calibration>, Vec<Parameter>) {
    let tolerance = |key: &str| model.tolerance.get(key).copied().filter(|t| *t > 0.0);
    let mut out = Vec::new();
    let mut add = |what: Calibration, key: String, tolerance: Option<f64>| {
        if let Some(t) = tolerance {
            let parameter = Parameter::calibration(key, t);
            let instrument = matches!(what, Calibration::Offset(i) if i > 0);
            out.push((
                what,
                if instrument {
                    parameter.on_instrument()
                } else {
                    parameter
                },
            ));
        }
    };
    for i in 0..2 {
        add(
            Calibration::GasVolume(i),
            format!("static_gas_volume_{}", i + 1),
            tolerance("static_gas_volume"),
        );
    }
    add(
        Calibration::StaticPressure,
        "static_pressure".into(),
        tolerance("static_pressure"),
    );
    for i in 0..3 {
        add(
            Calibration::Flow(i),
            format!("flow_coefficient_{}", i + 1),
            tolerance("flow_coefficient"),
        );
    }
    // Also where the oil is believed rigid: its volume matters as soon as it is not.
    add(Calibration::OilVolume, "oil_volume".into(), tolerance("oil_volume"));
    if model.effects.oil_compressibility.is_some() {
        add(
            Calibration::BulkModulus,
            "bulk_modulus".into(),
            tolerance("bulk_modulus"),
        );
    }
    if model.effects.gas_heat_transfer.is_some() {
        for i in 0..2 {
            add(
                Calibration::TimeConstant(i),
                format!("time_constant_{}", i + 1),
                tolerance("time_constant"),
            );
        }
    }
    // An ideal gas at ambient temperature has the same pressures at any ambient temperature.
    if model.effects.real_gas.is_some() {
        add(
            Calibration::Temperature,
            "temperature_K".into(),
            tolerance("temperature_K"),
        );
    }
    add(
        Calibration::Offset(0),
        "displacement_offset_m".into(),
        tolerance("displacement_offset_m"),
    );
    add(
        Calibration::Offset(1),
        "force_offset_N".into(),
        tolerance("force_offset_N"),
    );
    for (i, column) in COLUMNS.iter().enumerate().skip(2) {
        add(
            Calibration::Offset(i),
            format!("{column} offset"),
            tolerance("pressure_offset_Pa"),
        );
    }
    out.into_iter().unzip()
}

impl Specimen for TwoStageStrut {
    fn kind(&self) -> &'static str {
        "two-stage hydropneumatic strut"
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
    fn measured(&self, recording: usize, channel: usize) -> &[f64] {
        &self.recordings[recording].columns[1 + channel]
    }
    fn calibration(&self) -> &[Parameter] {
        &self.parameters
    }
    fn candidates(&self) -> &[Candidate] {
        &self.candidates
    }

    fn simulate(&self, hypothesis: &Hypothesis, recording: usize) -> Result<Series, String> {
        let mut model = self.applied(hypothesis);
        keep_displacement_faults(&mut model.effects);
        let p = replay(&model, &self.inputs[recording]).map_err(|e| e.to_string())?;
        let [p1, p2, p3, p4] = p.pressure_pa;
        let series = vec![p.force_n, p1, p2, p3, p4];
        if series.iter().all(|s| s.iter().all(|v| v.is_finite())) {
            Ok(series)
        } else {
            Err("the model ran to values that are not numbers".to_owned())
        }
    }

    fn observe(&self, hypothesis: &Hypothesis, recording: usize, truth: &Series) -> Series {
        let effects = self.applied(hypothesis).effects;
        let time_s = &self.recordings[recording].time_s;
        let mut shown = truth.clone();
        for (column, series) in CHANNELS.iter().zip(&mut shown) {
            record_column(&effects, column, time_s, series);
        }
        shown
    }

    fn noise_floor(&self, hypothesis: &Hypothesis) -> f64 {
        let model = self.applied(hypothesis);
        let noise = model.noise.get("displacement_m").copied().unwrap_or(0.0);
        let jittered = self
            .jittered
            .get_or_init(|| (self.inputs.par_iter()).map(|i| floor::jittered(i, noise)).collect());
        let excesses: Vec<(f64, usize)> = (self.inputs.par_iter())
            .zip(jittered)
            .filter_map(|(as_is, jittered)| floor::excess(&model, as_is, jittered, &self.channels))
            .collect();
        // Summed in order, so that the figure has the same bits on any number of threads.
        let (sum, count) = (excesses.iter()).fold((0.0, 0), |(sum, count), (s, c)| (sum + s, count + c));
        (1.0 + sum / count.max(1) as f64).sqrt()
    }

    fn model_toml(&self, hypothesis: &Hypothesis) -> Result<String, String> {
        Ok(self.applied(hypothesis).to_toml())
    }

    fn law(&self, candidate: usize, values: &[f64]) -> Option<serde_json::Value> {
        let law = laws::law(&self.candidates[candidate].label, values)?;
        serde_json::to_value(law).ok()
    }

    fn piston_area_m2(&self) -> Option<f64> {
        Some(self.model.piston_area_m2())
    }

    fn quiet(&self, recording: usize, sample: usize, speed_m_s: f64) -> bool {
        let segments = &self.inputs[recording].motion.segments;
        let back = self.settled(recording);
        sample >= back
            && segments[sample - back..sample]
                .iter()
                .all(|s| s.to_m_s.abs() < speed_m_s)
    }

    fn valve_open(&self, recording: usize, sample: usize, valve: usize) -> bool {
        self.held(recording, sample, valve, true)
    }

    fn valve_shut(&self, recording: usize, sample: usize, valve: usize) -> bool {
        self.held(recording, sample, valve, false)
    }

    fn states(&self, recording: usize) -> Vec<StateSeries> {
        let r = &self.recordings[recording];
        let motion = &self.inputs[recording].motion;
        let mut speed: Vec<f64> = motion.segments.iter().map(|s| s.to_m_s).collect();
        speed.insert(0, 0.0);
        let across = |a: usize, b: usize| r.columns[a].iter().zip(&r.columns[b]).map(|(a, b)| a - b).collect();
        let mut states = vec![
            StateSeries::new(State::Displacement, r.columns[0].clone()),
            StateSeries::new(State::Speed, speed),
            StateSeries::new(State::P1, r.columns[2].clone()),
            StateSeries::new(State::P1MinusP2, across(2, 3)),
            StateSeries::new(State::P1MinusP3, across(2, 4)),
            StateSeries::new(State::P3MinusP4, across(4, 5)),
        ];
        if let Some(since) = self.since_edge(recording) {
            states.push(StateSeries::new(State::TimeSinceSwitching, since));
        }
        states
    }
}

/// Faults of the displacement sensor change the motion; all other instruments are applied afterwards.
fn keep_displacement_faults(effects: &mut Effects) {
    for fault in [
        &mut effects.sensor_lag,
        &mut effects.sensor_gain,
        &mut effects.sensor_drift,
        &mut effects.sensor_skew,
        &mut effects.sensor_sign,
        &mut effects.sensor_offset,
    ]
    .into_iter()
    .flatten()
    {
        fault.retain(|column, _| column == COLUMNS[0]);
    }
}
