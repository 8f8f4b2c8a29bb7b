//! An effect that specimens of one kind have in common, tried where the search did not find it, or found it with other numbers.
//!
//! Its numbers are known from the others, so that it spends none here. It need not gain what an effect of this specimen alone must: it joins the model if
//! the recordings do not speak against it or, where one other alone shows it, if they speak for it. Where the search found it, the numbers of the others are
//! where further fits begin: it may have ended in a minimum that is not the lowest.

use super::selection::Selection;
use super::selector::{Open, Selector};
use crate::error::DiagnoseError;
use crate::estimation::{Fit, LeastSquares, Point};

/// By how much the cost of a fit falls that is better: less is within one standard deviation of the numbers.
const ONE_DEVIATION: f64 = 1.0;

/// What a search found, with an effect that others have with these coordinates; `None` if the recordings do not meet the model better with it, by this
/// much of the cost.
///
/// Effects that exclude it leave the model; in place of one of them the model may cost as much more as an effect must gain. Effects that it makes superfluous
/// leave too; in place of one of these the model may cost as much more as a fitted number gains by chance.
///
/// # Errors
/// [`DiagnoseError::Interrupted`] once the caller asked to stop.
pub fn with_shared(
    problem: &LeastSquares<'_>,
    found: &Selection,
    shared: usize,
    coordinates: &[f64],
    better_by: f64,
) -> Result<Option<Selection>, DiagnoseError> {
    let mut selector = Selector::new(problem);
    if !selector.testable().contains(&shared) {
        return Ok(None);
    }
    let specimen = problem.specimen();
    let least_gain = (selector.criteria().acceptance).least_gain_of(problem.residuals() as f64);
    let mut point = found.best.point.clone();
    let mut most = found.best.cost - better_by;
    let excluded = |e: &usize| selector.candidate(*e).excludes(selector.candidate(shared));
    while let Some(position) = point.effects.iter().position(excluded) {
        point = point.without_effect(specimen, position);
        most += least_gain;
    }
    point.effects.push(shared);
    point.z.extend(coordinates);
    let Some(mut held) = selector.with_last_held(point)? else {
        return Ok(None);
    };
    let is_met = held.cost <= most;
    // The number of one that leaves was fitted here, that of the shared effect was not.
    let in_place_of_one = selector.criteria().acceptance.least_gain;
    if held.cost > most + in_place_of_one * (held.point.effects.len() - 1) as f64 {
        return Ok(None);
    }
    while let Some(less) = selector.without_superfluous(&held, least_gain, &|point| selector.with_last_held(point))? {
        held = less;
        most += in_place_of_one;
    }
    if !is_met && held.cost > most {
        return Ok(None);
    }
    selector.found_with(found, held.point)
}

/// What a search found, fitted once more from the numbers with which others have one of its effects, as coordinates; `None` if none of these fits is better.
///
/// Effects that gain less beside the new numbers than an effect must leave the model.
///
/// # Errors
/// [`DiagnoseError::Interrupted`] once the caller asked to stop.
pub fn begun_at_others(
    problem: &LeastSquares<'_>,
    found: &Selection,
    shared: usize,
    starts: &[Vec<f64>],
) -> Result<Option<Selection>, DiagnoseError> {
    let mut selector = Selector::new(problem);
    let specimen = problem.specimen();
    let least_gain = (selector.criteria().acceptance).least_gain_of(problem.residuals() as f64);
    let Some(position) = found.best.point.effects.iter().position(|&effect| effect == shared) else {
        return Ok(None);
    };
    let without = found.best.point.without_effect(specimen, position);
    let worth = |fit: &Fit| fit.cost + least_gain * fit.point.effects.len() as f64;
    let mut best: Option<Fit> = None;
    for start in starts {
        let mut point = without.clone();
        point.effects.push(shared);
        point.z.extend(start);
        let Some(mut fit) = selector.fitted_holding(point, 0..0)? else {
            continue;
        };
        while let Some(less) =
            selector.without_superfluous(&fit, least_gain, &|point| selector.fitted_holding(point, 0..0))?
        {
            fit = less;
        }
        let least = best.as_ref().map_or(worth(&found.best) - ONE_DEVIATION, worth);
        if worth(&fit) < least {
            best = Some(fit);
        }
    }
    best.map_or(Ok(None), |best| selector.found_with(found, best.point))
}

impl Selector<'_, '_> {
    /// A model fitted with the numbers of its last effect held; `None` where it cannot be simulated.
    fn with_last_held(&self, point: Point) -> Result<Option<Fit>, DiagnoseError> {
        let held = point.coordinates_of(self.specimen(), point.effects.len() - 1);
        self.fitted_holding(point, held)
    }

    /// The model without the effect before the last that gains least, if it gains less than an effect must.
    fn without_superfluous(
        &self,
        full: &Fit,
        least_gain: f64,
        fitted: &dyn Fn(Point) -> Result<Option<Fit>, DiagnoseError>,
    ) -> Result<Option<Fit>, DiagnoseError> {
        let mut weakest: Option<Fit> = None;
        for position in 0..full.point.effects.len() - 1 {
            let less = fitted(full.point.without_effect(self.specimen(), position))?;
            let cost_of_weakest = weakest.as_ref().map_or(full.cost + least_gain, |w| w.cost);
            weakest = less.filter(|less| less.cost < cost_of_weakest).or(weakest);
        }
        Ok(weakest)
    }

    /// What a search found, with another model, which is fitted from this point.
    fn found_with(&mut self, found: &Selection, point: Point) -> Result<Option<Selection>, DiagnoseError> {
        let Some(best) = self.fitted_if_simulated(point)? else {
            return Ok(None);
        };
        let effects = self.compare_with_rivals(&best, Open::Names)?.effects;
        let beside = self.open(&best.point, Open::Names);
        let screened = self.screen(&best, beside)?;
        let mut scores = found.scores.clone();
        for score in &mut scores {
            (score.added, score.least_sizes) = (None, vec![]);
        }
        self.score_added(&screened, &best, &mut scores);
        Ok(Some(Selection {
            effects,
            improved_ratio: self.held_out_ratio(&best),
            incomplete: !self.is_complete(&best),
            complete_where_fitted: self.complete_where_fitted(&best),
            best,
            scores,
            ..found.clone()
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{Analytic, CUBIC, FRICTION, NEARLY_CUBIC, RUN, Recipe};
    use crate::search::select;
    use crate::specimen::Specimen;

    fn specimen(truth: Vec<(usize, Vec<f64>)>, candidates: &[usize]) -> Analytic {
        Recipe {
            truth,
            candidates: candidates.to_vec(),
            ..Recipe::default()
        }
        .make()
    }

    /// The model that comes of what a search finds and of an effect of this size that others have; `None` if it does not join.
    fn joined(specimen: &Analytic, shared: usize, size: f64) -> Option<Vec<usize>> {
        joined_if(specimen, shared, size, 0.0)
    }

    /// The same if it lowers the cost by this much.
    fn joined_if(specimen: &Analytic, shared: usize, size: f64, better_by: f64) -> Option<Vec<usize>> {
        let problem = LeastSquares::new(specimen, &RUN);
        let found = select(&problem, &|_, _| {}).expect("a selection");
        assert!(!found.best.point.effects.contains(&shared));
        let z = specimen.candidates()[shared].parameters[0].z(size);
        let joined = with_shared(&problem, &found, shared, &[z], better_by).expect("fits");
        joined.map(|selection| {
            let named: Vec<usize> = selection.effects.iter().map(|e| e.candidate).collect();
            let mut effects = selection.best.point.effects;
            effects.sort_unstable();
            assert!(effects.iter().all(|e| named.contains(e)), "{named:?}");
            effects
        })
    }

    #[test]
    fn what_is_too_weak_to_be_found_joins_and_what_is_not_there_does_not() {
        let weak = specimen(vec![(FRICTION, vec![0.003])], &[CUBIC, FRICTION]);
        assert_eq!(joined(&weak, FRICTION, 0.003), Some(vec![FRICTION]));
        // The recordings speak for it, but not aloud.
        assert_eq!(joined_if(&weak, FRICTION, 0.003, 1.0), Some(vec![FRICTION]));
        assert_eq!(joined_if(&weak, FRICTION, 0.003, 30.0), None);
        // The recordings speak against a friction that is three times as strong.
        assert_eq!(joined(&weak, FRICTION, 0.009), None);
        let without = specimen(vec![], &[CUBIC, FRICTION]);
        assert_eq!(joined(&without, FRICTION, 0.004), None);
    }

    #[test]
    fn what_took_its_place_leaves_and_what_is_needed_beside_it_stays() {
        let truth = vec![(CUBIC, vec![0.3]), (FRICTION, vec![0.1])];
        let specimen = specimen(truth, &[NEARLY_CUBIC, CUBIC, FRICTION]);
        let problem = LeastSquares::new(&specimen, &RUN);
        // As a search may have found it.
        let mut found = select(&problem, &|_, _| {}).expect("a selection");
        let wrong = Point::nominal(&specimen)
            .with_effect(&specimen, NEARLY_CUBIC, &[0.3])
            .with_effect(&specimen, FRICTION, &[0.1]);
        found.best = Selector::new(&problem).fitted(wrong).expect("a fit");
        let z = specimen.candidates()[CUBIC].parameters[0].z(0.3);
        let with_it = with_shared(&problem, &found, CUBIC, &[z], 0.0)
            .expect("fits")
            .expect("it joins");
        assert_eq!(with_it.best.point.effects, [FRICTION, CUBIC]);
        assert!(!with_it.incomplete);
    }

    #[test]
    fn what_others_have_may_meet_the_recordings_a_little_worse_than_what_leaves_for_it() {
        let weak = specimen(vec![(CUBIC, vec![0.02])], &[FRICTION, CUBIC]);
        let problem = LeastSquares::new(&weak, &RUN);
        let mut found = select(&problem, &|_, _| {}).expect("a selection");
        let in_its_place = Point::nominal(&weak).with_effect(&weak, FRICTION, &[0.004]);
        found.best = Selector::new(&problem).fitted(in_its_place).expect("a fit");
        let joined = |size: f64| {
            let z = weak.candidates()[CUBIC].parameters[0].z(size);
            let joined = with_shared(&problem, &found, CUBIC, &[z], 0.0).expect("fits");
            joined.map(|selection| selection.best.point.effects)
        };
        // The recordings show 0.02.
        assert_eq!([0.05, 0.06].map(joined), [Some(vec![CUBIC]), None]);
    }

    #[test]
    fn from_the_numbers_of_others_the_lower_minimum_is_found() {
        let specimen = specimen(vec![(CUBIC, vec![0.3])], &[CUBIC, FRICTION]);
        let problem = LeastSquares::new(&specimen, &RUN);
        let right = select(&problem, &|_, _| {}).expect("a selection");
        assert_eq!(right.best.point.effects, [CUBIC]);
        let z = |size: f64| vec![specimen.candidates()[CUBIC].parameters[0].z(size)];
        let begun = |found: &Selection, size: f64| begun_at_others(&problem, found, CUBIC, &[z(size)]).expect("fits");
        assert!(begun(&right, 0.29).is_none(), "it is the lowest already");
        // A search that ended beside it, and took friction for what was left.
        let beside = Point::nominal(&specimen)
            .with_effect(&specimen, CUBIC, &[0.2])
            .with_effect(&specimen, FRICTION, &[0.1]);
        let everything = 0..beside.z.len();
        let ended = Selection {
            best: (Selector::new(&problem).fitted_holding(beside, everything))
                .expect("fits")
                .expect("it can be simulated"),
            ..right.clone()
        };
        let better = begun(&ended, 0.29).expect("it is better");
        assert_eq!(better.best.point.effects, [CUBIC]);
        assert!((better.best.cost / right.best.cost - 1.0).abs() < 1e-6);
        assert!(
            begun_at_others(&problem, &right, FRICTION, &[z(0.3)])
                .expect("fits")
                .is_none()
        );
    }

    #[test]
    fn what_the_recordings_cannot_show_does_not_join() {
        let specimen = specimen(vec![], &[CUBIC]);
        assert_eq!(joined(&specimen, FRICTION, 0.001), None);
    }
}
