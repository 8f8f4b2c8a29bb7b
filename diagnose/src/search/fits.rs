//! Fits that are made once.
//!
//! The search returns to sets of effects: what is left when an effect is dropped was often a model on the way. And combinations begin from
//! candidates whose quick fits were made, and rejected, before.

use std::collections::{BTreeMap, VecDeque};

use crate::error::DiagnoseError;
use crate::estimation::{Fit, LeastSquares, Point, carried_on, fit};

/// Most quick fits that are remembered: each holds its derivatives, some tens of megabytes.
const MOST_QUICK: usize = 4;

/// Fits already made.
#[derive(Default)]
pub struct Fits {
    /// Converged ones, by their effects.
    known: BTreeMap<Vec<usize>, Fit>,
    /// The last quick ones that nobody carried on, with their starts.
    quick: VecDeque<(Point, Fit)>,
}

impl Fits {
    /// The converged fit of a model. Each set of effects is fitted once, unless the start is better than the fit that is known:
    /// that one had then ended in a local minimum.
    pub fn converged(&mut self, problem: &LeastSquares<'_>, start: Point) -> Result<Fit, DiagnoseError> {
        if let Some(known) = self.known_beside(problem, &start)? {
            return Ok(known.clone());
        }
        let full = fit(problem, start, problem.criteria.fitting.converged)?;
        self.remember(&full);
        Ok(full)
    }

    /// A fit that is carried only as far as is needed to judge whether it is worth carrying on; the converged one where it is known. `None`
    /// where the start cannot be simulated.
    pub fn quick(&self, problem: &LeastSquares<'_>, start: &Point) -> Result<Option<Fit>, DiagnoseError> {
        if let Some((_, quick)) = self.quick.iter().find(|(from, _)| from == start) {
            return Ok(Some(quick.clone()));
        }
        if_simulated(match self.known_beside(problem, start) {
            Ok(Some(known)) => Ok(known.clone()),
            Ok(None) => fit(problem, start.clone(), problem.criteria.fitting.quick),
            Err(other) => Err(other),
        })
    }

    /// Remembers a quick fit that is not worth carrying on, with its start, in case that combinations begin from it.
    pub fn remember_quick(&mut self, start: Point, quick: Fit) {
        self.quick.push_front((start, quick));
        self.quick.truncate(MOST_QUICK);
    }

    /// The converged fit that a quick one leads to; `None` where its derivatives cannot be simulated.
    pub fn carried_on(&mut self, problem: &LeastSquares<'_>, quick: Fit) -> Result<Option<Fit>, DiagnoseError> {
        if let Some(known) = self.known_unless(problem, &in_order(&quick.point), quick.cost) {
            return Ok(Some(known.clone()));
        }
        let full = if_simulated(carried_on(problem, quick, problem.criteria.fitting.converged))?;
        if let Some(full) = &full {
            self.remember(full);
        }
        Ok(full)
    }

    fn remember(&mut self, full: &Fit) {
        self.known.insert(in_order(&full.point), full.without_sensitivities());
    }

    /// The known fit of the effects of a start, unless the start is better.
    fn known_beside(&self, problem: &LeastSquares<'_>, start: &Point) -> Result<Option<&Fit>, DiagnoseError> {
        let effects = in_order(start);
        if !self.known.contains_key(&effects) {
            return Ok(None);
        }
        Ok(self.known_unless(problem, &effects, problem.cost_at(start)?))
    }

    /// The known fit of some effects, unless this cost is lower by enough to matter.
    fn known_unless(&self, problem: &LeastSquares<'_>, effects: &[usize], cost: f64) -> Option<&Fit> {
        let matters = problem.criteria.acceptance.gain_of_other_minimum();
        (self.known.get(effects)).filter(|known| cost > known.cost - matters)
    }
}

/// The effects of a point in the order of the candidates.
fn in_order(point: &Point) -> Vec<usize> {
    let mut effects = point.effects.clone();
    effects.sort_unstable();
    effects
}

/// A fit; `None` where its start cannot be simulated.
pub fn if_simulated(fit: Result<Fit, DiagnoseError>) -> Result<Option<Fit>, DiagnoseError> {
    match fit {
        Ok(fit) => Ok(Some(fit)),
        Err(DiagnoseError::Simulation { .. }) => Ok(None),
        Err(other) => Err(other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{CUBIC, FRAGILE, RUN, Recipe};

    #[test]
    fn what_was_fitted_is_not_simulated_again() {
        let specimen = Recipe {
            truth: vec![(CUBIC, vec![0.3])],
            ..Recipe::default()
        }
        .make();
        let problem = LeastSquares::new(&specimen, &RUN);
        let simulated = || problem.evaluation.simulated();
        let start = |size: f64| Point::nominal(&specimen).with_effect(&specimen, CUBIC, &[size]);
        let mut fits = Fits::default();
        let quick = fits.quick(&problem, &start(0.1)).expect("a fit").expect("a fit");
        fits.remember_quick(start(0.1), quick.clone());
        let before = simulated();
        let again = fits.quick(&problem, &start(0.1)).expect("a fit").expect("a fit");
        assert_eq!((again.point, simulated()), (quick.point.clone(), before));
        // Only a few are remembered.
        for k in 0..MOST_QUICK {
            fits.remember_quick(start(0.2 + 0.1 * k as f64), quick.clone());
        }
        fits.quick(&problem, &start(0.1)).expect("a fit");
        assert!(simulated() > before);
        // A quick fit that is no better than the converged one is not carried on.
        let full = fits.carried_on(&problem, quick.clone()).expect("a fit").expect("a fit");
        assert!(full.converged && full.cost <= quick.cost);
        let before = simulated();
        let again = fits.carried_on(&problem, quick).expect("a fit").expect("a fit");
        assert_eq!((again.point, simulated()), (full.point, before));
    }

    #[test]
    fn a_quick_fit_that_cannot_be_simulated_is_none() {
        let specimen = Recipe::default().make();
        let problem = LeastSquares::new(&specimen, &RUN);
        let broken = Point::nominal(&specimen).with_effect(&specimen, FRAGILE, &[2.0]);
        let mut fits = Fits::default();
        assert!(fits.quick(&problem, &broken).expect("no failure").is_none());
        assert!(fits.converged(&problem, broken).is_err());
    }
}
