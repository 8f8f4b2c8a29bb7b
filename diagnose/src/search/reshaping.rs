//! Reshaping: a law that leaves much behind may have the right place and another shape.
//!
//! A groove with a bottom is nearly a bell. Fitted from starts of its own it may end in another minimum than fitted from the bell that was found.

use super::selector::Selector;
use crate::effect::Candidate;
use crate::error::DiagnoseError;
use crate::estimation::Fit;

impl Selector<'_, '_> {
    /// The model with one of its laws in another shape at the same place, fitted from the numbers that both have; `None` if that explains little more.
    pub fn reshaped(&mut self, best: &Fit) -> Result<Option<Fit>, DiagnoseError> {
        let fraction = self.fraction_of_incomplete();
        for (position, &law) in best.point.effects.iter().enumerate() {
            for shape in self.other_shapes(law) {
                let other = self.with_shape(best, position, shape)?;
                if let Some(other) = other.filter(|other| self.improves(best, other, fraction)) {
                    return Ok(Some(other));
                }
            }
        }
        Ok(None)
    }

    /// The model with a law in another shape, which has the numbers that it shares with the one at this position.
    fn with_shape(&mut self, best: &Fit, position: usize, shape: usize) -> Result<Option<Fit>, DiagnoseError> {
        let (there, values) = &best.point.hypothesis(self.specimen()).effects[position];
        let own = self.candidate(shape).values_shared_with(self.candidate(*there), values);
        let without = best.point.without_effect(self.specimen(), position);
        self.fitted_if_simulated(without.with_effect(self.specimen(), shape, &own))
    }

    /// Shapes of the same law at the same place.
    fn other_shapes(&self, law: usize) -> Vec<usize> {
        let there = self.candidate(law);
        (self.testable().iter().copied())
            .filter(|&c| c != law && is_shape_of(self.candidate(c), there))
            .collect()
    }
}

/// True if two candidates are laws at one place whose size has the same meaning.
fn is_shape_of(other: &Candidate, law: &Candidate) -> bool {
    let size = |candidate: &Candidate| candidate.parameters.first().map(|p| p.key.clone());
    other.is_law() && law.is_law() && other.place == law.place && size(other) == size(law)
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
            selector.reshaped(&best).expect("fits").map(|fit| fit.point.effects)
        };
        assert_eq!(reshaped(FRICTION, "size"), Some(vec![CUBIC]));
        assert_eq!(reshaped(FRICTION, "another"), None);
        assert_eq!(reshaped(CUBIC, "size"), None, "nothing is left to explain");
    }
}
