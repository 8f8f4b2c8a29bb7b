//! Merging: a law and a number at one place may be one law of another shape.
//!
//! A friction that begins at a moment is nearly a friction that grows with time beside a friction of the seal that is too large. Both together leave
//! so little that no other law is tried, and yet one law is all that is missing.

use super::selector::{Selector, ranked};
use crate::error::DiagnoseError;
use crate::estimation::{Fit, Point};

impl Selector<'_, '_> {
    /// The model with one law in the place of two effects without a name at the same place, if it has no more numbers than both and does as well.
    pub fn merged(&mut self, best: &Fit) -> Result<Option<Fit>, DiagnoseError> {
        for pair in self.pairs_at_one_place(&best.point) {
            if let Some(other) = self.merged_at(best, pair)? {
                return Ok(Some(other));
            }
        }
        Ok(None)
    }

    fn merged_at(&mut self, best: &Fit, [first, second]: [usize; 2]) -> Result<Option<Fit>, DiagnoseError> {
        let specimen = self.specimen();
        let without = (best.point.without_effect(specimen, second)).without_effect(specimen, first);
        let laws = self.laws_of_no_more_numbers(&without, [first, second].map(|k| best.point.effects[k]));
        if laws.is_empty() {
            return Ok(None);
        }
        let less = self.fitted(without)?;
        let screened = self.screen_in_passing(&less, laws)?;
        let fraction = self.criteria().acceptance.least_fraction;
        for (_, start) in ranked(&screened)
            .into_iter()
            .take(self.criteria().screening.sizes_refined)
        {
            let other = self.fitted_if_simulated(start.point.clone())?;
            if let Some(other) = other.filter(|other| !self.improves(other, best, fraction)) {
                return Ok(Some(other));
            }
        }
        Ok(None)
    }

    /// Positions of two effects without a name at one place, of which one is a law.
    fn pairs_at_one_place(&self, point: &Point) -> Vec<[usize; 2]> {
        let effects: Vec<_> = point.effects.iter().map(|&e| self.candidate(e)).collect();
        (0..effects.len())
            .flat_map(|second| (0..second).map(move |first| [first, second]))
            .filter(|pair| {
                let [one, other] = pair.map(|k| effects[k]);
                let nameless = one.is_unlisted() && other.is_unlisted();
                nameless && one.place == other.place && (one.is_law() || other.is_law())
            })
            .collect()
    }

    /// Laws at the place of two effects that have no more numbers than both together, and which no other effect of the model excludes.
    fn laws_of_no_more_numbers(&self, without: &Point, pair: [usize; 2]) -> Vec<usize> {
        let [one, other] = pair.map(|e| self.candidate(e));
        let numbers = one.parameters.len() + other.parameters.len();
        (self.testable().iter().copied())
            .filter(|&c| {
                let law = self.candidate(c);
                let is_less = law.is_law() && law.place == one.place && law.parameters.len() <= numbers;
                is_less && !pair.contains(&c) && self.may_join(c, without.effects.iter().copied())
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{CUBIC, FRICTION, NEARLY_CUBIC, RUN, Recipe};
    use crate::estimation::LeastSquares;
    use crate::vocabulary::Site;

    /// What a model of a nearly cubic law and a friction that is another number becomes, where a cubic law may take the place of both.
    fn merged(truth: &[(usize, f64)], cubic_at: Site) -> Option<Vec<usize>> {
        let mut specimen = Recipe {
            truth: truth.iter().map(|&(law, size)| (law, vec![size])).collect(),
            candidates: vec![CUBIC, NEARLY_CUBIC, FRICTION],
            ..Recipe::default()
        }
        .make();
        for (law, site) in [
            (CUBIC, cubic_at),
            (NEARLY_CUBIC, Site::MainSeal),
            (FRICTION, Site::MainSeal),
        ] {
            specimen.take_name(law, site);
        }
        specimen.become_number(FRICTION);
        let problem = LeastSquares::new(&specimen, &RUN);
        let mut selector = Selector::new(&problem);
        let start = Point::nominal(&specimen).with_effect(&specimen, NEARLY_CUBIC, &[0.3]);
        let start = start.with_effect(&specimen, FRICTION, &[0.01]);
        let best = selector.fitted(start).expect("a fit");
        selector.merged(&best).expect("fits").map(|fit| fit.point.effects)
    }

    #[test]
    fn a_law_and_a_number_at_one_place_give_way_to_one_law_there_that_does_as_well() {
        assert_eq!(merged(&[(CUBIC, 0.4)], Site::MainSeal), Some(vec![CUBIC]));
        assert_eq!(merged(&[(CUBIC, 0.4)], Site::Mount), None);
        assert_eq!(merged(&[(NEARLY_CUBIC, 0.4), (FRICTION, 0.1)], Site::MainSeal), None);
    }
}
