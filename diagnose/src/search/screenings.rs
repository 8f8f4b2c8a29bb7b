//! What was screened beside the last few models, so that nothing is screened twice.
//!
//! The search returns to models: laws without a name are screened beside the model beside which all names were, and the rivals of the effect
//! that came last are what was screened before it came.

use std::collections::{BTreeMap, VecDeque};

use super::screen::{Screen, ScreenedCandidate, cost_of, finished, go_on, promising};
use crate::error::DiagnoseError;
use crate::estimation::{Fit, LeastSquares, Point};

/// Most models that are remembered: a candidate holds its normal equations, some hundred kilobytes.
const MOST: usize = 3;

/// Screened candidates, by the model beside which they were screened.
#[derive(Default)]
pub struct Screenings {
    beside: VecDeque<Beside>,
}

struct Beside {
    model: Point,
    candidates: BTreeMap<usize, Option<ScreenedCandidate>>,
}

impl Screenings {
    /// Whether candidates were screened beside a model lately.
    pub fn know(&self, model: &Point) -> bool {
        self.beside.iter().any(|beside| beside.model == *model)
    }

    /// Every candidate added alone to a fitted model, in the order given; `None` where it cannot be simulated at all. The promising of them get
    /// further steps.
    ///
    /// # Errors
    /// [`DiagnoseError::Interrupted`] once the caller asked to stop.
    pub fn screen(
        &mut self,
        problem: &LeastSquares<'_>,
        fit: &Fit,
        candidates: &[usize],
    ) -> Result<Vec<Option<Fit>>, DiagnoseError> {
        let remembered = self.beside.iter().position(|beside| beside.model == fit.point);
        let mut beside = remembered
            .and_then(|k| self.beside.remove(k))
            .unwrap_or_else(|| Beside {
                model: fit.point.clone(),
                candidates: BTreeMap::new(),
            });
        let known = &mut beside.candidates;
        let mut screen = None;
        let new: Vec<usize> = (candidates.iter().copied())
            .filter(|c| !known.contains_key(c))
            .collect();
        if !new.is_empty() {
            let begun = screen.insert(Screen::new(problem, fit)?).begun(&new)?;
            known.extend(new.into_iter().zip(begun));
        }
        let costs: Vec<f64> = candidates.iter().map(|c| cost_of(&known[c])).collect();
        let promising: Vec<usize> = (promising(&costs, fit, &problem.criteria.screening).into_iter())
            .map(|k| candidates[k])
            .collect();
        let go_on = go_on(
            promising.iter().filter_map(|c| known[c].as_ref()),
            fit,
            &problem.criteria.screening,
        );
        if go_on.contains(&true) {
            let screen = match screen {
                Some(screen) => screen,
                None => Screen::new(problem, fit)?,
            };
            let promising = (known.iter_mut())
                .filter(|(c, _)| promising.contains(c))
                .map(|(_, screened)| screened);
            screen.advance_all(promising)?;
        }
        let fits = (candidates.iter())
            .map(|c| known[c].as_ref().map(|c| finished(problem, fit, c)))
            .collect();
        self.beside.push_front(beside);
        self.beside.truncate(MOST);
        Ok(fits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{CUBIC, FRICTION, RUN, Recipe, TABLE};
    use crate::estimation::fit;

    #[test]
    fn nothing_is_screened_twice_beside_one_model() {
        let specimen = Recipe {
            truth: vec![(CUBIC, vec![0.3])],
            ..Recipe::default()
        }
        .make();
        let problem = LeastSquares::new(&specimen, &RUN);
        let calibrated = fit(&problem, Point::nominal(&specimen), problem.criteria.fitting.converged).expect("a fit");
        let mut screenings = Screenings::default();
        let mut costs = |candidates: &[usize]| {
            let before = problem.evaluation.simulated();
            let fits = screenings.screen(&problem, &calibrated, candidates).expect("screened");
            let costs: Vec<Option<u64>> = fits.iter().map(|f| f.as_ref().map(|f| f.cost.to_bits())).collect();
            (costs, problem.evaluation.simulated() - before)
        };
        let (names, _) = costs(&[CUBIC, FRICTION]);
        let (with_a_law, of_the_law) = costs(&[CUBIC, FRICTION, TABLE]);
        assert_eq!(with_a_law[..2], names);
        assert!(of_the_law > 0);
        let (again, nothing) = costs(&[TABLE, CUBIC]);
        assert_eq!((again, nothing), (vec![with_a_law[2], names[0]], 0));
    }
}
