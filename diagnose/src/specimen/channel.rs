//! The channels that are compared, and the states on which residuals may depend.

use std::collections::BTreeMap;

use crate::vocabulary::{Column, State};

/// A measured quantity that the model predicts.
#[derive(Debug, Clone)]
pub struct Channel {
    /// Column of the recordings that the channel is.
    pub column: Column,
    /// Standard deviation of its white noise, in the unit of the column.
    pub noise: f64,
}

/// One series a channel, each as long as the recording.
pub type Series = Vec<Vec<f64>>;

/// A state over the samples of one recording, or of several one after the other; NaN where it is not defined.
#[derive(Debug, Clone)]
pub struct StateSeries {
    /// The state whose values these are.
    pub state: State,
    /// Value of the state at each sample, in the state's unit.
    pub values: Vec<f64>,
}

impl StateSeries {
    /// A state with its values.
    #[must_use]
    pub const fn new(state: State, values: Vec<f64>) -> Self {
        Self { state, values }
    }
}

/// The number above zero that a table of a model file (`[noise]`, `[tolerance]`) states for a key.
#[must_use]
pub fn stated(table: &BTreeMap<String, f64>, key: &str) -> Option<f64> {
    table.get(key).copied().filter(|value| *value > 0.0)
}
