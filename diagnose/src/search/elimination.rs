//! Backward elimination: effects that the others have made superfluous leave the model.

use super::selector::Selector;
use crate::error::DiagnoseError;
use crate::estimation::interval::HALF_INTERVAL;
use crate::estimation::{Fit, Point, covariance};

/// A size of which nothing can be seen, in units of the size that shows.
const NEXT_TO_NOTHING: f64 = 1e-3;

impl Selector<'_, '_> {
    /// A model without what its other effects explain, each effect in its simplest form.
    pub fn reduced(&mut self, grown: Fit) -> Result<Fit, DiagnoseError> {
        let mut fraction = self.criteria().acceptance.least_fraction;
        let mut best = self.eliminate(grown, fraction)?;
        if !self.is_complete(&best) {
            fraction = self.fraction_of_incomplete();
            best = self.eliminate(best, fraction)?;
        }
        self.simplify(best, fraction)
    }

    /// Drops effects, one at a time and the weakest first, until each that is left is accepted beside the others.
    pub fn eliminate(&mut self, mut best: Fit, fraction: f64) -> Result<Fit, DiagnoseError> {
        while let Some(less) = self.without_weakest(&best, fraction)? {
            best = less;
        }
        Ok(best)
    }

    /// The model without its weakest effect, fitted again; `None` if every effect is accepted. Laws without a name go first:
    /// what a named effect explains as well needs none.
    fn without_weakest(&mut self, best: &Fit, fraction: f64) -> Result<Option<Fit>, DiagnoseError> {
        let effects = &best.point.effects;
        let hypothesis = best.point.hypothesis(self.specimen());
        let absent = |(effect, values): &(usize, Vec<f64>)| self.candidate(*effect).absent_at(values);
        // What has become nothing explains nothing, even where the steps of the simulation are other ones with it.
        let nothing = (hypothesis.effects.iter().position(absent)).map_or_else(
            || self.cannot_be_told_from_nothing(best, fraction),
            |position| Ok(Some(position)),
        )?;
        if let Some(position) = nothing {
            return self
                .fitted(best.point.without_effect(self.specimen(), position))
                .map(Some);
        }
        let (laws, named): (Vec<usize>, Vec<usize>) =
            (0..effects.len()).partition(|&position| self.candidate(effects[position]).is_unlisted());
        for positions in [laws, named] {
            let mut weakest: Option<(f64, Fit)> = None;
            for position in positions {
                let less = self.fitted(best.point.without_effect(self.specimen(), position))?;
                let gain = self.gain(self.held_out(&less), self.held_out(best));
                let fraction = self.least_fraction(effects[position], fraction);
                let weaker = weakest.as_ref().is_none_or(|(least, _)| gain.total < *least);
                if !self.improves(&less, best, fraction) && weaker {
                    weakest = Some((gain.total, less));
                }
            }
            if let Some((_, less)) = weakest {
                return Ok(Some(less));
            }
        }
        Ok(None)
    }

    /// An effect of one size whose interval contains zero, and that does as well as next to nothing. The recordings do not show it: with it the simulation
    /// only takes other steps, or treats oil near vacuum in another way, and may come closer to them by that.
    fn cannot_be_told_from_nothing(&self, fit: &Fit, fraction: f64) -> Result<Option<usize>, DiagnoseError> {
        let deviations = covariance::deviations(fit);
        for (position, &effect) in fit.point.effects.iter().enumerate() {
            let Some((nothing, k)) = self.only_size(&fit.point, position) else {
                continue;
            };
            if (fit.point.z[k] - nothing).abs() >= HALF_INTERVAL * deviations[k] {
                continue;
            }
            let mut point = fit.point.clone();
            point.z[k] = nothing + NEXT_TO_NOTHING;
            let next_to_nothing = self.fitted_holding(point, k..k + 1)?;
            let fraction = self.least_fraction(effect, fraction);
            if next_to_nothing.is_some_and(|less| !self.improves(&less, fit, fraction)) {
                return Ok(Some(position));
            }
        }
        Ok(None)
    }

    /// The coordinate of the size of an effect that has only one, and its value where the effect is not there.
    fn only_size(&self, point: &Point, position: usize) -> Option<(f64, usize)> {
        let parameters = &self.candidate(point.effects[position]).parameters;
        let coordinates = point.coordinates_of(self.specimen(), position);
        let mut sizes = (parameters.iter().zip(coordinates)).filter(|(parameter, _)| parameter.is_size);
        match (sizes.next(), sizes.next()) {
            (Some((size, k)), None) => Some((size.z(0.0), k)),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{CUBIC, FRICTION, GAIN, RUN, Recipe, TABLE};
    use crate::estimation::{LeastSquares, Point};
    use crate::specimen::Specimen;

    /// What the truth holds is friction only.
    fn with_friction() -> impl Specimen {
        let truth = vec![(FRICTION, vec![0.1])];
        let recipe = Recipe {
            truth,
            ..Recipe::default()
        };
        recipe.make()
    }

    /// Effects that are left of a model.
    fn left_of(effects: &[usize]) -> Vec<usize> {
        let specimen = with_friction();
        let problem = LeastSquares::new(&specimen, &RUN);
        let mut selector = Selector::new(&problem);
        let start = effects.iter().fold(Point::nominal(&specimen), |point, &e| {
            let values = vec![0.0; selector.candidate(e).parameters.len()];
            point.with_effect(&specimen, e, &values)
        });
        let full = selector.fitted(start).expect("a fit");
        let fraction = problem.criteria.acceptance.least_fraction;
        selector.eliminate(full, fraction).expect("a fit").point.effects
    }

    #[test]
    fn the_superfluous_leave_and_the_needed_stays() {
        assert_eq!(left_of(&[CUBIC, FRICTION, GAIN]), [FRICTION]);
        assert_eq!(left_of(&[TABLE, CUBIC, FRICTION]), [FRICTION]);
        assert_eq!(left_of(&[FRICTION]), [FRICTION]);
    }

    #[test]
    fn what_has_become_nothing_leaves_without_a_question() {
        let specimen = Recipe::default().make();
        let problem = LeastSquares::new(&specimen, &RUN);
        let mut selector = Selector::new(&problem);
        let start = Point::nominal(&specimen).with_effect(&specimen, FRICTION, &[0.0]);
        let (prior, ranges) = (start.prior(&specimen), start.ranges(&specimen));
        let fit = Fit::new(start, vec![], prior, 0.0, ranges);
        // Its cost of nothing would be kept.
        let less = selector.eliminate(fit, 0.0).expect("a fit");
        assert!(less.point.effects.is_empty());
    }

    #[test]
    fn what_cannot_be_told_from_nothing_leaves() {
        let specimen = with_friction();
        let problem = LeastSquares::new(&specimen, &RUN);
        let mut selector = Selector::new(&problem);
        let start = Point::nominal(&specimen).with_effect(&specimen, FRICTION, &[0.1]);
        let with_both = selector
            .fitted(start.with_effect(&specimen, CUBIC, &[0.0]))
            .expect("a fit");
        assert_eq!(
            selector.cannot_be_told_from_nothing(&with_both, 0.0).expect("fits"),
            Some(1)
        );
        let alone = selector.fitted(start).expect("a fit");
        assert_eq!(selector.cannot_be_told_from_nothing(&alone, 0.0).expect("fits"), None);
        // Where a size acts through another number the interval is too wide, but the recordings are met worse without it.
        let mut unsure = alone;
        let k = unsure.point.coordinates_of(&specimen, 0).start;
        for normal in &mut unsure.normals {
            normal.h[(k, k)] *= 1e-6;
        }
        assert!(covariance::deviations(&unsure)[k] > unsure.point.z[k].abs());
        assert_eq!(selector.cannot_be_told_from_nothing(&unsure, 0.0).expect("fits"), None);
    }

    #[test]
    fn a_model_of_nothing_but_the_superfluous_is_emptied() {
        assert_eq!(left_of(&[CUBIC, GAIN]), [] as [usize; 0]);
    }
}
