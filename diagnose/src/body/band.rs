//! One low pass for all series, and the derivative in it.
//!
//! The balance is linear with constant coefficients, so that it holds for filtered series as it does for the series themselves. A windowed sinc
//! (Oppenheim & Schafer, *Discrete-Time Signal Processing*, 7.5; *recalled*) passes what is below 6 Hz, where body and wheels move, and leaves out
//! where a sample every 5 ms shows p1 and the unit too coarsely. Regressors that are noisy draw a least-squares estimate towards zero by the ratio of
//! the variance of their noise to that of their motion. In the band the noise of a rate of 0.0024 rad/s is 0.013 rad/s2 after differentiation, beside
//! half a rad/s2 of motion on a bad road: less than one in a thousand, far below what is named.

use core::f64::consts::PI;

/// Edge of the band, Hz.
const EDGE_HZ: f64 = 6.0;
/// Half the length of the filter, s.
const HALF_S: f64 = 0.4;
/// Time between two samples behind the filter, s: a good three times as often as the edge needs.
const SPACING_S: f64 = 0.025;

/// The filter for series of one period.
pub struct Band {
    period_s: f64,
    taps: Vec<f64>,
    every: usize,
}

impl Band {
    /// The filter for samples at this period, s.
    pub fn new(period_s: f64) -> Self {
        let half = (HALF_S / period_s).round() as i64;
        let tap = |k: i64| {
            let x = 2.0 * PI * EDGE_HZ * period_s * k as f64;
            let sinc = if k == 0 { 1.0 } else { libm::sin(x) / x };
            sinc * (0.54 + 0.46 * libm::cos(PI * k as f64 / half as f64))
        };
        let mut taps: Vec<f64> = (-half..=half).map(tap).collect();
        let sum: f64 = taps.iter().sum();
        taps.iter_mut().for_each(|tap| *tap /= sum);
        Self {
            period_s,
            taps,
            every: (SPACING_S / period_s).round().max(1.0) as usize,
        }
    }

    /// Time between two values behind the filter, s.
    pub fn spacing_s(&self) -> f64 {
        self.every as f64 * self.period_s
    }

    /// The series in the band, as far as the filter lies wholly in it.
    pub fn pass(&self, series: &[f64]) -> Vec<f64> {
        let windows = series.windows(self.taps.len()).step_by(self.every);
        windows
            .map(|window| window.iter().zip(&self.taps).map(|(value, tap)| value * tap).sum())
            .collect()
    }

    /// Its derivative in the band: differences over two samples, which pass 6 Hz with an error of 0.6 %.
    pub fn derivative(&self, series: &[f64]) -> Vec<f64> {
        let mut slope = vec![0.0; series.len()];
        for (k, window) in series.windows(3).enumerate() {
            slope[k + 1] = (window[2] - window[0]) / (2.0 * self.period_s);
        }
        self.pass(&slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine(hz: f64) -> Vec<f64> {
        (0..4000)
            .map(|k| libm::sin(2.0 * PI * hz * 0.005 * f64::from(k)))
            .collect()
    }

    fn size(series: &[f64]) -> f64 {
        let inner = &series[10..series.len() - 10];
        (2.0 * inner.iter().map(|x| x * x).sum::<f64>() / inner.len() as f64).sqrt()
    }

    #[test]
    fn slow_motion_passes_with_its_derivative_and_fast_motion_does_not() {
        let band = Band::new(0.005);
        assert!((band.pass(&[3.0; 400])[7] - 3.0).abs() < 1e-12);
        for hz in [0.5, 1.5, 3.0] {
            assert!((size(&band.pass(&sine(hz))) - 1.0).abs() < 0.01, "{hz}");
            let slope = size(&band.derivative(&sine(hz))) / (2.0 * PI * hz);
            assert!((slope - 1.0).abs() < 0.012, "{hz}: {slope}");
        }
        assert!(size(&band.pass(&sine(12.0))) < 0.01);
    }
}
