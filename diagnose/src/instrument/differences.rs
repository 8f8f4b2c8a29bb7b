//! High differences of successive samples: noise without motion.
//!
//! A difference of order five takes from a motion of 6 Hz that is sampled at 500 Hz all but a part in 400,000, and leaves of
//! white noise, after division by the norm of its coefficients, exactly the standard deviation.

/// Coefficients of the difference of order five.
const COEFFICIENTS: [f64; 6] = [1.0, -5.0, 10.0, -10.0, 5.0, -1.0];
/// Their norm.
const NORM: f64 = 15.874_507_866_387_544;
/// Samples that a difference reaches over.
pub const REACH: usize = COEFFICIENTS.len() - 1;
/// A standard deviation of a normal variable is this many times the median of its size.
const OF_MEDIAN: f64 = 1.482_602_218_505_602;

/// The difference that begins at a sample and takes every `stride`-th, divided by its norm; NaN where a reading is missing.
pub fn difference(series: &[f64], begin: usize, stride: usize) -> f64 {
    let terms = COEFFICIENTS.iter().enumerate();
    terms.map(|(i, c)| c * series[begin + i * stride]).sum::<f64>() / NORM
}

/// All such differences of a series.
pub fn differences(series: &[f64], stride: usize) -> impl Iterator<Item = f64> + '_ {
    let count = series.len().saturating_sub(REACH * stride);
    (0..count).map(move |begin| difference(series, begin, stride))
}

/// Standard deviation of values about zero, from the median of their size: a few that are large change nothing. `None` if there
/// are none.
pub fn deviation(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut sizes: Vec<f64> = values.filter(|v| v.is_finite()).map(f64::abs).collect();
    let middle = sizes.len() / 2;
    (!sizes.is_empty()).then(|| OF_MEDIAN * *sizes.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Variance of a difference of noise whose neighbours, as far apart as the difference takes them, are correlated by `r` (and those
/// twice as far apart by `r^2`), over that of white noise.
pub fn variance_of_coloured(r: f64) -> f64 {
    // The autocorrelation of the coefficients is that of binomial coefficients: (-1)^k C(10, 5 + k).
    let others = r * (210.0 + r * (-120.0 + r * (45.0 + r * (-10.0 + r))));
    (252.0 - 2.0 * others) / 252.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instrument::noise::tests::noise;

    #[test]
    fn motion_is_gone_and_noise_stays() {
        let white = noise(1, 4000, 0.0);
        let moving: Vec<f64> = (white.iter().enumerate())
            .map(|(k, n)| 5e-6 * n + 0.025 * libm::sin(std::f64::consts::TAU * 6.0 * 0.002 * k as f64))
            .collect();
        let measured = deviation(differences(&moving, 1)).expect("values");
        assert!((measured / 5e-6 - 1.0).abs() < 0.05, "{measured}");
    }

    #[test]
    fn colour_lowers_what_differences_leave_as_computed() {
        for correlation in [0.3, 0.7, 0.9] {
            let coloured = noise(2, 20_000, correlation);
            for stride in [1, 4] {
                let measured = deviation(differences(&coloured, stride)).expect("values");
                let expected = variance_of_coloured(libm::pow(correlation, stride as f64)).sqrt();
                assert!(
                    (measured / expected - 1.0).abs() < 0.06,
                    "{correlation} {stride}: {measured} {expected}"
                );
            }
        }
        assert_eq!(variance_of_coloured(0.0), 1.0);
    }

    #[test]
    fn missing_readings_do_not_count() {
        let mut series = noise(3, 2000, 0.0);
        series[700] = f64::NAN;
        assert!((deviation(differences(&series, 1)).expect("values") - 1.0).abs() < 0.1);
        assert_eq!(deviation([f64::NAN].into_iter()), None);
    }
}
