//! Least squares by damped Gauss-Newton steps on the normal equations of the blocks.
//!
//! The published Levenberg-Marquardt crate wants one dense Jacobian; ten recordings of five channels and twenty-five
//! parameters would be re-laid-out for it at every step, and the sums over blocks that held-out figures and intervals are
//! made of would have to be formed again. The step itself is Marquardt's (J. SIAM 11(2), 1963), with bounds.

use std::sync::Arc;

use super::bounded_step::bounded_step;
use super::evaluation::Sensitivity;
use super::fit::Fit;
use super::least_squares::LeastSquares;
use super::normal_equations::{assemble, sum, total_cost, with_residuals};
use super::point::Point;
use crate::criteria::Effort;
use crate::error::DiagnoseError;
use crate::specimen::Series;

/// Steps with one Jacobian: a step costs one simulation, a Jacobian one for each parameter.
const STEPS_PER_JACOBIAN: usize = 4;
/// Dampings tried for the first step with a new Jacobian, and for each later one.
const DAMPINGS_TRIED: (usize, usize) = (6, 2);
/// Damping of the first step, and the smallest.
const DAMPING: (f64, f64) = (1e-4, 1e-9);
/// A step that fails raises the damping by this factor ...
const DAMPING_UP: f64 = 10.0;
/// ... and one that succeeds changes it by this one (Marquardt's).
const DAMPING_DOWN: f64 = 0.1;
/// The fit has converged when all steps with one Jacobian together gain less than this many times the tolerance.
const TOLERANCES_PER_JACOBIAN: f64 = 3.0;

/// Fits all parameters of a model from a starting point.
///
/// ```no_run
/// use std::sync::atomic::AtomicBool;
/// use oleo_diagnose::Campaign;
/// use oleo_diagnose::estimation::{LeastSquares, Point, fit};
///
/// let campaign = Campaign::open("recordings/strut-7".as_ref())?;
/// let stop = AtomicBool::new(false);
/// let problem = LeastSquares::new(&*campaign.specimen, &stop);
/// let start = Point::nominal(problem.specimen());
/// let calibrated = fit(&problem, start, problem.criteria.fitting.converged)?;
/// println!("cost {} of {} residuals", calibrated.cost, problem.residuals());
/// # Ok::<(), oleo_diagnose::DiagnoseError>(())
/// ```
///
/// # Errors
/// A start that cannot be simulated; [`DiagnoseError::Interrupted`] once the caller asked to stop. A step to where the model
/// cannot be simulated is only shortened.
pub fn fit(problem: &LeastSquares<'_>, start: Point, effort: Effort) -> Result<Fit, DiagnoseError> {
    fit_from(problem, Start::at(problem, start)?, effort)
}

/// A fit that goes on where another one ended. Where that one had converged by its own measure, the derivatives of its last steps serve on, and what was gained
/// with them counts, so that both together end where one fit would have ended.
///
/// # Errors
/// As [`fit()`].
pub fn carried_on(problem: &LeastSquares<'_>, from: Fit, effort: Effort) -> Result<Fit, DiagnoseError> {
    if !from.converged {
        return fit(problem, from.point, effort);
    }
    let gained = from.gained;
    let start = Start::of(problem, from)?;
    fit_from(problem, Start { gained, ..start }, effort)
}

/// A point with residuals and derivatives, from which a model may be fitted to more than one choice of blocks. It is large.
#[derive(Clone)]
pub struct Start {
    point: Point,
    sensitivities: Vec<Sensitivity>,
    /// By how much steps with these derivatives have lowered the cost already.
    gained: f64,
    /// Coordinates that keep their value.
    held: Vec<usize>,
}

impl Start {
    /// A point, moved into its ranges.
    ///
    /// # Errors
    /// As [`fit`].
    pub fn at(problem: &LeastSquares<'_>, point: Point) -> Result<Self, DiagnoseError> {
        let mut point = point;
        let ranges = point.ranges(problem.specimen());
        for (z, range) in point.z.iter_mut().zip(ranges) {
            *z = z.clamp(range.0, range.1);
        }
        let all: Vec<usize> = (0..point.z.len()).collect();
        let sensitivities = problem.evaluation.sensitivities(&point, &all, None)?;
        Ok(Self {
            point,
            sensitivities,
            gained: 0.0,
            held: vec![],
        })
    }

    /// The same with coordinates that keep their value.
    #[must_use]
    pub fn holding(self, held: Vec<usize>) -> Self {
        Self { held, ..self }
    }

    /// Where a fit has ended. Its derivatives, where it still has them, are those from which its last steps were taken.
    ///
    /// # Errors
    /// As [`fit()`].
    pub fn of(problem: &LeastSquares<'_>, fitted: Fit) -> Result<Self, DiagnoseError> {
        let Some(kept) = fitted.sensitivities else {
            return Self::at(problem, fitted.point);
        };
        Ok(Self {
            point: fitted.point,
            sensitivities: Arc::unwrap_or_clone(kept),
            gained: 0.0,
            held: vec![],
        })
    }
}

/// The same from a start whose derivatives are known.
///
/// # Errors
/// As [`fit`].
pub fn fit_from(problem: &LeastSquares<'_>, start: Start, effort: Effort) -> Result<Fit, DiagnoseError> {
    let (specimen, blocks, evaluation) = (problem.specimen(), &problem.blocks, &problem.evaluation);
    let Start {
        mut point,
        mut sensitivities,
        mut gained,
        held,
    } = start;
    let (prior, mut ranges) = (point.prior(specimen), point.ranges(specimen));
    for k in held {
        ranges[k] = (point.z[k], point.z[k]);
    }
    let all: Vec<usize> = (0..point.z.len()).collect();
    let mut normals = assemble(blocks, &sensitivities);
    let mut cost = total_cost(&normals) + point.prior_cost(specimen);
    let mut damping = DAMPING.0;
    let mut converged = false;
    let mut truths: Option<Vec<Series>> = None;
    for round in 0..effort.linearisations {
        if round > 0 {
            sensitivities = evaluation.sensitivities(&point, &all, truths.as_deref())?;
            normals = assemble(blocks, &sensitivities);
            gained = 0.0;
        }
        for step in 0..STEPS_PER_JACOBIAN {
            let (h, g) = sum(&normals, &prior, &point.z);
            let before_step = cost;
            let tries = if step == 0 { DAMPINGS_TRIED.0 } else { DAMPINGS_TRIED.1 };
            for _ in 0..tries {
                let Some(step) = bounded_step(&h, &g, damping, &point.z, &ranges) else {
                    damping *= DAMPING_UP;
                    continue;
                };
                let mut trial = point.clone();
                for ((z, d), range) in trial.z.iter_mut().zip(step.iter()).zip(&ranges) {
                    *z = (*z + d).clamp(range.0, range.1);
                }
                if trial == point {
                    break;
                }
                let there = match evaluation.truths(&trial) {
                    Ok(there) => there,
                    Err(DiagnoseError::Simulation { .. }) => {
                        damping *= DAMPING_UP;
                        continue;
                    }
                    Err(other) => return Err(other),
                };
                let residuals = evaluation.residuals(&evaluation.observed(&trial, &there));
                let trial_cost = problem.cost(&trial, &residuals);
                if trial_cost < cost {
                    (point, cost, truths) = (trial, trial_cost, Some(there));
                    for (s, residual) in sensitivities.iter_mut().zip(residuals) {
                        s.residual = residual;
                    }
                    normals = with_residuals(blocks, &normals, &sensitivities);
                    damping = (damping * DAMPING_DOWN).max(DAMPING.1);
                    break;
                }
                damping *= DAMPING_UP;
            }
            gained += before_step - cost;
            if before_step - cost < effort.tolerance * cost {
                break;
            }
        }
        if gained < TOLERANCES_PER_JACOBIAN * effort.tolerance * cost {
            converged = true;
            break;
        }
    }
    Ok(Fit {
        sensitivities: Some(Arc::new(sensitivities)),
        converged,
        gained,
        ..Fit::new(point, normals, prior, cost, ranges)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{CUBIC, FRAGILE, FRICTION, RUN, Recipe, VIBRATION};
    use crate::estimation::covariance::deviations;
    use crate::specimen::Specimen;

    fn fitted(recipe: &Recipe, effects: &[(usize, &[f64])]) -> (Vec<f64>, f64) {
        let specimen = recipe.make();
        let problem = LeastSquares::new(&specimen, &RUN);
        let start = (effects.iter()).fold(Point::nominal(&specimen), |p, (e, v)| p.with_effect(&specimen, *e, v));
        let fit = fit(&problem, start, problem.criteria.fitting.converged).expect("a fit");
        let hypothesis = fit.point.hypothesis(&specimen);
        let values = hypothesis.effects.into_iter().flat_map(|e| e.1).collect();
        (values, fit.cost / problem.residuals() as f64)
    }

    #[test]
    fn true_numbers_are_found_and_the_noise_is_left() {
        let truth = vec![(CUBIC, vec![0.25]), (FRICTION, vec![0.07])];
        let recipe = Recipe {
            truth,
            ..Recipe::default()
        };
        let (values, left) = fitted(&recipe, &[(CUBIC, &[0.0]), (FRICTION, &[0.0])]);
        assert!(
            (values[0] - 0.25).abs() < 0.005 && (values[1] - 0.07).abs() < 0.003,
            "{values:?}"
        );
        assert!((left - 1.0).abs() < 0.06, "{left}");
    }

    #[test]
    fn a_nonlinear_number_is_found_from_nearby_and_not_from_far() {
        let truth = vec![(VIBRATION, vec![0.1, 2.3])];
        let recipe = Recipe {
            truth,
            ..Recipe::default()
        };
        let (near, left) = fitted(&recipe, &[(VIBRATION, &[0.02, 2.29])]);
        assert!((near[1] - 2.3).abs() < 0.003 && left < 1.06, "{near:?} {left}");
        let (far, left) = fitted(&recipe, &[(VIBRATION, &[0.02, 1.5])]);
        assert!((far[1] - 2.3).abs() > 0.3 && left > 1.5, "{far:?} {left}");
    }

    #[test]
    fn a_fit_that_is_carried_on_ends_where_one_fit_would_have_ended_and_saves_derivatives() {
        let truth = vec![(VIBRATION, vec![0.1, 2.3])];
        let specimen = Recipe {
            truth,
            ..Recipe::default()
        }
        .make();
        let problem = LeastSquares::new(&specimen, &RUN);
        let (quick, converged) = (problem.criteria.fitting.quick, problem.criteria.fitting.converged);
        let start = Point::nominal(&specimen).with_effect(&specimen, VIBRATION, &[0.08, 2.298]);
        let counted = |fit: &dyn Fn() -> Fit| {
            let before = problem.evaluation.simulated();
            (fit(), problem.evaluation.simulated() - before)
        };
        let one = fit(&problem, start.clone(), converged).expect("a fit");
        let ends_there = |fit: &Fit| {
            let from_one = (fit.point.z.iter().zip(&one.point.z)).map(|(a, b)| (a - b).abs());
            assert!(
                fit.converged && from_one.fold(0.0, f64::max) < 1e-3,
                "{:?} {:?}",
                fit.point.z,
                one.point.z
            );
        };
        // One that has not converged is fitted anew, one that has goes on with its derivatives.
        for (linearisations, saves) in [(1, false), (quick.linearisations, true)] {
            let effort = Effort {
                linearisations,
                ..quick
            };
            let from = fit(&problem, start.clone(), effort).expect("a fit");
            assert_eq!(from.converged, saves);
            let (on, simulated) = counted(&|| carried_on(&problem, from.clone(), converged).expect("a fit"));
            let (anew, simulated_anew) = counted(&|| fit(&problem, from.point.clone(), converged).expect("a fit"));
            ends_there(&on);
            ends_there(&anew);
            assert_eq!(simulated < simulated_anew, saves, "{simulated} {simulated_anew}");
        }
    }

    #[test]
    fn numbers_stay_in_their_range() {
        // The true friction is beyond the candidate's range on the other side: an amount is not negative.
        let truth = vec![(FRICTION, vec![-0.1])];
        let recipe = Recipe {
            truth,
            ..Recipe::default()
        };
        assert_eq!(fitted(&recipe, &[(FRICTION, &[0.2])]).0, [0.0]);
        // And a start outside is moved inside.
        assert_eq!(fitted(&recipe, &[(FRICTION, &[-3.0])]).0, [0.0]);
    }

    #[test]
    fn a_number_that_is_held_keeps_its_value_and_the_others_make_the_best_of_it() {
        let truth = vec![(CUBIC, vec![0.25]), (FRICTION, vec![0.07])];
        let recipe = Recipe {
            truth,
            ..Recipe::default()
        };
        let specimen = recipe.make();
        let problem = LeastSquares::new(&specimen, &RUN);
        let start = Point::nominal(&specimen)
            .with_effect(&specimen, CUBIC, &[0.0])
            .with_effect(&specimen, FRICTION, &[0.1]);
        let friction = start.coordinates_of(&specimen, 1);
        let effort = problem.criteria.fitting.converged;
        let held = Start::at(&problem, start.clone())
            .and_then(|at| fit_from(&problem, at.holding(friction.clone().collect()), effort))
            .expect("a fit");
        let free = fit(&problem, start.clone(), effort).expect("a fit");
        let k = friction.start;
        assert_eq!(held.point.z[k], start.z[k]);
        // In a linear model with white noise, holding a number costs its squared distance from the best value over its variance.
        let distance = (held.point.z[k] - free.point.z[k]) / deviations(&free)[k];
        let ratio = (held.cost - free.cost) / (distance * distance);
        assert!((0.5..1.5).contains(&ratio), "{ratio}");
    }

    #[test]
    fn a_tolerance_holds_the_calibration_back() {
        // A cubic that is not in the model pulls on the stiffness; more than its tolerance and a tenth it may not give.
        let truth = vec![(CUBIC, vec![2.0])];
        let specimen = Recipe {
            truth,
            ..Recipe::default()
        }
        .make();
        let problem = LeastSquares::new(&specimen, &RUN);
        let fit = fit(&problem, Point::nominal(&specimen), problem.criteria.fitting.converged).expect("a fit");
        let stiffness = specimen.calibration()[0].value(fit.point.z[0]);
        assert!((stiffness - 0.022).abs() < 1e-9, "{stiffness}");
    }

    #[test]
    fn a_step_to_where_the_model_does_not_exist_is_shortened() {
        let recipe = Recipe {
            truth: vec![(CUBIC, vec![0.25])],
            ..Recipe::default()
        };
        let (values, _) = fitted(&recipe, &[(FRAGILE, &[0.9]), (CUBIC, &[0.0])]);
        assert!((values[1] - 0.25).abs() < 0.005, "{values:?}");
        let specimen = recipe.make();
        let problem = LeastSquares::new(&specimen, &RUN);
        let broken = Point::nominal(&specimen).with_effect(&specimen, FRAGILE, &[2.0]);
        let effort = problem.criteria.fitting.converged;
        assert!(matches!(
            fit(&problem, broken, effort),
            Err(DiagnoseError::Simulation { .. })
        ));
    }
}
