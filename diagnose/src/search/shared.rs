//! An effect that specimens of one kind have in common, tried where the search did not find it.
//!
//! Its numbers are known from the others, so that it spends none here. It need not gain what an effect of this specimen alone must: it joins the model if
//! the recordings do not speak against it or, where one other alone shows it, if they speak for it.

use super::selection::Selection;
use super::selector::{Open, Selector};
use crate::error::DiagnoseError;
use crate::estimation::{Fit, LeastSquares, Point};

/// What a search found, with an effect that others have with these coordinates; `None` if the recordings do not meet the model better with it, by this
/// much of the cost.
///
/// Effects that it makes superfluous leave the model, and so do those that exclude it; in place of one that leaves so the model may cost as much more as
/// an effect must gain.
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
    if held.cost > most {
        return Ok(None);
    }
    while let Some(less) = selector.without_superfluous(&held, least_gain)? {
        held = less;
    }
    let Some(best) = selector.fitted_if_simulated(held.point)? else {
        return Ok(None);
    };
    let effects = selector.compare_with_rivals(&best, Open::Names)?.effects;
    let beside = selector.open(&best.point, Open::Names);
    let screened = selector.screen(&best, beside)?;
    let mut scores = found.scores.clone();
    for score in &mut scores {
        (score.added, score.least_sizes) = (None, vec![]);
    }
    selector.score_added(&screened, &best, &mut scores);
    Ok(Some(Selection {
        effects,
        improved_ratio: selector.held_out_ratio(&best),
        incomplete: !selector.is_complete(&best),
        complete_where_fitted: selector.complete_where_fitted(&best),
        best,
        scores,
        ..found.clone()
    }))
}

impl Selector<'_, '_> {
    /// A model fitted with the numbers of its last effect held; `None` where it cannot be simulated.
    fn with_last_held(&self, point: Point) -> Result<Option<Fit>, DiagnoseError> {
        let held = point.coordinates_of(self.specimen(), point.effects.len() - 1);
        self.fitted_holding(point, held)
    }

    /// The model without the effect before the last that gains least, if it gains less than an effect must.
    fn without_superfluous(&self, full: &Fit, least_gain: f64) -> Result<Option<Fit>, DiagnoseError> {
        let mut weakest: Option<Fit> = None;
        for position in 0..full.point.effects.len() - 1 {
            let less = self.with_last_held(full.point.without_effect(self.specimen(), position))?;
            let cost_of_weakest = weakest.as_ref().map_or(full.cost + least_gain, |w| w.cost);
            weakest = less.filter(|less| less.cost < cost_of_weakest).or(weakest);
        }
        Ok(weakest)
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
    fn what_the_recordings_cannot_show_does_not_join() {
        let specimen = specimen(vec![], &[CUBIC]);
        assert_eq!(joined(&specimen, FRICTION, 0.001), None);
    }
}
