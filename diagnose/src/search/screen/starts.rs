//! Where candidates begin, how the promising ones go on, and what became of all of them.

use rayon::prelude::*;

use super::beside::{Screen, ScreenedCandidate, cost_of, finished, is_gross};
use super::look::Look;
use crate::criteria::Screening;
use crate::error::DiagnoseError;
use crate::estimation::{Fit, Point};
use crate::search::sizes::starting_sizes;
use crate::specimen::Series;

/// A candidate after its first steps from its own starts, and larger sizes of it with the cost of each, the lowest first.
struct Begun {
    candidate: Option<ScreenedCandidate>,
    sizes: Vec<(f64, Vec<f64>)>,
}

impl Screen<'_, '_> {
    /// Every candidate added alone, in the order given; `None` where it cannot be simulated at all.
    ///
    /// # Errors
    /// [`DiagnoseError::Interrupted`] once the caller asked to stop.
    pub fn all(&self, candidates: &[usize]) -> Result<Vec<Option<Fit>>, DiagnoseError> {
        let mut begun = self.begun(candidates)?;
        let costs: Vec<f64> = begun.iter().map(cost_of).collect();
        let promising = promising(&costs, self.fit, &self.problem.criteria.screening);
        self.advance_all(
            begun
                .iter_mut()
                .enumerate()
                .filter(|(k, _)| promising.contains(k))
                .map(|(_, c)| c),
        )?;
        Ok((begun.iter())
            .map(|candidate| candidate.as_ref().map(|c| finished(self.problem, self.fit, c)))
            .collect())
    }

    /// Candidates after their first steps, from the larger of their sizes too where these gain.
    ///
    /// # Errors
    /// [`DiagnoseError::Interrupted`] once the caller asked to stop.
    pub fn begun(&self, candidates: &[usize]) -> Result<Vec<Option<ScreenedCandidate>>, DiagnoseError> {
        let all = self.specimen().candidates();
        let swings = (candidates.iter().any(|&c| all[c].oscillates)).then(|| self.swings());
        let begun: Vec<Option<Begun>> = (candidates.par_iter())
            .map(|&c| {
                let begun = match &swings {
                    Some(swings) if all[c].oscillates => self.begin_oscillation(c, swings).map(Begun::of),
                    _ => self.begin(c),
                };
                // What cannot be simulated near the model so far is no candidate, and no failure of the diagnosis.
                match begun {
                    Err(DiagnoseError::Simulation { .. }) => Ok(None),
                    other => other.map(Some),
                }
            })
            .collect::<Result<_, _>>()?;
        let least = (begun.iter().flatten())
            .flat_map(|b| [cost_of(&b.candidate), b.sizes.first().map_or(f64::INFINITY, |s| s.0)])
            .fold(self.fit.cost, f64::min);
        (candidates.par_iter().zip(begun))
            .map(|(&c, begun)| begun.map_or(Ok(None), |begun| self.begin_at_sizes(c, begun, least)))
            .collect()
    }

    /// Takes promising candidates on, on all recordings, as long as they contend.
    ///
    /// # Errors
    /// [`DiagnoseError::Interrupted`] once the caller asked to stop.
    pub fn advance_all<'c>(
        &self,
        promising: impl Iterator<Item = &'c mut Option<ScreenedCandidate>>,
    ) -> Result<(), DiagnoseError> {
        let screening = &self.problem.criteria.screening;
        let mut promising: Vec<(&mut ScreenedCandidate, Option<Vec<Series>>)> =
            promising.flatten().map(|candidate| (candidate, None)).collect();
        for _ in 0..screening.more_steps {
            let go_on = go_on(promising.iter().map(|(candidate, _)| &**candidate), self.fit, screening);
            (promising.par_iter_mut().zip(go_on).filter(|(_, goes_on)| *goes_on)).try_for_each(
                |((candidate, truths), _)| {
                    candidate.further_steps += 1;
                    // What was seen of a few recordings has not arrived on all.
                    candidate.arrived &= !std::mem::take(&mut candidate.partly);
                    match self.advance_once(&self.all, candidate, truths) {
                        // A candidate whose derivatives cannot be simulated stays where its last step led.
                        Err(DiagnoseError::Simulation { .. }) => {
                            candidate.arrived = true;
                            Ok(())
                        }
                        other => other,
                    }
                },
            )?;
        }
        Ok(())
    }

    /// Where a candidate is looked at before it is known to be promising. What no simulation is needed for is looked at everywhere.
    pub(super) fn first_look(&self, candidate: usize) -> &Look<'_> {
        match &self.most {
            Some(most) if !self.leaves_physics_alone(candidate) => most,
            _ => &self.all,
        }
    }

    /// Where the shape of a law or its frequency is chosen.
    pub(super) fn regression_look(&self, candidate: usize) -> &Look<'_> {
        match &self.half {
            Some(half) if !self.leaves_physics_alone(candidate) => half,
            _ => self.first_look(candidate),
        }
    }

    /// A candidate after its first steps from the best of its starts, and what larger sizes cost where the model so far is far off.
    fn begin(&self, candidate: usize) -> Result<Begun, DiagnoseError> {
        let description = &self.specimen().candidates()[candidate];
        let own: Vec<f64> = description.parameters.iter().map(|p| p.start).collect();
        let starts: Vec<&Vec<f64>> = std::iter::once(&own).chain(&description.starts).collect();
        let look = self.first_look(candidate);
        if description.is_law() && description.absent_at(&own) {
            return self.begin_law(look, candidate, &starts).map(Begun::of);
        }
        let mut best: Option<ScreenedCandidate> = None;
        for start in &starts {
            let known = description.absent_at(start).then_some(look.truths.as_slice());
            self.begin_at(look, candidate, start, known, &mut best)?;
        }
        let mut begun = Begun::of(best);
        if description.is_law() || description.is_instrument_fault() || !is_gross(self.problem, self.fit) {
            return Ok(begun);
        }
        for start in starts {
            for direction in starting_sizes(description, start) {
                begun.sizes.extend(self.costs_of(candidate, direction)?);
            }
        }
        begun.sizes.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(begun)
    }

    /// A candidate stepped on from its larger sizes too, where these may lead lower. `least` is the lowest cost that any candidate has reached: beside
    /// it, a size that gains little does not become promising.
    fn begin_at_sizes(
        &self,
        candidate: usize,
        begun: Begun,
        least: f64,
    ) -> Result<Option<ScreenedCandidate>, DiagnoseError> {
        let (screening, look) = (&self.problem.criteria.screening, self.first_look(candidate));
        let mut best = begun.candidate;
        for (cost, values) in begun.sizes.into_iter().take(screening.sizes_refined) {
            let reached = best.as_ref().map_or(f64::INFINITY, |b| b.cost);
            let gains = self.fit.cost - cost > screening.gain_of_size * (self.fit.cost - least);
            if gains && cost < screening.size_contender * reached {
                self.begin_at(look, candidate, &values, None, &mut best)?;
            }
        }
        Ok(best)
    }

    /// The first steps of a candidate from a start, kept if they lead lower than `best`. A start that cannot be simulated is
    /// passed over.
    pub(super) fn begin_at(
        &self,
        look: &Look<'_>,
        candidate: usize,
        start: &[f64],
        known: Option<&[Series]>,
        best: &mut Option<ScreenedCandidate>,
    ) -> Result<(), DiagnoseError> {
        let point = self.fit.point.with_effect(self.specimen(), candidate, start);
        let begun = self.at(look, point, known).and_then(|mut begun| {
            self.step(look, &mut begun)?;
            let mut begun = begun.candidate;
            self.advance(
                look,
                &mut begun,
                self.problem.criteria.screening.first_steps.saturating_sub(1),
            )?;
            Ok(begun)
        });
        match begun {
            Ok(begun) if best.as_ref().is_none_or(|b| begun.cost < b.cost) => *best = Some(begun),
            Ok(_) | Err(DiagnoseError::Simulation { .. }) => {}
            Err(other) => return Err(other),
        }
        Ok(())
    }

    /// Sizes of a candidate, the smallest first, with the cost of each, up to the first that is too large.
    fn costs_of(&self, candidate: usize, sizes: Vec<Vec<f64>>) -> Result<Vec<(f64, Vec<f64>)>, DiagnoseError> {
        let look = self.half.as_ref().unwrap_or(&self.all);
        let mut costs = Vec::new();
        // One a decade is enough to step on from.
        let points: Vec<(Point, Vec<f64>)> = (sizes.into_iter().step_by(2))
            .map(|values| (self.fit.point.with_effect(self.specimen(), candidate, &values), values))
            .collect();
        for points in points.chunks(self.specimen().simulations_at_once()) {
            let at: Vec<Point> = points.iter().map(|(point, _)| point.clone()).collect();
            for (tried, (_, values)) in self.tried_at_each(look, &at).into_iter().zip(points) {
                let cost = match tried {
                    Ok(tried) => tried.cost,
                    Err(DiagnoseError::Simulation { .. }) => return Ok(costs),
                    Err(other) => return Err(other),
                };
                if cost >= self.problem.criteria.screening.size_overshoot * self.fit.cost {
                    return Ok(costs);
                }
                costs.push((cost, values.clone()));
            }
        }
        Ok(costs)
    }
}

impl Begun {
    fn of(candidate: Option<ScreenedCandidate>) -> Self {
        Self {
            candidate,
            sizes: Vec::new(),
        }
    }
}

/// Indices of the promising of screened costs beside a fitted model, the lowest first.
pub fn promising(costs: &[f64], fit: &Fit, screening: &Screening) -> Vec<usize> {
    let mut order: Vec<usize> = (0..costs.len()).filter(|&k| costs[k].is_finite()).collect();
    order.sort_by(|&a, &b| costs[a].total_cmp(&costs[b]));
    order.truncate(screening.promising);
    if let Some(&first) = order.first() {
        let least = screening.gain_of_promising * (fit.cost - costs[first]);
        order.retain(|&k| fit.cost - costs[k] >= least);
    }
    order
}

/// Which of the promising candidates beside a fitted model get a further step: those that had none, and those that would be fitted as they are, because they
/// are among the finalists or gain nearly as much as the best.
pub fn go_on<'c>(
    promising: impl Iterator<Item = &'c ScreenedCandidate> + Clone,
    fit: &Fit,
    screening: &Screening,
) -> Vec<bool> {
    let mut costs: Vec<f64> = promising.clone().map(|candidate| candidate.cost).collect();
    costs.sort_by(f64::total_cmp);
    let first = costs.first().copied().unwrap_or(f64::INFINITY);
    let last_finalist = costs.get(screening.finalists.saturating_sub(1)).copied();
    let least_gain = screening.gain_of_next_finalist * (fit.cost - first);
    promising
        .map(|candidate| {
            let contends =
                last_finalist.is_none_or(|last| candidate.cost <= last) || fit.cost - candidate.cost >= least_gain;
            match candidate.further_steps {
                0 => candidate.partly || !candidate.arrived,
                steps => steps < screening.more_steps && !candidate.arrived && contends,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{Analytic, CUBIC, FORTY_SINES, FRAGILE, FRICTION, GAIN, RUN, Recipe, VIBRATION};
    use crate::estimation::fit;
    use crate::estimation::{LeastSquares, Point};
    use std::sync::atomic::AtomicBool;

    fn calibrated<'a>(specimen: &'a Analytic) -> (LeastSquares<'a>, Fit) {
        let problem = LeastSquares::new(specimen, &RUN);
        let fit = fit(&problem, Point::nominal(specimen), problem.criteria.fitting.converged).expect("a fit");
        (problem, fit)
    }

    fn with_cubic(size: f64) -> Analytic {
        Recipe {
            truth: vec![(CUBIC, vec![size])],
            ..Recipe::default()
        }
        .make()
    }

    #[test]
    fn the_right_candidate_has_the_lowest_cost_and_about_its_true_size() {
        let specimen = with_cubic(0.3);
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
        let specimen = with_cubic(0.3);
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
        // So little, that its step is not even simulated.
        assert!((-1e-6..5.0).contains(&gained), "{gained}");
    }

    /// What the first steps see of some recordings only, the promising one sees of all.
    #[test]
    fn a_gross_effect_is_sized_on_all_recordings_though_most_of_it_shows_in_some() {
        let specimen = with_cubic(4.0);
        let (problem, calibrated) = calibrated(&specimen);
        let screen = Screen::new(&problem, &calibrated).expect("a screen");
        let looked_at = |look: &Option<Look<'_>>| look.as_ref().map_or(3, |l| l.truths.len());
        assert!(looked_at(&screen.half) <= looked_at(&screen.most) && looked_at(&screen.half) < 3);
        let candidates = [FRICTION, CUBIC, VIBRATION, GAIN];
        let begun = screen.begun(&candidates).expect("begun");
        let fits = screen.all(&candidates).expect("screened");
        let costs: Vec<f64> = fits.iter().flatten().map(|f| f.cost).collect();
        assert!((0..4).all(|k| k == 1 || costs[1] < 0.5 * costs[k]), "{costs:?}");
        let found = fits[1].as_ref().expect("a fit").point.hypothesis(&specimen);
        assert!((found.effects[0].1[0] - 4.0).abs() < 0.04, "{found:?}");
        let partly = |k: usize| begun[k].as_ref().is_some_and(|c| c.partly);
        assert_eq!(
            (partly(1), partly(3)),
            (screen.most.is_some(), false),
            "an instrument is seen everywhere"
        );
    }

    #[test]
    fn the_promising_go_on_as_long_as_they_contend() {
        let specimen = with_cubic(0.3);
        let (problem, calibrated) = calibrated(&specimen);
        let screening = Screening {
            finalists: 2,
            gain_of_next_finalist: 0.5,
            more_steps: 3,
            ..problem.criteria.screening
        };
        let candidate = |gain: f64, further_steps: usize| ScreenedCandidate {
            point: calibrated.point.clone(),
            normals: vec![],
            response: nalgebra::DVector::zeros(0),
            cost: calibrated.cost - gain,
            damping: 1.0,
            arrived: false,
            partly: false,
            further_steps,
        };
        let goes_on = |candidates: &[ScreenedCandidate]| go_on(candidates.iter(), &calibrated, &screening);
        // Everything promising gets one step.
        let first: Vec<_> = [100.0, 90.0, 60.0, 10.0].map(|gain| candidate(gain, 0)).into();
        assert_eq!(goes_on(&first), [true; 4]);
        // Then the finalists and what gains half as much as the best.
        let second: Vec<_> = [100.0, 90.0, 60.0, 10.0].map(|gain| candidate(gain, 1)).into();
        assert_eq!(goes_on(&second), [true, true, true, false]);
        let far_ahead: Vec<_> = [100.0, 9.0, 8.0].map(|gain| candidate(gain, 2)).into();
        assert_eq!(goes_on(&far_ahead), [true, true, false]);
        // Until it has arrived on all recordings, or had its steps.
        let mut arrived = [
            candidate(100.0, 1),
            candidate(90.0, 3),
            candidate(80.0, 0),
            candidate(70.0, 0),
        ];
        for candidate in &mut arrived {
            candidate.arrived = candidate.further_steps != 3;
        }
        arrived[3].partly = true;
        assert_eq!(goes_on(&arrived), [false, false, false, true]);
        assert_eq!(goes_on(&[]), [] as [bool; 0]);
    }

    #[test]
    fn the_fault_of_an_instrument_costs_no_simulation() {
        let specimen = with_cubic(0.3);
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
        let mut specimen = with_cubic(0.3);
        specimen.move_start(FRAGILE, 2.0);
        let (problem, calibrated) = calibrated(&specimen);
        let fits = Screen::new(&problem, &calibrated)
            .and_then(|s| s.all(&[FRAGILE, CUBIC]))
            .expect("screened");
        assert!(fits[0].is_none() && fits[1].is_some());
    }

    #[test]
    fn it_ends_when_asked_to_stop() {
        let specimen = with_cubic(0.3);
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
        let specimen = with_cubic(0.3);
        let (problem, calibrated) = calibrated(&specimen);
        let screen = Screen::new(&problem, &calibrated).expect("a screen");
        let bits = |candidates: &[usize], of: usize| {
            let fits = screen.all(candidates).expect("screened");
            fits[of].as_ref().map(|f| f.cost.to_bits())
        };
        assert_eq!(bits(&[CUBIC, FRICTION, FORTY_SINES], 0), bits(&[FRICTION, CUBIC], 1));
    }
}
