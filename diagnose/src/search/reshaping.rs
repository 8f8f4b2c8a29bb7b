//! Reshaping: an effect that leaves much behind may have the right place and another shape.
//!
//! A groove with a bottom is nearly a bell. Fitted from starts of its own it may end in another minimum than fitted from the bell that was found.
//! What has a kink or a spot between the points of a table needs a table in finer steps, and what breaks at a moment is not a drift.

use super::selector::{Open, Selector};
use crate::effect::unlisted::near;
use crate::effect::{Candidate, Joins};
use crate::error::DiagnoseError;
use crate::estimation::{Fit, Point};

impl Selector<'_, '_> {
    /// The model with one of its effects in another shape at the same place; `None` if that explains little more. Where laws are open, names and numbers
    /// give way to laws, too.
    pub fn reshaped(&mut self, best: &Fit, open: Open) -> Result<Option<Fit>, DiagnoseError> {
        let laws_are_open = matches!(open, Open::Laws | Open::TwoLaws);
        for (position, &there) in best.point.effects.iter().enumerate() {
            if (laws_are_open || self.candidate(there).is_law())
                && let Some(other) = self.reshaped_at(best, position)?
            {
                return Ok(Some(other));
            }
        }
        Ok(None)
    }

    /// The model with the effect that joined last in another shape, if it is a law and leaves much behind: what joins next would take a part of it.
    pub fn with_last_law_reshaped(&mut self, best: Fit) -> Result<Fit, DiagnoseError> {
        let last_is_law = best
            .point
            .effects
            .last()
            .is_some_and(|&last| self.candidate(last).is_law());
        if !last_is_law || self.is_complete(&best) {
            return Ok(best);
        }
        let other = self.reshaped_at(&best, best.point.effects.len() - 1)?;
        Ok(other.unwrap_or(best))
    }

    /// The model with the effect at a position in another shape; `None` if that explains little more. A law is fitted from what both shapes have.
    pub fn reshaped_at(&mut self, best: &Fit, position: usize) -> Result<Option<Fit>, DiagnoseError> {
        let mut quick = Vec::new();
        for shape in self.other_shapes(&best.point, best.point.effects[position]) {
            for start in self.starts_in_shape(best, position, shape)? {
                quick.extend(self.fits.quick(self.problem, &start)?);
            }
        }
        quick.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        let fraction = self.fraction_of_incomplete();
        for quick in quick.into_iter().take(self.criteria().screening.sizes_refined) {
            let other = self.fits.carried_on(self.problem, quick)?;
            if let Some(other) = other.filter(|other| self.improves(best, other, fraction)) {
                return Ok(Some(other));
            }
        }
        Ok(None)
    }

    /// Starts of a model with an effect in another shape: near the one at this position, beside it if it is no law, and where screening leads if the shape
    /// has starts of its own.
    fn starts_in_shape(&mut self, best: &Fit, position: usize, shape: usize) -> Result<Vec<Point>, DiagnoseError> {
        let specimen = self.specimen();
        let (there, values) = &best.point.hypothesis(specimen).effects[position];
        let (other, there) = (self.candidate(shape), self.candidate(*there));
        let own =
            near(other, there, values, self.longest_s()).unwrap_or_else(|| other.values_shared_with(there, values));
        let without = best.point.without_effect(specimen, position);
        let mut starts = vec![without.with_effect(specimen, shape, &own)];
        // What a number stands for may be a part of a law: the law begins beside it.
        let full = best.point.effects.len() >= self.criteria().acceptance.most_effects;
        if !full && !there.is_law() && !there.excludes(other) {
            starts.push(best.point.with_effect(specimen, shape, &own));
        }
        if other.joins == Joins::AtLast && !other.starts.is_empty() {
            let less = self.fitted(without)?;
            let screened = self.screen_in_passing(&less, vec![shape])?;
            starts.extend(screened.into_iter().filter_map(|(_, fit)| fit).map(|fit| fit.point));
        }
        Ok(starts)
    }

    /// Shapes that an effect of a model may have instead, which no other of its effects excludes.
    fn other_shapes(&self, point: &Point, effect: usize) -> Vec<usize> {
        let there = self.candidate(effect);
        let others = || point.effects.iter().copied().filter(|&e| e != effect);
        (self.testable().iter().copied())
            .filter(|&c| c != effect && is_shape_of(self.candidate(c), there) && self.may_join(c, others()))
            .collect()
    }

    /// Duration of the longest recording, s.
    fn longest_s(&self) -> f64 {
        let specimen = self.specimen();
        let lasts = |recording| match specimen.time_s(recording) {
            [first, .., last] => last - first,
            _ => 0.0,
        };
        (0..specimen.recordings().len()).map(lasts).fold(0.0, f64::max)
    }
}

/// True if one candidate may be another shape of the other: laws at one place whose size has the same meaning, and any law that is fitted only in the
/// place of what is there.
fn is_shape_of(other: &Candidate, there: &Candidate) -> bool {
    let size = |candidate: &Candidate| candidate.parameters.first().map(|p| p.key.clone());
    let same = other.is_law() && there.is_law() && size(other) == size(there);
    other.place == there.place && (same || other.joins != Joins::Screened)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{CUBIC, FRICTION, RUN, Recipe};
    use crate::estimation::{LeastSquares, Point};
    use crate::vocabulary::Site;

    #[test]
    fn a_law_takes_the_shape_that_explains_more_if_its_size_means_the_same() {
        let reshaped = |from: usize, key: &str| {
            let mut specimen = Recipe {
                truth: vec![(CUBIC, vec![0.4])],
                candidates: vec![CUBIC, FRICTION],
                ..Recipe::default()
            }
            .make();
            for (law, key) in [(CUBIC, "size"), (FRICTION, key)] {
                specimen.take_name(law, Site::Mount);
                specimen.take_key(law, key);
            }
            let problem = LeastSquares::new(&specimen, &RUN);
            let mut selector = Selector::new(&problem);
            let start = Point::nominal(&specimen).with_effect(&specimen, from, &[0.3]);
            let best = selector.fitted(start).expect("a fit");
            selector
                .reshaped(&best, Open::Laws)
                .expect("fits")
                .map(|fit| fit.point.effects)
        };
        assert_eq!(reshaped(FRICTION, "size"), Some(vec![CUBIC]));
        assert_eq!(reshaped(FRICTION, "another"), None);
        assert_eq!(reshaped(CUBIC, "size"), None, "nothing is left to explain");
    }

    /// What a model of a friction becomes where a cubic law is true that is fitted only in the place of what is there.
    fn reshaped_into_what_is_not_screened(friction_is_law: bool, open: Open) -> Option<Vec<usize>> {
        let mut specimen = Recipe {
            truth: vec![(CUBIC, vec![0.4])],
            candidates: vec![CUBIC, FRICTION],
            ..Recipe::default()
        }
        .make();
        specimen.take_name(CUBIC, Site::MainSeal);
        specimen.become_joining(CUBIC, Joins::InPlace);
        if friction_is_law {
            specimen.take_name(FRICTION, Site::MainSeal);
        }
        let problem = LeastSquares::new(&specimen, &RUN);
        let mut selector = Selector::new(&problem);
        let start = Point::nominal(&specimen).with_effect(&specimen, FRICTION, &[0.1]);
        assert!(
            !selector
                .open(&Point::nominal(&specimen), Open::TwoLaws)
                .contains(&CUBIC)
        );
        let best = selector.fitted(start).expect("a fit");
        selector
            .reshaped(&best, open)
            .expect("fits")
            .map(|fit| fit.point.effects)
    }

    #[test]
    fn what_is_not_screened_takes_the_place_of_a_law_and_of_a_name_only_where_laws_are_open() {
        assert_eq!(reshaped_into_what_is_not_screened(true, Open::Names), Some(vec![CUBIC]));
        assert_eq!(reshaped_into_what_is_not_screened(false, Open::Names), None);
        let effects = reshaped_into_what_is_not_screened(false, Open::Laws).expect("another shape");
        assert!(effects.contains(&CUBIC), "{effects:?}");
    }
}
