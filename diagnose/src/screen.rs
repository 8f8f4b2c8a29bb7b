//! A quick, fair look at every candidate: what could it explain beside the model so far?
//!
//! The model so far stays simulated where it is; its own parameters answer the candidate linearly (variable projection,
//! Golub & Pereyra, SIAM J. Numer. Anal. 10(2), 1973, with the nuisance part linearised). So a candidate costs a few
//! simulations, a fault of an instrument none, and none is judged without recalibration.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::error::DiagnoseError;
use crate::fit::{Fit, bounded_step, sum};
use crate::problem::{Normal, Point, Problem, Sensitivity};
use crate::specimen::Series;
use crate::vocabulary::Column;

/// Steps every candidate gets.
const FIRST_STEPS: usize = 1;
/// Steps the promising ones get.
const MORE_STEPS: usize = 3;
/// How many are promising.
const PROMISING: usize = 6;

/// The model so far with everything that screening reuses.
pub struct Screen<'p, 'a> {
    problem: &'p Problem<'a>,
    fit: &'p Fit,
    base: Arc<Vec<Sensitivity>>,
    truths: Vec<Series>,
}

/// A candidate on its way: coordinates, the model's answer, the cost with it.
struct Way {
    point: Point,
    normals: Vec<Normal>,
    answer: DVector<f64>,
    cost: f64,
    damping: f64,
    done: bool,
}

impl<'p, 'a> Screen<'p, 'a> {
    /// Prepares screening around a fitted model.
    ///
    /// # Errors
    /// As [`Problem::sensitivities`].
    pub fn new(problem: &'p Problem<'a>, fit: &'p Fit) -> Result<Self, DiagnoseError> {
        let truths = problem.truths(&fit.point)?;
        let base = if let Some(kept) = &fit.sensitivity {
            Arc::clone(kept)
        } else {
            let columns: Vec<usize> = (0..fit.point.z.len()).collect();
            Arc::new(problem.sensitivities(&fit.point, &columns, Some(&truths))?)
        };
        Ok(Self {
            problem,
            fit,
            base,
            truths,
        })
    }

    /// Every candidate added alone, in the order given; `None` where it cannot be simulated at all.
    ///
    /// # Errors
    /// The wish to stop.
    pub fn all(&self, candidates: &[usize]) -> Result<Vec<Option<Fit>>, DiagnoseError> {
        let first: Vec<Option<Way>> = candidates
            .par_iter()
            .map(|&c| self.begin(c))
            .collect::<Result<_, DiagnoseError>>()?;
        let mut order: Vec<usize> = (0..first.len()).filter(|&k| first[k].is_some()).collect();
        let cost = |k: usize| first[k].as_ref().map_or(f64::INFINITY, |w| w.cost);
        order.sort_by(|&a, &b| cost(a).total_cmp(&cost(b)));
        let promising: Vec<usize> = order.into_iter().take(PROMISING).collect();
        (first.into_par_iter().enumerate())
            .map(|(k, way)| {
                let Some(mut way) = way else { return Ok(None) };
                if promising.contains(&k) {
                    self.advance(&mut way, MORE_STEPS)?;
                }
                Ok(Some(self.finish(way)))
            })
            .collect()
    }

    fn begin(&self, candidate: usize) -> Result<Option<Way>, DiagnoseError> {
        let description = &self.problem.specimen.candidates()[candidate];
        let own: Vec<f64> = description.parameters.iter().map(|p| p.start).collect();
        let mut best: Option<Way> = None;
        for start in std::iter::once(&own).chain(&description.starts) {
            let point = self.problem.with_effect(&self.fit.point, candidate, start);
            let known = description.absent_at(start).then_some(self.truths.as_slice());
            let way = self.at(point, known).and_then(|mut way| {
                self.advance(&mut way, FIRST_STEPS)?;
                Ok(way)
            });
            match way {
                Ok(way) if best.as_ref().is_none_or(|b| way.cost < b.cost) => best = Some(way),
                Ok(_) | Err(DiagnoseError::Simulation { .. }) => {}
                Err(stop) => return Err(stop),
            }
        }
        Ok(best)
    }

    /// True quantities at a point that differs from the model so far by a candidate only, where they differ at all: a
    /// fault of an instrument leaves the physics alone (the displacement's is an input and does not).
    fn truths_at(&self, point: &Point) -> Result<Option<Vec<Series>>, DiagnoseError> {
        let outside = point.effects.last().is_some_and(|&c| {
            let candidate = &self.problem.specimen.candidates()[c];
            candidate.is_instrument_fault()
                && candidate.place.sensor() != Some(&Column::DISPLACEMENT)
                && candidate.parameters.iter().all(|p| p.instrument_only)
        });
        if outside {
            Ok(None)
        } else {
            self.problem.truths(point).map(Some)
        }
    }

    fn at(&self, point: Point, known: Option<&[Series]>) -> Result<Way, DiagnoseError> {
        let simulated = if known.is_some() { None } else { self.truths_at(&point)? };
        let truths = known.or(simulated.as_deref()).unwrap_or(&self.truths);
        let new: Vec<usize> = (self.fit.point.z.len()..point.z.len()).collect();
        let normals = self.extended(&self.problem.sensitivities(&point, &new, Some(truths))?);
        let (answer, cost) = self.answered(&point, &normals);
        Ok(Way {
            point,
            normals,
            answer,
            cost,
            damping: 1e-3,
            done: new.is_empty(),
        })
    }

    /// The cost at a point, and the true quantities for going on from it.
    fn cost_at(&self, point: &Point) -> Result<(f64, Option<Vec<Series>>), DiagnoseError> {
        let simulated = self.truths_at(point)?;
        let shown = self
            .problem
            .observed(point, simulated.as_deref().unwrap_or(&self.truths));
        let residuals: Vec<Sensitivity> = (self.problem.residuals(&shown).into_iter())
            .map(|residual| Sensitivity {
                residual,
                columns: Vec::new(),
            })
            .collect();
        Ok((self.answered(point, &self.extended(&residuals)).1, simulated))
    }

    fn advance(&self, way: &mut Way, steps: usize) -> Result<(), DiagnoseError> {
        let old = self.fit.point.z.len();
        let parameters = self.problem.parameters(&way.point.effects);
        let ranges: Vec<(f64, f64)> = parameters.iter().map(|p| p.z_range()).collect();
        let prior = DVector::from_iterator(
            parameters.len(),
            parameters.iter().map(|p| f64::from(u8::from(p.prior))),
        );
        for _ in 0..steps {
            if way.done {
                break;
            }
            let (h, g) = sum(&way.normals, &prior, &way.point.z);
            let mut next = None;
            for _ in 0..3 {
                let Some(step) = bounded_step(&h, &g, way.damping, &way.point.z, &ranges) else {
                    way.damping *= 30.0;
                    continue;
                };
                let mut trial = way.point.clone();
                for k in old..trial.z.len() {
                    trial.z[k] = (trial.z[k] + step[k]).clamp(ranges[k].0, ranges[k].1);
                }
                if trial == way.point {
                    break;
                }
                match self.cost_at(&trial) {
                    Ok((cost, truths)) if cost < way.cost => {
                        next = Some((trial, truths));
                        break;
                    }
                    Ok(_) | Err(DiagnoseError::Simulation { .. }) => way.damping *= 30.0,
                    Err(stop) => return Err(stop),
                }
            }
            let Some((trial, truths)) = next else {
                way.done = true;
                break;
            };
            let there = self.at(trial, truths.as_deref())?;
            let done = way.cost - there.cost < 1e-3 * there.cost;
            let damping = (way.damping * 0.1).max(1e-9);
            *way = Way { damping, done, ..there };
        }
        Ok(())
    }

    /// What the model's own parameters answer to the candidate, and the cost then.
    fn answered(&self, point: &Point, normals: &[Normal]) -> (DVector<f64>, f64) {
        let old = self.fit.point.z.len();
        let z = &self.fit.point.z;
        let prior = &self.fit.prior;
        let (mut h, mut g) = (DMatrix::zeros(old, old), DVector::zeros(old));
        for n in normals {
            h += n.h.view((0, 0), (old, old));
            g += n.g.rows(0, old);
        }
        for k in 0..old {
            h[(k, k)] += prior[k];
            g[k] -= prior[k] * z[k];
        }
        let answer = bounded_step(&h, &g, 1e-9, z, &self.fit.ranges).unwrap_or_else(|| DVector::zeros(old));
        let raw: f64 = normals.iter().map(|n| n.cost).sum::<f64>() + self.problem.prior_cost(point);
        let cost = raw - 2.0 * g.dot(&answer) + answer.dot(&(&h * &answer));
        (answer, cost)
    }

    /// A way's end as a fit: the answer is carried out in the linear picture.
    fn finish(&self, way: Way) -> Fit {
        let old = self.fit.point.z.len();
        let parameters = self.problem.parameters(&way.point.effects);
        let ranges = parameters.iter().map(|p| p.z_range()).collect();
        let prior = DVector::from_iterator(
            parameters.len(),
            parameters.iter().map(|p| f64::from(u8::from(p.prior))),
        );
        let mut point = way.point;
        (0..old).for_each(|k| point.z[k] += way.answer[k]);
        let mut step = DVector::zeros(point.z.len());
        step.rows_mut(0, old).copy_from(&way.answer);
        let normals = way
            .normals
            .into_iter()
            .map(|n| {
                let moved = &n.h * &step;
                let cost = (n.cost - 2.0 * n.g.dot(&step) + step.dot(&moved)).max(0.0);
                Normal {
                    g: n.g - moved,
                    cost,
                    ..n
                }
            })
            .collect();
        Fit {
            point,
            normals,
            prior,
            cost: way.cost,
            ranges,
            sensitivity: None,
            screened: true,
            judged: Arc::default(),
        }
    }

    /// Normal equations of the frozen columns and the new ones together.
    fn extended(&self, new: &[Sensitivity]) -> Vec<Normal> {
        let old = self.fit.point.z.len();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        (self.problem.blocks.iter().zip(&self.fit.normals))
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
