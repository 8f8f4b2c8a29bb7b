//! A model judged on what had no say in its fit: each fold is left out in turn.
//!
//! Numbers of one recording, like the gas temperature with which a drive begins, keep their fitted values unless the whole recording is left out. No other
//! recording knows them, so that the part of a recording that is left would have to find them anew, and its errors would hide what the model predicts.

use super::blocks::{Block, Blocks};
use super::fit::{Fit, HeldOut};
use super::gauss_newton::{Start, fit_from};
use super::least_squares::LeastSquares;
use super::normal_equations::total_cost;
use super::point::Point;
use crate::criteria::Effort;
use crate::specimen::Specimen;

/// Costs of the blocks when their fold is held out, and the points fitted without each fold; computed once for each fit.
///
/// By fits of their own where they are cheap, where the linear approximation around this fit says that leaving out a fold
/// changes much, or where it alone says that the model is not complete; else in that approximation.
pub fn held_out<'f>(fitted: &'f Fit, problem: &LeastSquares<'_>) -> &'f HeldOut {
    fitted.held_out.get_or_init(|| {
        let fitting = problem.criteria.fitting;
        let folds = problem.blocks.folds();
        if problem.refits_folds() {
            return refitted(fitted, problem, folds, |b| b.fold, fitting.converged);
        }
        let linear = linear(fitted, problem);
        let (cost, cost_held_out) = (total_cost(&fitted.normals), linear.costs.iter().sum::<f64>());
        let changes_much = cost_held_out >= fitting.linear_limit * cost;
        if fitted.screened || !(changes_much || decides_completeness(fitted, problem, cost, cost_held_out)) {
            linear
        } else {
            refitted(fitted, problem, folds, |b| b.fold, fitting.quick)
        }
    })
}

/// True if a model is complete by the blocks that it was fitted to, and not by their held-out cost in the linear approximation.
fn decides_completeness(fitted: &Fit, problem: &LeastSquares<'_>, cost: f64, cost_held_out: f64) -> bool {
    let residuals = problem.residuals() as f64;
    let most = problem.complete_up_to(fitted);
    (cost / residuals).sqrt() <= most && (cost_held_out / residuals).sqrt() > most
}

/// Cost of all recordings, each predicted by a fit of the others; computed once for each fit.
pub fn cost_of_whole_recordings(fitted: &Fit, problem: &LeastSquares<'_>) -> f64 {
    *fitted.whole_recordings.get_or_init(|| {
        let recordings = problem.specimen().recordings().len();
        let effort = problem.criteria.fitting.converged;
        refitted(fitted, problem, recordings, |b| b.recording, effort)
            .costs
            .iter()
            .sum()
    })
}

/// One fit without each of some parts, which the blocks are dealt into. A part whose rest cannot be fitted keeps the full fit's point, one that cannot be simulated
/// there costs infinitely much.
fn refitted(
    fitted: &Fit,
    problem: &LeastSquares<'_>,
    parts: usize,
    part_of: fn(&Block) -> usize,
    effort: Effort,
) -> HeldOut {
    let mut costs = vec![f64::INFINITY; fitted.normals.len()];
    let mut points = Vec::with_capacity(parts);
    let start = Start::of(problem, fitted.clone()).ok();
    for part in 0..parts {
        let rest = problem.keeping(|b| part_of(b) != part);
        let held = of_recordings_in(&rest.blocks, problem.specimen(), &fitted.point);
        let refit = start
            .clone()
            .and_then(|start| fit_from(&rest, start.holding(held), effort).ok());
        let point = refit.map_or_else(|| fitted.point.clone(), |f| f.point);
        if let Ok(residuals) = problem.evaluation.residuals_at(&point) {
            for (k, cost) in problem.block_costs(&residuals).into_iter().enumerate() {
                if part_of(&problem.blocks.as_slice()[k]) == part {
                    costs[k] = cost;
                }
            }
        }
        points.push(point);
    }
    HeldOut { costs, points }
}

/// Coordinates of numbers that belong to one recording, of which a part is kept.
fn of_recordings_in(kept: &Blocks, specimen: &dyn Specimen, point: &Point) -> Vec<usize> {
    let is_kept = |recording: usize| kept.as_slice().iter().any(|b| b.recording == recording);
    (point.parameters(specimen).iter().enumerate())
        .filter_map(|(k, parameter)| parameter.only_in.is_some_and(is_kept).then_some(k))
        .collect()
}

/// The same in the linear approximation around the fit.
fn linear(fitted: &Fit, problem: &LeastSquares<'_>) -> HeldOut {
    let blocks = problem.blocks.as_slice();
    let mut costs = vec![0.0; fitted.normals.len()];
    let mut points = Vec::with_capacity(problem.blocks.folds());
    for fold in 0..problem.blocks.folds() {
        let rest = problem.blocks.keeping(|b| b.fold != fold);
        let held = of_recordings_in(&rest, problem.specimen(), &fitted.point);
        let largest = problem.criteria.fitting.largest_linear_step;
        let step = fitted.step_without(|k| blocks[k].fold == fold, &held, largest);
        let own = fitted
            .normals
            .iter()
            .enumerate()
            .filter(|(k, _)| blocks[*k].fold == fold);
        for (k, normal) in own {
            costs[k] = step.as_ref().map_or(normal.cost, |d| normal.cost_after(d));
        }
        let mut point = fitted.point.clone();
        if let Some(d) = step {
            for ((z, d), r) in point.z.iter_mut().zip(d.iter()).zip(&fitted.ranges) {
                *z = (*z + d).clamp(r.0, r.1);
            }
        }
        points.push(point);
    }
    HeldOut { costs, points }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{CUBIC, FORTY_SINES, RUN, Recipe};
    use crate::criteria::Criteria;
    use crate::estimation::fit;

    /// The analytic specimen is linear, so that the approximation must equal the fits themselves.
    #[test]
    fn the_linear_approximation_is_exact_for_a_linear_model() {
        let specimen = Recipe {
            truth: vec![(CUBIC, vec![0.3])],
            ..Recipe::default()
        }
        .make();
        let problem = LeastSquares::new(&specimen, &RUN);
        let with_cubic = Point::nominal(&specimen).with_effect(&specimen, CUBIC, &[0.0]);
        let with_sines = with_cubic.with_effect(&specimen, FORTY_SINES, &[0.0; 40]);
        for start in [with_cubic, with_sines] {
            let fitted = fit(&problem, start, problem.criteria.fitting.converged).expect("a fit");
            let (linear, refitted) = (
                linear(&fitted, &problem),
                refitted(
                    &fitted,
                    &problem,
                    problem.blocks.folds(),
                    |b| b.fold,
                    problem.criteria.fitting.converged,
                ),
            );
            for (a, b) in linear.costs.iter().zip(&refitted.costs) {
                assert!((a - b).abs() < 1e-3 * b, "{a} {b}");
            }
        }
    }

    #[test]
    fn folds_are_fitted_where_the_approximation_alone_says_that_a_model_is_not_complete() {
        let specimen = Recipe::default().make();
        let start = Point::nominal(&specimen).with_effect(&specimen, FORTY_SINES, &[0.0; 40]);
        let simulated = |complete_up_to: f64| {
            let mut criteria = Criteria::default();
            (criteria.completeness.noise_ratio, criteria.completeness.over_floor) = (complete_up_to, 0.0);
            let problem = LeastSquares::new(&specimen, &RUN).with_criteria(criteria);
            let fitted = fit(&problem, start.clone(), problem.criteria.fitting.converged).expect("a fit");
            let before = problem.evaluation.simulated();
            held_out(&fitted, &problem);
            problem.evaluation.simulated() - before
        };
        let problem = LeastSquares::new(&specimen, &RUN);
        let fitted = fit(&problem, start.clone(), problem.criteria.fitting.converged).expect("a fit");
        let ratio = |cost: f64| (cost / problem.residuals() as f64).sqrt();
        let by_fit = ratio(total_cost(&fitted.normals));
        let by_approximation = ratio(linear(&fitted, &problem).costs.iter().sum());
        assert!(simulated(0.5 * (by_fit + by_approximation)) > 0);
        // Complete by both, and by neither.
        assert_eq!((simulated(1.01 * by_approximation), simulated(0.99 * by_fit)), (0, 0));
    }

    #[test]
    fn a_number_of_one_recording_is_held_unless_the_whole_recording_is_left_out() {
        let mut specimen = Recipe::default().make();
        specimen.tie_stiffness_to(0);
        let problem = LeastSquares::new(&specimen, &RUN);
        let effort = problem.criteria.fitting.converged;
        let fitted = fit(&problem, Point::nominal(&specimen), effort).expect("a fit");
        let folds = problem.blocks.folds();
        let by_folds = refitted(&fitted, &problem, folds, |b| b.fold, effort);
        for points in [linear(&fitted, &problem).points, by_folds.points] {
            let moved = |k: usize| points.iter().filter(|p| p.z[k] != fitted.point.z[k]).count();
            assert_eq!((moved(0), moved(1)), (0, folds));
        }
        let recordings = specimen.recordings().len();
        let by_recordings = refitted(&fitted, &problem, recordings, |b| b.recording, effort).points;
        let moved: Vec<bool> = (by_recordings.iter()).map(|p| p.z[0] != fitted.point.z[0]).collect();
        assert!(moved[0] && !moved[1..].contains(&true), "{moved:?}");
    }

    #[test]
    fn held_out_blocks_cost_more_than_fitted_ones_by_the_numbers_fitted() {
        let specimen = Recipe::default().make();
        let problem = LeastSquares::new(&specimen, &RUN);
        let start = Point::nominal(&specimen).with_effect(&specimen, FORTY_SINES, &[0.0; 40]);
        let fitted = fit(&problem, start, problem.criteria.fitting.converged).expect("a fit");
        let held_out: f64 = held_out(&fitted, &problem).costs.iter().sum();
        // Forty numbers take forty from the fitted cost and add about as much to what was held out.
        let excess = held_out - total_cost(&fitted.normals);
        assert!((50.0..130.0).contains(&excess), "{excess}");
    }
}
