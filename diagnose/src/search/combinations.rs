//! Combinations: effects that improve the model together, where none of them does alone.
//!
//! A carriage that is believed to be frictionless drifts one way under a small constant force. Dry friction alone does not
//! explain where it stops, nor does the force alone; only both do. A search that adds one effect at a time ends before such a
//! pair, or behind a wrong effect that explains a part of both. So where it has ended far above the noise, each of the
//! candidates joins the model though it is not accepted, and all others are screened beside it; from the best pairs of these,
//! triples are made in the same way. That is done beside the model where the search has ended, and beside the calibrated model
//! where it began.
//!
//! Where less is left, one effect may stand in the place of two: it explains more than either does alone, and not all that both explain.

use std::collections::BTreeSet;

use super::selector::{Open, Screened, Selector, cost_reached, ranked, reached};
use crate::error::DiagnoseError;
use crate::estimation::Fit;
use crate::estimation::covariance::covariance;

/// A model with the candidates that were screened beside it.
#[derive(Clone, Copy)]
pub struct Screening<'s> {
    /// The model.
    pub model: &'s Fit,
    /// The candidates.
    pub screened: &'s [Screened],
}

impl Selector<'_, '_> {
    /// Whether what a model leaves is so far above the noise, and so large a part of what the calibrated model left, that
    /// combinations are worth their cost.
    pub fn is_far_from_complete(&self, best: &Fit, calibrated: &Fit) -> bool {
        let criteria = &self.criteria().combinations;
        let (left, before) = (self.held_out_ratio(best), self.held_out_ratio(calibrated));
        left > criteria.far_from_complete * self.complete_up_to(best)
            && left * left > criteria.least_part_left * before * before
    }

    /// The model with the strongest combination added, to the model where the search has ended or to the one where it began;
    /// `None` if none is accepted. Each is given with the candidates screened beside it.
    pub fn strongest_combination(
        &mut self,
        end: Screening<'_>,
        begin: Screening<'_>,
    ) -> Result<Option<Fit>, DiagnoseError> {
        let fraction = self.criteria().acceptance.least_fraction_incomplete;
        let beside_end = self.combination_beside(end, Open::Names, end.model)?;
        if end.model.point.effects.is_empty() {
            return Ok(beside_end);
        }
        let anew = self
            .combination_beside(begin, Open::Names, end.model)?
            .filter(|anew| self.improves(end.model, anew, fraction));
        Ok(match (beside_end, anew) {
            (Some(more), Some(anew)) => {
                let fewer = anew.point.effects.len() < more.point.effects.len();
                let prefers_more = if fewer {
                    self.improves(&anew, &more, fraction)
                } else {
                    self.held_out_ratio(&more) < self.held_out_ratio(&anew)
                };
                Some(if prefers_more { more } else { anew })
            }
            (one, other) => one.or(other),
        })
    }

    /// The model with two other names in the place of one of its effects, where that leaves nothing but noise; `None` if none does. One name may explain more
    /// than either of two does alone, and not all that both explain.
    pub fn two_in_place_of_one(&mut self, best: &Fit) -> Result<Option<Fit>, DiagnoseError> {
        for (position, &effect) in best.point.effects.iter().enumerate() {
            let without = best.point.without_effect(self.specimen(), position);
            let Some(base) = self.fitted_if_simulated(without)? else {
                continue;
            };
            let mut others = self.open(&base.point, Open::Names);
            others.retain(|&other| other != effect);
            let screened = self.screen_in_passing(&base, others)?;
            let beside = Screening {
                model: &base,
                screened: &screened,
            };
            let pair = self.combination_beside(beside, Open::Names, best)?;
            if let Some(pair) = pair.filter(|pair| self.reaches_noise(pair)) {
                return Ok(Some(pair));
            }
        }
        Ok(None)
    }

    /// The strongest combination beside a model, of what may join it. It also has to gain over the model `best`.
    pub fn combination_beside(
        &mut self,
        base: Screening<'_>,
        open: Open,
        best: &Fit,
    ) -> Result<Option<Fit>, DiagnoseError> {
        let criteria = &self.criteria().combinations;
        let (seeds, largest) = if self.specimen().simulates_in_milliseconds() {
            (criteria.seeds, criteria.largest)
        } else {
            (criteria.seeds_of_slow, criteria.largest_of_slow)
        };
        let most = self.criteria().acceptance.most_effects;
        let room = most.saturating_sub(base.model.point.effects.len());
        let mut beam: Vec<Fit> = ranked(base.screened)
            .into_iter()
            .take(seeds)
            .map(|(_, fit)| fit.clone())
            .collect();
        for size in 2..=largest.min(room) {
            let grown = self.grown(beam, open)?;
            if let Some(found) = self.confirmed(&grown, [base.model, best], size)? {
                return Ok(Some(found));
            }
            beam = grown.into_iter().take(criteria.beam).collect();
        }
        Ok(None)
    }

    /// Each model with each further candidate screened beside it, the lowest cost first and each set of effects once.
    fn grown(&mut self, beam: Vec<Fit>, open: Open) -> Result<Vec<Fit>, DiagnoseError> {
        let mut known = BTreeSet::new();
        let mut all = Vec::new();
        for start in beam {
            let Some(seed) = self.fits.quick(self.problem, &start.point)? else {
                continue;
            };
            let new = |c: &usize| !known.contains(&sorted(&seed.point.effects, Some(*c)));
            let open: Vec<usize> = self.open(&seed.point, open).into_iter().filter(new).collect();
            known.extend(open.iter().map(|c| sorted(&seed.point.effects, Some(*c))));
            let screened = self.screen_in_passing(&seed, open)?;
            all.extend(
                screened
                    .into_iter()
                    .filter_map(|(_, fit)| fit)
                    .map(|fit| (cost_reached(&fit), fit)),
            );
        }
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(all.into_iter().map(|(_, fit)| fit).collect())
    }

    /// The best of the first few that held-out blocks confirm, as a whole and each of its last `size` effects in it.
    fn confirmed(&mut self, grown: &[Fit], [base, best]: [&Fit; 2], size: usize) -> Result<Option<Fit>, DiagnoseError> {
        let criteria = self.criteria();
        let fraction = criteria.acceptance.least_fraction_incomplete;
        let mut winner: Option<(f64, Fit)> = None;
        for start in grown.iter().take(criteria.combinations.finalists) {
            let is_large = |over: &Fit| {
                let gain = self.gain(self.held_out(over), &reached(start));
                gain.is_large(fraction, criteria.screening.margin, &criteria.acceptance)
            };
            if !is_large(base) || !is_large(best) {
                continue;
            }
            let Some(full) = self.fitted_if_simulated(start.point.clone())? else {
                continue;
            };
            let after = self.held_out(&full);
            let cost: f64 = after.iter().sum();
            let accepted = self.improves(base, &full, fraction);
            let better = winner.as_ref().is_none_or(|(least, _)| cost < *least);
            if accepted
                && better
                && !self.cancel_each_other(&full, &start.point.effects, size)
                && self.each_is_needed(&full, &start.point.effects, size)?
            {
                winner = Some((cost, full));
            }
        }
        Ok(winner.map(|(_, fit)| fit))
    }

    /// Whether the model would be worse on held-out blocks without any one of the last `size` of these effects.
    fn each_is_needed(&mut self, full: &Fit, effects: &[usize], size: usize) -> Result<bool, DiagnoseError> {
        for &effect in effects.iter().rev().take(size) {
            let Some(position) = full.point.effects.iter().position(|&e| e == effect) else {
                return Ok(false);
            };
            let less = self.fitted(full.point.without_effect(self.specimen(), position))?;
            let fraction = self.least_fraction(effect, self.criteria().acceptance.least_fraction);
            if !self.improves(&less, full, fraction) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Whether two of the last `size` of these effects nearly cancel each other: what they add to the model together is then a
    /// third law, which neither of them is.
    fn cancel_each_other(&self, full: &Fit, effects: &[usize], size: usize) -> bool {
        let Some(covariance) = covariance(full) else {
            return true;
        };
        let own: Vec<_> = (effects.iter().rev().take(size))
            .filter_map(|e| full.point.effects.iter().position(|f| f == e))
            .map(|position| full.point.coordinates_of(self.specimen(), position))
            .collect();
        let limit = self.criteria().combinations.largest_correlation;
        let correlated = |i: usize, j: usize| {
            let scale = (covariance[(i, i)] * covariance[(j, j)]).sqrt();
            covariance[(i, j)].abs() > limit * scale
        };
        own.iter()
            .enumerate()
            .any(|(k, a)| (own[..k].iter()).any(|b| a.clone().any(|i| b.clone().any(|j| correlated(i, j)))))
    }
}

/// A set of effects in order.
fn sorted(effects: &[usize], further: Option<usize>) -> Vec<usize> {
    let mut all: Vec<usize> = effects.iter().copied().chain(further).collect();
    all.sort_unstable();
    all
}

#[cfg(test)]
mod tests {
    use std::slice;

    use crate::analytic::{CUBIC, FIRST_OF_PAIR, FRICTION, GAIN, IMITATION, OTHER_TONE, RUN, Recipe, SECOND_OF_PAIR};
    use crate::criteria::Criteria;
    use crate::estimation::LeastSquares;
    use crate::search::select;

    /// Effects that the whole search finds.
    fn found(truth: &[(usize, f64)], criteria: Criteria) -> Vec<usize> {
        let specimen = Recipe {
            truth: truth.iter().map(|&(law, size)| (law, vec![size])).collect(),
            candidates: vec![CUBIC, FRICTION, GAIN, FIRST_OF_PAIR, SECOND_OF_PAIR],
            cheap: true,
            ..Recipe::default()
        }
        .make();
        let problem = LeastSquares::new(&specimen, &RUN).with_criteria(criteria);
        let mut effects = select(&problem, &|_, _| {}).expect("a selection").best.point.effects;
        effects.sort_unstable();
        effects
    }

    const PAIR: [(usize, f64); 2] = [(FIRST_OF_PAIR, 1.5), (SECOND_OF_PAIR, 1.5)];

    #[test]
    fn a_pair_is_found_of_which_neither_helps_alone() {
        let usual = Criteria::default();
        assert_eq!(found(&PAIR, usual), [FIRST_OF_PAIR, SECOND_OF_PAIR]);
        // Also beside what helps alone, and not without combinations.
        let three = [slice::from_ref(&(FRICTION, 0.5)), &PAIR].concat();
        assert_eq!(found(&three, usual), [FRICTION, FIRST_OF_PAIR, SECOND_OF_PAIR]);
        let mut never = usual;
        never.combinations.far_from_complete = f64::INFINITY;
        assert_eq!(found(&PAIR, never), [] as [usize; 0]);
    }

    #[test]
    fn two_take_the_place_of_one_that_explains_more_than_either_and_not_all() {
        let found = |truth: &[(usize, f64)], candidates: &[usize]| {
            let specimen = Recipe {
                truth: truth.iter().map(|&(law, size)| (law, vec![size])).collect(),
                candidates: candidates.to_vec(),
                ..Recipe::default()
            }
            .make();
            let selection = select(&LeastSquares::new(&specimen, &RUN), &|_, _| {}).expect("a selection");
            let mut effects = selection.best.point.effects;
            effects.sort_unstable();
            effects
        };
        let (both, all) = (
            [(FIRST_OF_PAIR, 0.2), (OTHER_TONE, 0.2)],
            [FRICTION, FIRST_OF_PAIR, OTHER_TONE, IMITATION],
        );
        assert_eq!(found(&both, &all), [FIRST_OF_PAIR, OTHER_TONE]);
        let three = [&both[..], &[(FRICTION, 0.2)]].concat();
        assert_eq!(found(&three, &all), [FRICTION, FIRST_OF_PAIR, OTHER_TONE]);
        // Where the two are not what is missing, the one stays.
        assert_eq!(found(&both, &[FIRST_OF_PAIR, FRICTION, IMITATION]), [IMITATION]);
        assert_eq!(found(&[(IMITATION, 0.2)], &all), [IMITATION]);
    }

    #[test]
    fn two_that_nearly_cancel_each_other_are_no_pair() {
        let mut strict = Criteria::default();
        // The correlation of the two amounts is 0.95.
        strict.combinations.largest_correlation = 0.9;
        assert_eq!(found(&PAIR, strict), [] as [usize; 0]);
    }

    #[test]
    fn nothing_is_combined_where_one_effect_suffices() {
        assert_eq!(found(&[(FRICTION, 0.5)], Criteria::default()), [FRICTION]);
        assert_eq!(found(&[(CUBIC, 0.3)], Criteria::default()), [CUBIC]);
    }
}
