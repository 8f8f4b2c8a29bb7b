//! Two tracks with a prescribed spectrum and left-right coherence.
//!
//! Spectral representation with random phases (Shinozuka & Deodatis, *Applied Mechanics Reviews* 44 (1991) 191): every
//! spatial frequency `n_k = k / period` gets exactly the power `Gd(n_k) / period` and a phase from a seeded generator,
//! so the spectrum is met by every track and not only on average. The right track is the left one through the complex
//! coherence `c` plus an independent rest: `R = c L + sqrt(1 - |c|^2) N`. One inverse FFT makes both.
//!
//! A road is the same to the bit on every platform (see [`super::inverse_fft`]). Heights are whole micrometres, as a survey has them.

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rustfft::num_complex::Complex;

use super::inverse_fft::inverse_fft;
use super::{RoadError, TwoTracks};

/// Distance between samples of a synthesised road, m: the grid of the measured Belgian block.
pub const SPACING_M: f64 = 0.01;
/// Longest road that is made, m.
const LIMIT_M: f64 = 20_000.0;

/// What a spatial frequency holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackSpectrum {
    /// One-sided displacement spectral density Gd of each track, m3.
    pub psd_m3: f64,
    /// Coherence of right with left, |c| <= 1.
    pub coherence: Complex<f64>,
}

/// Makes a periodic road of at least `length_m` (the period is a power of two times 1 cm) from its spectrum, a function
/// of the spatial frequency in cycles/m. Same seed, same road.
///
/// # Errors
/// A length that is not between 1 m and 20 km.
pub fn synthesise(length_m: f64, seed: u64, spectrum: impl Fn(f64) -> TrackSpectrum) -> Result<TwoTracks, RoadError> {
    if !(1.0..=LIMIT_M).contains(&length_m) {
        return Err(RoadError::Length {
            length_m,
            limit_m: LIMIT_M,
        });
    }
    let samples = ((length_m / SPACING_M).ceil() as usize)
        .max(MINIMUM_SAMPLES)
        .next_power_of_two();
    let step_per_m = 1.0 / (samples as f64 * SPACING_M);
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut both = vec![Complex::<f64>::default(); samples];
    for k in 1..samples / 2 {
        let (left_phase, rest_phase) = (phase(&mut random), phase(&mut random));
        let TrackSpectrum { psd_m3, coherence } = spectrum(k as f64 * step_per_m);
        let amplitude = (0.5 * psd_m3 * step_per_m).sqrt();
        let left = left_phase * amplitude;
        let rest = (1.0 - coherence.norm_sqr()).max(0.0).sqrt();
        let right = coherence * left + rest_phase * (amplitude * rest);
        // Left in the real part of the road, right in the imaginary.
        both[k] = left + right * Complex::i();
        both[samples - k] = left.conj() + right.conj() * Complex::i();
    }
    inverse_fft(&mut both);
    let heights = both.iter().map(|z| [micrometres(z.re), micrometres(z.im)]).collect();
    Ok(TwoTracks::periodic(SPACING_M, heights))
}

/// 82 m: a shorter road than this has too few lines in its spectrum to be random.
const MINIMUM_SAMPLES: usize = 8192;

/// A point of the unit circle.
fn phase(random: &mut ChaCha8Rng) -> Complex<f64> {
    let (sin, cos) = libm::sincos(2.0 * core::f64::consts::PI * random.random::<f64>());
    Complex::new(cos, sin)
}

fn micrometres(height_m: f64) -> f64 {
    (height_m * 1e6).round() * 1e-6
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::road::spectrum::SpectrumEstimator;

    fn white(coherence: Complex<f64>) -> impl Fn(f64) -> TrackSpectrum {
        move |n| TrackSpectrum {
            psd_m3: if (1.0..10.0).contains(&n) { 1e-5 } else { 0.0 },
            coherence,
        }
    }

    #[test]
    fn spectrum_and_coherence_are_those_asked_for() {
        let asked = Complex::new(-0.6, 0.3);
        let road = synthesise(300.0, 7, white(asked)).unwrap();
        let (left, right): (Vec<f64>, Vec<f64>) = road.samples_m().iter().map(|h| (h[0], h[1])).unzip();
        let variance = left.iter().map(|h| h * h).sum::<f64>() / left.len() as f64;
        assert!((variance / 9e-5 - 1.0).abs() < 5e-3, "{variance}");
        let mut estimator = SpectrumEstimator::new(1000, SPACING_M);
        estimator.add(&left, &right);
        let band = estimator.band(2.0, 9.0).unwrap();
        assert!((band.psd_m3 / 1e-5 - 1.0).abs() < 0.03, "{band:?}");
        assert!((band.coherence - asked).norm() < 0.05, "{band:?}");
    }

    #[test]
    fn a_seed_is_a_road() {
        let heights = |seed| {
            synthesise(50.0, seed, white(Complex::default()))
                .unwrap()
                .samples_m()
                .to_vec()
        };
        assert_eq!(heights(3), heights(3));
        assert_ne!(heights(3), heights(4));
    }

    #[test]
    fn impossible_lengths_are_refused() {
        for length in [0.0, -5.0, f64::NAN, f64::INFINITY, 1e9] {
            assert!(synthesise(length, 0, white(Complex::default())).is_err());
        }
    }
}
