//! What is wrong with an instrument, as it is said.

use oleo_report::significant;
use serde::Serialize;
use strum::IntoStaticStr;

use super::hum::Line;
use crate::vocabulary::Column;

/// Something that an instrument does and the model file does not state.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// Column of the instrument; `None` if all of them do it together.
    pub column: Option<Column>,
    /// What it does.
    pub flaw: Flaw,
}

/// What an instrument does.
#[derive(Debug, Clone, Copy, PartialEq, IntoStaticStr)]
#[strum(serialize_all = "snake_case")]
pub enum Flaw {
    /// No recording holds it.
    NotRecorded,
    /// Its white noise is not as large as stated; both as standard deviations, in the unit of the column.
    OtherNoise {
        /// As the model file has it.
        stated: f64,
        /// As the recordings have it.
        measured: f64,
    },
    /// Its noise is not white: neighbouring samples are correlated by this, 0 to 1.
    ColouredNoise {
        /// Correlation of neighbouring samples at the shortest sampling interval.
        correlation: f64,
    },
    /// The step of its converter is larger than the stated noise, in the unit of the column.
    CoarseSteps {
        /// Distance between neighbouring values.
        step: f64,
        /// Standard deviation of the noise as the model file has it.
        stated: f64,
    },
    /// Single readings are far off.
    Spikes {
        /// Number of these readings.
        readings: usize,
        /// Number of all readings.
        of: usize,
    },
    /// It sees the mains.
    MainsHum {
        /// Frequency and amplitude with their standard deviations.
        line: Line,
        /// Standard deviation of the noise that the column is judged by.
        noise: f64,
    },
    /// Samples are taken early or late; the standard deviation over the sampling interval.
    SamplingJitter {
        /// Standard deviation over the sampling interval.
        part: f64,
    },
}

/// A number of a finding with its 95 % interval, where there is one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Number {
    /// Its value, in SI units.
    pub value: f64,
    /// Ends of the interval.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ci95: Option<[f64; 2]>,
}

/// Two-sided 5 % point of a normal variable.
const NORMAL_95: f64 = 1.96;

impl Flaw {
    /// Name in the report: `mains_hum`.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.into()
    }

    /// Its numbers by name.
    #[must_use]
    pub fn numbers(&self) -> Vec<(&'static str, Number)> {
        let exact = |value: f64| Number { value, ci95: None };
        let with = |[value, deviation]: [f64; 2]| Number {
            value,
            ci95: Some([value - NORMAL_95 * deviation, value + NORMAL_95 * deviation]),
        };
        match *self {
            Self::NotRecorded => vec![],
            Self::OtherNoise { stated, measured } => vec![("stated", exact(stated)), ("measured", exact(measured))],
            Self::ColouredNoise { correlation } => vec![("correlation", exact(correlation))],
            Self::CoarseSteps { step, stated } => vec![("step", exact(step)), ("stated", exact(stated))],
            Self::Spikes { readings, of } => vec![("spikes", exact(readings as f64)), ("readings", exact(of as f64))],
            Self::MainsHum { line, .. } => vec![
                ("frequency_Hz", with(line.frequency_hz)),
                ("amplitude", with(line.amplitude)),
            ],
            Self::SamplingJitter { part } => vec![("part_of_interval", exact(part))],
        }
    }
}

impl Finding {
    /// The finding in one or two sentences: what the instrument does, what was done about it, and what to do.
    #[must_use]
    pub fn text(&self) -> String {
        let unit = self.column.as_ref().map_or("", Column::unit);
        let name = self.column.as_ref().map_or("All columns", Column::as_str);
        let digits = |v: f64| significant(v, 3);
        match self.flaw {
            Flaw::NotRecorded => format!(
                "{name} is not recorded. It is not compared, and what can be seen in it alone was not tested; record it if that matters."
            ),
            Flaw::OtherNoise { stated, measured } => format!(
                "{name} has a noise of {} {unit}, {} times the {} {unit} that the model file states. Its residuals are judged by \
                 what it has; correct [noise] if this is the sensor, and look for a disturbance or a filter if it is not.",
                digits(measured),
                digits(measured / stated),
                digits(stated)
            ),
            Flaw::ColouredNoise { correlation } => format!(
                "{name} has coloured noise: neighbouring samples are correlated by about {}. A filter or a disturbance makes this; the \
                 stated noise is taken for its size.",
                significant(correlation, 2)
            ),
            Flaw::CoarseSteps { step, stated } => format!(
                "{name} is recorded in steps of {} {unit}, more than the stated noise of {} {unit}. The rounding (step / sqrt(12)) is \
                 counted as noise; a converter with more bits or a smaller range would show more.",
                digits(step),
                digits(stated)
            ),
            Flaw::Spikes { readings, of } => format!(
                "{name} has {readings} spikes in {of} readings: single readings that are far off while their neighbours are not. They do \
                 not count; look for a loose contact or a disturbance."
            ),
            Flaw::MainsHum { line, noise } => {
                let [f, df] = line.frequency_hz;
                let [a, da] = line.amplitude;
                format!(
                    "{name} holds {} * sin(2 pi * {f:.3} Hz * t): amplitude {} +- {} {unit} ({} times the noise), frequency +- {} Hz, the \
                     phase free in each recording. It was taken off where the sampling is fast enough to tell it from the motion, and is counted as \
                     noise elsewhere; look for a ground loop or an unscreened cable.",
                    digits(a),
                    digits(a),
                    significant(NORMAL_95 * da, 2),
                    significant(a / noise, 2),
                    significant(NORMAL_95 * df, 2)
                )
            }
            Flaw::SamplingJitter { part } => format!(
                "{name} are sampled with jitter: readings are early or late by {} of the sampling interval (standard deviation), seen in a \
                 displacement whose noise grows with the speed. Noise in proportion to how fast each reading changes is added for it; sample \
                 by a hardware clock.",
                significant(part, 2)
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_finding_says_its_column_and_its_numbers() {
        let line = Line {
            frequency_hz: [50.02, 0.001],
            amplitude: [2800.0, 50.0],
        };
        let hum = Finding {
            column: Some(Column::known("p2_Pa")),
            flaw: Flaw::MainsHum { line, noise: 4e3 },
        };
        let text = hum.text();
        assert!(
            text.contains("p2_Pa") && text.contains("50.020 Hz") && text.contains("2800 +- 98 Pa"),
            "{text}"
        );
        assert_eq!(hum.flaw.name(), "mains_hum");
        assert_eq!(hum.flaw.numbers()[0].1.ci95, Some([50.02 - 0.00196, 50.02 + 0.00196]));
    }
}
