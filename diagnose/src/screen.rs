//! A quick, fair look at every candidate: what could it explain beside the model so far?
//!
//! Only the candidate's own derivatives are recomputed; those of the parameters already in the model are taken from its
//! fit. That is a Gauss-Newton iteration with a partly frozen Jacobian: good enough to rank forty candidates for the
//! price of fully fitting three.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::error::DiagnoseError;
use crate::fit::{Fit, bounded_step, sum};
use crate::problem::{Normal, Point, Problem, Sensitivity};

/// Gauss-Newton iterations a candidate gets.
const ITERATIONS: usize = 4;

/// The model so far with everything that screening reuses.
pub struct Screen<'p, 'a> {
    problem: &'p Problem<'a>,
    fit: &'p Fit,
    base: Vec<Sensitivity>,
}

impl<'p, 'a> Screen<'p, 'a> {
    /// Prepares screening around a fitted model.
    ///
    /// # Errors
    /// As [`Problem::sensitivities`].
    pub fn new(problem: &'p Problem<'a>, fit: &'p Fit) -> Result<Self, DiagnoseError> {
        let columns: Vec<usize> = (0..fit.point.z.len()).collect();
        Ok(Self {
            problem,
            fit,
            base: problem.sensitivities(&fit.point, &columns)?,
        })
    }

    /// Every candidate added alone, in the order given; `None` where it cannot be simulated at all.
    ///
    /// # Errors
    /// The wish to stop.
    pub fn all(&self, candidates: &[usize]) -> Result<Vec<Option<Fit>>, DiagnoseError> {
        candidates.par_iter().map(|&c| self.one(c)).collect()
    }

    fn one(&self, candidate: usize) -> Result<Option<Fit>, DiagnoseError> {
        let description = &self.problem.specimen.candidates()[candidate];
        let own: Vec<f64> = description.parameters.iter().map(|p| p.start).collect();
        let mut best: Option<Fit> = None;
        for start in std::iter::once(&own).chain(&description.starts) {
            match self.from(candidate, start) {
                Ok(fit) => {
                    if best.as_ref().is_none_or(|b| fit.cost < b.cost) {
                        best = Some(fit);
                    }
                }
                Err(DiagnoseError::Simulation { .. }) => {}
                Err(stop) => return Err(stop),
            }
        }
        Ok(best)
    }

    fn from(&self, candidate: usize, start: &[f64]) -> Result<Fit, DiagnoseError> {
        let problem = self.problem;
        let old = self.fit.point.z.len();
        let mut point = problem.with_effect(&self.fit.point, candidate, start);
        let parameters = problem.parameters(&point.effects);
        let ranges: Vec<(f64, f64)> = parameters.iter().map(|p| p.z_range()).collect();
        let prior = DVector::from_iterator(
            parameters.len(),
            parameters.iter().map(|p| if p.prior { 1.0 } else { 0.0 }),
        );
        let new: Vec<usize> = (old..point.z.len()).collect();
        let mut normals = self.extended(&problem.sensitivities(&point, &new)?);
        let mut cost = crate::fit::total(&normals) + problem.prior_cost(&point);
        let mut damping = 1e-3;
        for _ in 0..ITERATIONS {
            let (h, g) = sum(&normals, &prior, &point.z);
            let mut accepted = None;
            for _ in 0..3 {
                if let Some(step) = bounded_step(&h, &g, damping, &point.z, &ranges) {
                    let trial = moved(&point, &step, &ranges);
                    if trial == point {
                        break;
                    }
                    match problem.cost(&trial) {
                        Ok(c) if c < cost => {
                            accepted = Some((trial, c));
                            damping = (damping * 0.1_f64).max(1e-9);
                            break;
                        }
                        Ok(_) | Err(DiagnoseError::Simulation { .. }) => {}
                        Err(stop) => return Err(stop),
                    }
                }
                damping *= 30.0;
            }
            let Some((trial, lower)) = accepted else { break };
            let gain = cost - lower;
            point = trial;
            cost = lower;
            normals = self.extended(&problem.sensitivities(&point, &new)?);
            if gain < 1e-3 * cost {
                break;
            }
        }
        Ok(Fit {
            point,
            normals,
            prior,
            cost,
        })
    }

    /// Normal equations of the frozen columns and the new ones together.
    fn extended(&self, new: &[Sensitivity]) -> Vec<Normal> {
        let old = self.fit.point.z.len();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        self.problem
            .blocks
            .iter()
            .zip(&self.fit.normals)
            .map(|(b, frozen)| {
                let (base, added) = (&self.base[b.recording], &new[b.recording]);
                let p = old + added.columns.len();
                let (mut h, mut g) = (DMatrix::zeros(p, p), DVector::zeros(p));
                h.view_mut((0, 0), (old, old)).copy_from(&frozen.h);
                let mut cost = 0.0;
                for (c, residual) in added.residual.iter().enumerate() {
                    let r = &residual[b.start..b.end];
                    cost += dot(r, r);
                    for (k, column) in base.columns.iter().enumerate() {
                        g[k] += dot(&column[c][b.start..b.end], r);
                    }
                    for (i, column) in added.columns.iter().enumerate() {
                        let own = &column[c][b.start..b.end];
                        g[old + i] += dot(own, r);
                        for (k, other) in base.columns.iter().enumerate() {
                            let value = dot(own, &other[c][b.start..b.end]);
                            h[(old + i, k)] += value;
                            h[(k, old + i)] += value;
                        }
                        for (j, other) in added.columns[..=i].iter().enumerate() {
                            let value = dot(own, &other[c][b.start..b.end]);
                            h[(old + i, old + j)] += value;
                            if i != j {
                                h[(old + j, old + i)] += value;
                            }
                        }
                    }
                }
                Normal {
                    h,
                    g,
                    cost,
                    count: frozen.count,
                }
            })
            .collect()
    }
}

fn moved(point: &Point, step: &DVector<f64>, ranges: &[(f64, f64)]) -> Point {
    let mut there = point.clone();
    for ((z, d), range) in there.z.iter_mut().zip(step.iter()).zip(ranges) {
        *z = (*z + d).clamp(range.0, range.1);
    }
    there
}
