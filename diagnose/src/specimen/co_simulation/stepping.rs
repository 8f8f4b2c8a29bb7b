//! The times of a simulation, and what is driven at them from the samples of a recording.

use super::map::{Instant, Running};
use super::simulator::Stepping;
use crate::correction::between;

/// A step may be longer than asked for by this part of it, so that rounding makes no step of its own.
const ROUNDING: f64 = 1e-9;

/// The times of the simulation of one recording.
pub struct Times {
    /// Times of the model, s: they begin at zero, where the recording has not begun if there is time to settle.
    pub model_s: Vec<f64>,
    /// The same as times since the first sample, s: those of settling are negative.
    pub recording_s: Vec<f64>,
    /// Time of each sample since the first, s.
    pub samples_s: Vec<f64>,
    /// Where each sample is among the times; `None` where the model's steps are its own.
    first_sample: Option<usize>,
}

impl Times {
    /// Steps from sample to sample, or even ones.
    ///
    /// # Errors
    /// The model takes only steps of one length, and nobody says of which.
    pub fn of(time_s: &[f64], interval_s: f64, running: &Running, stepping: Stepping) -> Result<Self, String> {
        let begin = time_s.first().copied().unwrap_or(0.0);
        let samples_s: Vec<f64> = time_s.iter().map(|t| t - begin).collect();
        let step = match (running.step_s, stepping.variable) {
            (Some(step), _) => Some(step),
            (None, true) => None,
            (None, false) => Some(stepping.step_s.ok_or(
                "the model takes only steps of one length and does not say of which; state run.step_s in the map",
            )?),
        };
        let settle = running.settle_s;
        let (recording_s, first_sample) = match step {
            Some(step) => {
                let duration = settle + samples_s.last().copied().unwrap_or(0.0);
                let count = (duration / step - ROUNDING).ceil().max(1.0) as usize;
                // From zero on, so that the model's own times are multiples of its step.
                ((0..=count).map(|k| step * k as f64 - settle).collect(), None)
            }
            None => {
                let count = (settle / interval_s.max(1e-9) - ROUNDING).ceil().max(0.0) as usize;
                let before = (0..count).map(|k| settle * (k as f64 / count as f64 - 1.0));
                let all: Vec<f64> = before.chain(samples_s.iter().copied()).collect();
                (all, Some(count))
            }
        };
        Ok(Self {
            model_s: (recording_s.iter().enumerate())
                .map(|(k, t)| match step {
                    Some(step) => step * k as f64,
                    None => t + settle,
                })
                .collect(),
            recording_s,
            samples_s,
            first_sample,
        })
    }

    /// Values at the times as values at the samples.
    #[must_use]
    pub fn at_samples(&self, values: &[f64]) -> Vec<f64> {
        match self.first_sample {
            Some(first) => values[first.min(values.len())..].to_vec(),
            None => {
                let mut at = 0;
                (self.samples_s.iter())
                    .map(|t| between(&self.recording_s, values, *t, &mut at))
                    .collect()
            }
        }
    }

    /// Samples at each of some times. What switches holds until the next sample.
    fn of_samples(&self, times_s: impl Iterator<Item = f64>, values: &[f64], switches: bool) -> Vec<f64> {
        let mut at = 0;
        times_s
            .map(|t| {
                if switches {
                    let next = self.samples_s.partition_point(|s| *s <= t + ROUNDING);
                    values[next.saturating_sub(1)]
                } else {
                    between(&self.samples_s, values, t, &mut at)
                }
            })
            .collect()
    }

    /// The values of a column during each step and at each time.
    #[must_use]
    pub fn driven(&self, values: &[f64], switches: bool, instant: Instant) -> (Vec<f64>, Vec<f64>) {
        let at = self.of_samples(self.recording_s.iter().copied(), values, switches);
        let steps = self.recording_s.windows(2);
        let during = match instant {
            Instant::Begin => at[..at.len() - 1].to_vec(),
            Instant::End => at[1..].to_vec(),
            Instant::Middle => self.of_samples(steps.map(|w| 0.5 * (w[0] + w[1])), values, switches),
        };
        (during, at)
    }

    /// The mean rate of a column in each step, per second, and the rate at each time: that of the parabola through its neighbours.
    #[must_use]
    pub fn rate(&self, values: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let at = self.of_samples(self.recording_s.iter().copied(), values, false);
        let during: Vec<f64> = (self.recording_s.windows(2).zip(at.windows(2)))
            .map(|(t, x)| (x[1] - x[0]) / (t[1] - t[0]))
            .collect();
        let steps: Vec<f64> = self.recording_s.windows(2).map(|t| t[1] - t[0]).collect();
        let inside =
            (during.windows(2).zip(steps.windows(2))).map(|(r, h)| (r[0] * h[1] + r[1] * h[0]) / (h[0] + h[1]));
        let ends = |rate: Option<&f64>| rate.copied().into_iter();
        let rates = ends(during.first()).chain(inside).chain(ends(during.last())).collect();
        (during, rates)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const VARIABLE: Stepping = Stepping {
        variable: true,
        step_s: None,
    };

    fn times(step_s: Option<f64>, settle_s: f64) -> Times {
        let running = Running {
            step_s,
            settle_s,
            ..Running::default()
        };
        Times::of(&[5.0, 5.1, 5.3, 5.4], 0.1, &running, VARIABLE).expect("times")
    }

    fn near(a: &[f64], b: &[f64]) -> bool {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9)
    }

    #[test]
    fn steps_go_from_sample_to_sample() {
        let times = times(None, 0.0);
        assert!(near(&times.model_s, &[0.0, 0.1, 0.3, 0.4]));
        let (during, at) = times.driven(&[0.0, 1.0, 3.0, 4.0], false, Instant::Middle);
        assert!(near(&during, &[0.5, 2.0, 3.5]) && near(&at, &[0.0, 1.0, 3.0, 4.0]));
        let (during, _) = times.driven(&[0.0, 1.0, 1.0, 0.0], true, Instant::Begin);
        assert!(near(&during, &[0.0, 1.0, 1.0]));
        let (during, at) = times.rate(&[0.0, 1.0, 3.0, 4.0]);
        assert!(near(&during, &[10.0; 3]) && near(&at, &[10.0; 4]));
        let parabola: Vec<f64> = times.samples_s.iter().map(|t| t * t).collect();
        assert!(near(&times.rate(&parabola).1[1..3], &[0.2, 0.6]));
        assert!(near(&times.at_samples(&[7.0, 8.0, 9.0, 10.0]), &[7.0, 8.0, 9.0, 10.0]));
    }

    #[test]
    fn what_comes_before_the_recording_holds_its_first_sample() {
        let times = times(None, 0.25);
        assert!(near(
            &times.model_s,
            &[0.0, 0.25 / 3.0, 0.5 / 3.0, 0.25, 0.35, 0.55, 0.65]
        ));
        let (during, at) = times.driven(&[2.0, 1.0, 3.0, 4.0], false, Instant::Begin);
        assert!(near(&during, &[2.0, 2.0, 2.0, 2.0, 1.0, 3.0]) && near(&at[..4], &[2.0; 4]));
        let (rates, _) = times.rate(&[2.0, 1.0, 3.0, 4.0]);
        assert!(near(&rates, &[0.0, 0.0, 0.0, -10.0, 10.0, 10.0]));
        assert!(near(
            &times.at_samples(&[0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0]),
            &[1.0, 2.0, 3.0, 4.0]
        ));
    }

    #[test]
    fn even_steps_are_read_between() {
        let times = times(Some(0.15), 0.0);
        assert!(near(&times.model_s, &[0.0, 0.15, 0.3, 0.45]));
        assert!(near(&times.at_samples(&[0.0, 1.5, 3.0, 4.5]), &[0.0, 1.0, 3.0, 4.0]));
        let stubborn = Stepping {
            variable: false,
            step_s: None,
        };
        assert!(Times::of(&[0.0, 1.0], 1.0, &Running::default(), stubborn).is_err());
    }
}
