//! `[[check]]` tables of a scenario file, converted into a [`Check`].

use oleo_plant_sim::model_file::names::suggestion;
use oleo_plant_sim::model_file::{Checked, InvalidValue, Limit, Range};
use serde::Deserialize;

use super::check::{Check, Comparison, Metric};

/// A check as it stands in the file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CheckEntry {
    metric: String,
    at_most: Option<f64>,
    at_least: Option<f64>,
    equals: Option<toml::Value>,
}

impl CheckEntry {
    fn equal_number(&self) -> Option<f64> {
        match &self.equals {
            Some(toml::Value::Integer(number)) => Some(*number as f64),
            Some(toml::Value::Float(number)) => Some(*number),
            _ => None,
        }
    }

    fn equal_word(&self) -> Option<&str> {
        self.equals.as_ref().and_then(toml::Value::as_str)
    }
}

impl Checked for CheckEntry {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::optional("at_most", Range::Finite, "", |entry| entry.at_most),
        Limit::optional("at_least", Range::Finite, "", |entry| entry.at_least),
        Limit::optional("equals", Range::Finite, "", CheckEntry::equal_number),
    ];
}

impl CheckEntry {
    /// Converts the entry of the file into a check.
    pub fn check(&self, has_manoeuvre: bool) -> Result<Check, InvalidValue> {
        let metric = Metric::from_name(&self.metric).ok_or_else(|| {
            let names: Vec<&str> = Metric::ALL.iter().map(|metric| metric.name()).collect();
            let what = format!(
                "is {:?}, which is not a metric: {}",
                self.metric,
                suggestion(&self.metric, &names, "metrics")
            );
            InvalidValue::new("metric", what)
        })?;
        if metric.needs_manoeuvre() && !has_manoeuvre {
            let what = format!(
                "is {:?}, which the ride model does not have: add a manoeuvre to the scenario",
                self.metric
            );
            return Err(InvalidValue::new("metric", what));
        }
        let (key, comparison) = match (self.at_most, self.at_least, &self.equals) {
            (Some(limit), None, None) => ("at_most", Comparison::AtMost(limit)),
            (None, Some(limit), None) => ("at_least", Comparison::AtLeast(limit)),
            (None, None, Some(equals)) => match (self.equal_number(), self.equal_word()) {
                (Some(number), _) => ("equals", Comparison::Equals(number)),
                (None, Some(word)) => ("equals", Comparison::Is(word.to_owned())),
                (None, None) => {
                    let what = format!("is {equals}: must be a number or a word in quotation marks");
                    return Err(InvalidValue::new("equals", what));
                }
            },
            _ => {
                let what = format!(
                    "is {:?}: give exactly one of at_most, at_least and equals with it",
                    self.metric
                );
                return Err(InvalidValue::new("metric", what));
            }
        };
        if matches!(comparison, Comparison::Is(_)) == metric.is_word() {
            return Ok(Check { metric, comparison });
        }
        let what = format!(
            "does not go with {}, which is {}",
            metric.name(),
            if metric.is_word() {
                "a word: give equals = \"normal\", for example"
            } else {
                "a number: give a number"
            }
        );
        Err(InvalidValue::new(key, what))
    }
}
