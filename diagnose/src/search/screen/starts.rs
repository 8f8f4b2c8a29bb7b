//! Where candidates begin, how the promising ones go on, and what became of all of them.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::beside::{Screen, ScreenedCandidate, cost_of, finished, is_gross};
use super::look::Look;
use super::steps::{Moving, Start};
use crate::criteria::Screening;
use crate::error::DiagnoseError;
use crate::estimation::{Fit, Point};
use crate::search::sizes::starting_sizes;

/// From so many groups of candidates for each thread on, a group keeps one thread as busy as it can.
const GROUPS_A_THREAD: usize = 2;

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
        let groups = self.groups(candidates);
        let are_many = groups.len() >= GROUPS_A_THREAD * rayon::current_num_threads();
        let begin = |group: &[usize]| -> Vec<Result<Begun, DiagnoseError>> {
            match (&swings, group) {
                (Some(swings), &[one]) if all[one].oscillates => {
                    vec![self.begin_oscillation(one, swings).map(Begun::of)]
                }
                _ => self.begin(group, are_many),
            }
        };
        let of_groups: Vec<Vec<Result<Begun, DiagnoseError>>> = groups.par_iter().map(|group| begin(group)).collect();
        let mut begun: BTreeMap<usize, Option<Begun>> = BTreeMap::new();
        for (candidate, one) in groups.into_iter().flatten().zip(of_groups.into_iter().flatten()) {
            let one = match one {
                // What cannot be simulated near the model so far is no candidate, and no failure of the diagnosis.
                Err(DiagnoseError::Simulation { .. }) => None,
                other => Some(other?),
            };
            begun.insert(candidate, one);
        }
        let begun: Vec<Option<Begun>> = candidates.iter().map(|c| begun.remove(c).flatten()).collect();
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
        let mut promising: Vec<(&mut Option<ScreenedCandidate>, Moving)> = (promising)
            .filter_map(|slot| slot.take().map(|candidate| (slot, Moving::from(candidate))))
            .collect();
        for _ in 0..screening.more_steps {
            let go_on = go_on(
                promising.iter().map(|(_, moving)| &moving.candidate),
                self.fit,
                screening,
            );
            let mut going: Vec<&mut Moving> = (promising.iter_mut().zip(go_on))
                .filter(|(_, goes_on)| *goes_on)
                .map(|((_, moving), _)| moving)
                .collect();
            for Moving { candidate, .. } in &mut going {
                candidate.further_steps += 1;
                // What was seen of a few recordings has not arrived on all.
                candidate.arrived &= !std::mem::take(&mut candidate.partly);
            }
            let advanced = self.advance_each(&self.all, &mut going);
            for (moving, advanced) in going.into_iter().zip(advanced) {
                match advanced {
                    // A candidate whose derivatives cannot be simulated stays where its last step led.
                    Err(DiagnoseError::Simulation { .. }) => moving.candidate.arrived = true,
                    other => other?,
                }
            }
        }
        for (slot, moving) in promising {
            *slot = Some(moving.candidate);
        }
        Ok(())
    }

    /// Candidates of one kind that begin side by side: so many that their simulations fill the vectors of a thread. Those that need none, and those that
    /// swing, begin alone.
    fn groups(&self, candidates: &[usize]) -> Vec<Vec<usize>> {
        let specimen = self.specimen();
        let recordings = self.most.as_ref().unwrap_or(&self.all).truths.len();
        let side_by_side = (specimen.simulations_at_once() / recordings.max(1)).max(1);
        let begins_alone = |c: &usize| self.leaves_physics_alone(*c) || specimen.candidates()[*c].oscillates;
        let (alone, simulated): (Vec<usize>, Vec<usize>) = candidates.iter().copied().partition(begins_alone);
        let (laws, others): (Vec<usize>, Vec<usize>) = simulated.into_iter().partition(|&c| self.begins_as_law(c));
        (laws
            .chunks(side_by_side)
            .chain(others.chunks(side_by_side))
            .chain(alone.chunks(1)))
        .map(<[usize]>::to_vec)
        .collect()
    }

    /// Whether a candidate begins with the shape of it that explains most.
    fn begins_as_law(&self, candidate: usize) -> bool {
        let description = &self.specimen().candidates()[candidate];
        description.is_law() && (description.all_starts().first()).is_some_and(|own| description.absent_at(own))
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

    /// Candidates of a group after their first steps from the best of their starts, and what larger sizes cost where the model so far is far off.
    fn begin(&self, group: &[usize], is_one_of_many: bool) -> Vec<Result<Begun, DiagnoseError>> {
        let Some(&first) = group.first() else { return vec![] };
        let of_many;
        let look = if is_one_of_many {
            of_many = self.first_look(first).of_many();
            &of_many
        } else {
            self.first_look(first)
        };
        if self.begins_as_law(first) {
            return (self.begin_laws(look, group).into_iter())
                .map(|begun| begun.map(|begun| Begun::of(Some(begun))))
                .collect();
        }
        let all = self.specimen().candidates();
        let starts: Vec<(usize, Vec<f64>)> = (group.iter().enumerate())
            .flat_map(|(k, &c)| all[c].all_starts().into_iter().map(move |start| (k, start)))
            .collect();
        let mut best: Vec<Result<Option<ScreenedCandidate>, DiagnoseError>> = group.iter().map(|_| Ok(None)).collect();
        for starts in starts.chunks(self.specimen().simulations_at_once()) {
            let at = (starts.iter())
                .map(|(k, values)| Start {
                    point: self.fit.point.with_effect(self.specimen(), group[*k], values),
                    truths: all[group[*k]].absent_at(values).then_some(look.truths.as_slice()),
                })
                .collect();
            for ((k, _), begun) in starts.iter().zip(self.begin_at(look, at)) {
                keep_lower(&mut best[*k], begun);
            }
        }
        (group.iter().zip(best))
            .map(|(&candidate, best)| {
                Ok(Begun {
                    sizes: self.larger_sizes(candidate)?,
                    candidate: best?,
                })
            })
            .collect()
    }

    /// Larger sizes of a candidate with the cost of each, the lowest first; none of a law or of an instrument that only shows, or where the model so far is
    /// not far off. A displacement that is read by half drives the model by half, and is as far from linear as a gross effect of the specimen.
    fn larger_sizes(&self, candidate: usize) -> Result<Vec<(f64, Vec<f64>)>, DiagnoseError> {
        let description = &self.specimen().candidates()[candidate];
        let mut sizes = Vec::new();
        if description.is_law() || self.leaves_physics_alone(candidate) || !is_gross(self.problem, self.fit) {
            return Ok(sizes);
        }
        for start in description.all_starts() {
            for direction in starting_sizes(description, &start) {
                sizes.extend(self.costs_of(candidate, direction)?);
            }
        }
        sizes.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(sizes)
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
                best = self.begin_lower(look, candidate, &values, best)?;
            }
        }
        Ok(best)
    }

    /// The first steps of a candidate from a start, whose true quantities are not known, if they lead lower than `best`, and this otherwise.
    pub(super) fn begin_lower(
        &self,
        look: &Look<'_>,
        candidate: usize,
        start: &[f64],
        best: Option<ScreenedCandidate>,
    ) -> Result<Option<ScreenedCandidate>, DiagnoseError> {
        let at = Start {
            point: self.fit.point.with_effect(self.specimen(), candidate, start),
            truths: None,
        };
        let mut best = Ok(best);
        for begun in self.begin_at(look, vec![at]) {
            keep_lower(&mut best, begun);
        }
        best
    }

    /// The first steps of candidates, each from a start.
    fn begin_at(&self, look: &Look<'_>, starts: Vec<Start<'_>>) -> Vec<Result<ScreenedCandidate, DiagnoseError>> {
        let mut begun = self.stepped(look, self.at_each(look, starts));
        let more = self.problem.criteria.screening.first_steps.saturating_sub(1);
        self.advance(look, &mut begun.iter_mut().collect::<Vec<_>>(), more);
        (begun.into_iter())
            .map(|begun| begun.map(|moving| moving.candidate))
            .collect()
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

/// Keeps what has begun if it is lower. A start that cannot be simulated is passed over.
fn keep_lower(
    best: &mut Result<Option<ScreenedCandidate>, DiagnoseError>,
    begun: Result<ScreenedCandidate, DiagnoseError>,
) {
    match (&best, begun) {
        (Ok(lowest), Ok(begun)) if lowest.as_ref().is_none_or(|lowest| begun.cost < lowest.cost) => {
            *best = Ok(Some(begun));
        }
        (Err(_), _) | (_, Ok(_) | Err(DiagnoseError::Simulation { .. })) => {}
        (_, Err(other)) => *best = Err(other),
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
        let screen = Screen::new(&problem, &calibrated).expect("a screen");
        // Also of those that begin side by side with it.
        let groups = screen.groups(&[FRAGILE, CUBIC, FRICTION]);
        assert!(groups.iter().any(|group| group.len() > 1), "{groups:?}");
        let fits = screen.all(&[FRAGILE, CUBIC, FRICTION]).expect("screened");
        assert!(fits[0].is_none() && fits[1].is_some() && fits[2].is_some());
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
