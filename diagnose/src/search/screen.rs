//! A quick, fair look at every candidate: what could it explain beside the model so far?
//!
//! The model so far stays simulated where it is; its own parameters respond to the candidate linearly (variable projection,
//! Golub & Pereyra, SIAM J. Numer. Anal. 10(2), 1973, with the nuisance part linearised). So a candidate costs a few
//! simulations, a fault of an instrument none, and none is judged without recalibration.

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::oscillation::{Line, Oscillations};
use super::sizes::starting_sizes;
use crate::error::DiagnoseError;
use crate::estimation::bounded_step::bounded_step;
use crate::estimation::normal_equations::{extended, sum, total_cost};
use crate::estimation::{Fit, LeastSquares, NormalEquations, Point, Sensitivity};
use crate::specimen::{Series, Specimen};
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
const RESPONSE_DAMPING: f64 = 1e-9;
/// A candidate has arrived when a step gains less than this fraction of the cost.
const TOLERANCE: f64 = 1e-3;

/// The model so far with everything that screening reuses.
pub struct Screen<'p, 'a> {
    problem: &'p LeastSquares<'a>,
    fit: &'p Fit,
    base: Arc<Vec<Sensitivity>>,
    truths: Vec<Series>,
}

/// What the residual of the model so far holds at single frequencies.
struct Swings {
    oscillations: Oscillations,
    lines: Vec<Line>,
}

/// A candidate on its way to its best values.
struct ScreenedCandidate {
    /// The model so far with the candidate.
    point: Point,
    /// Normal equations of the model's coordinates and the candidate's.
    normals: Vec<NormalEquations>,
    /// The step that the model's own coordinates make in response.
    response: DVector<f64>,
    /// Cost with the response.
    cost: f64,
    damping: f64,
    arrived: bool,
}

impl<'p, 'a> Screen<'p, 'a> {
    /// Prepares screening beside a fitted model.
    ///
    /// # Errors
    /// As [`crate::estimation::Evaluation::truths`].
    pub fn new(problem: &'p LeastSquares<'a>, fit: &'p Fit) -> Result<Self, DiagnoseError> {
        let truths = problem.evaluation.truths(&fit.point)?;
        let base = if let Some(kept) = &fit.sensitivities {
            Arc::clone(kept)
        } else {
            let all: Vec<usize> = (0..fit.point.z.len()).collect();
            Arc::new(problem.evaluation.sensitivities(&fit.point, &all, Some(&truths))?)
        };
        Ok(Self {
            problem,
            fit,
            base,
            truths,
        })
    }

    fn specimen(&self) -> &'a dyn Specimen {
        self.problem.specimen()
    }

    /// Every candidate added alone, in the order given; `None` where it cannot be simulated at all.
    ///
    /// # Errors
    /// [`DiagnoseError::Interrupted`] once the caller asked to stop.
    pub fn all(&self, candidates: &[usize]) -> Result<Vec<Option<Fit>>, DiagnoseError> {
        let screening = &self.problem.criteria.screening;
        let all = self.specimen().candidates();
        let swings = (candidates.iter().any(|&c| all[c].oscillates)).then(|| self.swings());
        let first: Vec<Option<ScreenedCandidate>> = candidates
            .par_iter()
            .map(|&c| match &swings {
                Some(swings) if all[c].oscillates => self.begin_oscillation(c, swings),
                _ => self.begin(c),
            })
            .collect::<Result<_, DiagnoseError>>()?;
        let cost = |k: usize| first[k].as_ref().map_or(f64::INFINITY, |s| s.cost);
        let mut order: Vec<usize> = (0..first.len()).filter(|&k| first[k].is_some()).collect();
        order.sort_by(|&a, &b| cost(a).total_cmp(&cost(b)));
        order.truncate(screening.promising);
        (first.into_par_iter().enumerate())
            .map(|(k, begun)| {
                let Some(mut candidate) = begun else { return Ok(None) };
                if order.contains(&k) {
                    self.advance(&mut candidate, screening.more_steps)?;
                }
                Ok(Some(self.finish(candidate)))
            })
            .collect()
    }

    /// A candidate after its first steps from the best of its starts.
    fn begin(&self, candidate: usize) -> Result<Option<ScreenedCandidate>, DiagnoseError> {
        let description = &self.specimen().candidates()[candidate];
        let own: Vec<f64> = description.parameters.iter().map(|p| p.start).collect();
        let mut best: Option<ScreenedCandidate> = None;
        let starts: Vec<&Vec<f64>> = std::iter::once(&own).chain(&description.starts).collect();
        for start in &starts {
            let known = description.absent_at(start).then_some(self.truths.as_slice());
            self.begin_at(candidate, start, known, &mut best)?;
        }
        if description.is_unlisted() || description.is_instrument_fault() || !self.is_gross() {
            return Ok(best);
        }
        let screening = &self.problem.criteria.screening;
        let mut sizes = Vec::new();
        for start in starts {
            for direction in starting_sizes(description, start) {
                sizes.extend(self.costs_of(candidate, direction)?);
            }
        }
        sizes.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (cost, values) in sizes.into_iter().take(screening.sizes_refined) {
            let reached = best.as_ref().map_or(f64::INFINITY, |b| b.cost);
            if cost < self.fit.cost && cost < screening.size_contender * reached {
                self.begin_at(candidate, &values, None, &mut best)?;
            }
        }
        Ok(best)
    }

    fn swings(&self) -> Swings {
        let oscillations = Oscillations::of(self.specimen());
        let lines = oscillations.lines_of_channels(&self.residuals());
        Swings { oscillations, lines }
    }

    fn residuals(&self) -> Vec<&Series> {
        self.base.iter().map(|recording| &recording.residual).collect()
    }

    /// A law that swings after its first steps from the frequency that explains most; `None` where the residual holds no frequency that is not
    /// the excitation's.
    fn begin_oscillation(&self, candidate: usize, swings: &Swings) -> Result<Option<ScreenedCandidate>, DiagnoseError> {
        let specimen = self.specimen();
        let amplitude = self.fit.point.z.len();
        let numbers = &specimen.candidates()[candidate].parameters;
        let answers = |values: [f64; 3]| -> Result<Vec<Sensitivity>, DiagnoseError> {
            let point = self.fit.point.with_effect(specimen, candidate, &values);
            // Of amplitude zero. A law that swings shortens the steps of the simulation, so that also the truth is simulated with it.
            let known = numbers[0].instrument_only.then_some(self.truths.as_slice());
            self.problem.evaluation.sensitivities(&point, &[amplitude], known)
        };
        let lowest = numbers[2].lower;
        let envelopes: Vec<Series> = (answers([0.0, FRAC_PI_2, lowest])?.into_iter())
            .map(|mut s| s.columns.swap_remove(0))
            .collect();
        let mut lines = swings.oscillations.lines(&self.residuals(), &envelopes);
        lines.extend(&swings.lines);
        let mut best: Option<(f64, Vec<f64>)> = None;
        for line in lines {
            let f = line.frequency_hz;
            let (sine, cosine) = (answers([0.0, 0.0, f])?, answers([0.0, FRAC_PI_2, f])?);
            let both: Vec<Sensitivity> = (sine.into_iter().zip(cosine))
                .map(|(mut sine, cosine)| {
                    sine.columns.extend(cosine.columns);
                    sine
                })
                .collect();
            let normals = self.extended(&both);
            let [prior, z] = [&self.fit.prior, &DVector::from_column_slice(&self.fit.point.z)]
                .map(|own| own.clone().resize_vertically(amplitude + 2, 0.0));
            let (h, g) = sum(&normals, &prior, z.as_slice());
            let mut ranges = self.fit.point.ranges(specimen);
            ranges.resize(amplitude + 2, (f64::NEG_INFINITY, f64::INFINITY));
            let Some(step) = bounded_step(&h, &g, RESPONSE_DAMPING, z.as_slice(), &ranges) else {
                continue;
            };
            let gain = 2.0 * g.dot(&step) - step.dot(&(&h * &step));
            if best.as_ref().is_none_or(|(most, _)| gain > *most) {
                let (a, b) = (step[amplitude], step[amplitude + 1]);
                let size = numbers[0].value(libm::hypot(a, b));
                best = Some((gain, vec![size, libm::atan2(b, a), f]));
            }
        }
        let mut begun = None;
        if let Some((_, start)) = best {
            self.begin_at(candidate, &start, None, &mut begun)?;
        }
        Ok(begun)
    }

    /// The first steps of a candidate from a start, kept if they lead lower than `best`. A start that cannot be simulated is
    /// passed over.
    fn begin_at(
        &self,
        candidate: usize,
        start: &[f64],
        known: Option<&[Series]>,
        best: &mut Option<ScreenedCandidate>,
    ) -> Result<(), DiagnoseError> {
        let point = self.fit.point.with_effect(self.specimen(), candidate, start);
        let begun = self.at(point, known).and_then(|mut begun| {
            self.advance(&mut begun, self.problem.criteria.screening.first_steps)?;
            Ok(begun)
        });
        match begun {
            Ok(begun) if best.as_ref().is_none_or(|b| begun.cost < b.cost) => *best = Some(begun),
            Ok(_) | Err(DiagnoseError::Simulation { .. }) => {}
            Err(other) => return Err(other),
        }
        Ok(())
    }

    /// True if the model so far is so far off that a derivative at size zero may not show where an effect is.
    fn is_gross(&self) -> bool {
        let ratio = self.problem.criteria.screening.gross_noise_ratio;
        total_cost(&self.fit.normals) > ratio * ratio * self.problem.residuals() as f64
    }

    /// Sizes of a candidate, the smallest first, with the cost of each, up to the first that is too large.
    fn costs_of(&self, candidate: usize, sizes: Vec<Vec<f64>>) -> Result<Vec<(f64, Vec<f64>)>, DiagnoseError> {
        let mut costs = Vec::new();
        // One a decade is enough to step on from.
        for values in sizes.into_iter().step_by(2) {
            let point = self.fit.point.with_effect(self.specimen(), candidate, &values);
            match self.cost_at(&point) {
                Ok((cost, _)) if cost < self.problem.criteria.screening.size_overshoot * self.fit.cost => {
                    costs.push((cost, values));
                }
                Ok(_) | Err(DiagnoseError::Simulation { .. }) => break,
                Err(other) => return Err(other),
            }
        }
        Ok(costs)
    }

    /// True quantities at a point that differs from the model so far by a candidate only; `None` where they are those of the
    /// model. The fault of an instrument leaves the physics alone, but for the displacement, which is an input.
    fn truths_at(&self, point: &Point) -> Result<Option<Vec<Series>>, DiagnoseError> {
        let leaves_physics_alone = point.effects.last().is_some_and(|&c| {
            let candidate = &self.specimen().candidates()[c];
            candidate.is_instrument_fault()
                && candidate.place.sensor() != Some(&Column::DISPLACEMENT)
                && candidate.parameters.iter().all(|p| p.instrument_only)
        });
        if leaves_physics_alone {
            Ok(None)
        } else {
            self.problem.evaluation.truths(point).map(Some)
        }
    }

    /// A candidate at a point; its true quantities may be given where they are known.
    fn at(&self, point: Point, known: Option<&[Series]>) -> Result<ScreenedCandidate, DiagnoseError> {
        let simulated = if known.is_some() { None } else { self.truths_at(&point)? };
        let truths = known.or(simulated.as_deref()).unwrap_or(&self.truths);
        let new: Vec<usize> = (self.fit.point.z.len()..point.z.len()).collect();
        let added = self.problem.evaluation.sensitivities(&point, &new, Some(truths))?;
        let normals = self.extended(&added);
        let (response, cost) = self.response(&point, &normals);
        Ok(ScreenedCandidate {
            point,
            normals,
            response,
            cost,
            damping: DAMPING.0,
            arrived: new.is_empty(),
        })
    }

    /// The cost at a point, and the true quantities for going on from it.
    fn cost_at(&self, point: &Point) -> Result<(f64, Option<Vec<Series>>), DiagnoseError> {
        let simulated = self.truths_at(point)?;
        let evaluation = &self.problem.evaluation;
        let shown = evaluation.observed(point, simulated.as_deref().unwrap_or(&self.truths));
        let residuals: Vec<Sensitivity> = (evaluation.residuals(&shown).into_iter())
            .map(|residual| Sensitivity {
                residual,
                columns: Vec::new(),
            })
            .collect();
        Ok((self.response(point, &self.extended(&residuals)).1, simulated))
    }

    /// Takes a candidate some steps further; only its own coordinates move.
    fn advance(&self, candidate: &mut ScreenedCandidate, steps: usize) -> Result<(), DiagnoseError> {
        let old = self.fit.point.z.len();
        let ranges = candidate.point.ranges(self.specimen());
        let prior = candidate.point.prior(self.specimen());
        for _ in 0..steps {
            if candidate.arrived {
                break;
            }
            let (h, g) = sum(&candidate.normals, &prior, &candidate.point.z);
            let mut next = None;
            for _ in 0..DAMPINGS_TRIED {
                let z = &candidate.point.z;
                let Some(step) = bounded_step(&h, &g, candidate.damping, z, &ranges) else {
                    candidate.damping *= DAMPING_UP;
                    continue;
                };
                let mut trial = candidate.point.clone();
                for k in old..trial.z.len() {
                    trial.z[k] = (trial.z[k] + step[k]).clamp(ranges[k].0, ranges[k].1);
                }
                if trial == candidate.point {
                    break;
                }
                match self.cost_at(&trial) {
                    Ok((cost, truths)) if cost < candidate.cost => {
                        next = Some((trial, truths));
                        break;
                    }
                    Ok(_) | Err(DiagnoseError::Simulation { .. }) => candidate.damping *= DAMPING_UP,
                    Err(other) => return Err(other),
                }
            }
            let Some((trial, truths)) = next else {
                candidate.arrived = true;
                break;
            };
            let there = self.at(trial, truths.as_deref())?;
            *candidate = ScreenedCandidate {
                arrived: candidate.cost - there.cost < TOLERANCE * there.cost,
                damping: (candidate.damping * DAMPING_DOWN).max(DAMPING.1),
                ..there
            };
        }
        Ok(())
    }

    /// The step that the model's own coordinates make in response to the candidate, and the cost then.
    fn response(&self, point: &Point, normals: &[NormalEquations]) -> (DVector<f64>, f64) {
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

    /// The candidate as a fit: the response is carried out in the linear approximation.
    fn finish(&self, candidate: ScreenedCandidate) -> Fit {
        let old = self.fit.point.z.len();
        let (ranges, prior) = (
            candidate.point.ranges(self.specimen()),
            candidate.point.prior(self.specimen()),
        );
        let mut point = candidate.point;
        (0..old).for_each(|k| point.z[k] += candidate.response[k]);
        let mut step = DVector::zeros(point.z.len());
        step.rows_mut(0, old).copy_from(&candidate.response);
        let normals = (candidate.normals.into_iter())
            .map(|n| NormalEquations {
                cost: n.cost_after(&step),
                g: n.g - &n.h * &step,
                h: n.h,
            })
            .collect();
        let mut fit = Fit::new(point, normals, prior, candidate.cost, ranges);
        fit.screened = true;
        fit
    }

    /// Normal equations of the model's coordinates, frozen, and the candidate's together.
    fn extended(&self, added: &[Sensitivity]) -> Vec<NormalEquations> {
        extended(&self.problem.blocks, &self.fit.normals, &self.base, added)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{Analytic, CUBIC, FORTY_SINES, FRAGILE, FRICTION, GAIN, RUN, Recipe, VIBRATION};
    use crate::estimation::fit;
    use std::sync::atomic::AtomicBool;

    fn calibrated<'a>(specimen: &'a Analytic) -> (LeastSquares<'a>, Fit) {
        let problem = LeastSquares::new(specimen, &RUN);
        let fit = fit(&problem, Point::nominal(specimen), problem.criteria.fitting.converged).expect("a fit");
        (problem, fit)
    }

    fn with_cubic() -> Analytic {
        Recipe {
            truth: vec![(CUBIC, vec![0.3])],
            ..Recipe::default()
        }
        .make()
    }

    #[test]
    fn the_right_candidate_has_the_lowest_cost_and_about_its_true_size() {
        let specimen = with_cubic();
        let (problem, calibrated) = calibrated(&specimen);
        let candidates = [FRICTION, CUBIC, VIBRATION, GAIN];
        let fits = Screen::new(&problem, &calibrated)
            .and_then(|s| s.all(&candidates))
            .expect("screened");
        let costs: Vec<f64> = fits.iter().flatten().map(|f| f.cost).collect();
        assert!((0..4).all(|k| k == 1 || costs[1] < 0.5 * costs[k]), "{costs:?}");
        let found = fits[1].as_ref().expect("a fit").point.hypothesis(&specimen);
        assert!((found.effects[0].1[0] - 0.3).abs() < 0.01, "{found:?}");
    }

    /// Where everything is linear, the linear response of the model's own parameters is exact: screening ends where a full
    /// fit ends.
    #[test]
    fn screening_a_linear_candidate_ends_where_the_full_fit_does() {
        let specimen = with_cubic();
        let (problem, calibrated) = calibrated(&specimen);
        let screened = Screen::new(&problem, &calibrated)
            .and_then(|s| s.all(&[CUBIC]))
            .expect("screened");
        let screened = screened[0].as_ref().expect("a fit");
        let start = Point::nominal(&specimen).with_effect(&specimen, CUBIC, &[0.0]);
        let full = fit(&problem, start, problem.criteria.fitting.converged).expect("a fit");
        assert!(screened.screened && !full.screened);
        assert!(
            (screened.cost / full.cost - 1.0).abs() < 1e-4,
            "{} {}",
            screened.cost,
            full.cost
        );
        for (a, b) in screened.point.z.iter().zip(&full.point.z) {
            assert!((a - b).abs() < 0.02, "{:?} {:?}", screened.point, full.point);
        }
    }

    #[test]
    fn the_model_is_recalibrated_while_a_candidate_is_screened() {
        // A gain of 0.4 % is within the tolerance of the stiffness: beside recalibration it explains nearly nothing.
        let specimen = Recipe {
            truth: vec![(GAIN, vec![0.004])],
            ..Recipe::default()
        }
        .make();
        let (problem, calibrated) = calibrated(&specimen);
        let fits = Screen::new(&problem, &calibrated)
            .and_then(|s| s.all(&[GAIN]))
            .expect("screened");
        let gained = calibrated.cost - fits[0].as_ref().expect("a fit").cost;
        assert!((0.0..5.0).contains(&gained), "{gained}");
    }

    #[test]
    fn the_fault_of_an_instrument_costs_no_simulation() {
        let specimen = with_cubic();
        let (problem, calibrated) = calibrated(&specimen);
        let screen = Screen::new(&problem, &calibrated).expect("a screen");
        let before = problem.evaluation.simulated();
        let _ = screen.all(&[GAIN]).expect("screened");
        assert_eq!(problem.evaluation.simulated(), before);
        let _ = screen.all(&[CUBIC]).expect("screened");
        assert!(problem.evaluation.simulated() > before);
    }

    #[test]
    fn a_start_is_tried_beside_the_parameters_own() {
        let recipe = Recipe {
            truth: vec![(VIBRATION, vec![0.08, 2.3])],
            ..Recipe::default()
        };
        let cost = |starts: Vec<Vec<f64>>| {
            let mut specimen = recipe.make();
            specimen.give_starts(VIBRATION, starts);
            let (problem, calibrated) = calibrated(&specimen);
            let fits = Screen::new(&problem, &calibrated)
                .and_then(|s| s.all(&[VIBRATION]))
                .expect("screened");
            fits[0].as_ref().expect("a fit").cost / calibrated.cost
        };
        assert!(
            cost(vec![]) > 0.98,
            "from 1 rad/s the next local minimum is as far as it gets"
        );
        assert!(cost(vec![vec![0.0, 2.28]]) < 0.7);
    }

    #[test]
    fn what_cannot_be_simulated_is_no_candidate_and_no_failure() {
        let mut specimen = with_cubic();
        specimen.move_start(FRAGILE, 2.0);
        let (problem, calibrated) = calibrated(&specimen);
        let fits = Screen::new(&problem, &calibrated)
            .and_then(|s| s.all(&[FRAGILE, CUBIC]))
            .expect("screened");
        assert!(fits[0].is_none() && fits[1].is_some());
    }

    #[test]
    fn it_ends_when_asked_to_stop() {
        let specimen = with_cubic();
        let (_, calibrated) = calibrated(&specimen);
        let stop = AtomicBool::new(true);
        let problem = LeastSquares::new(&specimen, &stop);
        assert!(matches!(
            Screen::new(&problem, &calibrated),
            Err(DiagnoseError::Interrupted)
        ));
    }

    #[test]
    fn order_and_company_change_nothing() {
        let specimen = with_cubic();
        let (problem, calibrated) = calibrated(&specimen);
        let screen = Screen::new(&problem, &calibrated).expect("a screen");
        let bits = |candidates: &[usize], of: usize| {
            let fits = screen.all(candidates).expect("screened");
            fits[of].as_ref().map(|f| f.cost.to_bits())
        };
        assert_eq!(bits(&[CUBIC, FRICTION, FORTY_SINES], 0), bits(&[FRICTION, CUBIC], 1));
    }
}
