//! Wrong numbers: whether numbers of the model that are other than believed explain what names do not.
//!
//! A wrong number is as rigid as a name, and so are few of them: they are asked before laws, which bend to more, and are the answer only where nothing is left.

use super::selector::{Open, Selector};
use crate::error::DiagnoseError;
use crate::estimation::Fit;

/// Faults of instruments from which on a wrong number of the model is asked whether it is behind them: another bore looks like two gains.
const FAULTS_OF_ONE_NUMBER: usize = 2;

impl Selector<'_, '_> {
    /// The first of two models that wrong numbers complete: one with names, which may have a part each of what one number explains, or the one without any.
    pub fn completed_by_numbers(&mut self, [with_names, calibrated]: [&Fit; 2]) -> Result<Option<Fit>, DiagnoseError> {
        match self.with_numbers(with_names)? {
            None if !with_names.point.effects.is_empty() => self.with_numbers(calibrated),
            other => Ok(other),
        }
    }

    /// A complete model with wrong numbers in the place of faults of instruments; `None` if it does not take fewer effects.
    pub fn with_numbers_in_place_of_faults(
        &mut self,
        calibrated: &Fit,
        best: &Fit,
    ) -> Result<Option<Fit>, DiagnoseError> {
        let effects = &best.point.effects;
        let faults = effects.iter().filter(|&&e| self.candidate(e).is_instrument_fault());
        if faults.count() < FAULTS_OF_ONE_NUMBER {
            return Ok(None);
        }
        let other = self.with_numbers(calibrated)?;
        Ok(other.filter(|other| {
            let fewer = other.point.effects.len() < effects.len();
            fewer && !self.improves(other, best, self.criteria().acceptance.least_fraction)
        }))
    }

    /// A model that wrong numbers complete, with names beside them; `None` if none does.
    fn with_numbers(&mut self, from: &Fit) -> Result<Option<Fit>, DiagnoseError> {
        if !self.can_have_wrong_numbers() {
            return Ok(None);
        }
        let most = self.criteria().acceptance.most_effects;
        let mut grown = from.clone();
        while grown.point.effects.len() < most {
            let screened = self.screen_in_passing(&grown, self.open(&grown.point, Open::Numbers))?;
            match self.strongest(&screened, &grown)? {
                Some(next) => grown = next,
                None => break,
            }
        }
        if !self.is_completed_by_a_number(&grown) {
            return Ok(None);
        }
        let reduced = self.reduced(grown)?;
        Ok(self.is_completed_by_a_number(&reduced).then_some(reduced))
    }

    fn is_completed_by_a_number(&self, fit: &Fit) -> bool {
        let has_number = (fit.point.effects.iter()).any(|&e| self.candidate(e).is_believed_number);
        has_number && self.reaches_noise(fit)
    }

    fn can_have_wrong_numbers(&self) -> bool {
        self.testable().iter().any(|&c| self.candidate(c).is_believed_number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{CUBIC, FRICTION, GAIN, RUN, Recipe};
    use crate::estimation::{LeastSquares, Point};

    #[test]
    fn a_wrong_number_takes_the_place_of_faults_only_where_it_needs_fewer_effects() {
        let mut specimen = Recipe {
            truth: vec![(CUBIC, vec![0.4])],
            candidates: vec![CUBIC, GAIN, FRICTION],
            ..Recipe::default()
        }
        .make();
        specimen.become_number(CUBIC);
        let problem = LeastSquares::new(&specimen, &RUN);
        let mut selector = Selector::new(&problem);
        let calibrated = selector.fitted(Point::nominal(&specimen)).expect("a fit");
        let mut asked = |faults: usize| {
            let point = (0..faults).fold(Point::nominal(&specimen), |p, _| p.with_effect(&specimen, GAIN, &[0.0]));
            let best = selector.fitted(point).expect("a fit");
            let other = selector.with_numbers_in_place_of_faults(&calibrated, &best);
            other.expect("fits").map(|fit| fit.point.effects)
        };
        assert_eq!((asked(1), asked(2)), (None, Some(vec![CUBIC])));
    }
}
