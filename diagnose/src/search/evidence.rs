//! Whether one model meets held-out blocks better than another by more than chance.

use crate::criteria::Acceptance;

/// Smallest cost of which a logarithm is taken.
const LEAST_COST: f64 = 1e-9;

/// What one model gains over another on the same held-out blocks.
///
/// Three figures answer whether the gain is chance. The sum with its standard error is fair where all blocks have a part in
/// it. The mean of the logarithm is fair where a few blocks hold nearly all of the misfit, and the sum is as scattered as they
/// are. The sign test is fair for an effect that acts in some blocks only.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldOutGain {
    /// Cost before less cost after, all blocks.
    pub total: f64,
    /// Standard error of the sum, from the scatter between blocks.
    pub standard_error: f64,
    /// Mean over the blocks of the logarithm of cost before over cost after.
    pub mean_logarithm: f64,
    /// Standard error of that mean.
    pub logarithm_error: f64,
    /// Blocks that are better by more than chance.
    pub better_blocks: usize,
    /// Blocks that are worse by more than chance.
    pub worse_blocks: usize,
    /// Cost before beyond one for each residual.
    pub unexplained_before: f64,
    /// Number of residuals.
    pub residuals: f64,
}

impl HeldOutGain {
    /// Compares costs of the same blocks before and after.
    #[must_use]
    pub fn between(before: &[f64], after: &[f64], residuals: f64, acceptance: &Acceptance) -> Self {
        let n = before.len() as f64;
        let gains: Vec<f64> = before.iter().zip(after).map(|(b, a)| b - a).collect();
        let total: f64 = gains.iter().sum();
        let logarithms: Vec<f64> = (before.iter().zip(after))
            .map(|(b, a)| libm::log(b.max(LEAST_COST) / a.max(LEAST_COST)))
            .collect();
        let mean_logarithm = logarithms.iter().sum::<f64>() / n;
        Self {
            total,
            standard_error: (n * variance(&gains, total / n)).sqrt(),
            mean_logarithm,
            logarithm_error: (variance(&logarithms, mean_logarithm) / n).sqrt(),
            better_blocks: gains.iter().filter(|g| **g > acceptance.block_gain).count(),
            worse_blocks: gains.iter().filter(|g| -**g > acceptance.block_gain).count(),
            unexplained_before: (before.iter().sum::<f64>() - residuals).max(0.0),
            residuals,
        }
    }

    /// True if the gain is more than chance, by one of the three figures.
    #[must_use]
    pub fn is_certain(&self, acceptance: &Acceptance) -> bool {
        let errors = acceptance.least_standard_errors;
        let signs = acceptance.better_blocks_per_worse * self.worse_blocks + acceptance.better_blocks_besides;
        self.total > errors * self.standard_error
            || self.mean_logarithm > errors * self.logarithm_error
            || self.better_blocks >= signs
    }

    /// True if the gain is large enough, with `margin` times what acceptance asks for and `least_fraction` the smallest
    /// fraction of the unexplained cost.
    #[must_use]
    pub fn is_large(&self, least_fraction: f64, margin: f64, acceptance: &Acceptance) -> bool {
        self.total > margin * acceptance.least_gain_of(self.residuals)
            && self.total > margin * least_fraction * self.unexplained_before
    }

    /// True if the gain is both certain and large.
    #[must_use]
    pub fn is_accepted(&self, least_fraction: f64, acceptance: &Acceptance) -> bool {
        self.is_certain(acceptance) && self.is_large(least_fraction, 1.0, acceptance)
    }
}

/// Variance of values about their mean, the usual estimate from a sample.
fn variance(values: &[f64], mean: f64) -> f64 {
    let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
    squares / (values.len() as f64 - 1.0).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::criteria::Criteria;

    const RESIDUALS: f64 = 1000.0;

    fn gain(before: &[f64], after: &[f64]) -> HeldOutGain {
        HeldOutGain::between(before, after, RESIDUALS, &acceptance())
    }

    fn acceptance() -> Acceptance {
        Criteria::default().acceptance
    }

    #[test]
    fn sum_and_standard_error_are_those_of_the_textbook() {
        // Differences 8, 10, 12: mean 10, sample variance 4, standard error of the sum sqrt(3 x 4).
        let g = gain(&[20.0, 30.0, 40.0], &[12.0, 20.0, 28.0]);
        assert_eq!(g.total, 30.0);
        assert!((g.standard_error - 12.0_f64.sqrt()).abs() < 1e-12, "{g:?}");
        assert_eq!((g.better_blocks, g.worse_blocks), (3, 0));
        assert_eq!(g.unexplained_before, 0.0);
    }

    #[test]
    fn an_even_gain_is_certain_by_its_sum() {
        let g = gain(&[100.0; 10], &[95.0; 10]);
        // Five a block: too little for the sign test, the same everywhere.
        assert_eq!(g.better_blocks, 0);
        assert!(g.is_certain(&acceptance()));
    }

    #[test]
    fn a_gain_by_a_factor_is_certain_where_one_block_holds_nearly_everything() {
        let before = [1e6, 100.0, 120.0, 90.0, 110.0, 130.0];
        let after: Vec<f64> = before.iter().map(|b| 0.96 * b).collect();
        let g = gain(&before, &after);
        assert!(g.total < acceptance().least_standard_errors * g.standard_error, "{g:?}");
        assert!(g.mean_logarithm > 0.04 && g.is_certain(&acceptance()), "{g:?}");
    }

    #[test]
    fn an_effect_that_acts_in_some_blocks_only_is_certain_by_its_signs() {
        let mut after = [100.0; 40];
        for (k, cost) in after.iter_mut().enumerate().take(5) {
            *cost -= 7.0 + 40.0 * k as f64 / 4.0;
        }
        let mut before = [100.0; 40];
        // Everywhere else chance, evenly both ways and below what counts.
        for (k, cost) in before.iter_mut().enumerate().skip(5) {
            *cost += if k % 2 == 0 { 5.0 } else { -5.0 };
        }
        let g = gain(&before, &after);
        assert_eq!((g.better_blocks, g.worse_blocks), (5, 0));
        assert!(g.is_certain(&acceptance()));
        // One block that is worse asks for three more that are better.
        after[30] += 20.0;
        assert!(!gain(&before, &after).is_certain(&acceptance()));
    }

    #[test]
    fn chance_is_not_certain() {
        let before: Vec<f64> = (0..40).map(|k| 100.0 + f64::from((k * 7) % 11)).collect();
        let after: Vec<f64> = (0..40).map(|k| 100.0 + f64::from((k * 5) % 11)).collect();
        assert!(!gain(&before, &after).is_certain(&acceptance()));
    }

    #[test]
    fn a_gain_must_be_large_in_itself_for_each_residual_and_as_a_fraction() {
        let a = acceptance();
        // 29 of 1,000 residuals: above the least for each residual, below the least at all.
        assert!(!gain(&[129.0], &[100.0]).is_large(0.0, 1.0, &a));
        assert!(gain(&[131.0], &[100.0]).is_large(0.0, 1.0, &a));
        // 31 of 10,000 residuals: too little for each.
        let many = |before, after| HeldOutGain::between(&[before], &[after], 1e4, &a);
        assert!(!many(1e4 + 31.0, 1e4).is_large(0.0, 1.0, &a));
        assert!(many(1e4 + 81.0, 1e4).is_large(0.0, 1.0, &a));
        // 100 of 4,000 unexplained: a fortieth.
        let g = gain(&[5000.0], &[4900.0]);
        assert!(g.is_large(0.02, 1.0, &a) && !g.is_large(0.03, 1.0, &a));
        // With a margin less of each is enough.
        assert!(g.is_large(0.03, 0.6, &a));
    }
}
