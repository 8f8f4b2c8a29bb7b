//! Least squares over blocks, with the covariance of their means.
//!
//! Residuals of the balance are correlated over seconds, so that their number says little of the information in them. The gradients of blocks
//! of some seconds are nearly independent of each other, and the spread of their sums gives the covariance of the estimate whatever the correlation within a
//! block (batch means; Newey & West, Econometrica 55(3), 1987, for the sandwich form; *recalled*). With 20 blocks 95 % are 2.09
//! standard deviations (Student's t, 19 degrees of freedom).

use nalgebra::{DMatrix, DVector};

use super::balance::{Row, UNKNOWNS};

/// Number of blocks.
pub const BLOCKS: usize = 20;
/// Standard deviations to either side that hold 95 %.
pub const STUDENT_T: f64 = 2.093;
/// Passes in which the three rows get the weights of their residuals.
const PASSES: usize = 3;

/// Estimates of all unknowns with their covariance; an unknown that is left out is 0 with certainty.
#[derive(Debug, Clone)]
pub struct Fit {
    /// Estimates.
    pub values: [f64; UNKNOWNS],
    /// Covariance.
    pub covariance: [[f64; UNKNOWNS]; UNKNOWNS],
    /// RMS of what is left of heave (N), pitch and roll (N m).
    pub residual_rms: [f64; 3],
}

impl Fit {
    /// Standard deviation of an unknown.
    pub fn deviation(&self, at: usize) -> f64 {
        self.covariance[at][at].max(0.0).sqrt()
    }
}

/// Fits the unknowns of `active` to blocks of rows. `None` where the rows do not determine them.
pub fn fit(blocks: &[&[Row]], active: &[usize]) -> Option<Fit> {
    let n = active.len();
    let all = || blocks.iter().flat_map(|block| block.iter());
    let count = all().count().max(1) as f64;
    let slope =
        |row: &Row, equation: usize| DVector::from_iterator(n, active.iter().map(|at| row.slopes[equation][*at]));
    // Before the first pass each row has the size of its regressors.
    let mut rms =
        [0, 1, 2].map(|e| (all().map(|row| row.unbalanced[e] * row.unbalanced[e]).sum::<f64>() / count).sqrt());
    let (mut solution, mut inverse) = (DVector::zeros(n), DMatrix::zeros(n, n));
    for _ in 0..PASSES {
        let (mut normal, mut right) = (DMatrix::zeros(n, n), DVector::zeros(n));
        for row in all() {
            for (e, rms) in rms.iter().enumerate() {
                let (slope, weight) = (slope(row, e), 1.0 / (rms * rms));
                normal.ger(weight, &slope, &slope, 1.0);
                right.axpy(weight * row.unbalanced[e], &slope, 1.0);
            }
        }
        inverse = normal.cholesky()?.inverse();
        solution = &inverse * right;
        rms = [0, 1, 2].map(|e| {
            let left = all().map(|row| row.unbalanced[e] - slope(row, e).dot(&solution));
            (left.map(|r| r * r).sum::<f64>() / count).sqrt()
        });
    }
    let mut spread = DMatrix::zeros(n, n);
    for block in blocks {
        let mut gradient = DVector::zeros(n);
        for row in *block {
            for (e, rms) in rms.iter().enumerate() {
                let slope = slope(row, e);
                let left = row.unbalanced[e] - slope.dot(&solution);
                gradient.axpy(left / (rms * rms), &slope, 1.0);
            }
        }
        spread.ger(1.0, &gradient, &gradient, 1.0);
    }
    let blocks = blocks.len() as f64;
    let sandwich = &inverse * (spread * (blocks / (blocks - 1.0))) * &inverse;
    let mut fit = Fit {
        values: [0.0; UNKNOWNS],
        covariance: [[0.0; UNKNOWNS]; UNKNOWNS],
        residual_rms: rms,
    };
    for (i, at) in active.iter().enumerate() {
        fit.values[*at] = solution[i];
        for (j, other) in active.iter().enumerate() {
            fit.covariance[*at][*other] = sandwich[(i, j)];
        }
    }
    fit.values.iter().all(|value| value.is_finite()).then_some(fit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution as _, StandardNormal};

    /// Correlated residuals of known size: the interval of 95 % must hold the truth about that often, which white-noise formulas miss by far.
    #[test]
    fn intervals_hold_the_truth_where_residuals_are_correlated() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let mut held = 0;
        for _ in 0..200 {
            let (mut noise, mut course) = ([0.0f64; 3], 0.0f64);
            let mut draw = || -> f64 { StandardNormal.sample(&mut random) };
            let rows: Vec<Row> = (0..4000)
                .map(|_| {
                    course = 0.9 * course + draw();
                    noise = noise.map(|old| 0.9 * old + draw());
                    let mut slopes = [[0.0; UNKNOWNS]; 3];
                    (slopes[0][0], slopes[1][1], slopes[2][2]) = (9.8 + course, course, course);
                    Row {
                        unbalanced: [0, 1, 2].map(|e| 5.0 * slopes[e][e] + 10.0 * noise[e]),
                        slopes,
                        yaw_rate: 0.0,
                        strut_speed_squared: 1.0,
                    }
                })
                .collect();
            let blocks: Vec<&[Row]> = rows.chunks(4000 / BLOCKS).collect();
            let fit = fit(&blocks, &[0, 1, 2]).expect("determined");
            for at in 0..3 {
                let within = STUDENT_T * fit.covariance[at][at].sqrt();
                held += usize::from((fit.values[at] - 5.0).abs() < within);
            }
        }
        assert!((540..=594).contains(&held), "{held} of 600");
    }
}
