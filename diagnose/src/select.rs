//! Which physics is missing: forward selection, exchange, backward elimination, all judged on held-out blocks.
//!
//! A candidate is believed only if it improves blocks that had no say in its fit, by more than chance and by a part of
//! what is unexplained that is worth a name. Calibration within tolerance is fitted in every hypothesis, so it can never
//! pass for physics. When what remains is far above the noise, no model tried is complete, and small gains may be a wrong
//! term bending towards an unknown one: then a term must explain much more to be named.

use crate::error::DiagnoseError;
use crate::fit::{Effort, Fit, fit};
use crate::problem::{Point, Problem};
use crate::screen::Screen;

/// Most effects reported.
const MAX_EFFECTS: usize = 6;
/// Candidates fitted in full, after screening, in each round.
const FINALISTS: usize = 4;
/// A gain in cost below this is chance for one parameter (five standard deviations), whatever the sample.
const MIN_GAIN: f64 = 30.0;
/// Gain over its standard error from blocks.
const MIN_GAIN_SIGMAS: f64 = 2.5;
/// Smallest part of the unexplained cost that a term must explain, where the final model reaches the noise.
const MIN_SHARE: f64 = 0.08;
/// The same where it does not.
const MIN_SHARE_INCOMPLETE: f64 = 0.35;
/// Noise ratio up to which a model counts as complete.
pub const COMPLETE_NOISE_RATIO: f64 = 1.15;
/// A gain of a rival within this many standard errors of the chosen term's cannot be told from it.
const AMBIGUOUS_SIGMAS: f64 = 2.0;

/// What one candidate could do.
#[derive(Debug, Clone)]
pub struct Trial {
    /// The candidate.
    pub candidate: usize,
    /// Held-out noise ratio with it alone beside the calibrated model.
    pub alone: f64,
    /// Held-out noise ratio with it added to the chosen model; `None` if it is in it or excluded by it.
    pub added: Option<f64>,
}

/// A chosen effect and how sure it is.
#[derive(Debug, Clone)]
pub struct Chosen {
    /// The candidate.
    pub candidate: usize,
    /// Gain in held-out cost over the model without it.
    pub gain: f64,
    /// Standard error of the gain, from blocks.
    pub gain_error: f64,
    /// Held-out noise ratio of the best model without it.
    pub without: f64,
    /// The strongest rival in its place, and by how much the chosen one is better (cost, standard error).
    pub rival: Option<(usize, f64, f64)>,
}

/// The outcome.
#[derive(Debug, Clone)]
pub struct Selection {
    /// Calibrated, nothing added.
    pub calibrated: Fit,
    /// The best model.
    pub best: Fit,
    /// Effects of the best model, strongest first.
    pub chosen: Vec<Chosen>,
    /// Every testable candidate.
    pub trials: Vec<Trial>,
    /// Held-out noise ratio of the calibrated and the best model.
    pub noise_ratio: (f64, f64),
    /// True if something predictable or large remains.
    pub incomplete: bool,
}

/// Progress: what is being done, and the part done, 0 to 1.
pub type Report<'a> = &'a (dyn Fn(&str, f64) + Sync);

struct Judge<'p, 'a> {
    problem: &'p Problem<'a>,
    count: f64,
}

impl Judge<'_, '_> {
    fn held_out(&self, fit: &Fit) -> Vec<f64> {
        fit.held_out(self.problem)
    }

    fn ratio(&self, costs: &[f64]) -> f64 {
        (costs.iter().sum::<f64>() / self.count).sqrt()
    }

    /// Gain of `after` over `before` and its standard error.
    fn gain(before: &[f64], after: &[f64]) -> (f64, f64) {
        let n = before.len() as f64;
        let differences: Vec<f64> = before.iter().zip(after).map(|(b, a)| b - a).collect();
        let total: f64 = differences.iter().sum();
        let mean = total / n;
        let variance = differences.iter().map(|d| (d - mean) * (d - mean)).sum::<f64>() / (n - 1.0).max(1.0);
        (total, (n * variance).sqrt())
    }

    /// Whether a gain is worth a name, `share` being the least part of the unexplained cost.
    fn worth(&self, before: &[f64], after: &[f64], share: f64) -> bool {
        let (gain, error) = Self::gain(before, after);
        let unexplained = (before.iter().sum::<f64>() - self.count).max(0.0);
        gain > MIN_GAIN && gain > MIN_GAIN_SIGMAS * error && gain > share * unexplained
    }
}

/// Runs the whole selection.
///
/// # Errors
/// A nominal model that cannot be simulated, or the wish to stop.
pub fn select(problem: &Problem<'_>, report: Report<'_>) -> Result<Selection, DiagnoseError> {
    let judge = Judge {
        problem,
        count: problem.count() as f64,
    };
    report("calibrating within tolerance", 0.02);
    let calibrated = fit(problem, problem.nominal(), Effort::FULL)?;
    let calibrated_costs = judge.held_out(&calibrated);
    let candidates = problem.specimen.candidates();
    let testable: Vec<usize> = (0..candidates.len())
        .filter(|&c| candidates[c].untestable.is_none())
        .collect();

    report("screening candidates", 0.1);
    let first = Screen::new(problem, &calibrated)?.all(&testable)?;
    let mut trials: Vec<Trial> = testable
        .iter()
        .zip(&first)
        .map(|(&candidate, fit)| Trial {
            candidate,
            alone: fit.as_ref().map_or(f64::INFINITY, |f| judge.ratio(&judge.held_out(f))),
            added: None,
        })
        .collect();

    let mut best = calibrated.clone();
    let mut screened: Vec<(usize, Option<Fit>)> = testable.iter().copied().zip(first).collect();
    for round in 0..MAX_EFFECTS {
        report("fitting the strongest candidates", 0.2 + 0.1 * round as f64);
        let before = judge.held_out(&best);
        let Some(next) = strongest(problem, &judge, &screened, &before)? else {
            break;
        };
        best = next;
        best = exchange(problem, &judge, best)?;
        best = eliminate(problem, &judge, best, MIN_SHARE)?;
        report("screening again beside the model so far", 0.25 + 0.1 * round as f64);
        screened = screen_rest(problem, &best, &testable)?;
    }
    let ratio = judge.ratio(&judge.held_out(&best));
    if ratio > COMPLETE_NOISE_RATIO {
        best = eliminate(problem, &judge, best, MIN_SHARE_INCOMPLETE)?;
        screened = screen_rest(problem, &best, &testable)?;
    }

    report("testing rivals", 0.85);
    let best_costs = judge.held_out(&best);
    for (candidate, fit) in &screened {
        if let (Some(trial), Some(fit)) = (trials.iter_mut().find(|t| t.candidate == *candidate), fit) {
            trial.added = Some(judge.ratio(&judge.held_out(fit)));
        }
    }
    let chosen = explain(problem, &judge, &best, &best_costs, &testable)?;
    let noise_ratio = (judge.ratio(&calibrated_costs), judge.ratio(&best_costs));
    Ok(Selection {
        calibrated,
        best,
        chosen,
        trials,
        noise_ratio,
        incomplete: noise_ratio.1 > COMPLETE_NOISE_RATIO,
    })
}

/// Candidates not in the model and not excluded by a group member that is.
fn open_candidates(problem: &Problem<'_>, point: &Point, testable: &[usize]) -> Vec<usize> {
    let all = problem.specimen.candidates();
    let excluded = |c: usize| {
        point
            .effects
            .iter()
            .any(|&e| e == c || (!all[c].group.is_empty() && all[e].group == all[c].group))
    };
    testable.iter().copied().filter(|&c| !excluded(c)).collect()
}

fn screen_rest(
    problem: &Problem<'_>,
    fit: &Fit,
    testable: &[usize],
) -> Result<Vec<(usize, Option<Fit>)>, DiagnoseError> {
    let open = open_candidates(problem, &fit.point, testable);
    let fits = Screen::new(problem, fit)?.all(&open)?;
    Ok(open.into_iter().zip(fits).collect())
}

/// Screened fits, best first by held-out cost.
fn ranked(judge: &Judge<'_, '_>, screened: &[(usize, Option<Fit>)]) -> Vec<(f64, Fit)> {
    let mut order: Vec<(f64, Fit)> = screened
        .iter()
        .filter_map(|(_, f)| f.as_ref().map(|f| (judge.held_out(f).iter().sum::<f64>(), f.clone())))
        .collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    order
}

fn strongest(
    problem: &Problem<'_>,
    judge: &Judge<'_, '_>,
    screened: &[(usize, Option<Fit>)],
    before: &[f64],
) -> Result<Option<Fit>, DiagnoseError> {
    let total: f64 = before.iter().sum();
    let mut best: Option<(f64, Fit)> = None;
    for (screened_cost, start) in ranked(judge, screened).into_iter().take(FINALISTS) {
        // A full fit gains on the screened one, but not by orders: what gained next to nothing is not refitted.
        if total - screened_cost < 0.3 * MIN_GAIN {
            continue;
        }
        if best
            .as_ref()
            .is_some_and(|(b, _)| total - screened_cost < 0.25 * (total - b))
        {
            continue;
        }
        let full = fit(problem, start.point, Effort::FULL)?;
        let costs = judge.held_out(&full);
        if !judge.worth(before, &costs, MIN_SHARE) {
            continue;
        }
        let cost = costs.iter().sum::<f64>();
        if best.as_ref().is_none_or(|(b, _)| cost < *b) {
            best = Some((cost, full));
        }
    }
    Ok(best.map(|(_, f)| f))
}

/// Tries to replace every effect but the newest by its best rival.
fn exchange(problem: &Problem<'_>, judge: &Judge<'_, '_>, mut best: Fit) -> Result<Fit, DiagnoseError> {
    if best.point.effects.len() < 2 {
        return Ok(best);
    }
    let testable: Vec<usize> = {
        let all = problem.specimen.candidates();
        (0..all.len()).filter(|&c| all[c].untestable.is_none()).collect()
    };
    for position in 0..best.point.effects.len() - 1 {
        let own = best.point.effects[position];
        let less = fit(problem, problem.without(&best.point, position), Effort::QUICK)?;
        let rivals: Vec<usize> = open_candidates(problem, &less.point, &testable)
            .into_iter()
            .filter(|&c| c != own)
            .collect();
        let fits = Screen::new(problem, &less)?.all(&rivals)?;
        let screened: Vec<(usize, Option<Fit>)> = rivals.into_iter().zip(fits).collect();
        let now: f64 = judge.held_out(&best).iter().sum();
        let Some((cost, start)) = ranked(judge, &screened).into_iter().next() else {
            continue;
        };
        if cost < now + 0.2 * (less.cost - now).max(0.0) {
            let full = fit(problem, start.point, Effort::FULL)?;
            if judge.held_out(&full).iter().sum::<f64>() < now - MIN_GAIN {
                best = full;
            }
        }
    }
    Ok(best)
}

/// Drops effects that the others have made superfluous.
fn eliminate(problem: &Problem<'_>, judge: &Judge<'_, '_>, mut best: Fit, share: f64) -> Result<Fit, DiagnoseError> {
    loop {
        let costs = judge.held_out(&best);
        let mut weakest: Option<(f64, Fit)> = None;
        for position in 0..best.point.effects.len() {
            let less = fit(problem, problem.without(&best.point, position), Effort::FULL)?;
            let without = judge.held_out(&less);
            if judge.worth(&without, &costs, share) {
                continue;
            }
            let (gain, _) = Judge::gain(&without, &costs);
            if weakest.as_ref().is_none_or(|(g, _)| gain < *g) {
                weakest = Some((gain, less));
            }
        }
        match weakest {
            Some((_, less)) => best = less,
            None => return Ok(best),
        }
    }
}

/// For each chosen effect: what it is worth, and its strongest rival.
fn explain(
    problem: &Problem<'_>,
    judge: &Judge<'_, '_>,
    best: &Fit,
    costs: &[f64],
    testable: &[usize],
) -> Result<Vec<Chosen>, DiagnoseError> {
    let mut chosen = Vec::new();
    for (position, &candidate) in best.point.effects.iter().enumerate() {
        let less = fit(problem, problem.without(&best.point, position), Effort::FULL)?;
        let without = judge.held_out(&less);
        let (gain, gain_error) = Judge::gain(&without, costs);
        let rivals: Vec<usize> = open_candidates(problem, &less.point, testable)
            .into_iter()
            .filter(|&c| c != candidate)
            .collect();
        let fits = Screen::new(problem, &less)?.all(&rivals)?;
        let screened: Vec<(usize, Option<Fit>)> = rivals.into_iter().zip(fits).collect();
        let mut rival = None;
        if let Some((cost, start)) = ranked(judge, &screened).into_iter().next() {
            let id = *start.point.effects.last().unwrap_or(&candidate);
            let close = cost - costs.iter().sum::<f64>() < 0.5 * gain;
            let full = if close {
                fit(problem, start.point.clone(), Effort::FULL)?
            } else {
                start
            };
            let (lead, error) = Judge::gain(&judge.held_out(&full), costs);
            rival = Some((id, lead, error));
        }
        chosen.push(Chosen {
            candidate,
            gain,
            gain_error,
            without: judge.ratio(&without),
            rival,
        });
    }
    chosen.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    Ok(chosen)
}

impl Chosen {
    /// True if the strongest rival does as well.
    #[must_use]
    pub fn is_ambiguous(&self) -> bool {
        self.rival.is_some_and(|(_, lead, error)| {
            lead < (AMBIGUOUS_SIGMAS * error).max(0.5 * MIN_GAIN) && lead < 0.2 * self.gain
        })
    }
}
