//! The trait of a specimen, which is all that the search, the report and the page know of it.

use super::channel::{Channel, Series, StateSeries};
use super::hypothesis::Hypothesis;
use super::relation::MeasuredRelation;
use crate::effect::Candidate;
use crate::error::DiagnoseError;
use crate::parameter::Parameter;
use crate::recording::{ColumnSpec, GapPolicy, Recording};
use crate::vocabulary::SpecimenKind;
use crate::vocabulary::{Column, Place};

/// What is believed of a specimen: its model file, read and checked. With recordings it becomes a [`Specimen`].
pub trait BelievedModel {
    /// The columns that its recordings must have: first the displacement or other main input, then the compared channels,
    /// then all other inputs.
    fn columns(&self) -> Vec<ColumnSpec>;

    /// What is done with a hole in the time column of a recording.
    fn gap_policy(&self) -> GapPolicy;

    /// Model and recordings put together. The columns of each recording are those of [`Self::columns`].
    ///
    /// # Errors
    /// Numbers with which the specimen cannot even stand still.
    fn with_recordings(self: Box<Self>, recordings: Vec<Recording>) -> Result<Box<dyn Specimen>, DiagnoseError>;
}

/// A specimen: its recordings, what is believed of it, what that may lack, and what a model with all that predicts.
pub trait Specimen: Sync {
    /// The kind of specimen.
    fn kind(&self) -> SpecimenKind;

    /// The recordings, each with the columns of [`BelievedModel::columns`].
    fn recordings(&self) -> &[Recording];

    /// What is compared, in the order of the recordings' columns.
    fn channels(&self) -> &[Channel];

    /// Values that may be off within their tolerance. They are part of every fit.
    fn calibration(&self) -> &[Parameter];

    /// What the model may lack.
    fn candidates(&self) -> &[Candidate];

    /// The true quantities under a hypothesis, before any instrument: one series a channel.
    ///
    /// # Errors
    /// A message where the model does not exist at these values.
    fn simulate(&self, hypothesis: &Hypothesis, recording: usize) -> Result<Series, String>;

    /// What the instruments show of true quantities.
    fn observe(&self, hypothesis: &Hypothesis, recording: usize, truth: &Series) -> Series;

    /// The model file with the hypothesis in it.
    ///
    /// # Errors
    /// A law that the model file cannot hold.
    fn model_toml(&self, hypothesis: &Hypothesis) -> Result<String, String>;

    /// Quantities over which residuals are shown and explained. Which of them there are may differ between recordings.
    fn states(&self, recording: usize) -> Vec<StateSeries>;

    /// What the model gets of a recording, for a sentence: "displacement and switching signals".
    fn inputs_in_words(&self) -> &'static str;

    /// Measured series of a channel.
    fn measured(&self, recording: usize, channel: usize) -> &[f64] {
        &self.recordings()[recording].columns[1 + channel]
    }

    /// Noise ratio that a complete model reaches: above one where the noise of an input comes through.
    fn noise_floor(&self, _hypothesis: &Hypothesis) -> f64 {
        1.0
    }

    /// True if simulating all recordings takes milliseconds, so that what is otherwise approximated is computed.
    fn simulates_in_milliseconds(&self) -> bool {
        false
    }

    /// True if the model is said to be complete but for what is concealed or damaged, so that a misfit that stays is itself a
    /// finding.
    fn is_believed_complete(&self) -> bool {
        false
    }

    /// A law without a name with its values, for the report.
    fn law(&self, candidate: usize, values: &[f64]) -> Option<serde_json::Value> {
        let c = &self.candidates()[candidate];
        let keys: Vec<&str> = c.parameters.iter().map(|p| p.key.as_str()).collect();
        Some(serde_json::json!({ "place": c.place.to_string(), "form": c.label, "keys": keys, "values": values }))
    }

    /// What the recordings show without any model being fitted, one line each.
    fn remarks(&self) -> Vec<String> {
        Vec::new()
    }

    /// Relations between measured neighbours that hold whatever happens elsewhere, tested without simulation.
    fn measured_relations(&self) -> Vec<MeasuredRelation> {
        Vec::new()
    }

    /// The channels next to a place, the one downstream of it last; none where all are as near.
    fn nearest_channels(&self, place: &Place) -> Vec<Column> {
        place.sensor().cloned().into_iter().collect()
    }

    /// What was set and held at a sample: "valve 1 open".
    fn settings(&self, _recording: usize, _sample: usize) -> Vec<String> {
        Vec::new()
    }

    /// The specimen as a drawing (SVG) with the places marked where something was found.
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
