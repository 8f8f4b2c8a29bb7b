//! What a law from outside may depend on.

use std::fmt;

use serde::{Deserialize, Serialize};

/// A quantity that is known of every sample: recorded at an input, or simulated. Measured outputs are none: a model that is told them looks better than it is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(into = "String", from = "String")]
pub enum Quantity {
    /// A recorded input.
    Input(String),
    /// The rate of change of a recorded input, per second.
    Rate(String),
    /// How far a recorded input has moved since it turned, at most this far, and in its sense: what dry friction follows. Its state before the recording is not known and taken for zero.
    SinceTurned(String, f64),
    /// What the model gives for a compared column.
    Simulated(String),
    /// Time since the recording began, s.
    Time,
}

const RATE: &str = "rate of ";
const SINCE_TURNED: &str = " since it turned, at most ";
const SIMULATED: &str = "simulated ";
const TIME: &str = "time_s";

impl fmt::Display for Quantity {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input(column) => out.write_str(column),
            Self::Rate(column) => write!(out, "{RATE}{column}"),
            Self::SinceTurned(column, most) => write!(out, "{column}{SINCE_TURNED}{most:?}"),
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
        } else if let Some((column, most)) = since_turned(&text) {
            Self::SinceTurned(column.to_owned(), most)
        } else {
            Self::Input(text)
        }
    }
}

/// Column and range of a text, if it is one of that kind.
fn since_turned(text: &str) -> Option<(&str, f64)> {
    let (column, most) = text.split_once(SINCE_TURNED)?;
    let most = most.parse().ok().filter(|most: &f64| most.is_finite() && *most > 0.0)?;
    Some((column, most))
}

/// How far a series has moved since it turned, at most this far: the stop operator of Prandtl.
#[must_use]
pub fn moved_since_turned(values: &[f64], most: f64) -> Vec<f64> {
    let (mut before, mut moved) = (values.first().copied().unwrap_or(0.0), 0.0_f64);
    (values.iter())
        .map(|value| {
            moved = (moved + value - before).max(-most).min(most);
            before = *value;
            moved
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_read_back() {
        for quantity in [
            Quantity::Input("x_m".to_owned()),
            Quantity::Rate("x_m".to_owned()),
            Quantity::SinceTurned("x_m".to_owned(), 1e-4),
            Quantity::Simulated("force_N".to_owned()),
            Quantity::Time,
        ] {
            assert_eq!(Quantity::from(quantity.to_string()), quantity);
        }
    }

    #[test]
    fn what_has_turned_moves_back_before_it_resists_the_other_way() {
        let moved = moved_since_turned(&[1.0, 1.5, 4.0, 3.5, 2.0, 2.0], 1.0);
        assert_eq!(moved, [0.0, 0.5, 1.0, 0.5, -1.0, -1.0]);
    }
}
