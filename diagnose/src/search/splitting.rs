//! Splitting: a law of a combined place becomes one for each of its parts.
//!
//! A law of both accumulators is accepted before one of a single accumulator where both lack the same, because it explains more. If the two
//! parts differ in its numbers, as gas volumes of different sizes differ in how fast they take up heat, it stops short of the noise, and
//! its place keeps the laws of its parts away.

use super::selector::Selector;
use crate::error::DiagnoseError;
use crate::estimation::{Fit, Point};

/// Parts into which a law is split: a model has at most two laws.
const PARTS: usize = 2;

impl Selector<'_, '_> {
    /// The model with its law split in two, each with numbers of its own; `None` if it has no such law, or if held-out blocks do not confirm it.
    pub fn split(&mut self, best: &Fit) -> Result<Option<Fit>, DiagnoseError> {
        if self.laws_of(&best.point) != 1 {
            return Ok(None);
        }
        let Some(start) = self.in_parts(&best.point) else {
            return Ok(None);
        };
        let fraction = self.criteria().acceptance.least_fraction_incomplete;
        let split = self.fitted_if_simulated(start)?;
        Ok(split.filter(|split| self.improves(best, split, fraction)))
    }

    /// The same model with the law of a combined place as laws of its parts, with the numbers that it has.
    fn in_parts(&self, point: &Point) -> Option<Point> {
        let specimen = self.specimen();
        let (position, law) =
            (point.effects.iter().copied().enumerate()).find(|&(_, e)| self.candidate(e).one_of_several)?;
        let whole = self.candidate(law);
        let sites = whole.place.site.parts();
        if sites.len() != PARTS {
            return None;
        }
        let values: Vec<f64> = (whole
            .parameters
            .iter()
            .zip(&point.z[point.coordinates_of(specimen, position)]))
        .map(|(p, z)| p.value(*z))
        .collect();
        // The same law elsewhere has the same numbers.
        let is_same = |c: usize| {
            let keys = |c: usize| self.candidate(c).parameters.iter().map(|p| &p.key);
            self.candidate(c).is_unlisted() && keys(c).eq(keys(law))
        };
        let mut parts = point.without_effect(specimen, position);
        for site in sites {
            let place = whole.place.with_site(site);
            let part = (self.testable().iter().copied()).find(|&c| self.candidate(c).place == place && is_same(c))?;
            parts = parts.with_effect(specimen, part, &values);
        }
        Some(parts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{CUBIC, FIRST_OF_PAIR, NEARLY_CUBIC, RUN, Recipe};
    use crate::estimation::LeastSquares;
    use crate::vocabulary::{Branch, Site};

    /// Effects of the model with the cubic law of both accumulators after it was split into a nearly cubic one of the first and a vibration of the
    /// second.
    fn split(truth: &[(usize, f64)], keys: [&str; 2]) -> Option<Vec<usize>> {
        let mut specimen = Recipe {
            truth: truth.iter().map(|&(law, size)| (law, vec![size])).collect(),
            candidates: vec![CUBIC, NEARLY_CUBIC, FIRST_OF_PAIR],
            ..Recipe::default()
        }
        .make();
        specimen.take_name(CUBIC, Site::Accumulators);
        for ((part, branch), key) in [NEARLY_CUBIC, FIRST_OF_PAIR].into_iter().zip(Branch::ALL).zip(keys) {
            specimen.take_name(part, Site::Accumulator(branch));
            specimen.take_key(part, key);
        }
        let problem = LeastSquares::new(&specimen, &RUN);
        let mut selector = Selector::new(&problem);
        let start = Point::nominal(&specimen).with_effect(&specimen, CUBIC, &[0.1]);
        let best = selector.fitted(start).expect("a fit");
        selector.split(&best).expect("fits").map(|fit| fit.point.effects)
    }

    #[test]
    fn a_law_of_two_parts_is_split_where_they_differ_and_only_there() {
        let differing = [(NEARLY_CUBIC, 0.3), (FIRST_OF_PAIR, 0.5)];
        let parts = Some(vec![NEARLY_CUBIC, FIRST_OF_PAIR]);
        assert_eq!(split(&differing, ["cubic"; 2]), parts);
        assert_eq!(split(&[(CUBIC, 0.3)], ["cubic"; 2]), None);
        // What has other numbers is another law.
        assert_eq!(split(&differing, ["cubic", "vibration"]), None);
    }
}
