//! Where a law that swings in time may begin: frequencies that the residual holds and the excitation does not.
//!
//! A law that swings about what is believed answers, slowly enough, as the same law would if it were constant, times a sine. So the residual is
//! multiplied by the answer to the constant law, its *envelope*, and a line is looked for in the spectrum of the product: a friction that
//! swings shows in no line of the residual itself, because it changes its sign with the motion. The power at a frequency, over
//! what is usual nearby, has an exponential distribution under noise (Schuster, Terr. Magn. 3(1), 1898); its sum over the recordings needs no common
//! phase.
//!
//! A recording whose actuator or valves repeat at a frequency says nothing at it and at its multiples: whatever depends on the motion
//! swings there too. Where only such recordings hold a line, it is the excitation's, and time cannot be told from motion.

use std::collections::BTreeSet;
use std::f64::consts::{LN_2, TAU};

use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

use crate::median::median;
use crate::specimen::{Series, Specimen};

/// Highest frequency that is searched, Hz. Above are the mains, which the instruments are asked for.
const HIGHEST_HZ: f64 = 40.0;
/// Samples are summed up to about this interval, s.
const INTERVAL_S: f64 = 0.01;
/// Highest frequency as a part of the sampling frequency.
const HIGHEST_OF_SAMPLING: f64 = 0.4;
/// Frequencies of the grid in the width of a line of the longest recording.
const GRID: f64 = 4.0;
/// A recording shows an oscillation of which it holds at least this many turns.
const LEAST_TURNS: f64 = 2.0;
/// What is usual is the median of so many widths of a line on either side.
const NEARBY: f64 = 10.0;
/// Residuals are limited to this many of their standard deviations: an edge of a valve holds all frequencies.
const LIMIT: f64 = 4.0;
/// Most lines that are tried.
const MOST: usize = 3;
/// An input repeats if one of its frequencies, of this many turns or more, ...
const LEAST_TURNS_OF_INPUT: f64 = 3.0;
/// ... holds at least this part of its power: of a sine all, of a square wave four fifths. Of bursts of different frequencies none does.
const LEAST_PART_OF_INPUT: f64 = 0.5;
/// Multiples of an input's frequency at which whatever depends on it may swing.
const MULTIPLES: usize = 8;
/// Half the width of a line of a recording, in lines of one over its duration.
const HALF_WIDTH: f64 = 1.5;

/// A frequency that a residual holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// The frequency, Hz.
    pub frequency_hz: f64,
    /// Power over what is usual nearby, the sum over the recordings, beyond what noise would have.
    pub strength: f64,
}

/// Spectra of the recordings of a specimen on one grid of frequencies.
pub struct Oscillations {
    /// Distance of the frequencies, Hz.
    step_hz: f64,
    /// Number of frequencies, from zero.
    count: usize,
    recordings: Vec<OneRecording>,
}

struct OneRecording {
    interval_s: f64,
    duration_s: f64,
    /// Whether each frequency is one at which the inputs repeat.
    is_of_input: Vec<bool>,
}

impl Oscillations {
    /// Prepares the search beside the inputs of a specimen's recordings.
    #[must_use]
    pub fn of(specimen: &dyn Specimen) -> Self {
        let all = specimen.recordings();
        let duration = |time_s: &[f64]| time_s.last().copied().unwrap_or(0.0) - time_s.first().copied().unwrap_or(0.0);
        let longest_s = all.iter().map(|r| duration(&r.time_s)).fold(1.0, f64::max);
        let step_hz = 1.0 / (GRID * longest_s);
        let mut oscillations = Self {
            step_hz,
            count: (HIGHEST_HZ / step_hz) as usize + 1,
            recordings: Vec::new(),
        };
        let channels = specimen.channels().len();
        let mut planner = FftPlanner::new();
        for r in all {
            let mut one = OneRecording {
                interval_s: r.interval_s(),
                duration_s: duration(&r.time_s),
                is_of_input: vec![false; oscillations.count],
            };
            // The motion, and whatever is given besides, such as the switching signals.
            for (c, input) in r.columns.iter().enumerate() {
                if c == 0 || c > channels {
                    oscillations.mark_input(&mut one, input, &mut planner);
                }
            }
            oscillations.recordings.push(one);
        }
        oscillations
    }

    /// The strongest lines that recordings hold at which their own inputs do not repeat, the strongest first. `envelopes` is the answer to a
    /// constant law, by which the residuals are multiplied.
    #[must_use]
    pub fn lines(&self, residuals: &[&Series], envelopes: &[Series]) -> Vec<Line> {
        let spectra = self.spectra(residuals, |r, c| Some(envelopes[r][c].as_slice()));
        self.peaks(&self.strengths(&spectra, true))
    }

    /// The same of the residuals as they are, each channel on its own.
    #[must_use]
    pub fn lines_of_channels(&self, residuals: &[&Series]) -> Vec<Line> {
        self.of_channels(residuals, true)
    }

    /// Frequencies that only recordings hold whose inputs repeat at them, Hz, the strongest first.
    #[must_use]
    pub fn of_excitation(&self, residuals: &[&Series]) -> Vec<f64> {
        let free = self.of_channels(residuals, true);
        let width_hz = 2.0 * GRID * self.step_hz;
        (self.of_channels(residuals, false).into_iter())
            .filter(|line| {
                let k = self.index(line.frequency_hz);
                let is_of_input = self.recordings.iter().any(|r| r.is_of_input[k]);
                is_of_input
                    && free
                        .iter()
                        .all(|other| (other.frequency_hz - line.frequency_hz).abs() > width_hz)
            })
            .map(|line| line.frequency_hz)
            .collect()
    }

    fn of_channels(&self, residuals: &[&Series], without_inputs: bool) -> Vec<Line> {
        let channels = residuals.first().map_or(0, |r| r.len());
        let mut all: Vec<Line> = (0..channels)
            .flat_map(|channel| {
                let spectra = self.spectra(residuals, |_, c| (c == channel).then_some(&[][..]));
                self.peaks(&self.strengths(&spectra, without_inputs))
            })
            .collect();
        all.sort_by(|a, b| b.strength.total_cmp(&a.strength));
        let mut lines: Vec<Line> = Vec::new();
        for line in all {
            let near = |other: &Line| (other.frequency_hz - line.frequency_hz).abs() < GRID * self.step_hz;
            if !lines.iter().any(near) {
                lines.push(line);
            }
        }
        lines.truncate(MOST);
        lines
    }

    fn index(&self, frequency_hz: f64) -> usize {
        ((frequency_hz / self.step_hz).round() as usize).min(self.count - 1)
    }

    /// Power of each recording at each frequency, over what is usual nearby; zero where the recording does not show it. The envelope of
    /// a channel is given by recording and channel: `None` leaves the channel out, an empty one is one everywhere.
    fn spectra<'e>(
        &self,
        residuals: &[&Series],
        envelope: impl Fn(usize, usize) -> Option<&'e [f64]>,
    ) -> Vec<Vec<f64>> {
        let mut planner = FftPlanner::new();
        (self.recordings.iter().zip(residuals).enumerate())
            .map(|(r, (one, residual))| {
                let mut product = vec![0.0; residual.first().map_or(0, Vec::len)];
                for (c, series) in residual.iter().enumerate() {
                    let Some(envelope) = envelope(r, c) else { continue };
                    let limit = LIMIT * deviation_of_middle(series).max(1.0);
                    for (k, (sum, value)) in product.iter_mut().zip(series).enumerate() {
                        *sum += value.clamp(-limit, limit) * envelope.get(k).copied().unwrap_or(1.0);
                    }
                }
                let mut power = self.powers(one, &product, &mut planner);
                self.over_usual(one, &mut power);
                power
            })
            .collect()
    }

    /// Power of a series at each frequency, with a Hann window.
    fn powers(&self, one: &OneRecording, series: &[f64], planner: &mut FftPlanner<f64>) -> Vec<f64> {
        let together = ((INTERVAL_S / one.interval_s).round() as usize).max(1);
        let interval_s = together as f64 * one.interval_s;
        let mean = series.iter().sum::<f64>() / series.len().max(1) as f64;
        let sums: Vec<f64> = (series.chunks_exact(together))
            .map(|chunk| chunk.iter().map(|v| v - mean).sum())
            .collect();
        let n = sums.len() as f64;
        let mut values: Vec<Complex<f64>> = (sums.iter().enumerate())
            .map(|(k, v)| Complex::new(v * (0.5 - 0.5 * libm::cos(TAU * (k as f64 + 0.5) / n)), 0.0))
            .collect();
        let length = ((1.0 / (self.step_hz * interval_s)).round() as usize).max(values.len());
        values.resize(length, Complex::new(0.0, 0.0));
        planner.plan_fft_forward(length).process(&mut values);
        let shown = (HIGHEST_OF_SAMPLING * length as f64) as usize;
        (0..self.count)
            .map(|k| if k < shown { values[k].norm_sqr() } else { 0.0 })
            .collect()
    }

    /// Divides powers by their mean nearby, taken from the median; what a recording is too short to show is set to zero.
    fn over_usual(&self, one: &OneRecording, power: &mut [f64]) {
        if one.duration_s <= 0.0 {
            power.fill(0.0);
            return;
        }
        let first = (LEAST_TURNS / (one.duration_s * self.step_hz)).ceil() as usize;
        let shown = power.iter().rposition(|p| *p > 0.0).map_or(0, |last| last + 1);
        let nearby = (NEARBY / (one.duration_s * self.step_hz)).ceil() as usize;
        let stretch = (nearby / 4).max(1);
        let usual: Vec<f64> = (0..shown.div_ceil(stretch))
            .map(|s| {
                let middle = s * stretch + stretch / 2;
                let (from, to) = (middle.saturating_sub(nearby).max(1), (middle + nearby).min(shown));
                median(power.get(from..to).unwrap_or_default().to_vec()) / LN_2
            })
            .collect();
        for (k, p) in power.iter_mut().enumerate() {
            let usual = usual.get(k / stretch).copied().unwrap_or(0.0);
            *p = if k >= first && usual > 0.0 { *p / usual } else { 0.0 };
        }
    }

    /// Sum of the powers over the recordings beyond what noise has at most; without those recordings whose inputs repeat at the frequency, if
    /// so wished.
    fn strengths(&self, spectra: &[Vec<f64>], without_inputs: bool) -> Vec<f64> {
        (0..self.count)
            .map(|k| {
                let (mut sum, mut count) = (0.0, 0.0);
                for (one, power) in self.recordings.iter().zip(spectra) {
                    if power[k] > 0.0 && !(without_inputs && one.is_of_input[k]) {
                        sum += power[k];
                        count += 1.0;
                    }
                }
                sum - most_of_noise(count)
            })
            .collect()
    }

    /// The highest peaks above zero, the highest first.
    fn peaks(&self, strengths: &[f64]) -> Vec<Line> {
        let mut open: BTreeSet<usize> = (0..strengths.len()).filter(|&k| strengths[k] > 0.0).collect();
        let mut lines = Vec::new();
        while lines.len() < MOST {
            let Some(&peak) = open.iter().max_by(|&&a, &&b| strengths[a].total_cmp(&strengths[b])) else {
                break;
            };
            let top = strengths[peak];
            lines.push(Line {
                frequency_hz: (peak as f64 + vertex(strengths, peak)) * self.step_hz,
                strength: top,
            });
            // Its slopes belong to it, and so does what its window spreads.
            let spread = (2.0 * GRID) as usize;
            let below = |k: usize| k.abs_diff(peak) > spread && strengths[k] < 0.5 * top;
            let from = (0..peak).rev().find(|&k| below(k)).map_or(0, |k| k + 1);
            let to = (peak..strengths.len()).find(|&k| below(k)).unwrap_or(strengths.len());
            open.retain(|k| *k < from || *k >= to);
        }
        lines
    }

    /// Marks the frequencies at which an input repeats, and their multiples.
    fn mark_input(&self, one: &mut OneRecording, input: &[f64], planner: &mut FftPlanner<f64>) {
        if one.duration_s <= 0.0 || input.iter().any(|v| !v.is_finite()) {
            return;
        }
        let power = self.powers(one, input, planner);
        let width = HALF_WIDTH / (one.duration_s * self.step_hz);
        let half = width.ceil() as usize;
        let first = (1.0 / (one.duration_s * self.step_hz)).ceil() as usize;
        let least = (LEAST_TURNS_OF_INPUT / (one.duration_s * self.step_hz)).ceil() as usize;
        let total: f64 = power.iter().skip(first).sum();
        if total <= 0.0 {
            return;
        }
        for k in least.max(1)..self.count {
            let (from, to) = (k.saturating_sub(half), (k + half + 1).min(self.count));
            let is_highest = power[from..to].iter().all(|p| *p <= power[k]);
            if !is_highest || power[from..to].iter().sum::<f64>() < LEAST_PART_OF_INPUT * total {
                continue;
            }
            for multiple in 1..=MULTIPLES {
                let (low, high) = ((multiple * k).saturating_sub(half), multiple * k + half);
                (low..=high.min(self.count - 1)).for_each(|at| one.is_of_input[at] = true);
            }
        }
    }
}

/// Standard deviation of values about zero, from the median of their size.
fn deviation_of_middle(values: &[f64]) -> f64 {
    1.4826 * median(values.iter().map(|v| v.abs()).collect())
}

/// The sum of as many exponentially distributed powers, of mean one, that noise seldom exceeds. A line is where a law may begin; whether there is
/// one, held-out blocks decide.
fn most_of_noise(count: f64) -> f64 {
    count + 4.5 * count.sqrt() + 9.0
}

/// Where a parabola through a peak and its neighbours has its vertex, in steps from the peak.
fn vertex(values: &[f64], peak: usize) -> f64 {
    let (Some(a), Some(c)) = (peak.checked_sub(1).and_then(|k| values.get(k)), values.get(peak + 1)) else {
        return 0.0;
    };
    let bend = a - 2.0 * values[peak] + c;
    if bend < 0.0 {
        (0.5 * (a - c) / bend).clamp(-0.5, 0.5)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{Analytic, CUBIC, FRICTION, RUN, Recipe, SWING};
    use crate::estimation::{Evaluation, LeastSquares, Point, fit};
    use crate::search::select;

    const FREQUENCY_HZ: f64 = 1.7;

    fn specimen(seed: u64, truth: &[(usize, &[f64])]) -> Analytic {
        Recipe {
            seed,
            truth: truth.iter().map(|&(law, values)| (law, values.to_vec())).collect(),
            candidates: vec![CUBIC, FRICTION, SWING],
            ..Recipe::default()
        }
        .make()
    }

    /// What the calibrated model leaves.
    fn left(specimen: &Analytic) -> Vec<Series> {
        let problem = LeastSquares::new(specimen, &RUN);
        let calibrated = fit(&problem, Point::nominal(specimen), problem.criteria.fitting.converged).expect("a fit");
        problem.evaluation.residuals_at(&calibrated.point).expect("residuals")
    }

    /// The answer to a friction of constant level.
    fn envelopes(specimen: &Analytic) -> Vec<Series> {
        let point = Point::nominal(specimen).with_effect(specimen, FRICTION, &[0.0]);
        let answers = Evaluation::new(specimen, &RUN).sensitivities(&point, &[2], None);
        (answers.expect("answers").into_iter())
            .map(|mut s| s.columns.swap_remove(0))
            .collect()
    }

    #[test]
    fn a_level_that_swings_shows_beside_the_answer_to_a_constant_level() {
        for seed in 0..4 {
            let specimen = specimen(seed, &[(SWING, &[0.06, 0.4, FREQUENCY_HZ])]);
            let (residuals, envelopes) = (left(&specimen), envelopes(&specimen));
            let residuals: Vec<&Series> = residuals.iter().collect();
            let lines = Oscillations::of(&specimen).lines(&residuals, &envelopes);
            assert!((lines[0].frequency_hz - FREQUENCY_HZ).abs() < 0.01, "{lines:?}");
        }
    }

    #[test]
    fn noise_seldom_holds_a_line_and_never_a_law() {
        let mut lines = 0;
        for seed in 0..20 {
            let specimen = specimen(seed, &[]);
            let (residuals, envelopes) = (left(&specimen), envelopes(&specimen));
            let residuals: Vec<&Series> = residuals.iter().collect();
            let all = Oscillations::of(&specimen);
            lines += all.lines(&residuals, &envelopes).len() + all.lines_of_channels(&residuals).len();
            let found = select(&LeastSquares::new(&specimen, &RUN), &|_, _| {}).expect("a selection");
            assert!(
                found.effects.is_empty() && found.of_excitation_hz.is_empty(),
                "seed {seed}"
            );
        }
        assert!(lines <= 3, "{lines} lines in 60 spectra");
    }

    #[test]
    fn what_the_motion_makes_is_no_law_of_time() {
        // A cubic stiffness answers at the frequencies of the motion, at three times those, and at their sums.
        let specimen = specimen(1, &[(CUBIC, &[0.3])]);
        let residuals = left(&specimen);
        let residuals: Vec<&Series> = residuals.iter().collect();
        let all = Oscillations::of(&specimen);
        // The three recordings move at 0.14 to 0.20 Hz.
        let of_motion = all.of_excitation(&residuals);
        assert!(of_motion.iter().any(|f| (0.13..0.21).contains(f)), "{of_motion:?}");
    }

    #[test]
    fn the_search_finds_the_law_with_its_numbers_and_nothing_else() {
        for (amplitude, phase) in [(0.05, 0.4), (0.3, -2.0), (2.0, 3.0)] {
            let specimen = specimen(2, &[(SWING, &[amplitude, phase, FREQUENCY_HZ])]);
            let found = select(&LeastSquares::new(&specimen, &RUN), &|_, _| {}).expect("a selection");
            assert_eq!(found.best.point.effects, [SWING], "{amplitude}");
            let numbers = &found.best.point.hypothesis(&specimen).effects[0].1;
            assert!((numbers[0] - amplitude).abs() < 0.02, "{numbers:?}");
            assert!((numbers[2] - FREQUENCY_HZ).abs() < 0.003, "{numbers:?}");
            let off = (numbers[1] - phase) / TAU;
            assert!((off - off.round()).abs() < 0.1, "{numbers:?}");
            assert!(!found.incomplete && found.of_excitation_hz.is_empty());
        }
    }
}
