//! What is added to somebody else's model from outside: faults of the instruments around it, and laws without a name at its inputs, outputs and parameters.
//!
//! The equations inside such a model are not known. What it lacks can only be put before it (another input, another parameter) or behind it (another output).
//!
//! | file | what it holds |
//! |---|---|
//! | `quantity` | what a law may depend on |
//! | `law` | a table at an input, an output or a parameter |

mod law;
mod quantity;

use oleo_plant_sim::model_file::limits::each_checked;
use oleo_plant_sim::model_file::{Checked, InvalidValue, Limit};
use oleo_plant_sim::strut::{Effects, SensorEffect, TermId, record_column};
use serde::{Deserialize, Serialize};

pub use law::{Law, Target};
pub use quantity::{Quantity, moved_since_turned};

/// The table `[effects]` of a map: what is added from outside.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Corrections {
    /// First-order lag of a column, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor_lag: Option<SensorEffect>,
    /// Relative gain error of a column.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor_gain: Option<SensorEffect>,
    /// Drift of a column, unit per second.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor_drift: Option<SensorEffect>,
    /// Time by which a column is late, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor_skew: Option<SensorEffect>,
    /// Columns with the wrong sign: -1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor_sign: Option<SensorEffect>,
    /// Laws without a name.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub law: Vec<Law>,
}

impl Checked for Corrections {
    const LIMITS: &'static [Limit<Self>] = &[];

    fn check_together(&self) -> Result<(), InvalidValue> {
        each_checked(&self.law, "law")
    }
}

impl Corrections {
    /// The faulty columns of one kind of instrument fault; `None` for an id that is no fault of an instrument.
    pub fn sensor_fault_mut(&mut self, id: TermId) -> Option<&mut Option<SensorEffect>> {
        match id {
            TermId::SensorLag => Some(&mut self.sensor_lag),
            TermId::SensorGain => Some(&mut self.sensor_gain),
            TermId::SensorDrift => Some(&mut self.sensor_drift),
            TermId::SensorSkew => Some(&mut self.sensor_skew),
            TermId::SensorSign => Some(&mut self.sensor_sign),
            _ => None,
        }
    }

    /// The columns that are said to have a faulty instrument.
    pub fn faulty_columns(&self) -> impl Iterator<Item = &str> {
        [
            &self.sensor_lag,
            &self.sensor_gain,
            &self.sensor_drift,
            &self.sensor_skew,
            &self.sensor_sign,
        ]
        .into_iter()
        .flatten()
        .flat_map(|columns| columns.keys().map(String::as_str))
    }

    /// The laws at a target.
    pub fn laws_at<'c>(&'c self, target: Target, of: &'c str) -> impl Iterator<Item = &'c Law> {
        (self.law.iter()).filter(move |law| law.at == target && law.of == of)
    }

    /// What the instrument of a column shows of its true values.
    pub fn show(&self, column: &str, time_s: &[f64], truth: &mut [f64]) {
        let instruments = Effects {
            sensor_lag: self.sensor_lag.clone(),
            sensor_gain: self.sensor_gain.clone(),
            sensor_drift: self.sensor_drift.clone(),
            sensor_skew: self.sensor_skew.clone(),
            sensor_sign: self.sensor_sign.clone(),
            ..Effects::default()
        };
        record_column(&instruments, column, time_s, truth);
    }

    /// The true values behind what the instrument of a column shows. A lag is not undone: that would be noise.
    #[must_use]
    pub fn undo(&self, column: &str, time_s: &[f64], shown: &[f64]) -> Vec<f64> {
        let of = |fault: &Option<SensorEffect>| fault.as_ref().and_then(|sizes| sizes.get(column).copied());
        let factor = of(&self.sensor_sign).unwrap_or(1.0) * (1.0 + of(&self.sensor_gain).unwrap_or(0.0));
        let drift = of(&self.sensor_drift).unwrap_or(0.0);
        let begin = time_s.first().copied().unwrap_or(0.0);
        let mut truth: Vec<f64> = (shown.iter().zip(time_s))
            .map(|(value, time)| (value - drift * (time - begin)) / factor)
            .collect();
        if let Some(late) = of(&self.sensor_skew).filter(|late| *late != 0.0) {
            let as_shown = truth.clone();
            let mut at = 0;
            for (value, time) in truth.iter_mut().zip(time_s) {
                *value = between(time_s, &as_shown, time + late, &mut at);
            }
        }
        truth
    }
}

/// The value of a series at a time by linear interpolation, held at its ends. `at` is where the last one was found, for times that increase.
#[must_use]
pub fn between(time_s: &[f64], values: &[f64], time: f64, at: &mut usize) -> f64 {
    while *at + 2 < time_s.len() && time_s[*at + 1] <= time {
        *at += 1;
    }
    let (Some(&from), Some(&to)) = (time_s.get(*at), time_s.get(*at + 1)) else {
        return values.first().copied().unwrap_or(0.0);
    };
    let part = ((time - from) / (to - from)).clamp(0.0, 1.0);
    values[*at] + part * (values[*at + 1] - values[*at])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_an_instrument_shows_is_undone() {
        let time_s: Vec<f64> = (0..200).map(|k| 0.01 * f64::from(k)).collect();
        let truth: Vec<f64> = time_s.iter().map(|t| 2.0 + 3.0 * t).collect();
        for (id, size) in [
            (TermId::SensorGain, 0.1),
            (TermId::SensorDrift, 0.4),
            (TermId::SensorSkew, 0.013),
            (TermId::SensorSign, -1.0),
        ] {
            let mut corrections = Corrections::default();
            let table = corrections.sensor_fault_mut(id).expect("a fault");
            table.get_or_insert_default().insert("x_m".to_owned(), size);
            let mut shown = truth.clone();
            corrections.show("x_m", &time_s, &mut shown);
            let undone = corrections.undo("x_m", &time_s, &shown);
            assert!((shown[100] - truth[100]).abs() > 0.01, "{id}");
            assert!((undone[100] - truth[100]).abs() < 1e-9, "{id}");
            assert_eq!(corrections.undo("y_m", &time_s, &truth), truth);
        }
    }
}
