//! Mains hum: one frequency that a column holds in every recording, whatever the specimen does.
//!
//! The spectrum of a column is taken of its second differences, which leave little of the motion, with a Hann window. Under
//! noise the power at a frequency, over its mean nearby, has an exponential distribution in each recording.

use std::f64::consts::{PI, TAU};

use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

use super::differences::deviation;
use super::spikes::bridge;
use crate::recording::Recording;

/// Frequencies that are searched, Hz: mains of 50 and 60 Hz and what a generator makes of them.
const BAND_HZ: (f64, f64) = (40.0, 70.0);
/// Slowest sampling that shows the band, as a multiple of its upper end.
const LEAST_RATE: f64 = 2.2;
/// Distance of the frequencies of a spectrum, Hz.
const GRID_HZ: f64 = 0.02;
/// Differences are limited to this many standard deviations: at an edge of a valve they are far larger and hold all frequencies.
const LIMIT: f64 = 3.0;
/// Frequencies this close to the line say nothing of the noise, Hz.
const BESIDE_HZ: f64 = 3.0;
/// The power must be this many times what noise makes, in sum over the recordings ...
const LEAST_POWER: f64 = 12.0;
/// ... and this many times in at least half of them.
const LEAST_POWER_OF_EACH: f64 = 6.0;
/// The line must have this many times the power of any other of the band.
const LEAST_OVER_OTHERS: f64 = 3.0;
/// Smallest amplitude that is reported, in standard deviations of the noise.
const LEAST_AMPLITUDE: f64 = 0.15;

/// A line in the spectrum of a column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Frequency and the standard deviation of its estimate, Hz.
    pub frequency_hz: [f64; 2],
    /// Amplitude and the standard deviation of its estimate, in the unit of the column.
    pub amplitude: [f64; 2],
}

/// The spectrum of one recording.
struct Spectrum {
    /// From [`BAND_HZ`] on, every [`GRID_HZ`].
    values: Vec<Complex<f64>>,
    /// Amplitude of a sine in the readings for a value of one.
    scale: Vec<f64>,
    duration_s: f64,
}

/// The mains in a column; `None` if it holds none. `noise` is its standard deviation.
pub fn line(recordings: &[Recording], column: usize, noise: f64) -> Option<Line> {
    let mut planner = FftPlanner::new();
    let spectra: Vec<Spectrum> = (recordings.iter())
        .filter_map(|r| spectrum(&r.columns[column], r.interval_s(), &mut planner))
        .collect();
    let count = spectra.first()?.values.len();
    let levels: Vec<f64> = spectra.iter().map(|s| level(s, None)).collect();
    let power = |k: usize| -> f64 {
        let powers = spectra
            .iter()
            .zip(&levels)
            .map(|(s, level)| s.values[k].norm_sqr() / level);
        powers.sum()
    };
    let peak = (0..count).max_by(|&a, &b| power(a).total_cmp(&power(b)))?;
    let levels: Vec<f64> = spectra.iter().map(|s| level(s, Some(peak))).collect();
    let powers: Vec<f64> = (spectra.iter().zip(&levels))
        .map(|(s, level)| s.values[peak].norm_sqr() / level)
        .collect();
    let each = powers.iter().filter(|p| **p > LEAST_POWER_OF_EACH).count();
    let sum: f64 = powers.iter().sum();
    // Valves that are switched in a fixed rhythm make a row of lines; the mains make one.
    let beside = (BESIDE_HZ / GRID_HZ) as usize;
    let second = (0..count)
        .filter(|k| k.abs_diff(peak) > beside)
        .map(power)
        .fold(0.0, f64::max);
    let is_one = LEAST_OVER_OTHERS * second < power(peak);
    if sum < LEAST_POWER * powers.len() as f64 || 2 * each < powers.len() || !is_one {
        return None;
    }
    // Of the amplitude's square noise makes a known part; the recordings count by how well they know it.
    let (mut weights, mut squares, mut curvature) = (0.0, 0.0, 0.0);
    for (s, level) in spectra.iter().zip(&levels) {
        let (scale, variance) = (s.scale[peak], 0.5 * level * s.scale[peak] * s.scale[peak]);
        let square = s.values[peak].norm_sqr() * scale * scale - 2.0 * variance;
        weights += 1.0 / variance;
        squares += square / variance;
        // Cramer-Rao bound of a frequency (Rife & Boorstyn, IEEE Trans. Inform. Theory 20(5), 1974).
        curvature += square.max(0.0) * PI * PI * s.duration_s * s.duration_s / (3.0 * variance);
    }
    let amplitude = (squares / weights).max(0.0).sqrt();
    (amplitude > LEAST_AMPLITUDE * noise).then(|| Line {
        frequency_hz: [
            refined(peak, count, &power),
            1.0 / curvature.max(f64::MIN_POSITIVE).sqrt(),
        ],
        amplitude: [amplitude, 1.0 / weights.sqrt()],
    })
}

/// Frequency of a peak from the grid and its neighbours.
fn refined(peak: usize, count: usize, power: &dyn Fn(usize) -> f64) -> f64 {
    let at = |k: usize| BAND_HZ.0 + GRID_HZ * k as f64;
    if peak == 0 || peak + 1 >= count {
        return at(peak);
    }
    let [a, b, c] = [power(peak - 1), power(peak), power(peak + 1)];
    let bend = a - 2.0 * b + c;
    at(peak)
        + if bend < 0.0 {
            0.5 * GRID_HZ * (a - c) / bend
        } else {
            0.0
        }
}

/// Mean power of the noise in a spectrum, from its median: what is known of a line is left out.
fn level(spectrum: &Spectrum, line: Option<usize>) -> f64 {
    let beside = (BESIDE_HZ / GRID_HZ) as usize;
    let mut powers: Vec<f64> = (spectrum.values.iter().enumerate())
        .filter(|(k, _)| line.is_none_or(|line| k.abs_diff(line) > beside))
        .map(|(_, v)| v.norm_sqr())
        .collect();
    let middle = powers.len() / 2;
    let median = powers.select_nth_unstable_by(middle, f64::total_cmp).1;
    (*median / std::f64::consts::LN_2).max(f64::MIN_POSITIVE)
}

/// Second differences with their sign changed, each of the phase of the sample in its middle, and limited.
fn limited_differences(readings: &[f64]) -> Option<Vec<f64>> {
    let mut differences: Vec<f64> = readings.windows(3).map(|w| 2.0 * w[1] - w[0] - w[2]).collect();
    let limit = LIMIT * deviation(differences.iter().copied())?;
    differences.iter_mut().for_each(|d| *d = d.clamp(-limit, limit));
    Some(differences)
}

fn spectrum(series: &[f64], interval_s: f64, planner: &mut FftPlanner<f64>) -> Option<Spectrum> {
    if LEAST_RATE * BAND_HZ.1 * interval_s > 1.0 {
        return None;
    }
    let mut readings = series.to_vec();
    bridge(&mut readings);
    if readings.iter().any(|v| !v.is_finite()) {
        return None;
    }
    let differences = limited_differences(&readings)?;
    let n = differences.len();
    let length = ((1.0 / (GRID_HZ * interval_s)).round() as usize).max(n);
    let step_hz = 1.0 / (length as f64 * interval_s);
    let mut values: Vec<Complex<f64>> = (differences.iter().enumerate())
        .map(|(k, d)| Complex::new(d * (0.5 - 0.5 * libm::cos(TAU * (k as f64 + 0.5) / n as f64)), 0.0))
        .collect();
    values.resize(length, Complex::new(0.0, 0.0));
    planner.plan_fft_forward(length).process(&mut values);
    let count = ((BAND_HZ.1 - BAND_HZ.0) / GRID_HZ) as usize;
    let frequency = |k: usize| BAND_HZ.0 + GRID_HZ * k as f64;
    let scale = |f: f64| {
        let half = libm::sin(PI * f * interval_s);
        // Half of the window's sum is a quarter of the samples.
        4.0 / (n as f64 * 4.0 * half * half)
    };
    Some(Spectrum {
        values: (0..count)
            .map(|k| values[((frequency(k) / step_hz).round() as usize).min(length - 1)])
            .collect(),
        scale: (0..count).map(|k| scale(frequency(k))).collect(),
        duration_s: n as f64 * interval_s,
    })
}

/// Takes a line off the readings of a recording: amplitude and phase are fitted to this recording alone, because its clock does not
/// know the mains. False where the sampling is too slow to tell the line from the motion.
pub fn take_off(series: &mut [f64], interval_s: f64, frequency_hz: f64) -> bool {
    if LEAST_RATE * frequency_hz * interval_s > 1.0 {
        return false;
    }
    let turn = TAU * frequency_hz * interval_s;
    let mut readings = series.to_vec();
    bridge(&mut readings);
    let Some(differences) = limited_differences(&readings) else {
        return false;
    };
    let half = libm::sin(0.5 * turn);
    let n = differences.len() as f64;
    let (mut cosine, mut sine) = (0.0, 0.0);
    for (k, d) in differences.iter().enumerate() {
        let window = 0.5 - 0.5 * libm::cos(TAU * (k as f64 + 0.5) / n);
        let angle = turn * (k + 1) as f64;
        let d = window * d;
        cosine += d * libm::cos(angle);
        sine += d * libm::sin(angle);
    }
    let scale = 4.0 / (n * 4.0 * half * half);
    for (k, v) in series.iter_mut().enumerate() {
        let angle = turn * k as f64;
        *v -= scale * (cosine * libm::cos(angle) + sine * libm::sin(angle));
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instrument::noise::tests::{noise, recording};

    /// A pressure with the motion of a sine drive, edges of a valve, noise and hum.
    fn pressure(seed: u64, hum: f64) -> Vec<f64> {
        (noise(seed, 3000, 0.0).iter().enumerate())
            .map(|(k, n)| {
                let t = 0.002 * k as f64;
                let edges = if (k * k / 60_000) % 2 == 0 { 0.0 } else { 8e5 };
                4e6 + 1e6 * libm::sin(TAU * 6.0 * t) + edges + 4e3 * n + hum * libm::sin(TAU * 50.06 * t + seed as f64)
            })
            .collect()
    }

    fn recorded(hum: f64) -> Vec<Recording> {
        (0..6).map(|seed| recording(0.002, vec![pressure(seed, hum)])).collect()
    }

    #[test]
    fn the_line_is_found_with_its_numbers() {
        let found = line(&recorded(2.8e3), 0, 4e3).expect("a line");
        let ([f, df], [a, da]) = (found.frequency_hz, found.amplitude);
        assert!((f - 50.06).abs() < 4.0 * df + 0.002 && df < 0.01, "{found:?}");
        assert!((a - 2.8e3).abs() < 4.0 * da && da < 400.0, "{found:?}");
    }

    #[test]
    fn noise_and_motion_hold_no_line() {
        assert_eq!(line(&recorded(0.0), 0, 4e3), None);
    }

    #[test]
    fn a_line_that_is_taken_off_is_gone() {
        let (mut with, without) = (pressure(3, 8e3), pressure(3, 0.0));
        assert!(take_off(&mut with, 0.002, 50.06));
        let left = with.iter().zip(&without).map(|(a, b)| (a - b) * (a - b)).sum::<f64>() / 3000.0;
        assert!(left.sqrt() < 800.0, "{}", left.sqrt());
        assert!(!take_off(&mut with, 0.02, 50.06));
    }
}
