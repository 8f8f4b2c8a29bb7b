//! The common value of estimates of one number, if they do not contradict each other.
//!
//! Cochran's *Q*, the sum of the squared departures from the weighted mean over their variances, is a chi-square with one degree of freedom less than there are
//! estimates, if all have the same true value (Cochran, Biometrics 10(1), 1954).

/// Upper 0.1 % points of chi-square with one, two and three degrees of freedom, behind what one estimate has, which contradicts nothing.
const LARGEST_Q: [f64; 4] = [f64::INFINITY, 10.83, 13.82, 16.27];

/// The mean of estimates weighted by their variances.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pooled {
    pub mean: f64,
    /// Its standard deviation.
    pub deviation: f64,
}

impl Pooled {
    /// From one to four estimates with their standard deviations. One without a finite deviation has no say; `None` if none has one, or if they contradict
    /// each other.
    pub fn of(estimates: impl ExactSizeIterator<Item = (f64, f64)>) -> Option<Self> {
        let freedom = estimates.len().checked_sub(1)?;
        let largest_q = LARGEST_Q.get(freedom)?;
        let weighed: Vec<(f64, f64)> = estimates
            .map(|(value, deviation)| (value, 1.0 / (deviation * deviation)))
            .filter(|(value, weight)| value.is_finite() && weight.is_normal())
            .collect();
        let weights: f64 = weighed.iter().map(|(_, weight)| weight).sum();
        if weights <= 0.0 {
            return None;
        }
        let mean = weighed.iter().map(|(value, weight)| value * weight).sum::<f64>() / weights;
        let q: f64 = (weighed.iter())
            .map(|(value, weight)| weight * (value - mean) * (value - mean))
            .sum();
        // Estimates that scatter more than their intervals say make the common interval wider (Birge, Phys. Rev. 40, 1932).
        let deviation = (q / freedom.max(1) as f64).max(1.0).sqrt() / weights.sqrt();
        (q <= *largest_q).then_some(Self { mean, deviation })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pooled(estimates: &[(f64, f64)]) -> Option<Pooled> {
        Pooled::of(estimates.iter().copied())
    }

    #[test]
    fn the_mean_is_weighted_and_as_sure_as_all_estimates_together() {
        // Weights of 1 and 4.
        let two = pooled(&[(1.0, 1.0), (2.0, 0.5)]).expect("they agree");
        assert!((two.mean - 1.8).abs() < 1e-12 && (two.deviation - 1.0 / 5.0_f64.sqrt()).abs() < 1e-12);
        // They scatter by q = 9 where 1 is expected: three times as unsure.
        let apart = pooled(&[(0.0, 1.0), (18.0_f64.sqrt(), 1.0)]).expect("they agree");
        assert!((apart.deviation - 3.0 / 2.0_f64.sqrt()).abs() < 1e-12, "{apart:?}");
    }

    #[test]
    fn of_one_estimate_it_is_this_one() {
        // Divided by a weight that it was multiplied by, it may differ in its last digit.
        for k in 1..100 {
            let (value, deviation) = (0.1 * f64::from(k), 0.7 / f64::from(k));
            let one = pooled(&[(value, deviation)]).expect("it contradicts nothing");
            assert!((one.mean / value - 1.0).abs() < 1e-14 && (one.deviation / deviation - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn contradiction_and_ignorance_have_no_common_value() {
        // q is half of the squared distance.
        assert!(pooled(&[(0.0, 1.0), (21.0_f64.sqrt(), 1.0)]).is_some());
        assert!(pooled(&[(0.0, 1.0), (22.0_f64.sqrt(), 1.0)]).is_none());
        let unknown = (3.0, f64::INFINITY);
        assert_eq!(pooled(&[unknown, unknown]), None);
        assert!(pooled(&[(1.0, 0.1), unknown]).is_some_and(|p| (p.mean - 1.0).abs() < 1e-12));
        assert_eq!((pooled(&[]), pooled(&[(1.0, 1.0); 5])), (None, None));
    }
}
