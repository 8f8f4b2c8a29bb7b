//! The two-stage hydropneumatic strut: the belief as a [`StrutModel`] and five compared channels.

mod beginning;
mod calibration;
mod candidates;
mod channels;
mod drawing;
mod floor;
mod heating;
mod in_vehicle;
mod relations;
mod rod_memory;
mod unknown_motion;
mod unread;

use std::sync::OnceLock;

use oleo_interface::{StrutValves, Valve};
use oleo_plant_sim::model_file::InvalidValue;
use oleo_plant_sim::strut::{Beginning, COLUMNS, Inputs, OilCount, Prediction, StrutModel, record_column};
use rayon::prelude::*;

use calibration::Calibration;
use candidates::candidates;
pub use channels::{CHANNELS, columns};
use channels::{FORCE, Layout, P1, P2, P3, P4};
use relations::Measured;
use rod_memory::{RodMemory, Wanted};
use unknown_motion::UnknownMotion;

use super::channel::{Channel, Series, StateSeries};
use super::contract::{BelievedModel, Specimen};
use super::hypothesis::Hypothesis;
use super::relation::MeasuredRelation;
use crate::effect::{Candidate, of, unlisted};
use crate::error::DiagnoseError;
use crate::excitation;
use crate::instrument::{Examined, Finding, Flaw, Stated};
use crate::parameter::Parameter;
use crate::recording::{ColumnSpec, GapPolicy, Recording};
use crate::vocabulary::SpecimenKind;
use crate::vocabulary::{Branch, Column, EffectId, Place, Site, State};

/// Fewest channels of [`CHANNELS`] from which a strut is diagnosed: with fewer an effect and its rivals look alike.
pub const FEWEST_CHANNELS: usize = 4;

/// Noise ratio that a complete model reaches where the motion is poorly known. What it leaves unknown is counted as noise, and the size of
/// that noise, taken from one other draw, is known to about a fifth of its variance.
const FLOOR_OF_POOR_MOTION: f64 = 1.1;

/// Simulations that a thread is given at once: some for each lane of the processor's vectors.
const SIMULATIONS_AT_ONCE: usize = 16;

/// Why a candidate is not tested that somebody left out.
const LEFT_OUT: &str = "left out of the search";

/// A strut with its recordings.
pub struct TwoStageStrut {
    model: StrutModel,
    recordings: Vec<Recording>,
    layout: Layout,
    /// Of a strut in a vehicle, what its motion leaves unknown.
    unknown_motion: Option<UnknownMotion>,
    inputs: Vec<Inputs>,
    channels: Vec<Channel>,
    /// The density at which oil is counted whose compressibility the believed model lacks.
    found_oil_counted_at: OilCount,
    /// How each recording begins, as it was read.
    begins: Vec<Beginning>,
    calibration: Vec<Calibration>,
    /// What is not known of the beginnings; its parameters follow those of the calibration.
    unknown_beginnings: Vec<beginning::Unknown>,
    parameters: Vec<Parameter>,
    candidates: Vec<Candidate>,
    /// What the recordings say of the instruments, by which residuals are judged.
    instruments: Examined,
    /// The inputs with displacement noise once more; made when somebody asks for the floor.
    jittered: OnceLock<Vec<Inputs>>,
    /// Simulations of each recording that are wanted again.
    memories: Vec<RodMemory>,
}

impl TwoStageStrut {
    /// Puts model and recordings together. The recordings have all columns; a channel of which none holds a reading (only NaN) is
    /// not recorded, and is not compared. What the instruments do beside what the model states is looked for, and counted.
    ///
    /// # Errors
    /// A model whose numbers are impossible, or that states no noise for a channel; fewer than [`FEWEST_CHANNELS`] channels.
    pub fn new(model: StrutModel, mut recordings: Vec<Recording>) -> Result<Self, String> {
        let layout = Layout::of_readings(&recordings);
        if layout.channels().len() < FEWEST_CHANNELS {
            let missing: Vec<&str> = layout.unrecorded().collect();
            return Err(format!(
                "the recordings hold no {}: record at least {FEWEST_CHANNELS} of {}",
                missing.join(", "),
                CHANNELS.join(", ")
            ));
        }
        recordings.iter_mut().for_each(|r| layout.without_unrecorded(r));
        let mut instruments = Examined::of(&mut recordings, &stated_noise(&model, layout));
        let absent = layout.unrecorded().map(|name| Finding {
            column: Some(Column::known(name)),
            flaw: Flaw::NotRecorded,
        });
        instruments.findings.splice(0..0, absent);
        let inputs = (recordings.par_iter().enumerate())
            .map(|(k, r)| smoothed(&r.time_s, &r.columns[0], &layout.signals(r), &instruments, k))
            .collect();
        let begins = vec![Beginning::AtRest; recordings.len()];
        let mut strut = Self::with_layout(model, recordings, inputs, begins, layout, instruments)?;
        strut.count_poor_motion();
        strut.take_out_more_spikes();
        Ok(strut)
    }

    /// Counts as noise what a poorly measured motion leaves unknown of the other channels: the difference that another draw of its noise
    /// makes in the believed model.
    fn count_poor_motion(&mut self) {
        if !self.instruments.motion_is_poor {
            return;
        }
        let drawn: Vec<Option<Series>> = (0..self.inputs.len())
            .into_par_iter()
            .map(|r| {
                floor::differences(
                    &self.model,
                    [&self.inputs[r], &self.jittered()[r]],
                    &self.begins[r],
                    self.layout,
                )
            })
            .collect();
        for (r, differences) in drawn.iter().enumerate() {
            for (c, series) in differences.iter().flatten().enumerate() {
                self.instruments.add_noise(r, 1 + c, &floor::local_deviation(series));
            }
        }
    }

    /// Takes out the spikes that the motion hid.
    fn take_out_more_spikes(&mut self) {
        let has_spikes = |f: &Finding| matches!(f.flaw, Flaw::Spikes { .. });
        if !self.instruments.findings.iter().any(has_spikes) {
            return;
        }
        let believed = self.as_given();
        let simulated: Vec<Option<Series>> = (0..self.recordings.len())
            .into_par_iter()
            .map(|r| self.simulate(&believed, r).ok())
            .collect();
        self.instruments
            .take_out_spikes_beside(&mut self.recordings, &simulated);
    }

    /// The model as it is given.
    fn as_given(&self) -> Hypothesis {
        Hypothesis {
            calibration: self.parameters.iter().map(|p| p.start).collect(),
            effects: vec![],
        }
    }

    /// The inputs with the noise of the displacement once more.
    fn jittered(&self) -> &[Inputs] {
        self.jittered.get_or_init(|| {
            let instruments = &self.instruments;
            (self.inputs.par_iter().enumerate())
                .map(|(k, inputs)| {
                    let uneven = instruments.noise_of_moving_samples(k);
                    let even = instruments.noise_of_motion[k];
                    let noise = |sample: usize| uneven.as_ref().map_or(even, |noise| noise[sample]);
                    let drawn = floor::drawn_again(inputs, &noise, instruments.step_of_motion);
                    smoothed(&inputs.time_s, &drawn, &inputs.signals, instruments, k)
                })
                .collect()
        })
    }

    fn with_layout(
        model: StrutModel,
        recordings: Vec<Recording>,
        inputs: Vec<Inputs>,
        begins: Vec<Beginning>,
        layout: Layout,
        instruments: Examined,
    ) -> Result<Self, String> {
        let mut channels: Vec<Channel> = (layout.channels().into_iter())
            .map(|c| Channel::of(Column::known(c), &model.noise))
            .collect::<Result<_, _>>()
            .map_err(|invalid| invalid.to_string())?;
        for (channel, noise) in channels.iter_mut().zip(instruments.noise.iter().skip(1)) {
            channel.noise = *noise;
        }
        let displacement_noise = displacement_noise(&model);
        let noises = [P3, P4].map(|c| layout.has(c).then(|| channels[layout.channel(c)].noise));
        let pressure_noise = noises.into_iter().flatten().fold(0.0, f64::max);
        let (calibration, mut parameters) = calibration::of(&model, layout);
        let mut unknown_beginnings = Vec::new();
        if begins.iter().any(|begins| *begins != Beginning::AtRest) {
            let (unknowns, their_parameters) = beginning::unknowns(&recordings, &model);
            unknown_beginnings = unknowns;
            parameters.extend(their_parameters);
        }
        let mut strut = Self {
            model,
            recordings,
            layout,
            unknown_motion: None,
            inputs,
            channels,
            found_oil_counted_at: OilCount::default(),
            begins,
            calibration,
            unknown_beginnings,
            parameters,
            candidates: vec![],
            instruments,
            jittered: OnceLock::new(),
            memories: vec![],
        };
        strut.memories.resize_with(strut.inputs.len(), RodMemory::default);
        let excited = |recordings: &[Recording], layout: Layout| {
            let columns = excitation::StrutColumns {
                channels: std::array::from_fn(|c| layout.has(c).then(|| layout.column(c))),
                valves: layout.valves(),
            };
            excitation::Strut::of(recordings, &columns, pressure_noise, displacement_noise)
        };
        let believed = excited(&strut.as_believed()?, Layout::RIG);
        let excitation = excitation::Strut::of_measured_or_believed(excited(&strut.recordings, layout), &believed);
        strut.candidates = candidates(&strut.model, &excitation, layout);
        Ok(strut)
    }

    /// The recordings as the believed model would have them, with all columns. A recording that it cannot simulate is left out.
    ///
    /// # Errors
    /// A model that cannot simulate the first recording (that cannot even stand still), with the model's own words.
    fn as_believed(&self) -> Result<Vec<Recording>, String> {
        let believed = self.as_given();
        let simulated: Vec<Result<Series, String>> = (0..self.recordings.len())
            .into_par_iter()
            .flat_map_iter(|r| self.all_channels(&[(&believed, r)]))
            .collect();
        let mut all = Vec::with_capacity(simulated.len());
        for (k, (recording, simulated)) in self.recordings.iter().zip(simulated).enumerate() {
            match simulated {
                Ok(channels) => {
                    let mut recording = recording.clone();
                    recording.columns.splice(1..self.layout.valves(), channels);
                    all.push(recording);
                }
                Err(why) if k == 0 => return Err(why),
                Err(_) => {}
            }
        }
        Ok(all)
    }

    /// Takes a term out of the search, to see what is said of it without its name (self-test).
    pub fn leave_out(&mut self, id: EffectId) {
        for candidate in self.candidates.iter_mut().filter(|c| c.id == id) {
            candidate.untestable = Some(LEFT_OUT.to_owned());
        }
    }

    /// Leaves all candidates out of the search but those at these places of [`Specimen::candidates`].
    pub fn search_only(&mut self, places: &[usize]) {
        for (place, candidate) in self.candidates.iter_mut().enumerate() {
            if !places.contains(&place) {
                candidate.untestable.get_or_insert_with(|| LEFT_OUT.to_owned());
            }
        }
    }

    /// The model under a hypothesis, instruments included.
    #[must_use]
    pub fn applied(&self, hypothesis: &Hypothesis) -> StrutModel {
        let mut model = self.model.clone();
        for (what, &value) in self.calibration.iter().zip(&hypothesis.calibration) {
            what.apply(&mut model, value);
        }
        for (index, values) in &hypothesis.effects {
            let candidate = &self.candidates[*index];
            if let Some(effect) = of(candidate.id).in_strut() {
                effect.put(&mut model, candidate, values);
            }
        }
        if self.model.effects.oil_compressibility.is_none()
            && let Some(found) = &mut model.effects.oil_compressibility
        {
            found.counted_at = self.found_oil_counted_at;
        }
        model
    }

    /// How a recording begins under a hypothesis, whose model with its instruments is given.
    fn beginning(&self, hypothesis: &Hypothesis, model: &StrutModel, recording: usize) -> Beginning {
        let mut begins = beginning::behind_readings(self.begins[recording], &model.effects);
        let values = hypothesis.calibration.iter().skip(self.calibration.len());
        for (unknown, &value) in self.unknown_beginnings.iter().zip(values) {
            unknown.apply(recording, &mut begins, value);
        }
        begins
    }

    /// All of [`CHANNELS`] under hypotheses and of recordings, also those that are not recorded.
    fn all_channels(&self, wanted: &[(&Hypothesis, usize)]) -> Vec<Result<Series, String>> {
        let models: Vec<(StrutModel, Beginning)> = (wanted.iter())
            .map(|&(hypothesis, recording)| {
                let mut model = self.applied(hypothesis);
                let begins = self.beginning(hypothesis, &model, recording);
                // Faults of the displacement sensor change the motion; all other instruments are applied afterwards.
                model.effects.retain_sensor_faults(|column| column == COLUMNS[0]);
                (model, begins)
            })
            .collect();
        let replays: Vec<Wanted<'_>> = (models.iter().zip(wanted))
            .map(|((model, begins), &(_, recording))| Wanted {
                memory: &self.memories[recording],
                model,
                inputs: &self.inputs[recording],
                begins: *begins,
            })
            .collect();
        let predicted = rod_memory::replay_all(&replays);
        (predicted.into_iter())
            .map(|p| finite_channels(p.map_err(|e| e.to_string())?))
            .collect()
    }

    /// What was measured, for relations that need no model.
    fn as_measured(&self) -> Measured<'_> {
        let area = self.model.piston_area_m2();
        Measured::new(&self.recordings, &self.inputs, self.layout, &self.channels, area)
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

/// All of [`CHANNELS`], if they are numbers.
fn finite_channels(predicted: Prediction) -> Result<Series, String> {
    let [p1, p2, p3, p4] = predicted.pressure_pa;
    let series = vec![predicted.force_n, p1, p2, p3, p4];
    if series.iter().all(|s| s.iter().all(|v| v.is_finite())) {
        Ok(series)
    } else {
        Err("the simulation diverged to values that are not numbers".to_owned())
    }
}

impl BelievedModel for StrutModel {
    fn columns(&self) -> Vec<ColumnSpec> {
        columns()
    }

    fn check_noise(&self) -> Result<(), InvalidValue> {
        self.check_noise_is_complete()
    }

    fn gap_policy(&self) -> GapPolicy {
        GapPolicy::Cut
    }

    fn with_recordings(self: Box<Self>, recordings: Vec<Recording>) -> Result<Box<dyn Specimen>, DiagnoseError> {
        let strut = TwoStageStrut::new(*self, recordings).map_err(DiagnoseError::Model)?;
        Ok(Box::new(strut))
    }
}

impl Specimen for TwoStageStrut {
    fn kind(&self) -> SpecimenKind {
        SpecimenKind::TwoStageStrut
    }
    fn recordings(&self) -> &[Recording] {
        &self.recordings
    }
    fn channels(&self) -> &[Channel] {
        &self.channels
    }
    fn calibration(&self) -> &[Parameter] {
        &self.parameters
    }
    fn candidates(&self) -> &[Candidate] {
        &self.candidates
    }

    fn simulate(&self, hypothesis: &Hypothesis, recording: usize) -> Result<Series, String> {
        self.simulate_all(&[(hypothesis, recording)]).swap_remove(0)
    }

    fn simulate_all(&self, wanted: &[(&Hypothesis, usize)]) -> Vec<Result<Series, String>> {
        (self.all_channels(wanted).into_iter())
            .map(|channels| Ok(self.layout.recorded(channels?)))
            .collect()
    }

    fn simulations_at_once(&self) -> usize {
        SIMULATIONS_AT_ONCE
    }

    fn observe(&self, hypothesis: &Hypothesis, recording: usize, truth: &Series) -> Series {
        let effects = self.applied(hypothesis).effects;
        let time_s = &self.recordings[recording].time_s;
        let mut shown = truth.clone();
        for (column, series) in self.layout.channels().into_iter().zip(&mut shown) {
            record_column(&effects, column, time_s, series);
        }
        shown
    }

    fn noise_floor(&self, hypothesis: &Hypothesis) -> f64 {
        if let Some(motion) = &self.unknown_motion {
            return self.floor_of_unknown_motion(motion, hypothesis);
        }
        if self.instruments.motion_is_poor {
            return FLOOR_OF_POOR_MOTION;
        }
        let model = self.applied(hypothesis);
        let pairs: Vec<[&Inputs; 2]> = (self.inputs.iter().zip(self.jittered()))
            .map(|(as_is, jittered)| [as_is, jittered])
            .collect();
        let excesses: Vec<Option<(f64, usize)>> = (pairs.par_chunks(SIMULATIONS_AT_ONCE / 4))
            .flat_map_iter(|pairs| floor::excesses(&model, pairs, self.layout, &self.channels))
            .collect();
        // Summed in order, so that the figure has the same bits on any number of threads.
        let (sum, count) = (excesses.iter().flatten()).fold((0.0, 0), |(sum, count), (s, c)| (sum + s, count + c));
        (1.0 + sum / count.max(1) as f64).sqrt()
    }

    fn relative_noise(&self, recording: usize, channel: usize) -> Option<&[f64]> {
        self.instruments.relative(recording, 1 + channel)
    }

    fn instruments(&self) -> &[Finding] {
        &self.instruments.findings
    }

    fn model_toml(&self, hypothesis: &Hypothesis) -> Result<String, String> {
        Ok(self.applied(hypothesis).to_toml())
    }

    fn law(&self, candidate: usize, values: &[f64]) -> Option<serde_json::Value> {
        let law = unlisted::table(&self.candidates[candidate].label, values)?;
        serde_json::to_value(law).ok()
    }

    fn inputs_in_words(&self) -> &'static str {
        "displacement and switching signals"
    }

    fn is_believed_complete(&self) -> bool {
        true
    }

    fn measured_relations(&self) -> Vec<MeasuredRelation> {
        self.as_measured().relations()
    }

    fn settings(&self, recording: usize, sample: usize) -> Vec<String> {
        self.as_measured().settings(recording, sample)
    }

    fn nearest_channels(&self, place: &Place) -> Vec<Column> {
        let known = |channels: &[usize]| {
            let recorded = channels.iter().filter(|&&c| self.layout.has(c));
            recorded.map(|&c| Column::known(CHANNELS[c])).collect()
        };
        match &place.site {
            Site::MainSeal | Site::EndStop => known(&[FORCE]),
            Site::MainChamber => known(&[P1]),
            Site::Accumulator(Branch::First) => known(&[P2]),
            Site::Accumulator(Branch::Second) => known(&[P4]),
            Site::Path(Branch::First) => known(&[P1, P2]),
            Site::Path(Branch::Second) | Site::Valve(Valve::Spring) => known(&[P3, P4]),
            Site::Sensor(column) => vec![column.clone()],
            _ => vec![],
        }
    }

    fn drawing(&self, found: &[&Place]) -> Option<String> {
        Some(drawing::drawing(found))
    }

    fn states(&self, recording: usize) -> Vec<StateSeries> {
        let r = &self.recordings[recording];
        let motion = &self.inputs[recording].motion;
        let mut speed: Vec<f64> = motion.segments.iter().map(|s| s.to_m_s).collect();
        speed.insert(0, 0.0);
        let column = |channel: usize| (self.layout.has(channel)).then(|| &r.columns[self.layout.column(channel)]);
        let across = |state: State, a: usize, b: usize| {
            let difference = column(a)?.iter().zip(column(b)?).map(|(a, b)| a - b).collect();
            Some(StateSeries::new(state, difference))
        };
        let mut states = vec![
            StateSeries::new(State::Displacement, r.columns[0].clone()),
            StateSeries::new(State::Speed, speed),
        ];
        states.extend(column(P1).map(|p1| StateSeries::new(State::P1, p1.clone())));
        states.extend(across(State::P1MinusP2, P1, P2));
        states.extend(across(State::P1MinusP3, P1, P3));
        states.extend(across(State::P3MinusP4, P3, P4));
        if let Some(since) = self.since_edge(recording) {
            states.push(StateSeries::new(State::TimeSinceSwitching, since));
        }
        states
    }
}

/// The inputs of a recording, its displacement smoothed by what is known of its noise.
fn smoothed(
    time_s: &[f64],
    displacement_m: &[f64],
    signals: &[StrutValves<bool>],
    instruments: &Examined,
    recording: usize,
) -> Inputs {
    match instruments.noise_of_moving_samples(recording) {
        Some(noise) => Inputs::from_uneven_recording(time_s, displacement_m, signals, &noise),
        None => Inputs::from_recording(time_s, displacement_m, signals, instruments.noise_of_motion[recording]),
    }
}

/// The displacement and the compared channels, with the noise that a model states.
fn stated_noise(model: &StrutModel, layout: Layout) -> Vec<Stated> {
    (std::iter::once(COLUMNS[0]).chain(layout.channels()))
        .map(|name| Stated {
            column: Column::known(name),
            noise: model.noise.get(name).copied().unwrap_or(0.0),
        })
        .collect()
}

fn displacement_noise(model: &StrutModel) -> f64 {
    model.noise.get(COLUMNS[0]).copied().unwrap_or(0.0)
}
