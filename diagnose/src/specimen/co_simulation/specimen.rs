//! A model with recordings, as a specimen.

use oleo_plant_sim::specimen::smooth_motion;

use super::map::Instant;
use super::model::{Calibrated, CoSimulationModel};
use super::simulator::{Course, Driven, Role};
use super::stepping::Times;
use crate::correction::{Corrections, Law, Quantity, Target, moved_since_turned};
use crate::effect::{Candidate, of};
use crate::excitation::spread;
use crate::parameter::Parameter;
use crate::recording::Recording;
use crate::specimen::channel::{Channel, Series, StateSeries};
use crate::specimen::contract::Specimen;
use crate::specimen::hypothesis::Hypothesis;
use crate::vocabulary::{Column, Place, Site, SpecimenKind, State};

/// Half-width of the window over which the rate of an input is taken for laws that depend on it, in sampling intervals: five samples, where the map
/// asks for no smoothing.
const RATE_WINDOW: f64 = 2.5;
/// Name of the file of an improved map.
const MAP_FILE: &str = "map.toml";

/// A recorded input over all recordings.
pub(super) struct InputColumn {
    pub name: String,
    pub switches: bool,
}

/// A model with recordings.
pub(super) struct CoSimulation {
    pub model: CoSimulationModel,
    pub recordings: Vec<Recording>,
    pub times: Vec<Times>,
    pub channels: Vec<Channel>,
    /// Recorded inputs, in the order of their columns.
    pub inputs: Vec<InputColumn>,
    /// Rates of the inputs of each recording; of what switches empty.
    pub rates: Vec<Series>,
    /// What the model gives as it is stated, recording by recording.
    pub as_stated: Vec<Series>,
    pub calibration: Vec<Parameter>,
    pub candidates: Vec<Candidate>,
}

impl CoSimulation {
    /// Finds which inputs switch, and the rates of the others.
    pub fn look_at_inputs(&mut self) {
        let first = self.channels.len();
        let sources: Vec<String> = self.model.map.sources().into_iter().map(str::to_owned).collect();
        self.inputs = (sources.into_iter().enumerate())
            .map(|(k, name)| InputColumn {
                name,
                switches: (self.recordings.iter())
                    .all(|r| r.columns[first + k].iter().all(|value| *value == 0.0 || *value == 1.0)),
            })
            .collect();
        self.rates = (self.recordings.iter())
            .map(|recording| {
                let shortest = RATE_WINDOW * recording.interval_s();
                (self.inputs.iter().zip(&recording.columns[first..]))
                    .map(|(input, column)| match input.switches {
                        true => vec![],
                        false => {
                            let window = self.model.map.smoothed_s(&input.name).max(shortest);
                            smooth_motion(&recording.time_s, column, window).speed_m_s
                        }
                    })
                    .collect()
            })
            .collect();
    }

    /// What is added from outside under a hypothesis.
    pub fn corrections(&self, hypothesis: &Hypothesis) -> Corrections {
        let mut corrections = self.model.map.effects.clone();
        for (index, values) in &hypothesis.effects {
            let candidate = &self.candidates[*index];
            if let Some(effect) = of(candidate.id).in_co_simulation() {
                effect.put(&mut corrections, candidate, values);
            }
        }
        corrections
    }

    /// The samples of a quantity; `None` where it is not known. `simulated` are the channels as the model gives them.
    pub fn quantity(&self, quantity: &Quantity, recording: usize, simulated: &[Vec<f64>]) -> Option<Vec<f64>> {
        let input = |name: &str| self.inputs.iter().position(|input| input.name == name);
        Some(match quantity {
            Quantity::Time => self.times[recording].samples_s.clone(),
            Quantity::Input(name) => self.recordings[recording].columns[self.channels.len() + input(name)?].clone(),
            Quantity::SinceTurned(name, most) => {
                let column = &self.recordings[recording].columns[self.channels.len() + input(name)?];
                moved_since_turned(column, *most)
            }
            Quantity::Rate(name) => self.rates[recording][input(name)?].clone(),
            Quantity::Simulated(name) => {
                let channel = self
                    .channels
                    .iter()
                    .position(|channel| channel.column == name.as_str())?;
                simulated.get(channel)?.clone()
            }
        })
        .filter(|values| !values.is_empty())
    }

    /// The samples of a law's value.
    fn law(&self, law: &Law, recording: usize, simulated: &[Vec<f64>]) -> Option<Vec<f64>> {
        let argument = self.quantity(&law.over, recording, simulated)?;
        Some(argument.into_iter().map(|argument| law.value_at(argument)).collect())
    }

    /// The true samples of a recorded input.
    fn true_input(&self, corrections: &Corrections, recording: usize, name: &str) -> Vec<f64> {
        let recorded = &self.recordings[recording];
        let position = self
            .inputs
            .iter()
            .position(|input| input.name == name)
            .unwrap_or_default();
        let shown = &recorded.columns[self.channels.len() + position];
        let mut truth = corrections.undo(name, &recorded.time_s, shown);
        for law in corrections.laws_at(Target::Input, name) {
            if let Some(added) = self.law(law, recording, &[]) {
                truth.iter_mut().zip(added).for_each(|(value, added)| *value += added);
            }
        }
        truth
    }

    /// What is simulated of a recording under a hypothesis.
    pub fn course(&self, hypothesis: &Hypothesis, corrections: &Corrections, recording: usize) -> Course {
        let (model, times) = (&self.model, &self.times[recording]);
        let variables = model.simulator.variables();
        let columns: Vec<Vec<f64>> = (self.inputs.iter())
            .map(|input| self.true_input(corrections, recording, &input.name))
            .collect();
        let mut driven: Vec<Driven> = (model.map.inputs.iter())
            .map(|(name, input)| {
                let source = self.inputs.iter().position(|column| column.name == input.source());
                let source = source.unwrap_or_default();
                let variable = model.variable(name);
                let smoothed = input.smooth_s.map(|width| {
                    smooth_motion(&self.recordings[recording].time_s, &columns[source], width).displacement_m
                });
                let column = smoothed.as_ref().unwrap_or(&columns[source]);
                let (during, at) = if input.rate_of.is_some() {
                    times.rate(column)
                } else {
                    let switches = self.inputs[source].switches || !variables[variable].is_real;
                    let usual = if switches { Instant::Begin } else { Instant::Middle };
                    times.driven(column, switches, input.at.unwrap_or(usual))
                };
                let off = model.deviation(Calibrated::InputOffset(name), hypothesis);
                let (factor, offset) = (input.factor.unwrap_or(1.0), input.offset.unwrap_or(0.0) + off);
                let in_its_unit = |values: Vec<f64>| values.iter().map(|value| factor * value + offset).collect();
                Driven {
                    variable,
                    during: in_its_unit(during),
                    at: in_its_unit(at),
                }
            })
            .collect();
        let mut starts = Vec::new();
        for (name, setting) in &model.map.parameters {
            let first = setting
                .first_of
                .as_ref()
                .and_then(|column| self.first(recording, column));
            // What the model alone knows is left to it.
            let Some(stated) = first.or_else(|| model.stated(name)) else {
                continue;
            };
            let value = model.calibrated_value(name, stated, hypothesis);
            let variable = model.variable(name);
            starts.push((variable, value));
            let mut factor: Option<Vec<f64>> = None;
            for law in corrections.laws_at(Target::Parameter, name) {
                if let Some(of_law) = self.law(law, recording, &[]) {
                    let all = factor.get_or_insert_with(|| vec![1.0; of_law.len()]);
                    all.iter_mut().zip(of_law).for_each(|(all, of_law)| *all *= of_law);
                }
            }
            if let Some(factor) = factor {
                let (during, at) = times.driven(&factor, false, Instant::Middle);
                let scaled = |factors: Vec<f64>| factors.iter().map(|factor| value * factor).collect();
                driven.push(Driven {
                    variable,
                    during: scaled(during),
                    at: scaled(at),
                });
            }
        }
        Course {
            times_s: times.model_s.clone(),
            starts,
            driven,
            outputs: model.map.outputs.keys().map(|name| model.variable(name)).collect(),
        }
    }

    /// The first sample of a column.
    fn first(&self, recording: usize, column: &str) -> Option<f64> {
        let channel = self.channels.iter().position(|channel| channel.column == column);
        let input = || self.inputs.iter().position(|input| input.name == column);
        let position = channel.or_else(|| Some(self.channels.len() + input()?))?;
        self.recordings[recording].columns[position].first().copied()
    }

    /// The largest spread of a column within a recording.
    pub fn spread(&self, position: usize) -> f64 {
        let spreads = self
            .recordings
            .iter()
            .map(|recording| spread(&recording.columns[position]));
        spreads.fold(0.0, f64::max)
    }

    /// What residuals are shown over, and whether it has only two values.
    pub fn shown_quantities(&self) -> Vec<(Quantity, bool)> {
        let inputs = (self.inputs.iter()).map(|input| (Quantity::Input(input.name.clone()), input.switches));
        let moving = self.inputs.iter().filter(|input| !input.switches);
        let rates = moving.map(|input| (Quantity::Rate(input.name.clone()), false));
        let simulated = (self.channels.iter()).map(|c| (Quantity::Simulated(c.column.to_string()), false));
        inputs.chain(rates).chain(simulated).collect()
    }
}

impl Specimen for CoSimulation {
    fn kind(&self) -> SpecimenKind {
        SpecimenKind::CoSimulation
    }

    fn recordings(&self) -> &[Recording] {
        &self.recordings
    }

    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn measured(&self, recording: usize, channel: usize) -> &[f64] {
        // A model may have no input, so that the compared columns are the first.
        &self.recordings[recording].columns[channel]
    }

    fn calibration(&self) -> &[Parameter] {
        &self.calibration
    }

    fn candidates(&self) -> &[Candidate] {
        &self.candidates
    }

    fn simulate(&self, hypothesis: &Hypothesis, recording: usize) -> Result<Series, String> {
        let course = self.course(hypothesis, &self.corrections(hypothesis), recording);
        let outputs = (self.model.simulator).simulate(&self.recordings[recording].name, &course)?;
        Ok((self.model.map.outputs.values().zip(outputs))
            .map(|(output, values)| {
                let factor = output.factor.unwrap_or(1.0);
                let mut values = self.times[recording].at_samples(&values);
                values.iter_mut().for_each(|value| *value *= factor);
                values
            })
            .collect())
    }

    fn observe(&self, hypothesis: &Hypothesis, recording: usize, truth: &Series) -> Series {
        let corrections = self.corrections(hypothesis);
        let time_s = &self.recordings[recording].time_s;
        (self.channels.iter().zip(self.model.map.outputs.values()).zip(truth))
            .map(|((channel, output), truth_of_channel)| {
                let mut shown = truth_of_channel.clone();
                for law in corrections.laws_at(Target::Output, channel.column.as_str()) {
                    if let Some(added) = self.law(law, recording, truth) {
                        shown.iter_mut().zip(added).for_each(|(value, added)| *value += added);
                    }
                }
                corrections.show(channel.column.as_str(), time_s, &mut shown);
                let off = (self.model).deviation(Calibrated::OutputOffset(&output.column), hypothesis);
                let offset = output.offset.unwrap_or(0.0) + off;
                shown.iter_mut().for_each(|value| *value += offset);
                shown
            })
            .collect()
    }

    fn model_toml(&self, hypothesis: &Hypothesis) -> Result<String, String> {
        let mut map = self.model.map.clone();
        for (name, setting) in &mut map.parameters {
            // A value that is taken from each recording stays taken from it.
            if setting.first_of.is_none() {
                let stated = self.model.stated(name);
                setting.value = stated.map(|value| self.model.calibrated_value(name, value, hypothesis));
            }
        }
        let moved = |offset: &mut Option<f64>, by: f64| {
            if by != 0.0 {
                *offset = Some(offset.unwrap_or(0.0) + by);
            }
        };
        for (name, input) in &mut map.inputs {
            let by = self.model.deviation(Calibrated::InputOffset(name), hypothesis);
            moved(&mut input.offset, by);
        }
        for output in map.outputs.values_mut() {
            let by = self
                .model
                .deviation(Calibrated::OutputOffset(&output.column), hypothesis);
            moved(&mut output.offset, by);
        }
        map.effects = self.corrections(hypothesis);
        toml::to_string_pretty(&map).map_err(|error| error.to_string())
    }

    fn model_file(&self) -> &'static str {
        MAP_FILE
    }

    fn states(&self, recording: usize) -> Vec<StateSeries> {
        let simulated = self.as_stated.get(recording).map_or(&[][..], Vec::as_slice);
        (self.shown_quantities().into_iter())
            .filter_map(|(quantity, _)| {
                let state = state(&quantity)?;
                Some(StateSeries::new(state, self.quantity(&quantity, recording, simulated)?))
            })
            .collect()
    }

    fn inputs_in_words(&self) -> &'static str {
        "the inputs that its map names"
    }

    fn law(&self, candidate: usize, values: &[f64]) -> Option<serde_json::Value> {
        let candidate = &self.candidates[candidate];
        let mut corrections = Corrections::default();
        (of(candidate.id).in_co_simulation()?).put(&mut corrections, candidate, values);
        serde_json::to_value(corrections.law.first()?).ok()
    }

    fn remarks(&self) -> Vec<String> {
        let map = &self.model.map;
        (self.model.simulator.variables().iter())
            .filter(|v| {
                v.role == Role::Input && !map.inputs.contains_key(&v.name) && !map.parameters.contains_key(&v.name)
            })
            .map(|v| {
                format!(
                    "The input {} of the model is not in the map and keeps its value at the start.",
                    v.name
                )
            })
            .collect()
    }

    fn nearest_channels(&self, place: &Place) -> Vec<Column> {
        match &place.site {
            Site::Sensor(column) | Site::Output(column) => {
                let compared = self.channels.iter().any(|channel| channel.column == *column);
                compared.then(|| column.clone()).into_iter().collect()
            }
            _ => vec![],
        }
    }
}

/// A quantity as a state; none for the time, which everything has.
fn state(quantity: &Quantity) -> Option<State> {
    let text = |before: &str, name: &str, per_second: &str| {
        let column = Column::named(name.to_owned());
        let unit = match (column.unit(), per_second) {
            ("", "") => String::new(),
            ("", _) => ", 1/s".to_owned(),
            (unit, _) => format!(", {unit}{per_second}"),
        };
        format!("{before}{}{unit}", column.quantity())
    };
    match quantity {
        Quantity::Time | Quantity::SinceTurned(..) => None,
        Quantity::Input(name) => Some(State::named(&text("", name, ""))),
        Quantity::Rate(name) => Some(State::named(&text("rate of ", name, "/s"))),
        Quantity::Simulated(name) => Some(State::simulated(&text("", name, ""))),
    }
}
