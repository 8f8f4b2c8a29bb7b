//! Computes the displacement spectral density of a road's tracks and the coherence between them.
//!
//! One-sided spectral density `Gd(n)` in m3 over spatial frequency `n` in cycles/m, as ISO 8608 defines it, by Welch's
//! averaged, Hann-windowed periodograms of linearly detrended segments. The complex coherence
//! `c = <R conj(L)> / sqrt(<|L|^2> <|R|^2>)` keeps the phase: -1 is a road that goes down on the right where it rises on
//! the left. Its real part, weighted with Gd, is the left-right correlation.

use rustfft::{Fft, FftPlanner, num_complex::Complex};
use std::sync::Arc;

/// What a band of spatial frequencies holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Lower edge of the band, cycles/m.
    pub low_per_m: f64,
    /// Upper edge of the band, cycles/m.
    pub high_per_m: f64,
    /// Mean of Gd in the band over both tracks, m3.
    pub psd_m3: f64,
    /// Coherence of right with left: real and imaginary part.
    pub coherence: Complex<f64>,
}

/// Averages spectra of pairs of tracks.
pub struct SpectrumEstimator {
    fft: Arc<dyn Fft<f64>>,
    window: Vec<f64>,
    spacing_m: f64,
    segments: usize,
    left: Vec<f64>,
    right: Vec<f64>,
    cross: Vec<Complex<f64>>,
}

/// How the ends of a segment are weighted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Window {
    /// Towards zero: little leakage from strong to weak frequencies.
    Hann,
    /// Not at all: powers add up to the variance, products to the correlation.
    Rectangular,
}

impl SpectrumEstimator {
    /// For Hann-windowed segments of `length` samples (at least 8), `spacing_m` apart.
    pub fn new(length: usize, spacing_m: f64) -> Self {
        Self::with_window(length, spacing_m, Window::Hann)
    }

    /// For segments of `length` samples (at least 8), `spacing_m` apart.
    pub fn with_window(length: usize, spacing_m: f64, window: Window) -> Self {
        let length = length.max(8);
        let hann = |i: usize| 0.5 - 0.5 * libm::cos(2.0 * core::f64::consts::PI * i as f64 / (length - 1) as f64);
        let window = match window {
            Window::Hann => (0..length).map(hann).collect(),
            Window::Rectangular => vec![1.0; length],
        };
        let bins = length / 2 + 1;
        Self {
            fft: FftPlanner::new().plan_fft_forward(length),
            window,
            spacing_m,
            segments: 0,
            left: vec![0.0; bins],
            right: vec![0.0; bins],
            cross: vec![Complex::default(); bins],
        }
    }

    /// Adds a pair of tracks, cut into half-overlapping segments; what is shorter than a segment adds nothing.
    pub fn add(&mut self, left_m: &[f64], right_m: &[f64]) {
        let length = self.window.len();
        let common = left_m.len().min(right_m.len());
        let mut start = 0;
        while start + length <= common {
            self.add_segment(&left_m[start..start + length], &right_m[start..start + length]);
            start += length / 2;
        }
    }

    fn add_segment(&mut self, left_m: &[f64], right_m: &[f64]) {
        let (left_m, right_m) = (detrended(left_m), detrended(right_m));
        let length = self.window.len();
        // Two real transforms in one: left in the real part, right in the imaginary.
        let mut both: Vec<Complex<f64>> = left_m
            .iter()
            .zip(&right_m)
            .zip(&self.window)
            .map(|((l, r), w)| Complex::new(l * w, r * w))
            .collect();
        self.fft.process(&mut both);
        for k in 0..self.left.len() {
            let (z, mirror) = (both[k], both[(length - k) % length].conj());
            let l = (z + mirror) * 0.5;
            let r = (z - mirror) * Complex::new(0.0, -0.5);
            self.left[k] += l.norm_sqr();
            self.right[k] += r.norm_sqr();
            self.cross[k] += r * l.conj();
        }
        self.segments += 1;
    }

    /// Spatial frequency (cycles/m) and Gd (m3, mean of both tracks) of every bin.
    pub fn density(&self) -> Vec<(f64, f64)> {
        let scale = self.scale();
        (0..self.left.len())
            .map(|k| (self.wavenumber_per_m(k), 0.5 * (self.left[k] + self.right[k]) * scale))
            .collect()
    }

    /// The bins of `[low, high)` as one band; `None` where no bin lies in it or nothing was added.
    pub fn band(&self, low_per_m: f64, high_per_m: f64) -> Option<Band> {
        let inside: Vec<usize> = (0..self.left.len())
            .filter(|&k| (low_per_m..high_per_m).contains(&self.wavenumber_per_m(k)))
            .collect();
        if inside.is_empty() || self.segments == 0 {
            return None;
        }
        let left: f64 = inside.iter().map(|&k| self.left[k]).sum();
        let right: f64 = inside.iter().map(|&k| self.right[k]).sum();
        let cross: Complex<f64> = inside.iter().map(|&k| self.cross[k]).sum();
        let power = (left * right).sqrt();
        Some(Band {
            low_per_m,
            high_per_m,
            psd_m3: 0.5 * (left + right) * self.scale() / inside.len() as f64,
            coherence: if power > 0.0 { cross / power } else { Complex::default() },
        })
    }

    fn wavenumber_per_m(&self, bin: usize) -> f64 {
        bin as f64 / (self.window.len() as f64 * self.spacing_m)
    }

    fn scale(&self) -> f64 {
        let energy: f64 = self.window.iter().map(|w| w * w).sum();
        2.0 * self.spacing_m / (energy * self.segments.max(1) as f64)
    }
}

/// Less its least-squares straight line.
pub fn detrended(heights_m: &[f64]) -> Vec<f64> {
    let count = heights_m.len() as f64;
    let centre = 0.5 * (count - 1.0);
    let mean = heights_m.iter().sum::<f64>() / count;
    let mut product = 0.0;
    let mut square = 0.0;
    for (i, height) in heights_m.iter().enumerate() {
        let x = i as f64 - centre;
        product += x * height;
        square += x * x;
    }
    let slope = if square > 0.0 { product / square } else { 0.0 };
    heights_m
        .iter()
        .enumerate()
        .map(|(i, height)| height - mean - slope * (i as f64 - centre))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::PI;

    #[test]
    fn a_sine_s_power_and_phase_are_found() {
        let (spacing, amplitude, n0) = (0.05, 0.02, 0.625);
        let wave = |phase: f64| -> Vec<f64> {
            (0..4096)
                .map(|i| amplitude * libm::cos(2.0 * PI * n0 * spacing * f64::from(i) - phase))
                .collect()
        };
        let mut estimator = SpectrumEstimator::new(1024, spacing);
        estimator.add(&wave(0.0), &wave(1.0));
        let band = estimator.band(0.5, 0.75).unwrap();
        let bins = estimator
            .density()
            .iter()
            .filter(|(n, _)| (0.5..0.75).contains(n))
            .count() as f64;
        let power = band.psd_m3 * bins / (1024.0 * spacing);
        assert!((power / (0.5 * amplitude * amplitude) - 1.0).abs() < 2e-3, "{power}");
        assert!((band.coherence.norm() - 1.0).abs() < 1e-9);
        assert!((libm::atan2(band.coherence.im, band.coherence.re) + 1.0).abs() < 1e-3);
    }

    #[test]
    fn detrending_removes_a_line() {
        let line: Vec<f64> = (0..50).map(|i| 3.0 + 0.1 * f64::from(i)).collect();
        assert!(detrended(&line).iter().all(|h| h.abs() < 1e-12));
    }

    #[test]
    fn nothing_added_is_no_band() {
        let mut estimator = SpectrumEstimator::new(64, 0.1);
        estimator.add(&[0.0; 10], &[0.0; 10]);
        assert!(estimator.band(0.1, 1.0).is_none());
    }
}
