//! What all steps of the search share: fits that are made once, candidates that may be added, and judgement on held-out
//! blocks.

use std::ops::Range;

use super::evidence::HeldOutGain;
use super::fits::{Fits, if_simulated};
use super::screen::Screen;
use super::screenings::Screenings;
use crate::criteria::Criteria;
use crate::effect::{Candidate, Joins};
use crate::error::DiagnoseError;
use crate::estimation::gauss_newton::{Start, fit_from};
use crate::estimation::{Fit, LeastSquares, Point, cost_of_whole_recordings, held_out};
use crate::specimen::{Folding, Specimen};

/// What may join a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Open {
    /// Effects of the vocabulary.
    Names,
    /// Numbers of the model that may be other than believed, too.
    Numbers,
    /// Laws without a name too. Of those that exclude each other at their place only, a model has one.
    Laws,
    /// The same, and a model has two of them.
    TwoLaws,
}

/// A candidate and its screened fit; `None` where it cannot be simulated at all.
pub type Screened = (usize, Option<Fit>);

/// The search in progress.
pub struct Selector<'p, 'a> {
    /// Specimen, blocks and thresholds.
    pub problem: &'p LeastSquares<'a>,
    /// Candidates that the recordings can show.
    testable: Vec<usize>,
    /// Fits already made.
    pub fits: Fits,
    /// Candidates already screened.
    screenings: Screenings,
}

impl<'p, 'a> Selector<'p, 'a> {
    /// A search that has not begun.
    pub fn new(problem: &'p LeastSquares<'a>) -> Self {
        let all = problem.specimen().candidates();
        Self {
            problem,
            testable: (0..all.len()).filter(|&c| all[c].untestable.is_none()).collect(),
            fits: Fits::default(),
            screenings: Screenings::default(),
        }
    }

    pub fn criteria(&self) -> &'p Criteria {
        &self.problem.criteria
    }

    pub fn specimen(&self) -> &'a dyn Specimen {
        self.problem.specimen()
    }

    /// Candidates that the recordings can show.
    pub fn testable(&self) -> &[usize] {
        &self.testable
    }

    pub fn candidate(&self, index: usize) -> &'a Candidate {
        &self.specimen().candidates()[index]
    }

    /// The converged fit of a model, made once ([`Fits`]).
    pub fn fitted(&mut self, start: Point) -> Result<Fit, DiagnoseError> {
        self.fits.converged(self.problem, start)
    }

    /// The same where the start can be simulated; `None` where it cannot, which is no candidate and no failure.
    pub fn fitted_if_simulated(&mut self, start: Point) -> Result<Option<Fit>, DiagnoseError> {
        if_simulated(self.fitted(start))
    }

    /// A model fitted from a start of which some coordinates are held; `None` where it cannot be simulated.
    pub fn fitted_holding(&self, start: Point, held: Range<usize>) -> Result<Option<Fit>, DiagnoseError> {
        let start = Start::at(self.problem, start);
        let effort = self.criteria().fitting.converged;
        if_simulated(start.and_then(|start| fit_from(self.problem, start.holding(held.collect()), effort)))
    }

    /// Costs of the blocks, each held out.
    pub fn held_out<'f>(&self, fit: &'f Fit) -> &'f [f64] {
        &held_out(fit, self.problem).costs
    }

    /// Noise ratio of costs over all blocks.
    pub fn noise_ratio(&self, costs: &[f64]) -> f64 {
        (costs.iter().sum::<f64>() / self.problem.residuals() as f64).sqrt()
    }

    /// Held-out noise ratio of a fit.
    pub fn held_out_ratio(&self, fit: &Fit) -> f64 {
        self.noise_ratio(self.held_out(fit))
    }

    /// What one set of costs gains over another.
    pub fn gain(&self, before: &[f64], after: &[f64]) -> HeldOutGain {
        let residuals = self.problem.residuals() as f64;
        HeldOutGain::between(before, after, residuals, &self.criteria().acceptance)
    }

    /// True if a gain is accepted: certain, large, and at least a fraction of what is unexplained.
    pub fn accepts(&self, gain: &HeldOutGain, least_fraction: f64) -> bool {
        gain.is_accepted(least_fraction, &self.criteria().acceptance)
    }

    /// True if a model is accepted over one with fewer effects: the gain on held-out blocks is accepted, and whole recordings
    /// are not predicted worse.
    pub fn improves(&self, less: &Fit, full: &Fit, least_fraction: f64) -> bool {
        let gain = self.gain(self.held_out(less), self.held_out(full));
        self.accepts(&gain, least_fraction) && !self.predicts_recordings_worse(less, full)
    }

    /// True if a model predicts whole recordings, each from a fit of the others, worse than another model does. Asked of two
    /// recordings that repeat one motion each, because then a fold holds a part of each. (Where there are more, a fold is a
    /// whole recording.)
    pub fn predicts_recordings_worse(&self, than: &Fit, full: &Fit) -> bool {
        let specimen = self.specimen();
        let asked = specimen.folding() == Folding::WholeRecordings && specimen.recordings().len() == 2;
        asked && {
            let cost = |fit| cost_of_whole_recordings(fit, self.problem);
            cost(full) > self.criteria().acceptance.whole_recordings * cost(than)
        }
    }

    /// Candidates that may be added to a model: not in it and excluded by none of its effects. Laws without a name only
    /// where they are asked for.
    pub fn open(&self, point: &Point, open: Open) -> Vec<usize> {
        self.joinable(point, open, Joins::Screened)
    }

    /// The same of candidates that are screened only when nothing else joins.
    pub fn open_at_last(&self, point: &Point, open: Open) -> Vec<usize> {
        self.joinable(point, open, Joins::AtLast)
    }

    fn joinable(&self, point: &Point, open: Open, joins: Joins) -> Vec<usize> {
        let laws = self.laws_of(point);
        let excluded = |c: usize| {
            let candidate = self.candidate(c);
            let closed = match open {
                Open::Names => candidate.is_unlisted(),
                Open::Numbers => candidate.is_law(),
                Open::Laws => candidate.one_of_several && laws >= 1,
                Open::TwoLaws => candidate.one_of_several && laws >= 2,
            };
            closed || candidate.joins != joins || !self.may_join(c, point.effects.iter().copied())
        };
        self.testable.iter().copied().filter(|&c| !excluded(c)).collect()
    }

    /// Whether a candidate may join these effects: it is none of them, and none of them excludes it.
    pub fn may_join(&self, candidate: usize, mut effects: impl Iterator<Item = usize>) -> bool {
        effects.all(|e| e != candidate && !self.candidate(e).excludes(self.candidate(candidate)))
    }

    /// How many laws without a name a model has of those of which it can have two.
    pub fn laws_of(&self, point: &Point) -> usize {
        (point.effects.iter())
            .filter(|&&e| self.candidate(e).one_of_several)
            .count()
    }

    /// Whether there are laws without a name of which a model can have two.
    pub fn can_have_two_laws(&self) -> bool {
        self.testable.iter().any(|&c| self.candidate(c).one_of_several)
    }

    /// Screens candidates beside a fitted model, each once.
    pub fn screen(&mut self, fit: &Fit, candidates: Vec<usize>) -> Result<Vec<Screened>, DiagnoseError> {
        let fits = self.screenings.screen(self.problem, fit, &candidates)?;
        Ok(candidates.into_iter().zip(fits).collect())
    }

    /// The same beside a model that is only passed on the way to others: what is remembered of it is used, and nothing more is remembered.
    pub fn screen_in_passing(&mut self, fit: &Fit, candidates: Vec<usize>) -> Result<Vec<Screened>, DiagnoseError> {
        if self.screenings.know(&fit.point) {
            return self.screen(fit, candidates);
        }
        let fits = Screen::new(self.problem, fit)?.all(&candidates)?;
        Ok(candidates.into_iter().zip(fits).collect())
    }

    /// Smallest fraction of the unexplained cost that a candidate must explain. A law without a name bends to much, and so
    /// does an instrument where the model stays incomplete: both must explain more.
    pub fn least_fraction(&self, candidate: usize, fraction: f64) -> f64 {
        let acceptance = &self.criteria().acceptance;
        let candidate = self.candidate(candidate);
        let stays_incomplete = fraction > acceptance.least_fraction;
        if candidate.is_law() || (candidate.is_instrument_fault() && stays_incomplete) {
            fraction.max(acceptance.least_fraction_incomplete)
        } else {
            fraction
        }
    }

    /// Fraction of the unexplained cost that each effect of an incomplete model must explain.
    pub fn fraction_of_incomplete(&self) -> f64 {
        let (specimen, acceptance) = (self.specimen(), &self.criteria().acceptance);
        let several_conditions = specimen.recordings().len() > 1 && specimen.simulates_in_milliseconds();
        if several_conditions {
            acceptance.least_fraction_conditions
        } else {
            acceptance.least_fraction_incomplete
        }
    }

    /// Noise ratio that a fitted model would reach if it were complete.
    pub fn floor(&self, fit: &Fit) -> f64 {
        self.problem.floor(fit)
    }

    /// Noise ratio up to which a fitted model counts as complete.
    pub fn complete_up_to(&self, fit: &Fit) -> f64 {
        self.problem.complete_up_to(fit)
    }
}

/// Costs of the blocks as a screened fit reaches them. Held-out costs would ask too much of it: it has not converged, and
/// where one edge of a valve holds most of the misfit, the rest says little about it in a linear approximation.
pub fn reached(fit: &Fit) -> Vec<f64> {
    fit.normals.iter().map(|n| n.cost).collect()
}

/// The sum of these.
pub fn cost_reached(fit: &Fit) -> f64 {
    fit.normals.iter().map(|n| n.cost).sum()
}

/// Screened fits with the costs that they reach, the lowest first.
pub fn ranked(screened: &[Screened]) -> Vec<(f64, &Fit)> {
    let mut order: Vec<(f64, &Fit)> = (screened.iter())
        .filter_map(|(_, fit)| fit.as_ref())
        .map(|fit| (cost_reached(fit), fit))
        .collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{CUBIC, FRICTION, RUN, Recipe, VIBRATION};

    #[test]
    fn what_was_screened_beside_a_model_is_not_simulated_again_in_passing() {
        let specimen = Recipe::default().make();
        let problem = LeastSquares::new(&specimen, &RUN);
        let mut selector = Selector::new(&problem);
        let model = Point::nominal(&specimen).with_effect(&specimen, FRICTION, &[0.05]);
        let model = selector.fitted(model).expect("a fit");
        let mut in_passing = |is_remembered: bool| {
            let before = problem.evaluation.simulated();
            if is_remembered {
                selector.screen(&model, vec![CUBIC, VIBRATION]).expect("screened");
            }
            let remembering = problem.evaluation.simulated() - before;
            let screened = selector
                .screen_in_passing(&model, vec![CUBIC, VIBRATION])
                .expect("screened");
            let costs: Vec<_> = screened
                .into_iter()
                .map(|(c, fit)| (c, fit.map(|f| f.cost.to_bits())))
                .collect();
            (costs, problem.evaluation.simulated() - before - remembering)
        };
        let (first, simulated) = in_passing(false);
        assert!(simulated > 0);
        // Passing a model leaves nothing behind.
        assert_eq!(in_passing(false), (first.clone(), simulated));
        assert_eq!(in_passing(true), (first, 0));
    }
}
