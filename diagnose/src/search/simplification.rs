//! Simplification: an effect that has forms of fewer numbers is reported in the simplest that does as well.
//!
//! Friction whose level falls with speed holds friction whose level does not. Where the fall gains little, the numbers that
//! describe it are not determined and mean nothing. A fade of both dampers holds that of one.

use super::selector::Selector;
use crate::effect::Candidate;
use crate::error::DiagnoseError;
use crate::estimation::Fit;

impl Selector<'_, '_> {
    /// Puts simpler forms in the place of effects, as long as the form that is there is not accepted over the simpler one.
    pub fn simplify(&mut self, mut best: Fit, fraction: f64) -> Result<Fit, DiagnoseError> {
        for effect in best.point.effects.clone() {
            let mut forms = self.simpler_forms(effect, &best);
            forms.sort_by_key(|&form| self.candidate(form).parameters.len());
            for form in forms {
                let Some(position) = best.point.effects.iter().position(|&e| e == effect) else {
                    break;
                };
                // A place more is a finding of its own: it need only gain for certain.
                let elsewhere = self.candidate(form).place != self.candidate(effect).place;
                let least = if elsewhere { 0.0 } else { fraction };
                if let Some(simpler) = self.with_form(&best, position, form)?
                    && !self.improves(&simpler, &best, least)
                {
                    best = simpler;
                }
            }
        }
        Ok(best)
    }

    /// The model with a simpler form in the place of the effect at a position, fitted from the numbers that both have and from
    /// those that screening finds; `None` where it cannot be simulated.
    fn with_form(&mut self, best: &Fit, position: usize, form: usize) -> Result<Option<Fit>, DiagnoseError> {
        let specimen = self.specimen();
        let (there, values) = &best.point.hypothesis(specimen).effects[position];
        let own = self.candidate(form).values_shared_with(self.candidate(*there), values);
        let without = best.point.without_effect(specimen, position);
        let near = self.fitted_if_simulated(without.with_effect(specimen, form, &own))?;
        let less = self.fitted(without)?;
        match self.screen(&less, vec![form])?.into_iter().next() {
            Some((_, Some(start))) => Ok(self.fitted_if_simulated(start.point)?.or(near)),
            _ => Ok(near),
        }
    }

    /// Forms of an effect of a model with fewer numbers, which no other of its effects excludes.
    fn simpler_forms(&self, effect: usize, best: &Fit) -> Vec<usize> {
        let there = self.candidate(effect);
        let simpler = |form: &Candidate| {
            let is_form = is_form_of(form, there) || is_in_fewer_places(form, there);
            is_form && form.parameters.len() < there.parameters.len()
        };
        let others = || best.point.effects.iter().copied().filter(|&e| e != effect);
        (self.testable().iter().copied())
            .filter(|&c| simpler(self.candidate(c)) && self.may_join(c, others()))
            .collect()
    }
}

/// True if a candidate is a form of another at the same place: of the same named effect, or what the other becomes at an end of
/// its range.
pub fn is_form_of(form: &Candidate, other: &Candidate) -> bool {
    let named = !form.is_unlisted() && !other.is_unlisted();
    let same_effect = form.group.is_some() && form.group == other.group;
    named && form.place == other.place && (same_effect || other.becomes == Some(form.id))
}

/// True if a candidate is the effect of another in a part of its places.
fn is_in_fewer_places(form: &Candidate, other: &Candidate) -> bool {
    let named = !form.is_unlisted() && form.id == other.id;
    named && form.place != other.place && other.place.contains(&form.place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{Analytic, CUBIC, FRICTION, FRICTION_OF_BOTH, RUN, Recipe};
    use crate::estimation::{LeastSquares, Point};
    use crate::specimen::Specimen;
    use crate::vocabulary::{Branch, Site};

    /// What is left of friction with a number for each output, fitted to this truth.
    fn simplified(truth: (usize, Vec<f64>)) -> Vec<usize> {
        let specimen: Analytic = Recipe {
            truth: vec![truth],
            candidates: vec![FRICTION, FRICTION_OF_BOTH],
            ..Recipe::default()
        }
        .make();
        let problem = LeastSquares::new(&specimen, &RUN);
        let mut selector = Selector::new(&problem);
        let start = Point::nominal(&specimen).with_effect(&specimen, FRICTION_OF_BOTH, &[0.1, 0.1]);
        let best = selector.fitted(start).expect("a fit");
        let fraction = problem.criteria.acceptance.least_fraction;
        selector.simplify(best, fraction).expect("a fit").point.effects
    }

    #[test]
    fn the_simpler_form_is_taken_where_it_does_as_well() {
        assert_eq!(simplified((FRICTION, vec![0.1])), [FRICTION]);
        assert_eq!(simplified((FRICTION_OF_BOTH, vec![0.15, 0.04])), [FRICTION_OF_BOTH]);
    }

    #[test]
    fn an_effect_of_two_places_has_a_form_at_each() {
        let specimen = Recipe::default().make();
        let at = |candidate: usize, site: Site| Candidate {
            place: site.into(),
            ..specimen.candidates()[candidate].clone()
        };
        let both = at(FRICTION_OF_BOTH, Site::Accumulators);
        for branch in [Branch::First, Branch::Second] {
            assert!(is_in_fewer_places(&at(FRICTION, Site::Accumulator(branch)), &both));
            assert!(!is_in_fewer_places(&both, &at(FRICTION, Site::Accumulator(branch))));
            assert!(
                !is_in_fewer_places(&at(CUBIC, Site::Accumulator(branch)), &both),
                "another effect"
            );
        }
        assert!(!is_in_fewer_places(&at(FRICTION, Site::MainSeal), &both));
        assert!(
            !is_in_fewer_places(&at(FRICTION, Site::Accumulators), &both),
            "a form at the same place"
        );
    }
}
