//! Instruments as they are: what real ones do to a recording beside the white noise that the model file states.
//!
//! A flaw is drawn by name, so that a campaign has the same instruments whatever else is run. It changes what is recorded and
//! nothing of the truth: with a complete model every effect that is then reported is a false one.

use std::f64::consts::TAU;

use oleo_plant_sim::model_file::names::suggestion;
use serde::{Deserialize, Serialize};
use strum::{Display, EnumString, IntoStaticStr, VariantArray};

use super::draw::Draw;
use crate::specimen::strut::CHANNELS;

/// What is wrong with the instruments of a campaign.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Display,
    EnumString,
    IntoStaticStr,
    VariantArray,
    Serialize,
    Deserialize,
)]
#[strum(serialize_all = "snake_case")]
#[serde(rename_all = "snake_case")]
pub enum Flaw {
    /// Neighbouring samples of the noise are correlated by 0.5 to 0.9; its size is as stated.
    ColouredNoise,
    /// Converters of twelve bits, whose step is larger than the stated noise.
    TwelveBit,
    /// One in 200 to 1,000 readings is off by 10 to 60 times the noise.
    Spikes,
    /// The mains are seen on one column, with an amplitude of 0.7 to 3 times the noise.
    Hum,
    /// The samples of all columns are taken early or late together, by a twentieth to a fifth of the interval.
    Jitter,
    /// The noise is twice as large as stated.
    NoiseTwice,
    /// The noise is half as large as stated.
    NoiseHalf,
    /// The force is not recorded.
    NoForce,
    /// One of the pressures is not recorded.
    NoPressure,
}

/// A text that names no flaw of instruments.
#[derive(Debug, thiserror::Error)]
#[error("--instruments {0}: there is no such flaw, {known}; separate several by commas", known = suggested(.0))]
pub struct UnknownFlaw(String);

/// Every flaw.
const ALL: &str = "all";

/// The flaws, and which was probably meant.
fn suggested(text: &str) -> String {
    let known: Vec<&str> = Flaw::VARIANTS.iter().map(<&str>::from).chain([ALL]).collect();
    suggestion(text, &known, "flaws")
}

impl Flaw {
    /// The flaws of a list of names, in its order; `all` is every flaw.
    ///
    /// # Errors
    /// A name that is no flaw's.
    pub fn listed(names: &[String]) -> Result<Vec<Self>, UnknownFlaw> {
        let mut flaws = Vec::new();
        for name in names {
            if name == ALL {
                flaws.extend(Self::VARIANTS);
            } else {
                flaws.push(name.parse().map_err(|_| UnknownFlaw(name.clone()))?);
            }
        }
        Ok(flaws)
    }
}

impl Flaw {
    /// What a diagnosis should say of it.
    #[must_use]
    pub const fn is_said_as(self) -> &'static str {
        match self {
            Self::ColouredNoise => "coloured_noise",
            Self::TwelveBit => "coarse_steps",
            Self::Spikes => "spikes",
            Self::Hum => "mains_hum",
            Self::Jitter => "sampling_jitter",
            Self::NoiseTwice | Self::NoiseHalf => "other_noise",
            Self::NoForce | Self::NoPressure => "not_recorded",
        }
    }
}

/// Steps of converters of twelve bits, over the usual ranges of a rig's sensors: 0.25 m, 100 kN and 25 MPa.
const STEP_OF_TWELVE_BITS: [f64; 3] = [0.25 / 4096.0, 1e5 / 4096.0, 25e6 / 4096.0];
/// Frequency of the mains, and how far it is off at most, Hz.
const MAINS_HZ: (f64, f64) = (50.0, 0.1);

/// A flaw with its drawn numbers.
pub struct Instruments {
    flaw: Option<Flaw>,
    draw: Draw,
    /// Correlation of neighbours, part of the readings, amplitude over noise or jitter over interval: whatever the flaw has.
    size: f64,
    /// Column of a flaw of one instrument: 0 is the displacement.
    column: usize,
    frequency_hz: f64,
}

impl Instruments {
    /// The instruments of the campaign of a name.
    #[must_use]
    pub fn draw(name: &str, flaw: Option<Flaw>) -> Self {
        let mut draw = Draw::named(&format!("{name}:instruments"));
        let (size, column) = match flaw {
            Some(Flaw::ColouredNoise) => (draw.between(0.5, 0.9), 0),
            Some(Flaw::Spikes) => (draw.between(0.001, 0.005), 0),
            Some(Flaw::Hum) => (draw.between(0.7, 3.0), draw.index(1 + CHANNELS.len())),
            Some(Flaw::Jitter) => (draw.between(0.05, 0.2), 0),
            Some(Flaw::NoPressure) => (0.0, 2 + draw.index(CHANNELS.len() - 1)),
            Some(Flaw::NoForce) => (0.0, 1),
            _ => (0.0, 0),
        };
        let frequency_hz = MAINS_HZ.0 + MAINS_HZ.1 * draw.between(-1.0, 1.0);
        Self {
            flaw,
            draw,
            size,
            column,
            frequency_hz,
        }
    }

    /// By how much the samples of a recording are early or late, as a part of the interval; none without jitter.
    pub fn jitter(&mut self, samples: usize) -> Option<Vec<f64>> {
        (self.flaw == Some(Flaw::Jitter)).then(|| {
            // The first sample is when the recording begins.
            let late = |k| if k == 0 { 0.0 } else { self.size * self.draw.normal() };
            (0..samples).map(late).map(|late| late.clamp(-0.9, 0.9)).collect()
        })
    }

    /// The noise of a series of readings, drawn in units of its standard deviation and as white noise.
    pub fn noise(&mut self, white: Vec<f64>) -> Vec<f64> {
        match self.flaw {
            Some(Flaw::ColouredNoise) => coloured(white, self.size),
            Some(Flaw::NoiseTwice) => white.into_iter().map(|v| 2.0 * v).collect(),
            Some(Flaw::NoiseHalf) => white.into_iter().map(|v| 0.5 * v).collect(),
            _ => white,
        }
    }

    /// What the instrument of a column and its converter make of the readings; `noise` is the stated one.
    pub fn record(&mut self, column: usize, noise: f64, interval_s: f64, readings: &mut [f64]) {
        match self.flaw {
            Some(Flaw::TwelveBit) => {
                let step = STEP_OF_TWELVE_BITS[column.min(2)];
                readings.iter_mut().for_each(|v| *v = step * (*v / step).round());
            }
            Some(Flaw::Spikes) => {
                for reading in readings {
                    if self.draw.uniform() < self.size {
                        let sign = if self.draw.uniform() < 0.5 { -1.0 } else { 1.0 };
                        *reading += sign * noise * self.draw.between(10.0, 60.0);
                    }
                }
            }
            Some(Flaw::Hum) if column == self.column => {
                let phase = self.draw.between(0.0, TAU);
                let turn = TAU * self.frequency_hz * interval_s;
                for (k, reading) in readings.iter_mut().enumerate() {
                    *reading += self.size * noise * libm::sin(turn * k as f64 + phase);
                }
            }
            Some(Flaw::NoForce | Flaw::NoPressure) if column == self.column => readings.fill(f64::NAN),
            _ => {}
        }
    }
}

/// Noise of the same standard deviation whose neighbours are correlated.
fn coloured(white: Vec<f64>, correlation: f64) -> Vec<f64> {
    let fresh = (1.0 - correlation * correlation).sqrt();
    let mut last = None;
    (white.into_iter())
        .map(|v| {
            let value = last.map_or(v, |last: f64| correlation * last + fresh * v);
            last = Some(value);
            value
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::selftest::generate::generate;
    use crate::specimen::Specimen;
    use crate::specimen::strut::TwoStageStrut;

    /// Size of an effect, in units of noise.
    const GROSS: f64 = 30.0;

    /// What is said of the instruments of a campaign with a complete model.
    fn said(seed: usize, flaw: Option<Flaw>) -> Vec<(&'static str, String)> {
        let name = format!("test:{seed}:{}", flaw.map_or("none", Into::into));
        let campaign = generate(&name, &[], &[], flaw).expect("a campaign");
        let strut = TwoStageStrut::new(campaign.given, campaign.recordings).expect("a strut");
        let findings = strut.instruments().iter();
        findings
            .map(|f| {
                println!("{seed} {flaw:?}: {}", f.text());
                (
                    f.flaw.name(),
                    f.column.as_ref().map_or_else(String::new, ToString::to_string),
                )
            })
            .collect()
    }

    #[test]
    fn instruments_as_stated_are_not_spoken_of() {
        for seed in 0..3 {
            assert_eq!(said(seed, None), []);
        }
    }

    /// Effects of the specimen and of the vocabulary's instruments are not taken for flaws.
    #[test]
    fn no_effect_is_taken_for_a_flaw() {
        let mut wrong = Vec::new();
        for term in crate::effect::in_struts() {
            let campaign = generate(&format!("test:{term}"), &[(term, GROSS)], &[], None).expect("a campaign");
            let strut = TwoStageStrut::new(campaign.given, campaign.recordings).expect("a strut");
            let findings = strut.instruments().iter();
            wrong.extend(findings.map(|f| format!("{term}: {}", f.text())));
        }
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    }

    #[test]
    fn every_flaw_is_said_and_no_other() {
        let mut wrong = Vec::new();
        for &flaw in Flaw::VARIANTS {
            let said = said(0, Some(flaw));
            let columns = match flaw {
                Flaw::Hum | Flaw::Jitter | Flaw::NoForce | Flaw::NoPressure => 1,
                _ => 6,
            };
            if said.iter().any(|(what, _)| *what != flaw.is_said_as()) || said.len() != columns {
                wrong.push(format!("{flaw}: {said:?}"));
            }
        }
        assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    }
}
