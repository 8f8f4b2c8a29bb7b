//! Power: the size from which an effect that is not in the model would have been found, so that "absent" means something.
//!
//! An effect of size `z` that is left out costs `d' H_b d` in block `b`, where `H_b` is the curvature of the block's cost and
//! `d = (r, z)` has the response `r` of the model's own coordinates, as far as their ranges allow it (variable projection, Golub &
//! Pereyra, SIAM J. Numer. Anal. 10(2), 1973, with the model linearised). The least size is the one whose costs the rule of
//! acceptance accepts ([`super::evidence`]) although chance makes their root smaller by 1.645, as it does in one of 20 campaigns.
//! Other numbers of the effect are as screening left them.

use nalgebra::{DMatrix, DVector};

use super::selector::Selector;
use crate::estimation::Fit;
use crate::estimation::bounded_step::bounded_step;
use crate::estimation::normal_equations::sum;
use crate::specimen::Specimen;

/// The standard normal is below this in 19 of 20 draws.
const ONE_SIDED: f64 = 1.645;
/// What a fitted number costs on blocks that it was not fitted to (Akaike, IEEE Trans. Automatic Control 19(6), 1974).
const COST_OF_A_NUMBER: f64 = 2.0;
/// Damping of the model's response, against rounding only.
const RESPONSE_DAMPING: f64 = 1e-9;
/// The coordinate from which a size is doubled until it would be found; one of order 1 is visible.
const SMALLEST: f64 = 1e-6;
/// The least size is known to this fraction.
const TOLERANCE: f64 = 1e-3;

/// The size from which an effect would have been found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeastSize {
    /// Index of the number among those of the effect.
    pub parameter: usize,
    /// Value of the number; `None` if the recordings would show none within its range.
    pub value: Option<f64>,
}

impl Selector<'_, '_> {
    /// The least size of each size of a candidate with a name, as screened beside a model. None where the model is not complete: what
    /// remains may then hide an effect of any size.
    pub fn least_sizes(&self, best: &Fit, candidate: usize, screened: &Fit) -> Vec<LeastSize> {
        if self.candidate(candidate).is_unlisted() || !self.is_complete(best) {
            return vec![];
        }
        let own = best.point.z.len();
        (self.candidate(candidate).parameters.iter().enumerate())
            .filter(|(_, number)| number.is_size)
            .map(|(parameter, number)| {
                let z = self.least_found(best, candidate, screened, own + parameter, number.z_range().1);
                let value = z.map(|z| number.value(z));
                LeastSize { parameter, value }
            })
            .collect()
    }

    /// The least value of a coordinate beside those of the model that is found in 19 of 20 campaigns, up to the most that it may be.
    fn least_found(
        &self,
        best: &Fit,
        candidate: usize,
        screened: &Fit,
        coordinate: usize,
        largest: f64,
    ) -> Option<f64> {
        let acceptance = &self.criteria().acceptance;
        let after = self.held_out(best);
        let kept = 1.0 - COST_OF_A_NUMBER / after.iter().sum::<f64>();
        let fraction = self.least_fraction(candidate, acceptance.least_fraction);
        let left_out = LeftOut::of(self.specimen(), best, screened, coordinate);
        let found = |z: f64| {
            let costs = left_out.costs(z);
            let root = costs.iter().sum::<f64>().sqrt();
            let by_chance = ((root - ONE_SIDED) / root).max(0.0);
            let before: Vec<f64> = (after.iter().zip(&costs))
                .map(|(a, cost)| kept * a + by_chance * by_chance * cost)
                .collect();
            self.accepts(&self.gain(&before, after), fraction)
        };
        let is_fault = self.candidate(candidate).is_instrument_fault();
        let mut most = if is_fault { acceptance.least_fault } else { SMALLEST };
        if is_fault && found(most) {
            return Some(most);
        }
        while !found(most) {
            if most > largest {
                return None;
            }
            most *= 2.0;
        }
        let mut least = 0.5 * most;
        while most > (1.0 + TOLERANCE) * least {
            let middle = (least * most).sqrt();
            if found(middle) {
                most = middle;
            } else {
                least = middle;
            }
        }
        (most <= largest).then_some(most)
    }
}

/// What it costs to leave an effect out of a model.
struct LeftOut<'f> {
    screened: &'f Fit,
    coordinate: usize,
    /// Curvature of the model's coordinates, and their derivative with respect to the effect's.
    model: DMatrix<f64>,
    towards: DVector<f64>,
    /// Where the model's coordinates are, and how far they may go.
    z: &'f [f64],
    ranges: Vec<(f64, f64)>,
}

impl<'f> LeftOut<'f> {
    fn of(specimen: &dyn Specimen, best: &'f Fit, screened: &'f Fit, coordinate: usize) -> Self {
        let own = best.point.z.len();
        let (h, _) = sum(&screened.normals, &screened.prior, &screened.point.z);
        Self {
            screened,
            coordinate,
            model: h.view((0, 0), (own, own)).into_owned(),
            towards: h.view((0, coordinate), (own, 1)).column(0).into_owned(),
            z: &best.point.z,
            ranges: best.point.ranges(specimen),
        }
    }

    /// The costs of the blocks for a value of the coordinate; nothing where the model's response cannot be determined.
    fn costs(&self, z: f64) -> Vec<f64> {
        let mut d = DVector::zeros(self.screened.point.z.len());
        d[self.coordinate] = z;
        let towards = -z * &self.towards;
        match bounded_step(&self.model, &towards, RESPONSE_DAMPING, self.z, &self.ranges) {
            Some(response) => d.rows_mut(0, response.len()).copy_from(&response),
            None => d.fill(0.0),
        }
        let blocks = self.screened.normals.iter();
        blocks.map(|block| d.dot(&(&block.h * &d)).max(0.0)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{Analytic, CUBIC, FRAGILE, FRICTION, GAIN, RUN, Recipe, VIBRATION};
    use crate::estimation::{LeastSquares, Point};
    use crate::search::select;

    /// What a complete model's recordings would have shown of a candidate.
    fn least_sizes(candidate: usize, truth: &[(usize, f64)]) -> Vec<LeastSize> {
        let specimen = Recipe {
            truth: truth.iter().map(|&(law, size)| (law, vec![size])).collect(),
            candidates: vec![candidate],
            ..Recipe::default()
        }
        .make();
        let problem = LeastSquares::new(&specimen, &RUN);
        let mut selector = Selector::new(&problem);
        let best = selector.fitted(Point::nominal(&specimen)).expect("a fit");
        let screened = selector.screen(&best, vec![candidate]).expect("screened");
        let fit = screened[0].1.as_ref().expect("it can be simulated");
        selector.least_sizes(&best, candidate, fit)
    }

    /// In how many of 40 campaigns, which differ in their noise, a friction or another effect of a size is found.
    fn found(candidate: usize, size: f64) -> usize {
        (0..40)
            .filter(|seed| {
                let specimen: Analytic = Recipe {
                    seed: 100 + seed,
                    truth: vec![(candidate, vec![size])],
                    candidates: vec![candidate],
                    ..Recipe::default()
                }
                .make();
                let problem = LeastSquares::new(&specimen, &RUN);
                let selection = select(&problem, &|_, _| {}).expect("a selection");
                selection.best.point.effects == [candidate]
            })
            .count()
    }

    /// The promise itself: of the least size nearly all are found, of less than half of it next to none.
    #[test]
    fn nineteen_of_twenty_campaigns_show_an_effect_of_the_least_size() {
        for candidate in [CUBIC, FRICTION] {
            let [LeastSize { value: Some(least), .. }] = least_sizes(candidate, &[])[..] else {
                panic!("one size that can be shown");
            };
            let (at, below) = (found(candidate, least), found(candidate, 0.4 * least));
            assert!(
                at >= 36 && below <= 2,
                "{candidate} of size {least}: {at} and {below} of 40"
            );
        }
    }

    /// A wrong gain of the first output's instrument is imitated by its stiffness, as far as the tolerance of 2 % allows it.
    #[test]
    fn what_the_calibration_can_imitate_is_found_beyond_its_tolerance() {
        let [LeastSize { value: Some(least), .. }] = least_sizes(GAIN, &[])[..] else {
            panic!("one size that can be shown");
        };
        let (at, below) = (found(GAIN, least), found(GAIN, 0.6 * least));
        assert!(
            least > 0.02 && at >= 36 && below <= 2,
            "a gain of {least}: {at} and {below} of 40"
        );
    }

    #[test]
    fn what_changes_nothing_is_shown_at_no_size_and_a_frequency_is_none() {
        let shown = least_sizes(FRAGILE, &[]);
        assert_eq!(
            shown,
            [LeastSize {
                parameter: 0,
                value: None
            }]
        );
        // An amplitude is a size, and the frequency beside it is not.
        let of_vibration: Vec<usize> = least_sizes(VIBRATION, &[]).iter().map(|size| size.parameter).collect();
        assert_eq!(of_vibration, [0]);
    }

    #[test]
    fn nothing_is_said_beside_a_model_that_is_not_complete() {
        assert_eq!(least_sizes(CUBIC, &[(FRICTION, 1.0)]), vec![]);
    }
}
