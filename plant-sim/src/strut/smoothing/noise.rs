//! The noise of the samples that are smoothed.

/// Standard deviations of the samples, m: one for all, or one each.
pub(super) struct Noise {
    /// That of a sample at rest.
    pub at_rest: f64,
    /// Sums of squares up to each sample, where the samples differ.
    sums: Option<Vec<f64>>,
}

impl Noise {
    /// The same noise in every sample.
    pub const fn even(noise_m: f64) -> Self {
        Self {
            at_rest: noise_m,
            sums: None,
        }
    }

    /// Noise of each sample; the least is that at rest.
    pub fn of_samples(noise_m: &[f64]) -> Self {
        let mut sums = vec![0.0];
        for noise in noise_m {
            sums.push(sums[sums.len() - 1] + noise * noise);
        }
        Self {
            at_rest: noise_m.iter().copied().fold(f64::INFINITY, f64::min),
            sums: Some(sums),
        }
    }

    /// Mean variance of the samples `from..to`.
    pub fn variance(&self, from: usize, to: usize) -> f64 {
        match &self.sums {
            None => self.at_rest * self.at_rest,
            Some(sums) => (sums[to] - sums[from]) / (to - from) as f64,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_variance_is_the_mean_over_the_samples() {
        let noise = Noise::of_samples(&[1.0, 1.0, 3.0, 3.0]);
        assert_eq!(
            (noise.variance(0, 2), noise.variance(1, 3), noise.at_rest),
            (1.0, 5.0, 1.0)
        );
        assert_eq!(Noise::even(2.0).variance(1, 3), 4.0);
    }
}
