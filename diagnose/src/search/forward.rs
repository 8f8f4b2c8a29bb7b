//! Forward selection: the best of the screened candidates joins the model, if held-out blocks confirm it.

use super::selector::{Screened, Selector, ranked, reached};
use crate::error::DiagnoseError;
use crate::estimation::Fit;

impl Selector<'_, '_> {
    /// The same where names and laws without one compete: a name is preferred to a law that gains little more, unless the law completes the model and the name does not.
    pub fn strongest_name_or_law(&mut self, screened: &[Screened], best: &Fit) -> Result<Option<Fit>, DiagnoseError> {
        let Some(any) = self.strongest(screened, best)? else {
            return Ok(None);
        };
        if self.laws_of(&any.point) == self.laws_of(&best.point) {
            return Ok(Some(any));
        }
        let names: Vec<Screened> = (screened.iter())
            .filter(|(candidate, _)| !self.candidate(*candidate).is_unlisted())
            .cloned()
            .collect();
        let Some(named) = self.strongest(&names, best)? else {
            return Ok(Some(any));
        };
        let gain_of = |fit: &Fit| self.gain(self.held_out(best), self.held_out(fit)).total;
        let (by_law, by_name) = (gain_of(&any), gain_of(&named));
        let leads = by_law - by_name > self.criteria().rivalry.lead_over_named * by_name
            || (self.is_complete(&any) && !self.is_complete(&named));
        Ok(Some(if leads { any } else { named }))
    }

    /// The model with the strongest screened candidate added and everything fitted again; `None` if none is accepted.
    pub fn strongest(&mut self, screened: &[Screened], best: &Fit) -> Result<Option<Fit>, DiagnoseError> {
        let criteria = self.criteria();
        let before = self.held_out(best);
        let total: f64 = before.iter().sum();
        let mut winner: Option<(f64, Fit)> = None;
        for (screened_cost, start) in ranked(screened).into_iter().take(criteria.screening.finalists) {
            let Some(&candidate) = start.point.effects.last() else {
                continue;
            };
            let fraction = self.least_fraction(candidate, criteria.acceptance.least_fraction);
            // A screened fit is linear in the model's own parameters, so that single blocks may look worse than they are: its
            // gain must be large, not certain.
            let gain = self.gain(before, &reached(start));
            if !gain.is_large(fraction, criteria.screening.margin, &criteria.acceptance) {
                continue;
            }
            let behind = |cost: f64| total - screened_cost < criteria.screening.gain_of_next_finalist * (total - cost);
            if winner.as_ref().is_some_and(|(cost, _)| behind(*cost)) {
                continue;
            }
            // Most of what a fit costs is its last few thousandths, which decide nothing about one that is far behind.
            let Some(quick) = self.fits.quick(self.problem, &start.point)? else {
                continue;
            };
            let reached_quickly = reached(&quick);
            let large = (self.gain(before, &reached_quickly)).is_large(
                fraction,
                criteria.screening.margin_of_quick_fit,
                &criteria.acceptance,
            );
            let quick_cost: f64 = reached_quickly.iter().sum();
            if !large || winner.as_ref().is_some_and(|(cost, _)| quick_cost > *cost) {
                self.fits.remember_quick(start.point.clone(), quick);
                continue;
            }
            let Some(full) = self.fits.carried_on(self.problem, quick)? else {
                continue;
            };
            if self.is_too_small(&full, candidate) {
                continue;
            }
            let after = self.held_out(&full);
            let cost: f64 = after.iter().sum();
            let accepted = self.improves(best, &full, fraction);
            if accepted && winner.as_ref().is_none_or(|(best, _)| cost < *best) {
                winner = Some((cost, full));
            }
        }
        Ok(winner.map(|(_, fit)| fit))
    }

    /// True if an effect of a fit is a fault of an instrument too small to report.
    fn is_too_small(&self, fit: &Fit, effect: usize) -> bool {
        let Some(position) = fit.point.effects.iter().position(|&e| e == effect) else {
            return false;
        };
        let least = self.criteria().acceptance.least_fault;
        let own = &fit.point.z[fit.point.coordinates_of(self.specimen(), position)];
        self.candidate(effect).is_instrument_fault() && !own.is_empty() && own.iter().all(|z| z.abs() < least)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{Analytic, CUBIC, FORTY_SINES, FRICTION, GAIN, NEARLY_CUBIC, RUN, Recipe, VIBRATION};
    use crate::criteria::Criteria;
    use crate::estimation::{LeastSquares, Point};
    use crate::specimen::Specimen;
    use crate::vocabulary::Site;

    /// Laws that are true and not believed, with their numbers.
    fn lacking(truth: &[(usize, f64)]) -> Analytic {
        Recipe {
            truth: truth.iter().map(|&(law, size)| (law, vec![size])).collect(),
            ..Recipe::default()
        }
        .make()
    }

    /// One round of forward selection from the calibrated model: effects of the model that it ends with, and the number of
    /// recordings simulated after the screening. `change` may falsify what screening found.
    fn added(
        specimen: &Analytic,
        criteria: Criteria,
        candidates: &[usize],
        change: impl Fn(&mut Screened),
    ) -> (Vec<usize>, usize) {
        let problem = LeastSquares::new(specimen, &RUN).with_criteria(criteria);
        let mut selector = Selector::new(&problem);
        let calibrated = selector.fitted(Point::nominal(specimen)).expect("a fit");
        let mut screened = selector.screen(&calibrated, candidates.to_vec()).expect("screened");
        screened.iter_mut().for_each(change);
        let before = problem.evaluation.simulated();
        let best = selector.strongest(&screened, &calibrated).expect("a round");
        (
            best.map_or(vec![], |fit| fit.point.effects),
            problem.evaluation.simulated() - before,
        )
    }

    fn found(truth: &[(usize, f64)], candidates: &[usize]) -> Vec<usize> {
        added(&lacking(truth), Criteria::default(), candidates, |_| {}).0
    }

    /// Makes a screened candidate look as if it left only a part of its true cost.
    fn flatter(screened: &mut Screened, candidate: usize, part: f64) {
        if let (true, Some(fit)) = (screened.0 == candidate, &mut screened.1) {
            fit.normals.iter_mut().for_each(|n| n.cost *= part);
        }
    }

    #[test]
    fn the_missing_law_joins_and_of_two_the_one_that_explains_more() {
        let candidates = [FRICTION, VIBRATION, CUBIC, GAIN];
        assert_eq!(found(&[(FRICTION, 0.1)], &candidates), [FRICTION]);
        assert_eq!(found(&[(CUBIC, 0.3)], &candidates), [CUBIC]);
        // At these sizes the friction is the larger part of the misfit.
        assert_eq!(found(&[(CUBIC, 0.05), (FRICTION, 0.1)], &candidates), [FRICTION]);
    }

    #[test]
    fn a_law_joins_before_a_name_if_it_gains_clearly_more_or_completes_the_model() {
        // A cubic law without a name, and nearly the same law with one; then one with a name that is nothing like it.
        let lead = Criteria::default().rivalry.lead_over_named;
        let joined = |lead_over_named: f64, named: usize| {
            let mut specimen = lacking(&[(CUBIC, 0.4)]);
            specimen.take_name(CUBIC, Site::EndStop);
            let mut criteria = Criteria::default();
            criteria.rivalry.lead_over_named = lead_over_named;
            let problem = LeastSquares::new(&specimen, &RUN).with_criteria(criteria);
            let mut selector = Selector::new(&problem);
            let calibrated = selector.fitted(Point::nominal(&specimen)).expect("a fit");
            let screened = selector.screen(&calibrated, vec![CUBIC, named]).expect("screened");
            let either = selector.strongest(&screened, &calibrated).expect("a round");
            assert_eq!(either.map(|fit| fit.point.effects), Some(vec![CUBIC]));
            let best = selector.strongest_name_or_law(&screened, &calibrated).expect("a round");
            best.map(|fit| fit.point.effects)
        };
        assert_eq!(joined(lead, NEARLY_CUBIC), Some(vec![NEARLY_CUBIC]));
        assert_eq!(joined(lead, FRICTION), Some(vec![CUBIC]));
        // However much a law must gain: friction leaves the model incomplete, which the law completes.
        assert_eq!(joined(f64::INFINITY, FRICTION), Some(vec![CUBIC]));
    }

    #[test]
    fn nothing_joins_a_complete_model() {
        for seed in 0..4 {
            let specimen = Recipe {
                seed,
                ..Recipe::default()
            }
            .make();
            let candidates = [CUBIC, FRICTION, VIBRATION, FORTY_SINES, GAIN];
            let (effects, _) = added(&specimen, Criteria::default(), &candidates, |_| {});
            assert!(effects.is_empty(), "seed {seed}: {effects:?}");
        }
    }

    #[test]
    fn held_out_blocks_decide_and_not_the_order_of_screening() {
        // What fits the noise is tried first, is not confirmed, and does not keep the next from being tried.
        let noise_first = |s: &mut Screened| flatter(s, FORTY_SINES, 0.1);
        let specimen = lacking(&[(CUBIC, 0.3)]);
        let (effects, _) = added(&specimen, Criteria::default(), &[CUBIC, FORTY_SINES], noise_first);
        assert_eq!(effects, [CUBIC]);
        // A law of nearly the right shape is tried first and accepted, and then beaten.
        let nearly_first = |s: &mut Screened| flatter(s, NEARLY_CUBIC, 0.5);
        let specimen = lacking(&[(CUBIC, 3.0)]);
        let (effects, _) = added(&specimen, Criteria::default(), &[CUBIC, NEARLY_CUBIC], nearly_first);
        assert_eq!(effects, [CUBIC]);
    }

    #[test]
    fn a_finalist_far_behind_the_winner_is_not_fitted() {
        let specimen = lacking(&[(CUBIC, 0.3), (FRICTION, 0.02)]);
        let simulated = |candidates: &[usize], gain_of_next_finalist: f64| {
            let mut criteria = Criteria::default();
            criteria.screening.gain_of_next_finalist = gain_of_next_finalist;
            let (effects, simulated) = added(&specimen, criteria, candidates, |_| {});
            assert_eq!(effects, [CUBIC]);
            simulated
        };
        let alone = simulated(&[CUBIC], 0.5);
        assert_eq!(simulated(&[CUBIC, FRICTION], 0.5), alone);
        assert!(simulated(&[CUBIC, FRICTION], 0.0) > alone);
    }

    #[test]
    fn no_more_finalists_are_fitted_than_the_criteria_say() {
        let specimen = lacking(&[(CUBIC, 0.3)]);
        let with = |finalists: usize| {
            let mut criteria = Criteria::default();
            criteria.screening.finalists = finalists;
            let noise_first = |s: &mut Screened| flatter(s, FORTY_SINES, 0.1);
            added(&specimen, criteria, &[CUBIC, FORTY_SINES], noise_first).0
        };
        assert_eq!(with(1), [] as [usize; 0]);
        assert_eq!(with(2), [CUBIC]);
    }

    #[test]
    fn only_the_fault_of_an_instrument_can_be_too_small_to_report() {
        let specimen = lacking(&[]);
        let problem = LeastSquares::new(&specimen, &RUN);
        let selector = Selector::new(&problem);
        // One coordinate of the gain is 0.01, one of the friction 0.05 N; a tenth of either is the least that is reported.
        let too_small = |effect: usize, value: f64| {
            let point = Point::nominal(&specimen).with_effect(&specimen, effect, &[value]);
            let (prior, ranges) = (point.prior(&specimen), point.ranges(&specimen));
            selector.is_too_small(&Fit::new(point, vec![], prior, 0.0, ranges), effect)
        };
        assert!(too_small(GAIN, 0.0009) && too_small(GAIN, -0.0009));
        assert!(!too_small(GAIN, 0.0011) && !too_small(GAIN, -0.0011));
        assert!(specimen.candidates()[GAIN].is_instrument_fault() && !too_small(FRICTION, 0.0));
    }
}
