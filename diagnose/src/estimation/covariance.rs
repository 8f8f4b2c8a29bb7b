//! How sure the coordinates of a fit are, from the scatter between blocks.

use nalgebra::{DMatrix, DVector};

use super::fit::Fit;
use super::normal_equations::sum;

/// Added to each diagonal element, as a fraction of it and besides, against rounding: a coordinate of order one that the
/// recordings determine has a curvature far above either.
const AGAINST_ROUNDING: (f64, f64) = (1e-9, 1e-12);
/// Smallest variance that is divided by.
const LEAST_VARIANCE: f64 = 1e-300;

/// Standard deviation of every coordinate; infinite where the recordings do not determine them.
#[must_use]
pub fn deviations(fit: &Fit) -> DVector<f64> {
    let p = fit.prior.len();
    match covariance(fit) {
        Some(c) => DVector::from_iterator(p, (0..p).map(|k| c[(k, k)].max(0.0).sqrt())),
        None => DVector::from_element(p, f64::INFINITY),
    }
}

/// Covariance of the coordinates; `None` where the recordings do not determine them.
///
/// Residuals of a free run are coloured, so the usual formula is far too narrow. This is the sandwich
/// `H^-1 (sum g_b g_b') H^-1` (White, Econometrica 50(1), 1982) with blocks as the independent unit, never smaller than the
/// formula for white noise.
#[must_use]
pub fn covariance(fit: &Fit) -> Option<DMatrix<f64>> {
    let p = fit.prior.len();
    let (h, _) = sum(&fit.normals, &fit.prior, &fit.point.z);
    let mut damped = h.clone();
    (0..p).for_each(|k| damped[(k, k)] += AGAINST_ROUNDING.0 * h[(k, k)] + AGAINST_ROUNDING.1);
    let inverse = damped.cholesky()?.inverse();
    let mut scatter = DMatrix::zeros(p, p);
    for n in &fit.normals {
        scatter += &n.g * n.g.transpose();
    }
    for k in 0..p {
        scatter[(k, k)] += fit.prior[k];
    }
    let blocks = fit.normals.len() as f64;
    let robust = &inverse * scatter * &inverse * (blocks / (blocks - 1.0).max(1.0));
    let scale = |k: usize| (inverse[(k, k)] / robust[(k, k)].max(LEAST_VARIANCE)).max(1.0).sqrt();
    Some(DMatrix::from_fn(p, p, |i, j| robust[(i, j)] * scale(i) * scale(j)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{CUBIC, RUN, Recipe};
    use crate::estimation::{LeastSquares, Point, fit};

    /// Fraction of true values inside their 95 % interval, by the sandwich from blocks and by the formula for white noise.
    fn coverage(colour: f64) -> (f64, f64) {
        const SEEDS: u64 = 120;
        let (mut robust, mut plain) = (0.0, 0.0);
        for seed in 0..SEEDS {
            let specimen = Recipe {
                seed,
                colour,
                samples: 400,
                recordings: 4,
                truth: vec![(CUBIC, vec![0.2])],
                ..Recipe::default()
            }
            .make();
            let problem = LeastSquares::new(&specimen, &RUN);
            let start = Point::nominal(&specimen).with_effect(&specimen, CUBIC, &[0.0]);
            let fitted = fit(&problem, start, problem.criteria.fitting.converged).expect("a fit");
            let (h, _) = sum(&fitted.normals, &fitted.prior, &fitted.point.z);
            let formula = h.try_inverse().expect("regular")[(2, 2)].sqrt();
            // One coordinate is 0.05.
            let off = (0.05 * fitted.point.z[2] - 0.2).abs() / 0.05;
            robust += f64::from(u8::from(off < 1.96 * deviations(&fitted)[2]));
            plain += f64::from(u8::from(off < 1.96 * formula));
        }
        (robust / SEEDS as f64, plain / SEEDS as f64)
    }

    /// Of 120 intervals 108 to 120 hold the truth in all but one of a thousand runs, if each does with 0.95.
    #[test]
    fn intervals_hold_the_truth_in_white_noise() {
        let (robust, _) = coverage(0.0);
        assert!(robust >= 0.9, "{robust}");
    }

    #[test]
    fn intervals_from_blocks_survive_coloured_noise_and_the_usual_formula_does_not() {
        let (robust, plain) = coverage(0.9);
        assert!(robust >= 0.85 && plain < 0.7, "{robust} {plain}");
    }
}
