//! Dormant numbers: numbers of the model that matter only beside an effect that it lacks.
//!
//! A strut in the middle of a drive has gas of an unknown temperature, which is nothing to a model whose gas is always at ambient temperature. Beside a candidate
//! screening lets the model's numbers respond as they do without it, so that such a number does not respond at all, and the candidate
//! that wakes it seems to explain little. Where no name is left to add, these candidates are therefore fitted with all numbers.

use super::selector::Selector;
use crate::effect::Candidate;
use crate::error::DiagnoseError;
use crate::estimation::Fit;

impl Selector<'_, '_> {
    /// The best model with an effect that wakes a number, added to the model without effects or to the one where the search has ended; `None` if none is accepted
    /// over that one.
    pub fn with_dormant_numbers(&mut self, [best, calibrated]: [&Fit; 2]) -> Result<Option<Fit>, DiagnoseError> {
        let acceptance = &self.criteria().acceptance;
        let mut found: Option<Fit> = None;
        let has_effects = !best.point.effects.is_empty();
        for candidate in self.awakening() {
            for base in std::iter::once(calibrated).chain(has_effects.then_some(best)) {
                let effects = &base.point.effects;
                let may_join = self.may_join(candidate, effects.iter().copied());
                if !may_join || effects.len() >= acceptance.most_effects {
                    continue;
                }
                let Some(full) = self.fitted_from_all_starts(base, candidate)? else {
                    continue;
                };
                let accepted = self.improves(best, &full, acceptance.least_fraction);
                let better_than = |other: &Fit| self.improves(other, &full, acceptance.least_fraction);
                if accepted && found.as_ref().is_none_or(better_than) {
                    found = Some(full);
                }
            }
        }
        Ok(found)
    }

    /// Candidates with a name beside which alone a number of the model matters.
    fn awakening(&self) -> Vec<usize> {
        let calibration = self.specimen().calibration();
        let wakes = |candidate: &Candidate| {
            let mut awaited = calibration.iter().filter_map(|number| number.only_beside.as_ref());
            !candidate.is_unlisted() && awaited.any(|beside| beside.is(candidate.id, &candidate.place))
        };
        (self.testable().iter().copied())
            .filter(|&c| wakes(self.candidate(c)))
            .collect()
    }

    /// A model with one more effect, fitted from the start that leads lowest; `None` where it cannot be simulated.
    fn fitted_from_all_starts(&mut self, base: &Fit, candidate: usize) -> Result<Option<Fit>, DiagnoseError> {
        let mut lowest: Option<Fit> = None;
        for values in self.candidate(candidate).all_starts() {
            let start = base.point.with_effect(self.specimen(), candidate, &values);
            let quick = self.fits.quick(self.problem, &start)?;
            lowest = (lowest.into_iter().chain(quick)).min_by(|a, b| a.cost.total_cmp(&b.cost));
        }
        match lowest {
            Some(quick) => self.fits.carried_on(self.problem, quick),
            None => Ok(None),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{Analytic, CUBIC, PHASED, RUN, Recipe};
    use crate::estimation::{LeastSquares, Point};
    use crate::search::select;

    /// What lacks these effects, with a vibration whose phase sleeps among the candidates.
    fn lacking(truth: Vec<(usize, Vec<f64>)>, candidates: &[usize]) -> Analytic {
        let mut specimen = Recipe {
            truth,
            candidates: candidates.to_vec(),
            ..Recipe::default()
        }
        .make();
        specimen.let_phase_sleep();
        specimen
    }

    #[test]
    fn an_effect_that_explains_nothing_unless_it_wakes_a_number_is_found() {
        for truth in [vec![(PHASED, vec![0.4])], vec![(CUBIC, vec![0.3]), (PHASED, vec![0.4])]] {
            let effects: Vec<usize> = truth.iter().map(|(effect, _)| *effect).collect();
            let specimen = lacking(truth, &[CUBIC, PHASED]);
            let problem = LeastSquares::new(&specimen, &RUN);
            let mut selector = Selector::new(&problem);
            let calibrated = selector.fitted(Point::nominal(&specimen)).expect("a fit");
            let screened = selector.screen(&calibrated, vec![PHASED]).expect("screened");
            assert!(selector.strongest(&screened, &calibrated).expect("a round").is_none());
            let mut found = select(&problem, &|_, _| {}).expect("a selection");
            found.best.point.effects.sort_unstable();
            assert_eq!(found.best.point.effects, effects);
            assert!(!found.incomplete);
        }
    }

    #[test]
    fn what_improves_nothing_does_not_join() {
        let specimen = lacking(vec![(CUBIC, vec![0.3])], &[PHASED]);
        let problem = LeastSquares::new(&specimen, &RUN);
        let mut selector = Selector::new(&problem);
        let calibrated = selector.fitted(Point::nominal(&specimen)).expect("a fit");
        let before = problem.evaluation.simulated();
        let woken = selector.with_dormant_numbers([&calibrated; 2]).expect("fits");
        assert!(woken.is_none() && problem.evaluation.simulated() > before);
    }
}
