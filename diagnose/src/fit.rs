//! Least squares by damped Gauss-Newton steps on per-block normal equations.
//!
//! The published Levenberg-Marquardt crate wants one dense Jacobian; ten recordings of five channels and twenty-five
//! parameters would be re-laid-out for it at every step, and the per-block sums that held-out figures and intervals are
//! made of would have to be formed again. The step itself is Marquardt's (J. SIAM 11(2), 1963), with bounds by freezing.

use std::sync::{Arc, OnceLock};

use nalgebra::{DMatrix, DVector};

use crate::error::DiagnoseError;
use crate::problem::{Normal, Point, Problem, Sensitivity};

/// Steps with one Jacobian.
const CHORD_STEPS: usize = 4;

/// How hard to try.
#[derive(Debug, Clone, Copy)]
pub struct Effort {
    /// Most Jacobians.
    pub linearisations: usize,
    /// Stop when a step gains less than this part of the cost.
    pub tolerance: f64,
}

impl Effort {
    /// To convergence.
    pub const FULL: Self = Self {
        linearisations: 8,
        tolerance: 3e-5,
    };
    /// Enough to rank candidates.
    pub const QUICK: Self = Self {
        linearisations: 2,
        tolerance: 1e-3,
    };
}

/// A fitted point with its normal equations.
#[derive(Debug, Clone)]
pub struct Fit {
    /// Where.
    pub point: Point,
    /// Normal equations of every block, at the point.
    pub normals: Vec<Normal>,
    /// Diagonal of the prior's normal matrix.
    pub prior: DVector<f64>,
    /// Total cost with the prior.
    pub cost: f64,
    /// Range of every coordinate.
    pub ranges: Vec<(f64, f64)>,
    /// Residual and derivatives, where they were kept (they are large).
    pub sensitivity: Option<Arc<Vec<Sensitivity>>>,
    /// True for the linear end of a screening, which has not converged.
    pub screened: bool,
    /// Leaving out the folds, once somebody has asked.
    pub judged: Arc<OnceLock<Judged>>,
}

/// What leaving out each fold does.
#[derive(Debug, Clone)]
pub struct Judged {
    /// Cost of every block when its fold had no say in the fit.
    costs: Vec<f64>,
    /// The point fitted without each fold.
    points: Vec<Point>,
}

/// Largest change of a coordinate that leaving out blocks is believed to make: beyond, the linear picture is no guide.
const MAX_LEFT_OUT_STEP: f64 = 1.5;
/// Held-out cost over fitted cost up to which the linear picture is believed.
const LINEAR_LIMIT: f64 = 1.5;

/// Fits all parameters of the structure from a starting point.
///
/// # Errors
/// A start that cannot be simulated, or the wish to stop. Steps into impossible regions are only shortened.
pub fn fit(problem: &Problem<'_>, start: Point, effort: Effort) -> Result<Fit, DiagnoseError> {
    let parameters = problem.parameters(&start.effects);
    let prior = DVector::from_iterator(
        parameters.len(),
        parameters.iter().map(|p| if p.prior { 1.0 } else { 0.0 }),
    );
    let ranges: Vec<(f64, f64)> = parameters.iter().map(|p| p.z_range()).collect();
    let mut point = start;
    for (z, range) in point.z.iter_mut().zip(&ranges) {
        *z = z.clamp(range.0, range.1);
    }
    let columns: Vec<usize> = (0..point.z.len()).collect();
    let mut sensitivity = problem.sensitivities(&point, &columns, None)?;
    let mut normals = problem.assemble(&sensitivity);
    let mut cost = total(&normals) + problem.prior_cost(&point);
    let mut damping = 1e-4;
    for round in 0..effort.linearisations {
        if round > 0 {
            sensitivity = problem.sensitivities(&point, &columns, None)?;
            normals = problem.assemble(&sensitivity);
        }
        let before = cost;
        // Several steps with one Jacobian: a step costs one simulation, a Jacobian one a parameter.
        for step in 0..CHORD_STEPS {
            let (h, g) = sum(&normals, &prior, &point.z);
            let gained = cost;
            let tries = if step == 0 { 6 } else { 2 };
            for _ in 0..tries {
                let Some(step) = bounded_step(&h, &g, damping, &point.z, &ranges) else {
                    damping *= 10.0;
                    continue;
                };
                let mut trial = point.clone();
                for ((z, d), range) in trial.z.iter_mut().zip(step.iter()).zip(&ranges) {
                    *z = (*z + d).clamp(range.0, range.1);
                }
                if trial == point {
                    break;
                }
                let residuals = match problem.predict(&trial) {
                    Ok(predicted) => problem.residuals(&predicted),
                    Err(DiagnoseError::Simulation { .. }) => {
                        damping *= 10.0;
                        continue;
                    }
                    Err(stop) => return Err(stop),
                };
                let trial_cost = problem.squares(&residuals) + problem.prior_cost(&trial);
                if trial_cost < cost {
                    (point, cost) = (trial, trial_cost);
                    sensitivity.iter_mut().zip(residuals).for_each(|(s, r)| s.residual = r);
                    normals = problem.with_residuals(&normals, &sensitivity);
                    damping = (damping * 0.1_f64).max(1e-9);
                    break;
                }
                damping *= 10.0;
            }
            if gained - cost < effort.tolerance * cost {
                break;
            }
        }
        if before - cost < 3.0 * effort.tolerance * cost {
            break;
        }
    }
    Ok(Fit {
        point,
        normals,
        prior,
        cost,
        ranges,
        sensitivity: Some(Arc::new(sensitivity)),
        screened: false,
        judged: Arc::default(),
    })
}

/// Sum of the blocks' costs.
#[must_use]
pub fn total(normals: &[Normal]) -> f64 {
    normals.iter().map(|n| n.cost).sum()
}

pub(crate) fn sum(normals: &[Normal], prior: &DVector<f64>, z: &[f64]) -> (DMatrix<f64>, DVector<f64>) {
    let p = prior.len();
    let (mut h, mut g) = (DMatrix::zeros(p, p), DVector::zeros(p));
    for n in normals {
        h += &n.h;
        g += &n.g;
    }
    for k in 0..p {
        h[(k, k)] += prior[k];
        g[k] -= prior[k] * z[k];
    }
    (h, g)
}

/// Damped Newton step within the ranges: the minimum of the damped quadratic in the box.
pub(crate) fn bounded_step(
    h: &DMatrix<f64>,
    g: &DVector<f64>,
    damping: f64,
    z: &[f64],
    ranges: &[(f64, f64)],
) -> Option<DVector<f64>> {
    let p = z.len();
    let mut a = h.clone();
    (0..p).for_each(|k| a[(k, k)] += damping * (h[(k, k)] + 1e-3));
    let limits: Vec<(f64, f64)> = (z.iter().zip(ranges))
        .map(|(z, r)| ((r.0 - z).min(0.0), (r.1 - z).max(0.0)))
        .collect();
    let mut step = DVector::zeros(p);
    let mut fixed = vec![false; p];
    // Primal active set (Nocedal & Wright, Numerical Optimization, 16.5): every step is feasible and none is worse.
    for _ in 0..4 * p + 10 {
        let free: Vec<usize> = (0..p).filter(|&k| !fixed[k]).collect();
        let part = a.select_rows(&free).select_columns(&free);
        let gradient = g - &a * &step;
        let right = DVector::from_iterator(free.len(), free.iter().map(|&k| gradient[k]));
        let direction = part.cholesky()?.solve(&right);
        let mut reach = 1.0;
        let mut stop = None;
        for (&k, &d) in free.iter().zip(direction.iter()) {
            let room = if d > 0.0 {
                limits[k].1 - step[k]
            } else {
                limits[k].0 - step[k]
            };
            if d != 0.0 && room / d < reach {
                (reach, stop) = ((room / d).max(0.0), Some(k));
            }
        }
        for (&k, &d) in free.iter().zip(direction.iter()) {
            step[k] = (step[k] + reach * d).clamp(limits[k].0, limits[k].1);
        }
        if let Some(k) = stop {
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
            Some(k) if pull(k) > 1e-6 => fixed[k] = false,
            _ => return Some(step),
        }
    }
    Some(step)
}

impl Fit {
    /// Cost of every block when its fold had no say in the fit.
    #[must_use]
    pub fn held_out(&self, problem: &Problem<'_>) -> &[f64] {
        &self.judged(problem).costs
    }

    /// The point fitted without each fold.
    #[must_use]
    pub fn fold_points(&self, problem: &Problem<'_>) -> &[Point] {
        &self.judged(problem).points
    }

    /// By fits of their own where they are cheap, or where the linear approximation around this fit says that leaving
    /// out a fold changes much; else in that approximation.
    fn judged(&self, problem: &Problem<'_>) -> &Judged {
        self.judged.get_or_init(|| {
            if problem.refits_folds() {
                return self.refitted(problem, Effort::FULL);
            }
            let linear = self.left_out(problem);
            if self.screened || linear.costs.iter().sum::<f64>() < LINEAR_LIMIT * total(&self.normals) {
                linear
            } else {
                self.refitted(problem, Effort::QUICK)
            }
        })
    }

    fn refitted(&self, problem: &Problem<'_>, effort: Effort) -> Judged {
        let mut costs = vec![f64::INFINITY; self.normals.len()];
        let mut points = Vec::with_capacity(problem.folds);
        for fold in 0..problem.folds {
            let without = fit(&problem.without_fold(fold), self.point.clone(), effort).map(|f| f.point);
            let point = without.unwrap_or_else(|_| self.point.clone());
            if let Ok(there) = problem.block_costs(&point) {
                for (k, cost) in there.into_iter().enumerate() {
                    if problem.blocks[k].fold == fold {
                        costs[k] = cost;
                    }
                }
            }
            points.push(point);
        }
        Judged { costs, points }
    }

    /// The same in the linear approximation.
    fn left_out(&self, problem: &Problem<'_>) -> Judged {
        let mut costs = vec![0.0; self.normals.len()];
        let mut points = Vec::with_capacity(problem.folds);
        for fold in 0..problem.folds {
            let step = self.step_without(|k| problem.blocks[k].fold == fold);
            for (k, normal) in self
                .normals
                .iter()
                .enumerate()
                .filter(|(k, _)| problem.blocks[*k].fold == fold)
            {
                costs[k] = match &step {
                    Some(d) => (normal.cost - 2.0 * normal.g.dot(d) + d.dot(&(&normal.h * d))).max(0.0),
                    None => normal.cost,
                };
            }
            let mut point = self.point.clone();
            if let Some(d) = step {
                for ((z, d), r) in point.z.iter_mut().zip(d.iter()).zip(&self.ranges) {
                    *z = (*z + d).clamp(r.0, r.1);
                }
            }
            points.push(point);
        }
        Judged { costs, points }
    }

    /// The change of coordinates when the selected blocks are left out; `None` if the rest does not determine them.
    /// Coordinates at their bound stay there.
    #[must_use]
    pub fn step_without(&self, left_out: impl Fn(usize) -> bool) -> Option<DVector<f64>> {
        let kept: Vec<Normal> = self
            .normals
            .iter()
            .enumerate()
            .filter(|(k, _)| !left_out(*k))
            .map(|(_, n)| n.clone())
            .collect();
        let (h, mut g) = sum(&kept, &self.prior, &self.point.z);
        // Only the difference that leaving out makes: the gradient left at the full fit is rounding and bounds.
        let (_, full) = sum(&self.normals, &self.prior, &self.point.z);
        g -= full;
        let near: Vec<(f64, f64)> = (self.ranges.iter().zip(&self.point.z))
            .map(|(r, z)| (r.0.max(z - MAX_LEFT_OUT_STEP), r.1.min(z + MAX_LEFT_OUT_STEP)))
            .collect();
        bounded_step(&h, &g, 1e-6, &self.point.z, &near)
    }

    /// Standard deviation of every coordinate, from blocks: residuals of a free run are coloured, so the usual formula
    /// is far too narrow. Sandwich `H^-1 (sum g_b g_b') H^-1` (White, Econometrica 50(1), 1982) with neighbouring blocks
    /// as the independent unit, never smaller than the formula for white noise.
    #[must_use]
    pub fn deviations(&self) -> DVector<f64> {
        let p = self.prior.len();
        match self.covariance() {
            Some(c) => DVector::from_iterator(p, (0..p).map(|k| c[(k, k)].max(0.0).sqrt())),
            None => DVector::from_element(p, f64::INFINITY),
        }
    }

    /// Covariance of the coordinates as described at [`Self::deviations`].
    #[must_use]
    pub fn covariance(&self) -> Option<DMatrix<f64>> {
        let p = self.prior.len();
        let (h, _) = sum(&self.normals, &self.prior, &self.point.z);
        let mut damped = h.clone();
        (0..p).for_each(|k| damped[(k, k)] += 1e-9 * h[(k, k)] + 1e-12);
        let inverse = damped.cholesky()?.inverse();
        let mut meat = DMatrix::zeros(p, p);
        for n in &self.normals {
            meat += &n.g * n.g.transpose();
        }
        for k in 0..p {
            meat[(k, k)] += self.prior[k];
        }
        let blocks = self.normals.len() as f64;
        let robust = &inverse * meat * &inverse * (blocks / (blocks - 1.0).max(1.0));
        let scale = |k: usize| (inverse[(k, k)] / robust[(k, k)].max(1e-300)).max(1.0).sqrt();
        Some(DMatrix::from_fn(p, p, |i, j| robust[(i, j)] * scale(i) * scale(j)))
    }
}
