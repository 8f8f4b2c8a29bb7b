//! The steps of a candidate beside the model so far: damped Gauss-Newton steps of its own coordinates, to which those of the model respond linearly.

use nalgebra::{DMatrix, DVector};

use super::beside::{Screen, ScreenedCandidate};
use super::look::Look;
use crate::error::DiagnoseError;
use crate::estimation::bounded_step::bounded_step;
use crate::estimation::normal_equations::{extended, extended_with_residuals, sum, total_cost};
use crate::estimation::{NormalEquations, Point, Sensitivity};
use crate::specimen::Series;
use crate::vocabulary::Column;

/// Damping of the first step, and the smallest.
const DAMPING: (f64, f64) = (1e-3, 1e-9);
/// A step that fails raises the damping by this factor ...
const DAMPING_UP: f64 = 30.0;
/// ... and one that succeeds changes it by this one.
const DAMPING_DOWN: f64 = 0.1;
/// Dampings tried for one step.
const DAMPINGS_TRIED: usize = 3;
/// Damping of the model's response, against rounding only.
pub(super) const RESPONSE_DAMPING: f64 = 1e-9;
/// A candidate has arrived when a step gains less than this fraction of the cost.
const TOLERANCE: f64 = 1e-3;

/// A candidate with the derivatives from which it can step on.
pub(super) struct Linearised {
    pub candidate: ScreenedCandidate,
    /// Residuals and derivatives with respect to the candidate's coordinates, of the recordings that are looked at.
    added: Vec<Sensitivity>,
}

/// A point that was simulated.
pub(super) struct Tried {
    /// Its cost with the response of the model's own coordinates.
    pub cost: f64,
    /// True quantities for going on from it; `None` where they are those of the model so far.
    pub truths: Option<Vec<Series>>,
    pub residuals: Vec<Series>,
}

impl Screen<'_, '_> {
    /// True quantities at a point that differs from the model so far by a candidate only; `None` where they are those of the
    /// model. The fault of an instrument leaves the physics alone, but for the displacement, which is an input.
    pub(super) fn truths_at(&self, look: &Look<'_>, point: &Point) -> Result<Option<Vec<Series>>, DiagnoseError> {
        if point.effects.last().is_some_and(|&c| self.leaves_physics_alone(c)) {
            Ok(None)
        } else {
            look.evaluation.truths(point).map(Some)
        }
    }

    /// True for a candidate that only changes what instruments show of given quantities.
    pub(super) fn leaves_physics_alone(&self, candidate: usize) -> bool {
        let specimen = self.specimen();
        let candidate = &specimen.candidates()[candidate];
        let sensor = candidate.place.sensor();
        // A fault without a number, which nothing says this of, is one of the instrument alone where its column is compared and no input.
        let is_compared = || {
            specimen
                .channels()
                .iter()
                .any(|channel| sensor == Some(&channel.column))
        };
        (candidate.is_instrument_fault() || candidate.is_unlisted())
            && sensor != Some(&Column::DISPLACEMENT)
            && candidate.parameters.iter().all(|p| p.instrument_only)
            && (!candidate.parameters.is_empty() || is_compared())
    }

    /// A candidate at a point; its true quantities in the recordings that are looked at may be given where they are known.
    pub(super) fn at(
        &self,
        look: &Look<'_>,
        point: Point,
        known: Option<&[Series]>,
    ) -> Result<Linearised, DiagnoseError> {
        let simulated = if known.is_some() {
            None
        } else {
            self.truths_at(look, &point)?
        };
        let truths = known.or(simulated.as_deref()).unwrap_or(&look.truths);
        let answering = self.answering(&point);
        let added = look.evaluation.sensitivities(&point, &answering, Some(truths))?;
        Ok(self.linearised(look, point, &answering, added))
    }

    /// A candidate at several points where the true quantities are those of the model so far.
    pub(super) fn at_each(&self, look: &Look<'_>, points: Vec<Point>) -> Result<Vec<Linearised>, DiagnoseError> {
        let answering: Vec<Vec<usize>> = points.iter().map(|point| self.answering(point)).collect();
        let asked: Vec<(&Point, &[usize])> = points.iter().zip(answering.iter().map(Vec::as_slice)).collect();
        let added = look.evaluation.sensitivities_at_each(&asked, &look.truths)?;
        Ok((points.into_iter().zip(&answering).zip(added))
            .map(|((point, answering), added)| self.linearised(look, point, answering, added))
            .collect())
    }

    /// A candidate at a point with the derivatives along those of its coordinates that answer there.
    fn linearised(
        &self,
        look: &Look<'_>,
        point: Point,
        answering: &[usize],
        mut added: Vec<Sensitivity>,
    ) -> Linearised {
        let new = self.fit.point.z.len()..point.z.len();
        for s in &mut added {
            for k in new.clone().filter(|k| !answering.contains(k)) {
                let nothing: Series = s.residual.iter().map(|channel| vec![0.0; channel.len()]).collect();
                s.columns.insert(k - new.start, nothing);
            }
        }
        let normals = self.extended(look, &added);
        let (response, cost) = self.response(&point, &normals);
        let candidate = ScreenedCandidate {
            point,
            normals,
            response,
            cost,
            damping: DAMPING.0,
            arrived: new.is_empty(),
            partly: look.truths.len() < self.all.truths.len(),
            further_steps: 0,
        };
        Linearised { candidate, added }
    }

    /// Coordinates of the candidate that change something at a point.
    fn answering(&self, point: &Point) -> Vec<usize> {
        let new = self.fit.point.z.len()..point.z.len();
        new.filter(|&k| self.answers(point, k)).collect()
    }

    /// False for a coordinate of the candidate that changes nothing at a point: a number besides the sizes, while these are zero.
    fn answers(&self, point: &Point, coordinate: usize) -> bool {
        let specimen = self.specimen();
        let Some((candidate, values)) = point.hypothesis(specimen).effects.pop() else {
            return true;
        };
        let candidate = &specimen.candidates()[candidate];
        let own = coordinate - self.fit.point.z.len();
        candidate.parameters[own].is_size || !candidate.absent_at(&values)
    }

    /// What follows from the simulation of each of several points with the same candidate; an error where a point cannot be simulated.
    pub(super) fn tried_at_each(&self, look: &Look<'_>, points: &[Point]) -> Vec<Result<Tried, DiagnoseError>> {
        let candidate = points.first().and_then(|point| point.effects.last());
        if candidate.is_some_and(|&c| self.leaves_physics_alone(c)) {
            return points.iter().map(|point| Ok(self.tried(look, point, None))).collect();
        }
        (look.evaluation.truths_at_each(points).into_iter().zip(points))
            .map(|(truths, point)| truths.map(|truths| self.tried(look, point, Some(truths))))
            .collect()
    }

    /// The cost at a point, and what follows from its simulation.
    pub(super) fn cost_at(&self, look: &Look<'_>, point: &Point) -> Result<Tried, DiagnoseError> {
        let truths = self.truths_at(look, point)?;
        Ok(self.tried(look, point, truths))
    }

    /// What follows from the simulation of a point: its true quantities are given, or are those of the model so far.
    pub(super) fn tried(&self, look: &Look<'_>, point: &Point, truths: Option<Vec<Series>>) -> Tried {
        let evaluation = &look.evaluation;
        let shown = evaluation.observed(point, truths.as_deref().unwrap_or(&look.truths));
        let residuals: Vec<Sensitivity> = (evaluation.residuals(&shown).into_iter())
            .map(|residual| Sensitivity {
                residual,
                columns: Vec::new(),
            })
            .collect();
        let cost = self.response(point, &self.extended(look, &residuals)).1;
        let residuals = residuals.into_iter().map(|s| s.residual).collect();
        Tried {
            cost,
            truths,
            residuals,
        }
    }

    /// Takes a candidate some steps further, each with derivatives of its own; only its own coordinates move.
    pub(super) fn advance(
        &self,
        look: &Look<'_>,
        candidate: &mut ScreenedCandidate,
        steps: usize,
    ) -> Result<(), DiagnoseError> {
        let mut truths = None;
        for _ in 0..steps {
            self.advance_once(look, candidate, &mut truths)?;
        }
        Ok(())
    }

    /// Takes a candidate a step further, unless it has arrived. The true quantities where it is may be given; after it they are those at its end.
    pub(super) fn advance_once(
        &self,
        look: &Look<'_>,
        candidate: &mut ScreenedCandidate,
        truths: &mut Option<Vec<Series>>,
    ) -> Result<(), DiagnoseError> {
        if candidate.arrived {
            return Ok(());
        }
        let there = self.at(look, candidate.point.clone(), truths.as_deref())?;
        let mut next = Linearised {
            candidate: ScreenedCandidate {
                damping: candidate.damping,
                further_steps: candidate.further_steps,
                ..there.candidate
            },
            added: there.added,
        };
        *truths = self.step(look, &mut next)?;
        *candidate = next.candidate;
        Ok(())
    }

    /// One step of a candidate; the true quantities at its end, where there was one and they were simulated. The derivatives stay those of its
    /// beginning: most candidates get no further one.
    pub(super) fn step(&self, look: &Look<'_>, begun: &mut Linearised) -> Result<Option<Vec<Series>>, DiagnoseError> {
        let candidate = &mut begun.candidate;
        if candidate.arrived {
            return Ok(None);
        }
        let old = self.fit.point.z.len();
        let ranges = candidate.point.ranges(self.specimen());
        let prior = candidate.point.prior(self.specimen());
        let (h, g) = sum(&candidate.normals, &prior, &candidate.point.z);
        let least = TOLERANCE * candidate.cost;
        for _ in 0..DAMPINGS_TRIED {
            let z = &candidate.point.z;
            let Some(step) = bounded_step(&h, &g, candidate.damping, z, &ranges) else {
                candidate.damping *= DAMPING_UP;
                continue;
            };
            // What gains nothing even where everything is linear is not simulated.
            if 2.0 * g.dot(&step) - step.dot(&(&h * &step)) < least {
                break;
            }
            let mut trial = candidate.point.clone();
            for k in old..trial.z.len() {
                trial.z[k] = (trial.z[k] + step[k]).clamp(ranges[k].0, ranges[k].1);
            }
            if trial == candidate.point {
                break;
            }
            match self.cost_at(look, &trial) {
                Ok(tried) if tried.cost < candidate.cost => {
                    for (s, residual) in begun.added.iter_mut().zip(tried.residuals) {
                        s.residual = residual;
                    }
                    let (blocks, base, added) =
                        (&self.problem.blocks, &self.base, self.by_recording(look, &begun.added));
                    candidate.normals =
                        extended_with_residuals(blocks, &candidate.normals, base, &self.answering, &added);
                    (candidate.response, _) = self.response(&trial, &candidate.normals);
                    candidate.arrived = candidate.cost - tried.cost < TOLERANCE * tried.cost;
                    candidate.damping = (candidate.damping * DAMPING_DOWN).max(DAMPING.1);
                    (candidate.point, candidate.cost) = (trial, tried.cost);
                    return Ok(tried.truths);
                }
                Ok(_) | Err(DiagnoseError::Simulation { .. }) => candidate.damping *= DAMPING_UP,
                Err(other) => return Err(other),
            }
        }
        candidate.arrived = true;
        Ok(None)
    }

    /// Cost that a step would leave if everything were linear, as far as the ranges allow.
    pub(super) fn left_by_linear_step(&self, candidate: &ScreenedCandidate) -> f64 {
        let (point, specimen) = (&candidate.point, self.specimen());
        let (h, g) = sum(&candidate.normals, &point.prior(specimen), &point.z);
        let Some(step) = bounded_step(&h, &g, candidate.damping, &point.z, &point.ranges(specimen)) else {
            return candidate.cost;
        };
        let raw = total_cost(&candidate.normals) + point.prior_cost(specimen);
        raw - 2.0 * g.dot(&step) + step.dot(&(&h * &step))
    }

    /// The step that the model's own coordinates make in response to the candidate, and the cost then.
    pub(super) fn response(&self, point: &Point, normals: &[NormalEquations]) -> (DVector<f64>, f64) {
        let old = self.fit.point.z.len();
        let (z, prior) = (&self.fit.point.z, &self.fit.prior);
        let (mut h, mut g) = (DMatrix::zeros(old, old), DVector::zeros(old));
        for n in normals {
            h += n.h.view((0, 0), (old, old));
            g += n.g.rows(0, old);
        }
        for k in 0..old {
            h[(k, k)] += prior[k];
            g[k] -= prior[k] * z[k];
        }
        // The candidate may free a value of the model from its tolerance.
        let ranges = &point.ranges(self.specimen())[..old];
        let response = bounded_step(&h, &g, RESPONSE_DAMPING, z, ranges).unwrap_or_else(|| DVector::zeros(old));
        let raw = total_cost(normals) + point.prior_cost(self.specimen());
        let cost = raw - 2.0 * g.dot(&response) + response.dot(&(&h * &response));
        (response, cost)
    }

    /// What is known of each recording; `None` where it was not looked at.
    fn by_recording<'s>(&self, look: &Look<'_>, added: &'s [Sensitivity]) -> Vec<Option<&'s Sensitivity>> {
        let mut all = vec![None; self.base.len()];
        for (&r, s) in look.evaluation.recordings().iter().zip(added) {
            all[r] = Some(s);
        }
        all
    }

    /// Normal equations of the model's coordinates, frozen, and the candidate's together.
    pub(super) fn extended(&self, look: &Look<'_>, added: &[Sensitivity]) -> Vec<NormalEquations> {
        extended(
            &self.problem.blocks,
            &self.fit.normals,
            &self.base,
            &self.answering,
            &self.by_recording(look, added),
        )
    }
}
