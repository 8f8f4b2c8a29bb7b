//! Whether a model is complete: nothing remains that the noise does not explain.

use super::selector::{Selector, reached};
use crate::estimation::Fit;
use crate::specimen::Folding;

/// So many residuals for each number of a model leave the numbers no room to bend towards noise.
const RESIDUALS_A_NUMBER: usize = 1000;

impl Selector<'_, '_> {
    /// Whether a model is complete: it predicts blocks that had no say in its fit, or it is made of names and meets those that had.
    pub fn is_complete(&self, fit: &Fit) -> bool {
        self.predicts_held_out(fit) || self.is_met_by_names(fit)
    }

    /// Noise ratio on the blocks that a model was fitted to, if these alone make it complete.
    pub fn complete_where_fitted(&self, fit: &Fit) -> Option<f64> {
        (!self.predicts_held_out(fit) && self.is_met_by_names(fit)).then(|| self.noise_ratio(&reached(fit)))
    }

    /// Whether a model predicts blocks that had no say in its fit as a complete one does.
    fn predicts_held_out(&self, fit: &Fit) -> bool {
        self.held_out_ratio(fit) <= self.complete_up_to(fit)
    }

    /// Whether a model leaves so little that no law without a name is looked for.
    pub fn reaches_noise(&self, fit: &Fit) -> bool {
        self.held_out_ratio(fit) <= self.noise_reached_at(fit) || self.is_met_by_names(fit)
    }

    /// Whether a model of names alone meets the blocks that it was fitted to as closely as their noise allows. A number that one block alone
    /// determines is lost with that block, so that the block is predicted badly though nothing is missing. A law without a name can bend
    /// to such a block and is not believed.
    fn is_met_by_names(&self, fit: &Fit) -> bool {
        let point = &fit.point;
        let of_names = !point.effects.is_empty() && point.effects.iter().all(|&e| !self.candidate(e).is_unlisted());
        let many_residuals = self.problem.residuals() >= RESIDUALS_A_NUMBER * point.z.len();
        let each_holds_all_motions = self.specimen().folding() == Folding::PartsOfEach;
        of_names
            && many_residuals
            && each_holds_all_motions
            && self.noise_ratio(&reached(fit)) <= self.noise_reached_at(fit)
    }

    /// Noise ratio up to which nothing is looked for that has no name.
    fn noise_reached_at(&self, fit: &Fit) -> f64 {
        (self.criteria().completeness.law_noise_ratio).max(self.floor(fit))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{CUBIC, LATE, RUN, Recipe};
    use crate::estimation::{LeastSquares, Point};
    use crate::vocabulary::Site;

    /// Whether a model of one effect is complete and leaves only noise where a vibration that begins late is true, and what it reaches
    /// on blocks that it was fitted to and on others.
    fn judged(effect: usize, has_name: bool) -> (bool, bool, [f64; 2]) {
        let mut specimen = Recipe {
            truth: vec![(LATE, vec![0.1])],
            recordings: 1,
            samples: 2400,
            candidates: vec![CUBIC, LATE],
            ..Recipe::default()
        }
        .make();
        if !has_name {
            specimen.take_name(effect, Site::Mount);
        }
        let problem = LeastSquares::new(&specimen, &RUN);
        let mut selector = Selector::new(&problem);
        let start = Point::nominal(&specimen).with_effect(&specimen, effect, &[0.1]);
        let fit = selector.fitted(start).expect("a fit");
        let ratios = [selector.noise_ratio(&reached(&fit)), selector.held_out_ratio(&fit)];
        (selector.is_complete(&fit), selector.reaches_noise(&fit), ratios)
    }

    #[test]
    fn a_name_that_one_part_of_the_recording_determines_is_complete_and_a_law_is_not() {
        let (complete, reaches_noise, [fitted, held_out]) = judged(LATE, true);
        assert!(fitted < 1.03 && held_out > 1.3, "{fitted} {held_out}");
        assert!(complete && reaches_noise);
        let (complete, reaches_noise, _) = judged(LATE, false);
        assert!(!complete && !reaches_noise);
    }

    #[test]
    fn a_name_that_leaves_a_misfit_is_not_complete() {
        let (complete, reaches_noise, [fitted, _]) = judged(CUBIC, true);
        assert!(fitted > 1.3, "{fitted}");
        assert!(!complete && !reaches_noise);
    }
}
