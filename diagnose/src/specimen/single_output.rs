//! The common part of all specimens with only one compared channel.
//!
//! Their model is an equation for a whole recording: inputs and parameters in, the one output out. A kind says how the model
//! is made from a hypothesis and what it answers; everything else a [`Specimen`] offers is here.

use super::channel::{Channel, Series, StateSeries};
use super::contract::Specimen;
use super::folding::Folding;
use super::hypothesis::Hypothesis;
use super::portrait::Portrait;
use crate::effect::Candidate;
use crate::parameter::Parameter;
use crate::recording::Recording;
use crate::vocabulary::Place;
use crate::vocabulary::SpecimenKind;

/// The trait of a kind of specimen with one compared channel.
pub trait SingleOutput: Send + Sync {
    /// The model file of this kind.
    type Model;

    /// The kind of specimen.
    fn kind(&self) -> SpecimenKind;

    /// What the model gets of a recording, for a sentence.
    fn inputs_in_words(&self) -> &'static str;

    /// The model with a hypothesis in it.
    fn applied(&self, candidates: &[Candidate], hypothesis: &Hypothesis) -> Self::Model;

    /// The true output over a recording, whose index is given too.
    ///
    /// # Errors
    /// A message where the model does not exist at these values.
    fn output(&self, model: &Self::Model, recording: &Recording, index: usize) -> Result<Vec<f64>, String>;

    /// What the instrument shows of the true output.
    fn shown(&self, model: &Self::Model, time_s: &[f64], output: Vec<f64>) -> Vec<f64>;

    /// The model as a file.
    ///
    /// # Errors
    /// The serialiser's message.
    fn to_toml(&self, model: &Self::Model) -> Result<String, String>;

    /// Quantities over which residuals are explained.
    fn states(&self, recording: &Recording, index: usize) -> Vec<StateSeries>;

    /// What the recordings show without any model being fitted.
    fn remarks(&self, recordings: &[Recording]) -> Vec<String>;

    /// The specimen as a drawing with the places marked where something was found.
    fn drawing(&self, found: &[&Place]) -> String;

    /// Noise ratio that a complete model reaches, 1 or more.
    fn noise_floor(&self, _model: &Self::Model, _recordings: &[Recording], _noise: f64) -> f64 {
        1.0
    }

    /// What a fold of held-out data is, where there are several recordings.
    fn folding(&self) -> Folding {
        Folding::PartsOfEach
    }

    /// The picture by which people of the trade judge a specimen of this kind.
    fn portrait(&self) -> Option<Portrait> {
        None
    }
}

/// A specimen with one compared channel.
pub struct SingleOutputSpecimen<K> {
    /// The part that differs between the kinds of specimen.
    pub kind: K,
    /// Recordings of the specimen.
    pub recordings: Vec<Recording>,
    /// The only channel that is predicted.
    pub channel: Channel,
    /// Values that may be off within tolerance.
    pub calibration: Vec<Parameter>,
    /// What the model may lack.
    pub candidates: Vec<Candidate>,
}

impl<K: SingleOutput> Specimen for SingleOutputSpecimen<K> {
    fn kind(&self) -> SpecimenKind {
        self.kind.kind()
    }

    fn recordings(&self) -> &[Recording] {
        &self.recordings
    }

    fn channels(&self) -> &[Channel] {
        std::slice::from_ref(&self.channel)
    }

    fn calibration(&self) -> &[Parameter] {
        &self.calibration
    }

    fn candidates(&self) -> &[Candidate] {
        &self.candidates
    }

    fn simulate(&self, hypothesis: &Hypothesis, recording: usize) -> Result<Series, String> {
        let model = self.kind.applied(&self.candidates, hypothesis);
        Ok(vec![self.kind.output(
            &model,
            &self.recordings[recording],
            recording,
        )?])
    }

    fn observe(&self, hypothesis: &Hypothesis, recording: usize, truth: &Series) -> Series {
        let model = self.kind.applied(&self.candidates, hypothesis);
        vec![self.kind.shown(&model, self.time_s(recording), truth[0].clone())]
    }

    fn model_toml(&self, hypothesis: &Hypothesis) -> Result<String, String> {
        self.kind.to_toml(&self.kind.applied(&self.candidates, hypothesis))
    }

    fn states(&self, recording: usize) -> Vec<StateSeries> {
        self.kind.states(&self.recordings[recording], recording)
    }

    fn inputs_in_words(&self) -> &'static str {
        self.kind.inputs_in_words()
    }

    fn simulates_in_milliseconds(&self) -> bool {
        true
    }

    fn remarks(&self) -> Vec<String> {
        self.kind.remarks(&self.recordings)
    }

    fn drawing(&self, found: &[&Place]) -> Option<String> {
        Some(self.kind.drawing(found))
    }

    fn noise_floor(&self, hypothesis: &Hypothesis) -> f64 {
        let model = self.kind.applied(&self.candidates, hypothesis);
        self.kind.noise_floor(&model, &self.recordings, self.channel.noise)
    }

    fn folding(&self) -> Folding {
        self.kind.folding()
    }

    fn portrait(&self) -> Option<Portrait> {
        self.kind.portrait()
    }
}
