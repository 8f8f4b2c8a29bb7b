//! How far runs may be apart: a number in the unit of the figure or trace, a percentage, or a multiple of the sensor noise.

use std::collections::BTreeMap;
use std::path::Path;
use std::str::FromStr;

use oleo_plant_sim::model_file::{self, Checked, InvalidValue, Limit};
use serde::Deserialize;

use super::difference::{Difference, Size};
use super::figures::Figure;
use crate::failure::Failure;
use oleo_hil::parameter_files;

/// A tolerance of a figure or trace.
#[derive(Clone, Debug, PartialEq)]
pub struct Tolerance {
    /// Name of the figure or of the column.
    pub name: String,
    /// How much is allowed.
    pub allowed: Allowed,
}

/// How much is allowed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Allowed {
    /// In the unit of the figure or trace.
    Absolute(f64),
    /// Percent of the reference: of a figure's value, or of a trace's RMS. Of a state, percent of the samples.
    Percent(f64),
    /// Multiple of the noise that the model states for the channel.
    Noise(f64),
}

impl FromStr for Allowed {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        let (number, of): (&str, fn(f64) -> Self) = if let Some(number) = text.strip_suffix('%') {
            (number, Self::Percent)
        } else if let Some(number) = text.strip_suffix('x') {
            (number, Self::Noise)
        } else {
            (text, Self::Absolute)
        };
        match number.trim().parse::<f64>() {
            Ok(number) if number.is_finite() && number >= 0.0 => Ok(of(number)),
            _ => Err(format!(
                "{text:?} is no tolerance; give a number of 0 or more, alone, with % or with x for multiples of the noise"
            )),
        }
    }
}

impl std::fmt::Display for Allowed {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Absolute(number) => write!(out, "{number}"),
            Self::Percent(number) => write!(out, "{number} %"),
            Self::Noise(number) => write!(out, "{number} x noise"),
        }
    }
}

impl FromStr for Tolerance {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, allowed) = text
            .split_once('=')
            .ok_or_else(|| format!("{text:?} has no =; write NAME=VALUE, such as max_roll_deg=5%"))?;
        Ok(Self {
            name: name.trim().to_owned(),
            allowed: allowed.parse()?,
        })
    }
}

/// A file of tolerances.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    /// Names with numbers or texts such as "5 %".
    tolerance: BTreeMap<String, toml::Value>,
}

impl Checked for File {
    const LIMITS: &'static [Limit<Self>] = &[];

    fn check_together(&self) -> Result<(), InvalidValue> {
        let bad = |(name, value): (&String, &toml::Value)| allowed(value).err().map(|what| (name.clone(), what));
        match self.tolerance.iter().find_map(bad) {
            None => Ok(()),
            Some((name, what)) => Err(InvalidValue::new("tolerance", format!("{name}: {what}"))),
        }
    }
}

/// What a value of a file allows.
fn allowed(value: &toml::Value) -> Result<Allowed, String> {
    match value {
        toml::Value::String(text) => text.parse(),
        other => other.to_string().parse(),
    }
}

/// The tolerances in a file.
pub fn read(path: &Path) -> Result<Vec<Tolerance>, Failure> {
    let (text, file) = parameter_files::read(path, "tolerances")?;
    let file: File = model_file::read(&text, &file)?;
    (file.tolerance.into_iter())
        .map(|(name, value)| {
            let allowed = allowed(&value).map_err(Failure::new)?;
            Ok(Tolerance { name, allowed })
        })
        .collect()
}

/// Share of the samples of the reference at which a trace must be compared for a tolerance to be met. Two runs of a manoeuvre end some
/// samples apart; a run that ended early has not shown that it is within.
const LEAST_COMPARED: f64 = 0.95;

/// What was found of a tolerance: the value that was held against it, and whether it is within.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// The difference in the unit of the tolerance; NaN if it cannot be compared.
    pub found: f64,
    /// Whether it is within.
    pub passed: bool,
}

impl Judged {
    fn of(found: f64, allowed: f64) -> Self {
        Self {
            found,
            passed: found <= allowed,
        }
    }

    /// What cannot be compared. It is not within.
    pub const MISSING: Self = Self {
        found: f64::NAN,
        passed: false,
    };
}

/// Holds a figure against that of the reference. Words are within if they are the same.
pub fn judge_figure(allowed: Allowed, reference: &Figure, figure: &Figure) -> Judged {
    match (reference, figure) {
        (Figure::Number(a), Figure::Number(b)) => {
            let apart = (b - a).abs();
            match allowed {
                Allowed::Absolute(most) => Judged::of(apart, most),
                Allowed::Percent(_) if apart == 0.0 => Judged::of(0.0, 0.0),
                Allowed::Percent(most) => Judged::of(100.0 * apart / a.abs(), most),
                Allowed::Noise(_) => Judged::MISSING,
            }
        }
        (Figure::Word(a), Figure::Word(b)) => Judged {
            found: f64::from(u8::from(a != b)),
            passed: a == b,
        },
        _ => Judged::MISSING,
    }
}

/// Holds the difference of a trace against its tolerance. `noise` is that of the channel.
pub fn judge_trace(allowed: Allowed, difference: &Difference, noise: Option<f64>) -> Judged {
    let judged = match (difference.size, allowed) {
        (Size::Quantity { rms, .. }, Allowed::Absolute(most)) => Judged::of(rms, most),
        (Size::Quantity { rms, .. }, Allowed::Noise(most)) => match noise {
            Some(noise) => Judged::of(rms / noise, most),
            None => Judged::MISSING,
        },
        (Size::Quantity { rms: 0.0, .. }, Allowed::Percent(_)) => Judged::of(0.0, 0.0),
        (Size::Quantity { rms, reference_rms, .. }, Allowed::Percent(most)) => {
            Judged::of(100.0 * rms / reference_rms, most)
        }
        (Size::State(share), Allowed::Absolute(most)) => Judged::of(share, most),
        (Size::State(share), Allowed::Percent(most)) => Judged::of(100.0 * share, most),
        (Size::State(_), Allowed::Noise(_)) => Judged::MISSING,
    };
    Judged {
        passed: judged.passed && difference.compared >= LEAST_COMPARED,
        ..judged
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tolerance_is_a_name_and_what_is_allowed() {
        for (text, allowed) in [
            ("max_roll_deg=5%", Allowed::Percent(5.0)),
            ("max_roll_deg = 0.1", Allowed::Absolute(0.1)),
            ("max_roll_deg=1.2x", Allowed::Noise(1.2)),
        ] {
            let name = "max_roll_deg".to_owned();
            assert_eq!(text.parse(), Ok(Tolerance { name, allowed }));
        }
        for bad in ["max_roll_deg", "a=", "a=-1", "a=nan", "a=5 percent"] {
            assert!(bad.parse::<Tolerance>().is_err(), "{bad}");
        }
    }

    #[test]
    fn a_run_that_ended_early_is_not_within() {
        let apart = |compared| Difference {
            size: Size::State(0.0),
            compared,
        };
        assert!(judge_trace(Allowed::Absolute(0.0), &apart(0.99), None).passed);
        assert!(!judge_trace(Allowed::Absolute(1.0), &apart(0.5), None).passed);
    }

    #[test]
    fn a_limit_that_is_met_exactly_is_met() {
        let number = Figure::Number;
        let passes = |allowed, a: Figure, b: Figure| judge_figure(allowed, &a, &b).passed;
        assert!(passes(Allowed::Absolute(0.5), number(1.0), number(1.5)));
        assert!(!passes(Allowed::Absolute(0.5), number(1.0), number(1.625)));
        assert!(passes(Allowed::Percent(50.0), number(-1.0), number(-1.5)));
        assert!(passes(Allowed::Percent(0.0), number(0.0), number(0.0)));
        assert!(!passes(Allowed::Percent(50.0), number(0.0), number(0.1)));
        assert!(!passes(Allowed::Absolute(9.0), number(1.0), number(f64::NAN)));
        assert!(!passes(
            Allowed::Absolute(9.0),
            Figure::Word("none".into()),
            number(1.0)
        ));
        assert!(passes(
            Allowed::Absolute(0.0),
            Figure::Word("a".into()),
            Figure::Word("a".into())
        ));
    }
}
