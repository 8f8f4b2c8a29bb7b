//! Random roads of the standard: ISO 8608 classes A to F.
//!
//! `Gd(n) = Gd(0.1) (n / 0.1)^-2` with the geometric mean of each class, 16e-6 m3 (A) times 4 a class; made from 0.011 to
//! 10 cycles/m (the standard reports 0.011 to 2.83; the rest extends its law to what wheel hop and tyres feel).
//!
//! The standard says nothing of the second track. Here the surface is isotropic (Dodds & Robson, *J. Sound and Vibration* 31
//! (1973) 175; Kamash & Robson, ibid. 57 (1978) 89): the profile across is as rough as along, which for the exponent -2
//! gives the coherence of two tracks B apart in closed form,
//!
//! ```text
//! g(n) = 2 pi n B K1(2 pi n B)
//! ```
//!
//! (K1 the modified Bessel function): one for waves much longer than the track, nothing for waves much shorter.

use super::{EnteredSmoothly, HALF_TRACK_M, Lanes, RoadError, TrackSpectrum, TwoTracks, synthesise};
use core::f64::consts::PI;
use rustfft::num_complex::Complex;

/// Roughness class: geometric mean of Gd(0.1 cycles/m).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Class {
    /// 16e-6 m3: a very good motorway.
    A,
    /// Class B: Gd(0.1 cycles/m) = 64e-6 m3.
    B,
    /// Class C: Gd(0.1 cycles/m) = 256e-6 m3.
    C,
    /// Class D: Gd(0.1 cycles/m) = 1024e-6 m3.
    D,
    /// Class E: Gd(0.1 cycles/m) = 4096e-6 m3.
    E,
    /// 16384e-6 m3: rough terrain.
    F,
}

impl Class {
    /// Gd at 0.1 cycles/m, m3.
    pub fn density_m3(self) -> f64 {
        let microns = match self {
            Self::A => 16.0,
            Self::B => 64.0,
            Self::C => 256.0,
            Self::D => 1024.0,
            Self::E => 4096.0,
            Self::F => 16384.0,
        };
        microns * 1e-6
    }
}

/// Range of spatial frequencies that is made, cycles/m.
const RANGE_PER_M: (f64, f64) = (0.011, 10.0);

/// A road of a class of at least `length_m`, entered smoothly from level ground.
///
/// # Errors
/// A length that is not between 1 m and 20 km.
pub fn iso8608(class: Class, length_m: f64, seed: u64) -> Result<EnteredSmoothly<Lanes<TwoTracks>>, RoadError> {
    let tracks = Lanes::new(tracks(class, length_m, seed)?, HALF_TRACK_M);
    Ok(EnteredSmoothly::new(tracks))
}

fn tracks(class: Class, length_m: f64, seed: u64) -> Result<TwoTracks, RoadError> {
    synthesise(length_m, seed, |n| {
        let inside = n >= RANGE_PER_M.0 && n <= RANGE_PER_M.1;
        let psd_m3 = if inside {
            class.density_m3() * 0.01 / (n * n)
        } else {
            0.0
        };
        TrackSpectrum {
            psd_m3,
            coherence: Complex::new(isotropic_coherence(n, 2.0 * HALF_TRACK_M), 0.0),
        }
    })
}

/// Coherence of two tracks `separation_m` apart on an isotropic surface with Gd ~ n^-2, 0..1.
pub fn isotropic_coherence(wavenumber_per_m: f64, separation_m: f64) -> f64 {
    let x = 2.0 * PI * wavenumber_per_m * separation_m;
    if x <= 0.0 { 1.0 } else { (x * bessel_k1(x)).min(1.0) }
}

/// Modified Bessel function K1 for x > 0: Abramowitz & Stegun 9.8.3, 9.8.7, 9.8.8; relative error below 3e-7. `libm` and
/// `statrs` have none.
fn bessel_k1(x: f64) -> f64 {
    let horner = |t: f64, coefficients: &[f64]| coefficients.iter().rev().fold(0.0, |sum, c| sum * t + c);
    if x <= 2.0 {
        let t = (x / 3.75) * (x / 3.75);
        let i1 = x * horner(
            t,
            &[
                0.5,
                0.878_905_94,
                0.514_988_69,
                0.150_849_34,
                0.026_587_33,
                0.003_015_32,
                0.000_324_11,
            ],
        );
        let t = 0.25 * x * x;
        let series = horner(
            t,
            &[
                1.0,
                0.154_431_44,
                -0.672_785_79,
                -0.181_568_97,
                -0.019_194_02,
                -0.001_104_04,
                -0.000_046_86,
            ],
        );
        libm::log(0.5 * x) * i1 + series / x
    } else {
        let series = horner(
            2.0 / x,
            &[
                1.253_314_14,
                0.234_986_19,
                -0.036_556_20,
                0.015_042_68,
                -0.007_803_53,
                0.003_256_14,
                -0.000_682_45,
            ],
        );
        series * libm::exp(-x) / x.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::road::spectrum::SpectrumEstimator;

    #[test]
    fn bessel_function_has_its_tabulated_values() {
        // Abramowitz & Stegun, tables 9.8 and 9.9 (and the recurrence's wronskian I0 K1 + I1 K0 = 1/x at 1).
        for (x, k1) in [
            (0.1, 9.853_844_780_9),
            (1.0, 0.601_907_230_2),
            (2.0, 0.139_865_881_8),
            (5.0, 0.004_044_613_4),
        ] {
            assert!((bessel_k1(x) / k1 - 1.0).abs() < 1e-6, "{x} {}", bessel_k1(x));
        }
    }

    #[test]
    fn coherence_falls_from_one_to_nothing() {
        let mut last = 1.0;
        for i in 1..400 {
            let now = isotropic_coherence(0.005 * f64::from(i), 1.486);
            assert!(now < last + 1e-6 && now >= 0.0);
            last = now;
        }
        assert!(isotropic_coherence(1e-4, 1.486) > 0.999);
        assert!(last < 1e-6);
    }

    #[test]
    fn classes_have_the_standard_s_density_and_slope() {
        let road = tracks(Class::C, 5000.0, 11).unwrap();
        let (left, right): (Vec<f64>, Vec<f64>) = road.samples_m().iter().map(|h| (h[0], h[1])).unzip();
        let mut estimator = SpectrumEstimator::new(16384, 0.01);
        estimator.add(&left, &right);
        for (low, high) in [(0.05, 0.1), (0.1, 0.2), (0.2, 0.5), (0.5, 1.0), (1.0, 2.0), (2.0, 5.0)] {
            let band = estimator.band(low, high).unwrap();
            // The mean of n^-2 over a band is 1 / (low high).
            let expected = 256e-6 * 0.01 / (low * high);
            assert!((band.psd_m3 / expected - 1.0).abs() < 0.15, "{band:?} {expected}");
            let middle = (low * high).sqrt();
            assert!(
                (band.coherence.re - isotropic_coherence(middle, 1.486)).abs() < 0.15,
                "{band:?}"
            );
        }
    }

    #[test]
    fn each_class_is_four_times_the_one_before() {
        let classes = [Class::A, Class::B, Class::C, Class::D, Class::E, Class::F];
        for pair in classes.windows(2) {
            assert_eq!(pair[1].density_m3() / pair[0].density_m3(), 4.0);
        }
    }
}
