//! The channels that are compared, and the states on which residuals may depend.

use std::collections::BTreeMap;

use oleo_plant_sim::model_file::InvalidValue;
use oleo_plant_sim::model_file::instruments::noise_of_compared;

use crate::vocabulary::{Column, State};

/// A measured quantity that the model predicts.
#[derive(Debug, Clone)]
pub struct Channel {
    /// Column of the recordings that the channel is.
    pub column: Column,
    /// Standard deviation of its white noise, in the unit of the column.
    pub noise: f64,
}

impl Channel {
    /// A compared column with the noise that the table `[noise]` of the model file states.
    ///
    /// # Errors
    /// The table states no noise for it, or zero.
    pub fn of(column: Column, noise: &BTreeMap<String, f64>) -> Result<Self, InvalidValue> {
        let noise = noise_of_compared(noise, column.as_str())?;
        Ok(Self { column, noise })
    }
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
