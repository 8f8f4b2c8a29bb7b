//! One damped Newton step within the parameters' ranges.

use nalgebra::{DMatrix, DVector};

/// Added to the diagonal under the damping, so that a coordinate without curvature is damped too.
const LEAST_CURVATURE: f64 = 1e-3;
/// A coordinate at its limit is let go if it would gain more than this by coming back.
const LEAST_PULL: f64 = 1e-6;
/// Passes for each coordinate, after which the step is taken as it is: one meets its limit in a pass, and is let go in another.
const PASSES_PER_COORDINATE: usize = 4;
/// Passes besides, for few coordinates.
const PASSES_BESIDES: usize = 10;

/// The step `d` that minimises `d (H + damping) d - 2 g d` while `z + d` stays in its ranges.
///
/// Primal active set (Nocedal & Wright, Numerical Optimization, 2006, 16.5): every intermediate step is feasible and none is
/// worse than the one before. `None` where the damped matrix is not positive definite.
///
/// ```
/// use nalgebra::{DMatrix, DVector};
/// use oleo_diagnose::estimation::bounded_step::bounded_step;
///
/// // Without limits the step would be (1, 1); the first coordinate may go to 0.5 only.
/// let (h, g) = (DMatrix::from_diagonal_element(2, 2, 2.0), DVector::from_element(2, 2.0));
/// let step = bounded_step(&h, &g, 0.0, &[0.0, 0.0], &[(0.0, 0.5), (-9.0, 9.0)]);
/// assert_eq!(step, Some(DVector::from_vec(vec![0.5, 1.0])));
/// ```
#[must_use]
pub fn bounded_step(
    h: &DMatrix<f64>,
    g: &DVector<f64>,
    damping: f64,
    z: &[f64],
    ranges: &[(f64, f64)],
) -> Option<DVector<f64>> {
    let p = z.len();
    let mut a = h.clone();
    (0..p).for_each(|k| a[(k, k)] += damping * (h[(k, k)] + LEAST_CURVATURE));
    let limits: Vec<(f64, f64)> = (z.iter().zip(ranges))
        .map(|(z, r)| ((r.0 - z).min(0.0), (r.1 - z).max(0.0)))
        .collect();
    let mut step = DVector::zeros(p);
    let mut fixed = vec![false; p];
    for _ in 0..PASSES_PER_COORDINATE * p + PASSES_BESIDES {
        let free: Vec<usize> = (0..p).filter(|&k| !fixed[k]).collect();
        let part = a.select_rows(&free).select_columns(&free);
        let gradient = g - &a * &step;
        let right = DVector::from_iterator(free.len(), free.iter().map(|&k| gradient[k]));
        let direction = part.cholesky()?.solve(&right);
        // As far along the direction as the first limit allows.
        let mut length = 1.0;
        let mut stopped_by = None;
        for (&k, &d) in free.iter().zip(direction.iter()) {
            let room = if d > 0.0 {
                limits[k].1 - step[k]
            } else {
                limits[k].0 - step[k]
            };
            if d != 0.0 && room / d < length {
                (length, stopped_by) = ((room / d).max(0.0), Some(k));
            }
        }
        for (&k, &d) in free.iter().zip(direction.iter()) {
            step[k] = (step[k] + length * d).clamp(limits[k].0, limits[k].1);
        }
        if let Some(k) = stopped_by {
            fixed[k] = true;
            continue;
        }
        let gradient = g - &a * &step;
        // The coordinate at a limit that would gain most by coming back.
        let pull = |k: usize| if step[k] <= limits[k].0 { gradient[k] } else { -gradient[k] } / a[(k, k)].sqrt();
        let release = (0..p)
            .filter(|&k| fixed[k] && limits[k].0 < limits[k].1)
            .max_by(|&x, &y| pull(x).total_cmp(&pull(y)));
        match release {
            Some(k) if pull(k) > LEAST_PULL => fixed[k] = false,
            _ => return Some(step),
        }
    }
    Some(step)
}
