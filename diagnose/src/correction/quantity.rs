//! What a law from outside may depend on.

use std::fmt;

use serde::{Deserialize, Serialize};

/// A quantity that is known of every sample: recorded at an input, or simulated. Measured outputs are none: a model that is told them looks better than it is.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(into = "String", from = "String")]
pub enum Quantity {
    /// A recorded input.
    Input(String),
    /// The rate of change of a recorded input, per second.
    Rate(String),
    /// What the model gives for a compared column.
    Simulated(String),
    /// Time since the recording began, s.
    Time,
}

const RATE: &str = "rate of ";
const SIMULATED: &str = "simulated ";
const TIME: &str = "time_s";

impl fmt::Display for Quantity {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input(column) => out.write_str(column),
            Self::Rate(column) => write!(out, "{RATE}{column}"),
            Self::Simulated(column) => write!(out, "{SIMULATED}{column}"),
            Self::Time => out.write_str(TIME),
        }
    }
}

impl From<Quantity> for String {
    fn from(quantity: Quantity) -> Self {
        quantity.to_string()
    }
}

impl From<String> for Quantity {
    fn from(text: String) -> Self {
        if text == TIME {
            Self::Time
        } else if let Some(column) = text.strip_prefix(RATE) {
            Self::Rate(column.to_owned())
        } else if let Some(column) = text.strip_prefix(SIMULATED) {
            Self::Simulated(column.to_owned())
        } else {
            Self::Input(text)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_read_back() {
        for quantity in [
            Quantity::Input("x_m".to_owned()),
            Quantity::Rate("x_m".to_owned()),
            Quantity::Simulated("force_N".to_owned()),
            Quantity::Time,
        ] {
            assert_eq!(Quantity::from(quantity.to_string()), quantity);
        }
    }
}
