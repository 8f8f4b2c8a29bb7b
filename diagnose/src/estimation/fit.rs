//! A fitted model with its normal equations, from which everything that follows a fit is computed.

use std::sync::{Arc, OnceLock};

use nalgebra::DVector;

use super::bounded_step::bounded_step;
use super::evaluation::Sensitivity;
use super::normal_equations::{NormalEquations, sum};
use super::point::Point;

/// Damping of the step that leaves out blocks. It changes a step by a millionth, and keeps a coordinate that no other block
/// determines where it is.
const DAMPING: f64 = 1e-6;

/// A fitted point with its normal equations.
#[derive(Debug, Clone)]
pub struct Fit {
    /// Effects and coordinates.
    pub point: Point,
    /// Normal equations of every block, at the point.
    pub normals: Vec<NormalEquations>,
    /// Diagonal of the prior's normal matrix.
    pub prior: DVector<f64>,
    /// Cost of all blocks with the prior.
    pub cost: f64,
    /// Range of every coordinate.
    pub ranges: Vec<(f64, f64)>,
    /// Residuals and derivatives, where they were kept (they are large).
    pub sensitivities: Option<Arc<Vec<Sensitivity>>>,
    /// True if the fit comes from screening: linear in the model's own parameters, and not converged.
    pub screened: bool,
    /// False if the fit ended before its last step gained as little as was asked for.
    pub converged: bool,
    /// By how much the steps with the last derivatives lowered the cost.
    pub(super) gained: f64,
    /// The folds left out in turn, once somebody has asked ([`super::held_out`]).
    pub(super) held_out: Arc<OnceLock<HeldOut>>,
    /// Cost of all recordings, each predicted by a fit of the others, once somebody has asked.
    pub(super) whole_recordings: Arc<OnceLock<f64>>,
    /// Noise ratio that the model would reach if it were complete, once somebody has asked.
    pub(super) floor: Arc<OnceLock<f64>>,
}

/// A model judged on each fold by a fit that the fold had no say in.
#[derive(Debug, Clone)]
pub struct HeldOut {
    /// Cost of every block.
    pub costs: Vec<f64>,
    /// The point fitted without each fold.
    pub points: Vec<Point>,
}

impl Fit {
    /// A fit that nobody has judged yet.
    #[must_use]
    pub fn new(
        point: Point,
        normals: Vec<NormalEquations>,
        prior: DVector<f64>,
        cost: f64,
        ranges: Vec<(f64, f64)>,
    ) -> Self {
        Self {
            point,
            normals,
            prior,
            cost,
            ranges,
            sensitivities: None,
            screened: false,
            converged: true,
            gained: 0.0,
            held_out: Arc::default(),
            whole_recordings: Arc::default(),
            floor: Arc::default(),
        }
    }

    /// The same without residuals and derivatives, to be kept.
    #[must_use]
    pub fn without_sensitivities(&self) -> Self {
        Self {
            sensitivities: None,
            ..self.clone()
        }
    }

    /// The change of coordinates when the selected blocks are left out, in the linear approximation. No coordinate changes by
    /// more than `largest` or leaves its range, and one that is held or that the rest does not determine stays where it is. `None`
    /// where the rest is singular even so.
    #[must_use]
    pub fn step_without(&self, left_out: impl Fn(usize) -> bool, held: &[usize], largest: f64) -> Option<DVector<f64>> {
        let z = &self.point.z;
        let kept = (self.normals.iter().enumerate())
            .filter(|(k, _)| !left_out(*k))
            .map(|(_, n)| n);
        let (h, mut g) = sum(kept, &self.prior, z);
        // Only the difference that leaving out makes: the gradient left at the full fit is rounding and bounds.
        let (_, full) = sum(&self.normals, &self.prior, z);
        g -= full;
        let mut near: Vec<(f64, f64)> = (self.ranges.iter().zip(z))
            .map(|(r, z)| (r.0.max(z - largest), r.1.min(z + largest)))
            .collect();
        held.iter().for_each(|&k| near[k] = (z[k], z[k]));
        bounded_step(&h, &g, DAMPING, z, &near)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimation::normal_equations::total_cost;
    use nalgebra::DMatrix;

    /// Normal equations of `y = X z` with noise of 1, at `z`.
    fn block(x: &DMatrix<f64>, y: &DVector<f64>, z: &DVector<f64>) -> NormalEquations {
        let residual = y - x * z;
        NormalEquations {
            h: x.transpose() * x,
            g: x.transpose() * &residual,
            cost: residual.dot(&residual),
        }
    }

    /// Rows of the blocks one below the other.
    fn stacked<'b>(blocks: impl IntoIterator<Item = &'b (DMatrix<f64>, DVector<f64>)>) -> (DMatrix<f64>, DVector<f64>) {
        let (mut rows, mut values) = (Vec::new(), Vec::new());
        for (x, y) in blocks {
            rows.extend(x.row_iter().map(|r| r.clone_owned()));
            values.extend(y.iter().copied());
        }
        (DMatrix::from_rows(&rows), DVector::from_vec(values))
    }

    /// Least squares by singular values, which has nothing in common with normal equations.
    fn solved(x: DMatrix<f64>, y: &DVector<f64>) -> DVector<f64> {
        x.svd(true, true).solve(y, 1e-12).expect("a solution")
    }

    /// A straight line over time measured in four blocks, whose offset and slope differ a little from block to block.
    fn line() -> Vec<(DMatrix<f64>, DVector<f64>)> {
        (0..4_i32)
            .map(|k| {
                let time: Vec<f64> = (0..6).map(|i| f64::from(6 * k + i) / 10.0).collect();
                let bend = 0.2 * f64::from(k * (3 - k));
                let y: Vec<f64> = (time.iter().enumerate())
                    .map(|(i, t)| 0.5 + 1.5 * t + bend + if i % 2 == 0 { 0.1 } else { -0.1 })
                    .collect();
                let x = DMatrix::from_fn(6, 2, |i, column| if column == 0 { 1.0 } else { time[i] });
                (x, DVector::from_vec(y))
            })
            .collect()
    }

    /// The blocks fitted, each coordinate within a range and with a prior's precision.
    fn fitted(blocks: &[(DMatrix<f64>, DVector<f64>)], z: &DVector<f64>, prior: f64, range: (f64, f64)) -> Fit {
        let normals: Vec<NormalEquations> = blocks.iter().map(|(x, y)| block(x, y, z)).collect();
        let cost = total_cost(&normals) + prior * z.dot(z);
        let point = Point {
            effects: vec![],
            z: z.iter().copied().collect(),
        };
        Fit::new(
            point,
            normals,
            DVector::from_element(z.len(), prior),
            cost,
            vec![range; z.len()],
        )
    }

    const FAR: (f64, f64) = (-100.0, 100.0);

    #[test]
    fn leaving_out_a_block_is_the_fit_of_the_others() {
        let blocks = line();
        let (x, y) = stacked(&blocks);
        let z = solved(x, &y);
        let fit = fitted(&blocks, &z, 0.0, FAR);
        for left_out in 0..blocks.len() {
            let rest = blocks
                .iter()
                .enumerate()
                .filter(|(k, _)| *k != left_out)
                .map(|(_, b)| b);
            let (x, y) = stacked(rest);
            let expected = solved(x, &y) - &z;
            let step = fit.step_without(|k| k == left_out, &[], 10.0).expect("a step");
            assert!(expected.norm() > 0.01 && (step - &expected).norm() < 1e-4 * expected.norm());
        }
        // Nothing left out changes nothing.
        assert!(fit.step_without(|_| false, &[], 10.0).expect("a step").norm() < 1e-12);
    }

    /// A mean of one number for each block with a prior: `z = sum(y) / (n + 1)`, whatever is left out.
    #[test]
    fn the_prior_stays_when_blocks_go() {
        let y = [1.0, 2.0, 6.0];
        let blocks: Vec<_> = (y.iter())
            .map(|y| (DMatrix::from_element(1, 1, 1.0), DVector::from_element(1, *y)))
            .collect();
        let fit = fitted(&blocks, &DVector::from_element(1, 9.0 / 4.0), 1.0, FAR);
        for (left_out, y) in y.iter().enumerate() {
            let step = fit.step_without(|k| k == left_out, &[], 10.0).expect("a step")[0];
            let expected = (9.0 - y) / 3.0 - 9.0 / 4.0;
            assert!((step - expected).abs() < 1e-5, "{step} {expected}");
        }
    }

    #[test]
    fn no_step_leaves_the_range_or_is_longer_than_asked() {
        let y = [0.0, 0.0, 9.0];
        let blocks: Vec<_> = (y.iter())
            .map(|y| (DMatrix::from_element(1, 1, 1.0), DVector::from_element(1, *y)))
            .collect();
        let mean = DVector::from_element(1, 3.0);
        // Without the third block the mean is 0, without the first it is 4.5.
        let step = |range, left_out, largest| {
            let fit = fitted(&blocks, &mean, 0.0, range);
            fit.step_without(|k| k == left_out, &[], largest).expect("a step")[0]
        };
        assert!((step(FAR, 2, 10.0) + 3.0).abs() < 1e-5 && (step(FAR, 0, 10.0) - 1.5).abs() < 1e-5);
        assert_eq!(step(FAR, 2, 0.25), -0.25);
        assert_eq!(step((2.5, 3.5), 2, 10.0), -0.5);
        // At the end of its range already.
        assert_eq!(step((2.5, 3.0), 0, 10.0), 0.0);
    }

    #[test]
    fn a_coordinate_that_no_other_block_determines_stays_where_it_is() {
        let one = |row: [f64; 2], y: f64| (DMatrix::from_row_slice(1, 2, &row), DVector::from_element(1, y));
        let blocks = [one([1.0, 0.0], 1.0), one([1.0, 0.0], 3.0), one([0.0, 1.0], 5.0)];
        let fit = fitted(&blocks, &DVector::from_vec(vec![2.0, 5.0]), 0.0, FAR);
        let step = fit.step_without(|k| k == 2, &[], 10.0).expect("a step");
        assert!(step.norm() < 1e-12, "{step}");
    }

    #[test]
    fn a_copy_that_is_kept_is_smaller_and_not_judged_again() {
        let z = DVector::from_element(2, 0.0);
        let mut fit = fitted(&line(), &z, 0.0, FAR);
        fit.sensitivities = Some(Arc::default());
        let kept = fit.without_sensitivities();
        assert!(kept.sensitivities.is_none() && kept.point == fit.point);
        let judged = HeldOut {
            costs: vec![1.0, 2.0],
            points: vec![],
        };
        assert!(fit.held_out.set(judged).is_ok());
        assert_eq!(kept.held_out.get().map(|h| h.costs.clone()), Some(vec![1.0, 2.0]));
    }
}
