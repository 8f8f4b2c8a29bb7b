//! Jitter of the sampling: readings that were taken early or late.
//!
//! A sample that is late by *j* shows a displacement that is off by the speed times *j*. The noise of the displacement then grows
//! with the speed, which no noise of a sensor and no converter does.

use super::differences::{REACH, deviation, difference};
use crate::recording::Recording;

/// Groups of equal size by speed.
const GROUPS: usize = 10;
/// Fewest samples of a recording.
const FEWEST_SAMPLES: usize = 200;
/// In the fastest group the variance from jitter must be this many times what the noise makes.
const VISIBLE: f64 = 3.0;
/// A recording tells of jitter if this part of its sampling interval would be visible at its speeds.
const TOLD_FROM: f64 = 0.03;
/// Least jitter that is reported, as a part of the sampling interval.
const LEAST: f64 = 0.02;

/// Standard deviation of the sampling times over the sampling interval; `None` where there is nothing to see. `noise` is that of
/// the displacement, in the first column, with its steps.
pub fn jitter(recordings: &[Recording], noise: f64) -> Option<f64> {
    let mut parts: Vec<f64> = recordings.iter().filter_map(|r| part(r, noise)).collect();
    if parts.is_empty() {
        return None;
    }
    // The median over the recordings that could show it: in a few of them the motion itself changes within a sample.
    let middle = (parts.len() - 1) / 2;
    let median = *parts.select_nth_unstable_by(middle, f64::total_cmp).1;
    (median > LEAST).then_some(median)
}

/// Jitter of one recording over its interval, 0 if there is none; `None` if its speeds could not show it.
fn part(recording: &Recording, noise: f64) -> Option<f64> {
    let x = &recording.columns[0];
    if x.len() < FEWEST_SAMPLES {
        return None;
    }
    // Change from sample to sample, and the difference that holds its noise.
    let mut samples: Vec<(f64, f64)> = (0..x.len() - REACH)
        .map(|k| ((x[k + REACH] - x[k]).abs() / REACH as f64, difference(x, k, 1)))
        .collect();
    samples.sort_by(|a, b| a.0.total_cmp(&b.0));
    let groups: Vec<(f64, f64)> = (0..GROUPS)
        .filter_map(|g| {
            let group = &samples[samples.len() * g / GROUPS..samples.len() * (g + 1) / GROUPS];
            let change = group.iter().map(|s| s.0 * s.0).sum::<f64>() / group.len() as f64;
            let variance = deviation(group.iter().map(|s| s.1))?;
            Some((change, variance * variance))
        })
        .collect();
    let fastest = groups.last()?.0;
    if TOLD_FROM * TOLD_FROM * fastest < VISIBLE * noise * noise {
        return None;
    }
    let (still, slope) = line(&groups, noise * noise);
    Some(if slope * fastest > VISIBLE * still.max(noise * noise) {
        slope.sqrt()
    } else {
        0.0
    })
}

/// Straight line through variances over the square of the change: value at rest and slope, neither negative. A variance is known
/// to a part of itself, so that small ones weigh more.
fn line(groups: &[(f64, f64)], least: f64) -> (f64, f64) {
    let mut s = [0.0; 5];
    for &(x, y) in groups {
        let w = 1.0 / (y.max(least) * y.max(least));
        for (sum, v) in s.iter_mut().zip([1.0, x, y, x * x, x * y]) {
            *sum += w * v;
        }
    }
    let [n, x, y, xx, xy] = s;
    let determinant = n * xx - x * x;
    let slope = (n * xy - x * y) / determinant;
    let still = (y - slope * x) / n;
    if !slope.is_finite() || slope <= 0.0 {
        (y / n, 0.0)
    } else if still < 0.0 {
        (0.0, (xy / xx).max(0.0))
    } else {
        (still, slope)
    }
}

/// Change of a column from sample to sample, at each sample, over as many samples as make the noise small beside it.
pub fn changes(series: &[f64]) -> Vec<f64> {
    const BESIDE: usize = 2;
    let last = series.len().saturating_sub(1);
    (0..series.len())
        .map(|k| {
            let (a, b) = (k.saturating_sub(BESIDE), (k + BESIDE).min(last));
            let change = (series[b] - series[a]) / (b - a).max(1) as f64;
            if change.is_finite() { change } else { 0.0 }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instrument::noise::tests::{noise, recording};

    /// Sines of 25 mm at 2 Hz, sampled at 500 Hz with jitter and noise.
    fn sines(jitter: f64, noise_m: f64) -> Recording {
        let (late, white) = (noise(1, 4000, 0.0), noise(2, 4000, 0.0));
        let x = (late.iter().zip(&white).enumerate())
            .map(|(k, (late, white))| {
                let t = 0.002 * (k as f64 + jitter * late);
                0.025 * libm::sin(std::f64::consts::TAU * 2.0 * t) + noise_m * white
            })
            .collect();
        recording(0.002, vec![x])
    }

    #[test]
    fn jitter_is_measured_and_noise_is_none() {
        for part in [0.05, 0.1, 0.2] {
            let found = jitter(&[sines(part, 5e-6)], 5e-6).expect("jitter");
            assert!((found / part - 1.0).abs() < 0.15, "{part}: {found}");
        }
        assert_eq!(jitter(&[sines(0.0, 5e-6)], 5e-6), None);
        // Ten times the noise, which the model file does not say.
        assert_eq!(jitter(&[sines(0.0, 5e-5)], 5e-6), None);
    }
}
