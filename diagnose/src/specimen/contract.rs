//! The trait of a specimen, which is all that the search, the report and the page know of it.

use oleo_plant_sim::model_file::InvalidValue;

use super::channel::{Channel, Series, StateSeries};
use super::folding::Folding;
use super::hypothesis::Hypothesis;
use super::portrait::Portrait;
use super::relation::MeasuredRelation;
use crate::effect::Candidate;
use crate::error::DiagnoseError;
use crate::instrument::Finding;
use crate::parameter::Parameter;
use crate::recording::{ColumnSpec, GapPolicy, Recording};
use crate::vocabulary::SpecimenKind;
use crate::vocabulary::{Column, Place};

/// The given model of a specimen, read from its model file and checked. Together with recordings it becomes a [`Specimen`].
pub trait BelievedModel {
    /// The columns that its recordings must have: first the displacement or other main input, then the compared channels,
    /// then all other inputs.
    fn columns(&self) -> Vec<ColumnSpec>;

    /// Refuse a model that does not state the noise of every channel, by which its residuals are judged.
    ///
    /// # Errors
    /// The channels whose noise is missing; a compared channel whose noise is zero.
    fn check_noise(&self) -> Result<(), InvalidValue>;

    /// How a gap in the time column of a recording is treated.
    fn gap_policy(&self) -> GapPolicy;

    /// Model and recordings put together. The columns of each recording are those of [`Self::columns`].
    ///
    /// # Errors
    /// Values with which the specimen cannot be at rest.
    fn with_recordings(self: Box<Self>, recordings: Vec<Recording>) -> Result<Box<dyn Specimen>, DiagnoseError>;
}

/// A specimen: its recordings, its given model, the candidates, and the predictions of a model with some of them.
pub trait Specimen: Send + Sync {
    /// The kind of specimen.
    fn kind(&self) -> SpecimenKind;

    /// The recordings, each with the columns of [`BelievedModel::columns`].
    fn recordings(&self) -> &[Recording];

    /// The channels that are compared, in the order of the recordings' columns.
    fn channels(&self) -> &[Channel];

    /// Calibration parameters: values that may differ from nominal within their tolerance. They are part of every fit.
    fn calibration(&self) -> &[Parameter];

    /// The effects that the model may lack.
    fn candidates(&self) -> &[Candidate];

    /// The true quantities under a hypothesis, without sensor faults: one series for each channel.
    ///
    /// # Errors
    /// A message if the model cannot be simulated with these values.
    fn simulate(&self, hypothesis: &Hypothesis, recording: usize) -> Result<Series, String>;

    /// The same for several hypotheses and recordings, one result each, on this thread. The results are those of [`Self::simulate`] to the bit; a
    /// specimen that simulates several in less time than one after the other does so here.
    fn simulate_all(&self, wanted: &[(&Hypothesis, usize)]) -> Vec<Result<Series, String>> {
        (wanted.iter())
            .map(|&(hypothesis, recording)| self.simulate(hypothesis, recording))
            .collect()
    }

    /// How many simulations [`Self::simulate_all`] is best given at once; 1 where nothing is gained.
    fn simulations_at_once(&self) -> usize {
        1
    }

    /// The readings of the sensors for the true quantities.
    fn observe(&self, hypothesis: &Hypothesis, recording: usize, truth: &Series) -> Series;

    /// The model file of a hypothesis.
    ///
    /// # Errors
    /// A law that cannot be written into the model file.
    fn model_toml(&self, hypothesis: &Hypothesis) -> Result<String, String>;

    /// Name of the file of [`Self::model_toml`] among the results.
    fn model_file(&self) -> &'static str {
        "model.toml"
    }

    /// The states over which residuals are shown and explained. They may differ between recordings.
    fn states(&self, recording: usize) -> Vec<StateSeries>;

    /// The inputs of the simulation in words, such as "displacement and switching signals".
    fn inputs_in_words(&self) -> &'static str;

    /// Measured series of a channel.
    fn measured(&self, recording: usize, channel: usize) -> &[f64] {
        &self.recordings()[recording].columns[1 + channel]
    }

    /// Noise of the readings of a channel as multiples of the channel's noise, one a sample; `None` if all are 1.
    fn relative_noise(&self, _recording: usize, _channel: usize) -> Option<&[f64]> {
        None
    }

    /// A series in units of the noise of its samples, in the unit of its column.
    fn in_units(&self, recording: usize, channel: usize, series: &[f64]) -> Vec<f64> {
        let noise = self.channels()[channel].noise;
        match self.relative_noise(recording, channel) {
            None => series.iter().map(|v| noise * v).collect(),
            Some(relative) => series
                .iter()
                .zip(relative)
                .map(|(v, relative)| noise * relative * v)
                .collect(),
        }
    }

    /// What the recordings say of their instruments that the model file does not state.
    fn instruments(&self) -> &[Finding] {
        &[]
    }

    /// Noise ratio that a complete model reaches, 1 or more; above 1 if the noise of an input affects the prediction.
    fn noise_floor(&self, _hypothesis: &Hypothesis) -> f64 {
        1.0
    }

    /// Whether simulating all recordings takes only milliseconds. Then quantities are computed that are otherwise approximated.
    fn simulates_in_milliseconds(&self) -> bool {
        false
    }

    /// What a fold of held-out data is, where there are several recordings.
    fn folding(&self) -> Folding {
        Folding::PartsOfEach
    }

    /// The picture by which people of the trade judge a specimen of this kind; none if there is no usual one.
    fn portrait(&self) -> Option<Portrait> {
        None
    }

    /// Whether the model is stated to be complete apart from missing effects, so that a remaining misfit is itself a result.
    fn is_believed_complete(&self) -> bool {
        false
    }

    /// A law without a name with its values, for the report.
    fn law(&self, candidate: usize, values: &[f64]) -> Option<serde_json::Value> {
        let c = &self.candidates()[candidate];
        let keys: Vec<&str> = c.parameters.iter().map(|p| p.key.as_str()).collect();
        Some(serde_json::json!({ "place": c.place.to_string(), "form": c.label, "keys": keys, "values": values }))
    }

    /// Results that the recordings show without fitting a model, one line each.
    fn remarks(&self) -> Vec<String> {
        Vec::new()
    }

    /// Relations between neighbouring sensors that hold whatever happens elsewhere, tested without simulation.
    fn measured_relations(&self) -> Vec<MeasuredRelation> {
        Vec::new()
    }

    /// The channels next to a place, the one downstream of it last; none if all are equally near.
    fn nearest_channels(&self, place: &Place) -> Vec<Column> {
        place.sensor().cloned().into_iter().collect()
    }

    /// The settings at a sample, such as "valve 1 open".
    fn settings(&self, _recording: usize, _sample: usize) -> Vec<String> {
        Vec::new()
    }

    /// The specimen as a drawing (SVG) with the given places marked.
    fn drawing(&self, _found: &[&Place]) -> Option<String> {
        None
    }

    /// Name of a recording.
    fn recording_name(&self, recording: usize) -> &str {
        &self.recordings()[recording].name
    }

    /// Sample times of a recording, s.
    fn time_s(&self, recording: usize) -> &[f64] {
        &self.recordings()[recording].time_s
    }

    /// Number of samples of all recordings.
    fn samples(&self) -> usize {
        self.recordings().iter().map(Recording::len).sum()
    }
}
