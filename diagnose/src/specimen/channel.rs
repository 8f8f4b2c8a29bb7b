//! What is compared, and over which quantities residuals are explained.

use std::collections::BTreeMap;

use crate::vocabulary::{Column, State};

/// A measured quantity that the model predicts.
#[derive(Debug, Clone)]
pub struct Channel {
    /// Its column.
    pub column: Column,
    /// Standard deviation of its white noise, in the unit of the column.
    pub noise: f64,
}

/// One series a channel, each as long as the recording.
pub type Series = Vec<Vec<f64>>;

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

/// The number above zero that a table of a model file (`[noise]`, `[tolerance]`) states for a key.
#[must_use]
pub fn stated(table: &BTreeMap<String, f64>, key: &str) -> Option<f64> {
    table.get(key).copied().filter(|value| *value > 0.0)
}
