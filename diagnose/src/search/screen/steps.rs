//! The steps of candidates beside the model so far: damped Gauss-Newton steps of the own coordinates of each, to which those of the model respond linearly.
//! Several candidates step side by side, each on its own, so that their simulations fill the vectors of the processor.

use std::borrow::Cow;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::beside::{Screen, ScreenedCandidate};
use super::look::Look;
use crate::error::DiagnoseError;
use crate::estimation::bounded_step::bounded_step;
use crate::estimation::normal_equations::{extended, extended_with_residuals, sum, total_cost};
use crate::estimation::{NormalEquations, Point, Sensitivity, Wanted};
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

/// A point from which a candidate goes on.
pub(super) struct Start<'t> {
    /// The model so far with the candidate.
    pub point: Point,
    /// True quantities there in the recordings that are looked at, where they are known.
    pub truths: Option<&'t [Series]>,
}

/// A candidate on its way.
pub(super) struct Moving {
    pub candidate: ScreenedCandidate,
    /// True quantities where it is in the recordings that are looked at; `None` where they are those of the model so far, or not known.
    pub truths: Option<Vec<Series>>,
}

impl From<ScreenedCandidate> for Moving {
    fn from(candidate: ScreenedCandidate) -> Self {
        Self {
            candidate,
            truths: None,
        }
    }
}

/// What a step of a candidate is worked out from.
struct Local {
    h: DMatrix<f64>,
    g: DVector<f64>,
    ranges: Vec<(f64, f64)>,
}

/// A candidate within a step.
struct Stepping<'l> {
    begun: &'l mut Linearised,
    /// `None` once the step has ended.
    local: Option<Local>,
    /// The true quantities at the end of the step, where there was one and they were simulated.
    reached: Result<Option<Vec<Series>>, DiagnoseError>,
}

/// A point that was simulated.
pub(super) struct Tried {
    pub point: Point,
    /// Its cost with the response of the model's own coordinates.
    pub cost: f64,
    /// True quantities for going on from it; `None` where they are those of the model so far.
    pub truths: Option<Vec<Series>>,
    pub residuals: Vec<Series>,
}

impl Screen<'_, '_> {
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

    /// Whether a point that differs from the model so far by a candidate only has the true quantities of the model. The fault of an instrument leaves
    /// the physics alone, but for the displacement, which is an input.
    fn has_physics_of_model(&self, point: &Point) -> bool {
        point.effects.last().is_some_and(|&c| self.leaves_physics_alone(c))
    }

    /// Candidates, each at a point; an error where one cannot be simulated.
    pub(super) fn at_each(&self, look: &Look<'_>, starts: Vec<Start<'_>>) -> Vec<Result<Linearised, DiagnoseError>> {
        let unknown: Vec<Point> = (starts.iter())
            .filter(|start| start.truths.is_none() && !self.has_physics_of_model(&start.point))
            .map(|start| start.point.clone())
            .collect();
        let mut simulated = look.evaluation.truths_at_each(&unknown).into_iter();
        let known: Vec<Result<Cow<'_, [Series]>, DiagnoseError>> = (starts.iter())
            .map(|start| match start.truths {
                Some(truths) => Ok(Cow::Borrowed(truths)),
                None if self.has_physics_of_model(&start.point) => Ok(Cow::Borrowed(look.truths.as_slice())),
                None => simulated
                    .next()
                    .map_or(Err(DiagnoseError::Interrupted), |truths| truths.map(Cow::Owned)),
            })
            .collect();
        let answering: Vec<Vec<usize>> = starts.iter().map(|start| self.answering(&start.point)).collect();
        let wanted: Vec<Wanted<'_>> = (starts.iter().zip(&answering).zip(&known))
            .filter_map(|((start, coordinates), truths)| {
                let (point, truths) = (&start.point, &**truths.as_ref().ok()?);
                Some(Wanted {
                    point,
                    coordinates,
                    truths,
                })
            })
            .collect();
        let mut added = look.evaluation.sensitivities_at_each(&wanted).into_iter();
        let known: Vec<Result<Vec<Sensitivity>, DiagnoseError>> = (known.into_iter())
            .map(|truths| truths.and_then(|_| added.next().unwrap_or(Err(DiagnoseError::Interrupted))))
            .collect();
        (starts.into_par_iter().zip(answering).zip(known))
            .map(|((start, answering), added)| Ok(self.linearised(look, start.point, &answering, added?)))
            .collect()
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

    /// What follows from the simulation of each of several points; an error where a point cannot be simulated.
    pub(super) fn tried_at_each(&self, look: &Look<'_>, points: &[Point]) -> Vec<Result<Tried, DiagnoseError>> {
        let changed: Vec<Point> = (points.iter().filter(|point| !self.has_physics_of_model(point)))
            .cloned()
            .collect();
        let mut simulated = look.evaluation.truths_at_each(&changed).into_iter();
        let truths: Vec<Result<Option<Vec<Series>>, DiagnoseError>> = (points.iter())
            .map(|point| {
                if self.has_physics_of_model(point) {
                    None
                } else {
                    simulated.next()
                }
            })
            .map(Option::transpose)
            .collect();
        (points.par_iter().zip(truths))
            .map(|(point, truths)| Ok(self.tried(look, point, truths?)))
            .collect()
    }

    /// What follows from the simulation of a point: its true quantities are given, or are those of the model so far.
    fn tried(&self, look: &Look<'_>, point: &Point, truths: Option<Vec<Series>>) -> Tried {
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
            point: point.clone(),
            cost,
            truths,
            residuals,
        }
    }

    /// Takes candidates some steps further, each with derivatives of its own; only their own coordinates move.
    pub(super) fn advance(&self, look: &Look<'_>, all: &mut [&mut Result<Moving, DiagnoseError>], steps: usize) {
        for _ in 0..steps {
            let mut moving: Vec<&mut Moving> = all.iter_mut().filter_map(|one| one.as_mut().ok()).collect();
            let mut advanced = self.advance_each(look, &mut moving).into_iter();
            for one in all.iter_mut().filter(|one| one.is_ok()) {
                if let Some(Err(why)) = advanced.next() {
                    **one = Err(why);
                }
            }
        }
    }

    /// Takes candidates a step further, those that have not arrived. One that fails stays where it is.
    pub(super) fn advance_each(&self, look: &Look<'_>, all: &mut [&mut Moving]) -> Vec<Result<(), DiagnoseError>> {
        let starts = (all.iter().filter(|one| !one.candidate.arrived))
            .map(|one| Start {
                point: one.candidate.point.clone(),
                truths: one.truths.as_deref(),
            })
            .collect();
        let mut there = self.at_each(look, starts);
        let moving = all.iter().filter(|one| !one.candidate.arrived);
        for (one, next) in moving.zip(&mut there) {
            if let Ok(next) = next {
                next.candidate.damping = one.candidate.damping;
                next.candidate.further_steps = one.candidate.further_steps;
            }
        }
        let mut stepped = self.stepped(look, there).into_iter();
        (all.iter_mut())
            .map(|one| {
                if !one.candidate.arrived {
                    **one = stepped.next().unwrap_or(Err(DiagnoseError::Interrupted))?;
                }
                Ok(())
            })
            .collect()
    }

    /// Candidates after a step, those that could be simulated.
    pub(super) fn stepped(
        &self,
        look: &Look<'_>,
        mut there: Vec<Result<Linearised, DiagnoseError>>,
    ) -> Vec<Result<Moving, DiagnoseError>> {
        let mut reached = self.step_each(look, there.iter_mut().flatten().collect()).into_iter();
        (there.into_iter())
            .map(|there| {
                Ok(Moving {
                    candidate: there?.candidate,
                    truths: reached.next().unwrap_or(Err(DiagnoseError::Interrupted))?,
                })
            })
            .collect()
    }

    /// One step of each candidate; the true quantities at its end, where there was one and they were simulated. The derivatives stay those of its
    /// beginning: most candidates get no further one.
    fn step_each(
        &self,
        look: &Look<'_>,
        begun: Vec<&mut Linearised>,
    ) -> Vec<Result<Option<Vec<Series>>, DiagnoseError>> {
        let mut stepping: Vec<Stepping<'_>> = (begun.into_iter())
            .map(|begun| Stepping {
                local: (!begun.candidate.arrived).then(|| self.local(&begun.candidate)),
                begun,
                reached: Ok(None),
            })
            .collect();
        for _ in 0..DAMPINGS_TRIED {
            let trials: Vec<Option<Point>> = stepping.iter_mut().map(|one| self.trial(one)).collect();
            let points: Vec<Point> = trials.iter().flatten().cloned().collect();
            let mut tried = self.tried_at_each(look, &points).into_iter();
            let tried: Vec<Option<Result<Tried, DiagnoseError>>> = (trials.into_iter())
                .map(|trial| trial.and_then(|_| tried.next()))
                .collect();
            (stepping.par_iter_mut().zip(tried)).for_each(|(one, tried)| {
                if let Some(tried) = tried {
                    self.conclude(look, one, tried);
                }
            });
        }
        (stepping.into_iter())
            .map(|one| {
                // No damping leads lower.
                one.begun.candidate.arrived |= one.local.is_some();
                one.reached
            })
            .collect()
    }

    /// What a step of a candidate is worked out from.
    fn local(&self, candidate: &ScreenedCandidate) -> Local {
        let prior = candidate.point.prior(self.specimen());
        let (h, g) = sum(&candidate.normals, &prior, &candidate.point.z);
        Local {
            h,
            g,
            ranges: candidate.point.ranges(self.specimen()),
        }
    }

    /// Where a candidate's damping leads; `None` where nothing is to be simulated.
    fn trial(&self, one: &mut Stepping<'_>) -> Option<Point> {
        let Local { h, g, ranges } = one.local.as_ref()?;
        let (old, candidate) = (self.fit.point.z.len(), &mut one.begun.candidate);
        let Some(step) = bounded_step(h, g, candidate.damping, &candidate.point.z, ranges) else {
            candidate.damping *= DAMPING_UP;
            return None;
        };
        let mut trial = candidate.point.clone();
        for k in old..trial.z.len() {
            trial.z[k] = (trial.z[k] + step[k]).clamp(ranges[k].0, ranges[k].1);
        }
        // What gains nothing even where everything is linear is not simulated.
        let gain = 2.0 * g.dot(&step) - step.dot(&(h * &step));
        if gain < TOLERANCE * candidate.cost || trial == candidate.point {
            candidate.arrived = true;
            one.local = None;
            return None;
        }
        Some(trial)
    }

    /// Ends the step of a candidate where the simulation of its trial led lower; raises its damping where it did not.
    fn conclude(&self, look: &Look<'_>, one: &mut Stepping<'_>, tried: Result<Tried, DiagnoseError>) {
        match tried {
            Ok(tried) if tried.cost < one.begun.candidate.cost => {
                one.reached = Ok(self.accept(look, one.begun, tried));
                one.local = None;
            }
            Ok(_) | Err(DiagnoseError::Simulation { .. }) => one.begun.candidate.damping *= DAMPING_UP,
            Err(other) => {
                one.reached = Err(other);
                one.local = None;
            }
        }
    }

    /// Takes a candidate to where it has been simulated; the true quantities there, where they were.
    fn accept(&self, look: &Look<'_>, begun: &mut Linearised, tried: Tried) -> Option<Vec<Series>> {
        for (s, residual) in begun.added.iter_mut().zip(tried.residuals) {
            s.residual = residual;
        }
        let (blocks, base, added) = (&self.problem.blocks, &self.base, self.by_recording(look, &begun.added));
        let candidate = &mut begun.candidate;
        candidate.normals = extended_with_residuals(blocks, &candidate.normals, base, &self.answering, &added);
        (candidate.response, _) = self.response(&tried.point, &candidate.normals);
        candidate.arrived = candidate.cost - tried.cost < TOLERANCE * tried.cost;
        candidate.damping = (candidate.damping * DAMPING_DOWN).max(DAMPING.1);
        (candidate.point, candidate.cost) = (tried.point, tried.cost);
        tried.truths
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
