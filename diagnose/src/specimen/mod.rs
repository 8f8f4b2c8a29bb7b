//! What the machinery needs to know of a specimen: what is measured, what may be off, what may be missing, and what a
//! model with all that predicts. Struts, gas springs and cylinders differ only here.

pub mod balance;
pub mod corner;
pub mod cylinder;
pub mod gas_spring;
pub mod instrument;
pub mod strut;

use crate::parameter::Parameter;
use crate::vocabulary::{Column, EffectId, Place, State};

/// A measured quantity that the model predicts.
#[derive(Debug, Clone)]
pub struct Channel {
    /// Its column.
    pub column: Column,
    /// Standard deviation of its white noise, in the unit of the column.
    pub noise: f64,
}

/// A piece of physics that the model may lack: a kind of element at a place.
#[derive(Debug, Clone)]
pub struct Candidate {
    /// Id of the vocabulary, `unlisted` for laws without a name.
    pub id: EffectId,
    /// Where it acts.
    pub place: Place,
    /// What to call it where `id` does not distinguish (laws without a name).
    pub label: String,
    /// Numbers to fit; none for a term that is simply there or not.
    pub parameters: Vec<Parameter>,
    /// Other starting points, in values, tried beside the parameters' own.
    pub starts: Vec<Vec<f64>>,
    /// Candidates of the same group exclude each other.
    pub group: Option<ExclusionGroup>,
    /// Why the recordings cannot show it, where they cannot.
    pub untestable: Option<String>,
}

/// Candidates that stand for the same thing in different forms, of which a model can hold one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExclusionGroup {
    /// One damper or both fade.
    DampingFade,
    /// What the gas does with its heat.
    GasProcess,
    /// Laws without a name.
    Unlisted,
}

impl Candidate {
    /// True for a law that the vocabulary does not name.
    #[must_use]
    pub fn is_unlisted(&self) -> bool {
        self.id == EffectId::Unlisted
    }

    /// True for the fault of an instrument, which is judged before physics.
    #[must_use]
    pub const fn is_instrument_fault(&self) -> bool {
        self.id.is_instrument_fault()
    }

    /// True if the two cannot be in one model: members of one group, and two faults of one instrument, which shade into
    /// each other (a short lag is nearly a skew).
    #[must_use]
    pub fn excludes(&self, other: &Self) -> bool {
        (self.group.is_some() && self.group == other.group)
            || (self.is_instrument_fault() && other.is_instrument_fault() && self.place == other.place)
    }

    /// True if these values leave the model as it is: an amount that starts at zero is zero.
    #[must_use]
    pub fn absent_at(&self, values: &[f64]) -> bool {
        self.parameters
            .iter()
            .zip(values)
            .any(|(p, v)| p.start == 0.0 && *v == 0.0)
    }

    /// Id and place in one word, unique.
    #[must_use]
    pub fn name(&self) -> String {
        if self.label.is_empty() {
            format!("{}@{}", self.id, self.place)
        } else {
            format!("{}@{} ({})", self.id, self.place, self.label)
        }
    }
}

/// A model to simulate: calibration values, and the candidates present with their values.
#[derive(Debug, Clone, Default)]
pub struct Hypothesis {
    /// Values of [`Specimen::calibration`], same order.
    pub calibration: Vec<f64>,
    /// Index into [`Specimen::candidates`] and the values of its parameters.
    pub effects: Vec<(usize, Vec<f64>)>,
}

/// A state over the samples of one recording, or of several one after the other; NaN where it is not defined.
#[derive(Debug, Clone)]
pub struct StateSeries {
    /// Which state.
    pub state: State,
    /// Its values.
    pub values: Vec<f64>,
}

impl StateSeries {
    /// A state with its values.
    #[must_use]
    pub const fn new(state: State, values: Vec<f64>) -> Self {
        Self { state, values }
    }
}

/// One series a channel, each as long as the recording.
pub type Series = Vec<Vec<f64>>;

/// A specimen with its recordings and the belief about it.
pub trait Specimen: Sync {
    /// Its kind, as in the model file.
    fn kind(&self) -> &'static str;
    /// What is compared.
    fn channels(&self) -> &[Channel];
    /// Number of recordings.
    fn recordings(&self) -> usize;
    /// Name of a recording.
    fn recording_name(&self, recording: usize) -> &str;
    /// Sample times, s.
    fn time_s(&self, recording: usize) -> &[f64];
    /// Measured series of a channel.
    fn measured(&self, recording: usize, channel: usize) -> &[f64];
    /// Values that may be off within tolerance.
    fn calibration(&self) -> &[Parameter];
    /// Physics that may be missing.
    fn candidates(&self) -> &[Candidate];
    /// The true quantities under a hypothesis, before any instrument. A message where it cannot be simulated.
    ///
    /// # Errors
    /// Values outside the range in which the model exists.
    fn simulate(&self, hypothesis: &Hypothesis, recording: usize) -> Result<Series, String>;
    /// What the instruments show of it.
    fn observe(&self, hypothesis: &Hypothesis, recording: usize, truth: &Series) -> Series;
    /// The model file with the hypothesis in it.
    ///
    /// # Errors
    /// A law that the model file cannot hold.
    fn model_toml(&self, hypothesis: &Hypothesis) -> Result<String, String>;
    /// Noise ratio that a complete model reaches: above one where the noise of an input comes through.
    fn noise_floor(&self, _hypothesis: &Hypothesis) -> f64 {
        1.0
    }
    /// True if simulating all recordings takes milliseconds.
    fn is_cheap(&self) -> bool {
        false
    }
    /// A law without a name with its values, for the report.
    fn law(&self, candidate: usize, values: &[f64]) -> Option<serde_json::Value> {
        let c = &self.candidates()[candidate];
        let keys: Vec<&str> = c.parameters.iter().map(|p| p.key.as_str()).collect();
        Some(serde_json::json!({ "place": c.place.to_string(), "form": c.label, "keys": keys, "values": values }))
    }
    /// Piston area of a strut, m2; `None` for other kinds.
    fn piston_area_m2(&self) -> Option<f64> {
        None
    }
    /// True if nothing has moved faster than a speed, m/s, for a while before a sample.
    fn quiet(&self, _recording: usize, _sample: usize, _speed_m_s: f64) -> bool {
        false
    }
    /// True if a valve has been signalled open for a while.
    fn valve_open(&self, _recording: usize, _sample: usize, _valve: usize) -> bool {
        false
    }
    /// True if a valve has been signalled shut for a while.
    fn valve_shut(&self, _recording: usize, _sample: usize, _valve: usize) -> bool {
        false
    }
    /// Quantities over which residuals are shown and explained, per recording: which of them there are differs from recording to recording.
    fn states(&self, recording: usize) -> Vec<StateSeries>;
}
