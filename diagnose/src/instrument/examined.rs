//! Recordings whose instruments have been examined.

use super::differences::REACH;
use super::finding::{Finding, Flaw};
use super::hum;
use super::jitter::{changes, jitter};
use super::noise::{LEAST_CORRELATION, Measured, at_most, measured};
use super::spikes::{Course, Spike, spikes};
use super::steps::{step, unknown_of_still};
use crate::recording::Recording;
use crate::vocabulary::Column;

/// Noise is called larger than stated above this, in units of what is stated with the rounding of the converter ...
const LARGER: f64 = 1.12;
/// ... and smaller below this. What is next to noiseless is a simulation or smoothed, and says nothing of a sensor.
const SMALLER: (f64, f64) = (0.25, 0.85);
/// White noise is the same at every sampling rate, to this part.
const SAME: f64 = 0.15;
/// A step of this part of the stated noise leaves its mark on differences: noise is then not called smaller.
const VISIBLE_STEP: f64 = 0.5;
/// A sample tells of the noise if jitter makes at most this of it.
const LITTLE_JITTER: f64 = 0.4;

/// A few readings that look like spikes may be anything, and cost nothing.
const FEWEST_SPIKES: usize = 5;

/// A column with the noise that the model file states.
#[derive(Debug, Clone)]
pub struct Stated {
    /// The column.
    pub column: Column,
    /// Standard deviation of its noise; 0 for an exact input.
    pub noise: f64,
}

/// Noise of the samples of one column of one recording, as multiples of the column's; `None` if all are 1.
type Relative = Option<Vec<f64>>;

/// What the recordings are to be judged by.
#[derive(Debug, Clone, Default)]
pub struct Examined {
    /// Names of the columns.
    columns: Vec<Column>,
    /// Standard deviation of the noise of each column: as stated, or as measured where that is something else.
    pub noise: Vec<f64>,
    /// Standard deviation of the noise of the first column, the motion, in each recording; where jitter adds to it, at rest.
    pub noise_of_motion: Vec<f64>,
    /// Step of the converter of the motion, if it is larger than the stated noise.
    pub step_of_motion: Option<f64>,
    /// Whether the motion is known much worse than stated, so that what it leaves unknown of the other columns counts as noise.
    pub motion_is_poor: bool,
    /// By recording and column.
    relative: Vec<Vec<Relative>>,
    /// What is wrong with the instruments.
    pub findings: Vec<Finding>,
}

impl Examined {
    /// Examines the first columns of recordings, of which the very first is the displacement. Spikes become missing readings (in
    /// the displacement, which is an input, a fitted curve replaces them), and mains hum is taken off. Nothing else of the recordings changes.
    #[must_use]
    pub fn of(recordings: &mut [Recording], stated: &[Stated]) -> Self {
        let steps: Vec<Option<f64>> = (0..stated.len()).map(|c| step(recordings, c)).collect();
        let rounded = |c: usize| {
            let coarse = steps[c].filter(|step| *step > stated[c].noise).unwrap_or(0.0);
            together(stated[c].noise, coarse / 12.0_f64.sqrt())
        };
        let mut out = Self {
            columns: stated.iter().map(|s| s.column.clone()).collect(),
            noise: (0..stated.len()).map(rounded).collect(),
            noise_of_motion: vec![],
            step_of_motion: steps.first().copied().flatten().filter(|step| *step > stated[0].noise),
            motion_is_poor: false,
            relative: vec![vec![None; stated.len()]; recordings.len()],
            findings: vec![],
        };
        for (c, stated) in stated.iter().enumerate() {
            if let Some(step) = steps[c].filter(|step| *step > stated.noise && stated.noise > 0.0) {
                out.find(
                    stated,
                    Flaw::CoarseSteps {
                        step,
                        stated: stated.noise,
                    },
                );
            }
        }
        out.motion_is_poor = out.step_of_motion.is_some();
        let part = (stated.first()).and_then(|motion| jitter(recordings, motion.noise.max(out.noise[0])));
        if let Some(part) = part {
            out.motion_is_poor = true;
            out.findings.push(Finding {
                column: None,
                flaw: Flaw::SamplingJitter { part },
            });
        }
        for (c, stated) in stated.iter().enumerate() {
            out.measure(recordings, c, stated, steps[c], part);
        }
        if let Some(part) = part {
            out.count_jitter(recordings, part);
        }
        out.take_out_spikes(recordings, stated);
        out.noise_of_motion = vec![out.noise.first().copied().unwrap_or(0.0); recordings.len()];
        for (c, stated) in stated.iter().enumerate() {
            out.take_off_hum(recordings, c, stated);
        }
        out
    }

    /// The same of what a vehicle logs, where wheels move about as fast as the bus samples: columns may have less noise than is stated with the rounding
    /// of the bus, and readings may stand still. `rounded_to` are the steps of the columns, 0 where they are not rounded; `beside_model` are the
    /// readings of all columns but the first less what the believed model makes of them, by column and recording. Nothing of the recordings changes.
    #[must_use]
    pub fn of_drives(
        recordings: &[Recording],
        stated: &[Stated],
        rounded_to: &[f64],
        beside_model: &[Vec<Vec<f64>>],
    ) -> Self {
        let mut out = Self {
            columns: stated.iter().map(|s| s.column.clone()).collect(),
            noise: stated.iter().map(|s| s.noise).collect(),
            relative: vec![vec![None; stated.len()]; recordings.len()],
            ..Self::default()
        };
        for (c, stated) in stated.iter().enumerate().skip(1) {
            let rounding = rounded_to[c] / 12.0_f64.sqrt();
            if let Some(most) = beside_model.get(c - 1).and_then(|of_column| at_most(of_column)) {
                // The rounding is there also where little moves.
                let measured = most.max(rounding).max(SMALLER.0 * stated.noise);
                if measured < SMALLER.1 * stated.noise {
                    out.noise[c] = measured;
                    out.find(
                        stated,
                        Flaw::OtherNoise {
                            stated: stated.noise,
                            measured,
                        },
                    );
                }
            }
            for (r, recording) in recordings.iter().enumerate().filter(|_| rounding > 0.0) {
                let deviations = unknown_of_still(&recording.columns[c], rounding);
                if deviations.iter().any(|deviation| *deviation > 0.0) {
                    out.add_noise(r, c, &deviations);
                }
            }
        }
        out
    }

    /// Noise of the samples of a column of a recording, as multiples of the column's; `None` if all are 1.
    #[must_use]
    pub fn relative(&self, recording: usize, column: usize) -> Option<&[f64]> {
        self.relative.get(recording)?.get(column)?.as_deref()
    }

    /// Noise of the samples of the motion of a recording, where they differ: in proportion to the speed.
    #[must_use]
    pub fn noise_of_moving_samples(&self, recording: usize) -> Option<Vec<f64>> {
        let noise = self.noise_of_motion[recording];
        let relative = self.relative(recording, 0)?;
        Some(relative.iter().map(|relative| noise * relative).collect())
    }

    /// Adds noise to the samples of a column of a recording, one standard deviation a sample, in the unit of the column.
    pub fn add_noise(&mut self, recording: usize, column: usize, deviations: &[f64]) {
        let noise = self.noise[column];
        let relative = self.relative[recording][column].get_or_insert_with(|| vec![1.0; deviations.len()]);
        (relative.iter_mut().zip(deviations)).for_each(|(v, deviation)| *v = together(*v, deviation / noise));
    }

    /// Takes out further spikes of the columns that have some, where the readings less what a model makes of them say so: what
    /// the specimen does fast does not hide them there. `believed` are all columns but the first, by recording; `None` if the model
    /// cannot be simulated.
    pub fn take_out_spikes_beside(&mut self, recordings: &mut [Recording], believed: &[Option<Vec<Vec<f64>>>]) {
        let mut beside = recordings.to_vec();
        for (recording, believed) in beside.iter_mut().zip(believed) {
            // What cannot be simulated says nothing new.
            let Some(believed) = believed else { continue };
            for (series, believed) in recording.columns.iter_mut().skip(1).zip(believed) {
                series.iter_mut().zip(believed).for_each(|(v, believed)| *v -= believed);
            }
        }
        let found = self.spikes(&beside, Course::Smooth);
        for finding in &mut self.findings {
            let (Some(name), Flaw::Spikes { readings, .. }) = (&finding.column, &mut finding.flaw) else {
                continue;
            };
            let Some(c) = self.columns.iter().position(|column| column == name).filter(|c| *c > 0) else {
                continue;
            };
            for (recording, found) in recordings.iter_mut().zip(&found) {
                *readings += found[c].len();
                (found[c].iter()).for_each(|spike| recording.columns[c][spike.sample] = f64::NAN);
            }
        }
    }

    /// Spikes of all columns, by recording and column.
    fn spikes(&self, recordings: &[Recording], others: Course) -> Vec<Vec<Vec<Spike>>> {
        spikes(recordings, self.noise.len(), others, &|r, c, k| {
            self.noise[c] * self.relative(r, c).map_or(1.0, |relative| relative[k])
        })
    }

    fn find(&mut self, stated: &Stated, flaw: Flaw) {
        self.findings.push(Finding {
            column: Some(stated.column.clone()),
            flaw,
        });
    }

    /// Compares the noise of a column with what is stated.
    fn measure(
        &mut self,
        recordings: &[Recording],
        column: usize,
        stated: &Stated,
        step: Option<f64>,
        jitter: Option<f64>,
    ) {
        let expected = self.noise[column];
        let slow = jitter.map(|part| -> Vec<Vec<bool>> {
            let slow = |change: &f64| part * change.abs() < LITTLE_JITTER * expected;
            recordings
                .iter()
                .map(|r| changes(&r.columns[column]).iter().map(slow).collect())
                .collect()
        });
        let counts = |r: usize, k: usize| slow.as_ref().is_none_or(|slow| slow[r][k + REACH / 2]);
        let Some(found) = measured(recordings, column, &counts).filter(|_| expected > 0.0) else {
            return;
        };
        if found.fast > LARGER * expected {
            self.noise[column] = found.fast;
            self.find(
                stated,
                Flaw::OtherNoise {
                    stated: stated.noise,
                    measured: found.fast,
                },
            );
        } else if found.fast < SMALLER.1 * stated.noise && step.is_none_or(|step| step < VISIBLE_STEP * stated.noise) {
            if found.correlation > LEAST_CORRELATION {
                self.find(
                    stated,
                    Flaw::ColouredNoise {
                        correlation: found.correlation,
                    },
                );
            } else if found.fast > SMALLER.0 * stated.noise && is_same_at_every_rate(&found) {
                self.noise[column] = found.fast;
                self.find(
                    stated,
                    Flaw::OtherNoise {
                        stated: stated.noise,
                        measured: found.fast,
                    },
                );
            }
        }
    }

    /// Noise from jitter, in proportion to how fast each reading changes.
    fn count_jitter(&mut self, recordings: &[Recording], part: f64) {
        for (own, r) in self.relative.iter_mut().zip(recordings) {
            for ((relative, series), noise) in own.iter_mut().zip(&r.columns).zip(&self.noise) {
                let of = |change: &f64| together(1.0, part * change / noise);
                *relative = Some(changes(series).iter().map(of).collect());
            }
        }
    }

    /// Makes missing readings of spikes.
    fn take_out_spikes(&mut self, recordings: &mut [Recording], stated: &[Stated]) {
        let found = self.spikes(recordings, Course::WithPulses);
        let count = |c: usize| found.iter().map(|of| of[c].len()).sum();
        let counts: Vec<usize> = (0..stated.len()).map(count).collect();
        for (recording, found) in recordings.iter_mut().zip(&found) {
            for (c, (own, series)) in found.iter().zip(&mut recording.columns).enumerate() {
                for spike in own.iter().filter(|_| counts[c] >= FEWEST_SPIKES) {
                    // The motion is an input and must be known everywhere.
                    series[spike.sample] = if c == 0 { spike.instead } else { f64::NAN };
                }
            }
        }
        let of = recordings.iter().map(Recording::len).sum();
        for (stated, readings) in stated.iter().zip(counts) {
            if readings >= FEWEST_SPIKES {
                self.find(stated, Flaw::Spikes { readings, of });
            }
        }
    }

    /// Takes mains hum off a column, and counts it as noise where the sampling is too slow for that.
    fn take_off_hum(&mut self, recordings: &mut [Recording], column: usize, stated: &Stated) {
        let noise = self.noise[column];
        let Some(line) = hum::line(recordings, column, noise).filter(|_| noise > 0.0) else {
            return;
        };
        let rest = line.amplitude[0] / std::f64::consts::SQRT_2;
        for (r, recording) in recordings.iter_mut().enumerate() {
            let interval_s = recording.interval_s();
            if hum::take_off(&mut recording.columns[column], interval_s, line.frequency_hz[0]) {
                continue;
            }
            if column == 0 {
                self.noise_of_motion[r] = together(self.noise_of_motion[r], rest);
                continue;
            }
            let samples = recording.len();
            let relative = self.relative[r][column].get_or_insert_with(|| vec![1.0; samples]);
            relative.iter_mut().for_each(|v| *v = together(*v, rest / noise));
        }
        self.find(stated, Flaw::MainsHum { line, noise });
    }
}

/// White noise is the same whether it is sampled fast or slowly; what a filter or the motion makes is not.
fn is_same_at_every_rate(found: &Measured) -> bool {
    found.slow.is_none_or(|slow| (slow / found.fast - 1.0).abs() < SAME)
}

/// Standard deviation of the sum of two independent errors; exactly the first where there is no other.
fn together(a: f64, b: f64) -> f64 {
    if b == 0.0 { a } else { (a * a + b * b).sqrt() }
}
