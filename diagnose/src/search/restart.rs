//! Starting again: a model that is not complete, and to which nothing can be added, may have ended in a local minimum.

use nalgebra::DVector;

use super::fits::if_simulated;
use super::selector::Selector;
use super::sizes::starting_sizes;
use crate::effect::Candidate;
use crate::error::DiagnoseError;
use crate::estimation::bounded_step::bounded_step;
use crate::estimation::normal_equations::{assemble, sum};
use crate::estimation::{Fit, Point, fit};

/// Moves of one fitted number, in coordinates of order one.
const MOVED: [f64; 6] = [-3.0, -2.0, -1.0, 1.0, 2.0, 3.0];
/// Steps in which the sizes of a start are fitted: what they change is nearly in proportion to them.
const STEPS_OF_SIZES: usize = 2;
/// Damping of these steps, against rounding only.
const DAMPING_OF_SIZES: f64 = 1e-9;
/// Starts whose cost differs by less from that of the fit, as a part of it, are where the fit is.
const SAME_COST: f64 = 1e-3;
/// A size below this, in coordinates of order one, is none.
const NO_SIZE: f64 = 1e-3;
/// Numbers that differ by less, in coordinates of order one, are about the same.
const SAME_SHAPE: f64 = 0.3;

impl Selector<'_, '_> {
    /// The model fitted on where its fit ended before it had converged, or fitted again from other starts of one of its effects;
    /// `None` if neither ends lower by what an effect must gain. Only effects with numbers besides their size are started again:
    /// of a size alone screening has tried all. Where the noise is reached, only those are that have lost one of their sizes, and
    /// they need gain no more than tells two minima apart.
    pub fn restarted(&mut self, best: &Fit) -> Result<Option<Fit>, DiagnoseError> {
        let continued = self.criteria().fitting.continued;
        let has_misfit = !self.reaches_noise(best);
        let least = match has_misfit {
            true => (self.criteria().acceptance).least_gain_of(self.problem.residuals() as f64),
            false => self.criteria().acceptance.gain_of_other_minimum(),
        };
        if has_misfit && !best.converged {
            let on = fit(self.problem, best.point.clone(), continued)?;
            if on.cost < best.cost - least && self.held_out_ratio(&on) < self.held_out_ratio(best) {
                return self.fitted(on.point).map(Some);
            }
        }
        for position in 0..best.point.effects.len() {
            if !has_misfit && !self.has_lost_a_size(&best.point, position) {
                continue;
            }
            let mut begun = Vec::new();
            for start in self.other_starts(best, position)? {
                let quick = if_simulated(fit(self.problem, start, self.criteria().fitting.quick))?;
                begun.extend(quick.filter(|quick| !self.same_shape(&quick.point, &best.point, position)));
            }
            begun.sort_by(|a, b| a.cost.total_cmp(&b.cost));
            for quick in begun.into_iter().take(self.criteria().screening.sizes_refined) {
                let again = if_simulated(fit(self.problem, quick.point, continued))?;
                if let Some(lower) = again.filter(|again| again.cost < best.cost - least) {
                    return self.fitted_if_simulated(lower.point);
                }
            }
        }
        Ok(None)
    }

    /// True if one of the sizes of the effect at a position has been fitted to nothing beside others that have not: a stop of a stiffness of zero, whose
    /// clearance and progression have taken its part, is as likely the end of a wrong way as a stop that is purely progressive.
    fn has_lost_a_size(&self, point: &Point, position: usize) -> bool {
        let parameters = &self.candidate(point.effects[position]).parameters;
        let own = point.coordinates_of(self.specimen(), position);
        let sizes = (parameters.iter().zip(own)).filter(|(p, _)| p.is_size);
        let (lost, kept): (Vec<usize>, Vec<usize>) = sizes.map(|(_, k)| k).partition(|&k| point.z[k].abs() < NO_SIZE);
        !lost.is_empty() && !kept.is_empty()
    }

    /// True if two points have about the same numbers, sizes apart, for the effect at a position: the one is on its way back to
    /// the minimum in which the other is.
    fn same_shape(&self, a: &Point, b: &Point, position: usize) -> bool {
        let parameters = &self.candidate(a.effects[position]).parameters;
        let own = a.coordinates_of(self.specimen(), position);
        (parameters.iter().zip(own)).all(|(p, k)| p.is_size || (a.z[k] - b.z[k]).abs() < SAME_SHAPE)
    }

    /// Starts of the effect at a position with everything else as fitted: the best size of every shape, by one simulation each,
    /// and of those the shapes of lowest cost.
    fn other_starts(&self, best: &Fit, position: usize) -> Result<Vec<Point>, DiagnoseError> {
        let description = self.candidate(best.point.effects[position]);
        if description.is_unlisted() || description.parameters.iter().all(|p| p.is_size) {
            return Ok(vec![]);
        }
        let without = self
            .problem
            .cost_at(&best.point.without_effect(self.specimen(), position))?;
        let own = best.point.coordinates_of(self.specimen(), position);
        let fitted: Vec<f64> = (description.parameters.iter().zip(&best.point.z[own.clone()]))
            .map(|(p, z)| p.value(*z))
            .collect();
        let at = |values: Vec<f64>| {
            let mut point = best.point.clone();
            for (k, (p, value)) in own.clone().zip(description.parameters.iter().zip(values)) {
                point.z[k] = p.z(value);
            }
            point
        };
        let mut starts = Vec::new();
        for shape in shapes(description, fitted) {
            let points: Vec<Point> = (starting_sizes(description, &shape).into_iter().flatten())
                .map(at)
                .collect();
            let mut least: Option<(f64, Point)> = None;
            for (point, cost) in points.iter().zip(self.problem.costs_at_each(&points)) {
                match cost {
                    Ok(cost) if least.as_ref().is_none_or(|l| cost < l.0) => least = Some((cost, point.clone())),
                    Ok(_) | Err(DiagnoseError::Simulation { .. }) => {}
                    Err(other) => return Err(other),
                }
            }
            if let Some((_, point)) = least {
                starts.push(self.best_sizes(point, position)?);
            }
        }
        // What differs only in a number that the recordings do not determine would lead back, and would keep others from being tried.
        let is_other = |cost: f64| cost < without && (cost / best.cost - 1.0).abs() > SAME_COST;
        starts.retain(|(cost, _)| is_other(*cost));
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        starts.truncate(self.criteria().screening.shapes_restarted);
        Ok(starts.into_iter().map(|(_, point)| point).collect())
    }
}

impl Selector<'_, '_> {
    /// The point with the sizes of one of its effects fitted and all else as it is, where that lowers the cost; with its cost. The sizes that were tried keep one
    /// proportion, while the stiffness of a stop may be large and its progression small: such a start would lead back to where the fit came from.
    fn best_sizes(&self, start: Point, position: usize) -> Result<(f64, Point), DiagnoseError> {
        let (specimen, problem) = (self.specimen(), self.problem);
        let own = start.coordinates_of(specimen, position);
        let parameters = &self.candidate(start.effects[position]).parameters;
        let sizes: Vec<usize> = (own.zip(parameters))
            .filter(|(_, p)| p.is_size)
            .map(|(k, _)| k)
            .collect();
        let ranges = start.ranges(specimen);
        let ranges: Vec<(f64, f64)> = sizes.iter().map(|&k| ranges[k]).collect();
        let mut best = (problem.cost_at(&start)?, start);
        for _ in 0..STEPS_OF_SIZES {
            let answers = match problem.evaluation.sensitivities(&best.1, &sizes, None) {
                Err(DiagnoseError::Simulation { .. }) => break,
                answers => answers?,
            };
            let none = DVector::zeros(sizes.len());
            let z: Vec<f64> = sizes.iter().map(|&k| best.1.z[k]).collect();
            let (h, g) = sum(&assemble(&problem.blocks, &answers), &none, &z);
            let Some(step) = bounded_step(&h, &g, DAMPING_OF_SIZES, &z, &ranges) else {
                break;
            };
            let mut trial = best.1.clone();
            for ((&k, step), range) in sizes.iter().zip(step.iter()).zip(&ranges) {
                trial.z[k] = (trial.z[k] + step).clamp(range.0, range.1);
            }
            match problem.cost_at(&trial) {
                Ok(cost) if cost < best.0 => best = (cost, trial),
                Ok(_) | Err(DiagnoseError::Simulation { .. }) => break,
                Err(other) => return Err(other),
            }
        }
        Ok(best)
    }
}

/// Numbers besides the sizes from which an effect is started again: those of its starts, the fitted ones, and those with one
/// number moved either way by what would show.
fn shapes(candidate: &Candidate, fitted: Vec<f64>) -> Vec<Vec<f64>> {
    let mut all = candidate.all_starts();
    for (k, parameter) in candidate.parameters.iter().enumerate().filter(|(_, p)| !p.is_size) {
        for steps in MOVED {
            let mut shape = fitted.clone();
            shape[k] = parameter.value(parameter.z(fitted[k]) + steps);
            all.push(shape);
        }
    }
    all.push(fitted);
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{CUBIC, FRICTION_OF_BOTH, RUN, Recipe, VIBRATION};
    use crate::estimation::LeastSquares;

    /// The fit of a vibration of 2.3 rad/s from another frequency, started again: frequencies before and after.
    fn started_again(from: f64, starts: Vec<Vec<f64>>) -> (f64, Option<f64>) {
        let mut specimen = Recipe {
            truth: vec![(VIBRATION, vec![0.1, 2.3])],
            ..Recipe::default()
        }
        .make();
        specimen.give_starts(VIBRATION, starts);
        let problem = LeastSquares::new(&specimen, &RUN);
        let mut selector = Selector::new(&problem);
        let start = Point::nominal(&specimen).with_effect(&specimen, VIBRATION, &[0.02, from]);
        let best = selector.fitted(start).expect("a fit");
        let again = selector.restarted(&best).expect("fits");
        let frequency = |fit: &Fit| fit.point.hypothesis(&specimen).effects[0].1[1];
        (frequency(&best), again.as_ref().map(frequency))
    }

    #[test]
    fn a_local_minimum_is_left_from_a_start_in_the_basin_of_the_lowest() {
        let (before, after) = started_again(1.5, vec![vec![0.0, 2.28]]);
        assert!((before - 2.3).abs() > 0.3, "{before}");
        assert!(after.is_some_and(|w| (w - 2.3).abs() < 0.003), "{after:?}");
    }

    #[test]
    fn a_fit_that_is_at_the_lowest_stays() {
        let (before, after) = started_again(2.29, vec![vec![0.0, 1.0]]);
        assert!((before - 2.3).abs() < 0.003 && after.is_none(), "{before} {after:?}");
    }

    #[test]
    fn sizes_of_a_start_need_not_keep_its_proportion() {
        let specimen = Recipe {
            truth: vec![(FRICTION_OF_BOTH, vec![0.15, 0.01])],
            ..Recipe::default()
        }
        .make();
        let problem = LeastSquares::new(&specimen, &RUN);
        let selector = Selector::new(&problem);
        let start = Point::nominal(&specimen).with_effect(&specimen, FRICTION_OF_BOTH, &[0.05, 0.05]);
        let before = problem.cost_at(&start).expect("a cost");
        let (cost, point) = selector.best_sizes(start, 0).expect("a start");
        let sizes = &point.hypothesis(&specimen).effects[0].1;
        assert!(
            (sizes[0] - 0.15).abs() < 0.01 && (sizes[1] - 0.01).abs() < 0.01,
            "{sizes:?}"
        );
        assert!(cost < before && problem.cost_at(&point).expect("a cost") == cost);
    }

    #[test]
    fn a_size_is_lost_where_it_is_nothing_beside_another() {
        let specimen = Recipe::default().make();
        let problem = LeastSquares::new(&specimen, &RUN);
        let selector = Selector::new(&problem);
        let lost = |effect: usize, sizes: &[f64]| {
            let point = Point::nominal(&specimen).with_effect(&specimen, effect, sizes);
            selector.has_lost_a_size(&point, 0)
        };
        assert!(lost(FRICTION_OF_BOTH, &[0.0, 0.1]) && lost(FRICTION_OF_BOTH, &[0.1, 1e-6]));
        assert!(!lost(FRICTION_OF_BOTH, &[0.1, 0.1]) && !lost(FRICTION_OF_BOTH, &[0.0, 0.0]) && !lost(CUBIC, &[0.0]));
    }

    #[test]
    fn an_effect_of_nothing_but_its_size_is_not_started_again() {
        let specimen = Recipe {
            truth: vec![(VIBRATION, vec![0.1, 2.3])],
            ..Recipe::default()
        }
        .make();
        let problem = LeastSquares::new(&specimen, &RUN);
        let mut selector = Selector::new(&problem);
        let start = Point::nominal(&specimen).with_effect(&specimen, CUBIC, &[0.1]);
        let best = selector.fitted(start).expect("a fit");
        let before = problem.evaluation.simulated();
        assert!(selector.restarted(&best).expect("fits").is_none());
        assert_eq!(problem.evaluation.simulated(), before);
    }
}
