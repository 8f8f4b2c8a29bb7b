//! Which physics is missing: forward selection, exchange, backward elimination, all judged on held-out blocks.
//!
//! A candidate is believed only if it improves blocks that had no say in its fit, by more than chance and by a part of
//! what is unexplained that is worth a name. Calibration within tolerance is fitted in every hypothesis, so it can never
//! pass for physics. When what remains is far above the noise, no model tried is complete, and small gains may be a wrong
//! term bending towards an unknown one: then a term must explain much more to be named.

use std::collections::BTreeMap;

use crate::error::DiagnoseError;
use crate::fit::{Effort, Fit, fit};
use crate::problem::{Point, Problem};
use crate::screen::Screen;

/// Most effects reported.
const MAX_EFFECTS: usize = 6;
/// Candidates fitted in full, after screening, in each round.
const FINALISTS: usize = 3;
/// A gain in cost below this is chance for one parameter (five standard deviations), whatever the sample.
const MIN_GAIN: f64 = 30.0;
/// A gain below this part of the number of residuals is too small to matter: smoothing a measured displacement leaves
/// errors of that size, and they bend towards late or lagging sensors (complete models: at most 0.0035).
const MIN_GAIN_PER_RESIDUAL: f64 = 0.008;
/// Gain over its standard error from blocks.
const MIN_GAIN_SIGMAS: f64 = 2.5;
/// Change of a block's cost that is not chance.
const BLOCK_GAIN: f64 = 6.0;
/// Smallest part of the unexplained cost that a term must explain, where the final model reaches the noise.
const MIN_SHARE: f64 = 0.08;
/// The same where it does not.
const MIN_SHARE_INCOMPLETE: f64 = 0.35;
/// The same for a cylinder recorded under several conditions, whose few parameters those pin down.
const MIN_SHARE_CONDITIONS: f64 = 0.1;
/// Noise ratio up to which a model counts as complete, where the noise of its inputs does not come through.
pub const COMPLETE_NOISE_RATIO: f64 = 1.15;
/// The same over the floor that the noise of the inputs sets.
const COMPLETE_OVER_FLOOR: f64 = 1.07;
/// An instrument's fault below this part of what would be visible is not worth a name: a clock off by a hundredth of a
/// sample, a gain by a thousandth.
const LEAST_FAULT: f64 = 0.1;
/// Noise ratio above which, and above the floor, laws without a name are tried.
const LAW_NOISE_RATIO: f64 = 1.06;
/// Screening is linear in the model's own parameters: what it calls a little less than worth it is still fitted.
const SCREEN_MARGIN: f64 = 0.6;
/// To be told from its strongest rival, an effect must lead by this part of what it takes to be believed at all.
const AMBIGUITY_MARGIN: f64 = 0.25;

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
    /// True if the strongest rival does as well, as far as the recordings can tell.
    pub ambiguous: bool,
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

type Screened = Vec<(usize, Option<Fit>)>;

struct Judge<'p, 'a> {
    problem: &'p Problem<'a>,
    count: f64,
    testable: Vec<usize>,
    /// Fits already made, by structure.
    known: BTreeMap<Vec<usize>, Fit>,
}

impl<'p, 'a> Judge<'p, 'a> {
    fn new(problem: &'p Problem<'a>) -> Self {
        let all = problem.specimen.candidates();
        let testable = (0..all.len()).filter(|&c| all[c].untestable.is_none()).collect();
        Self {
            problem,
            count: problem.count() as f64,
            testable,
            known: BTreeMap::new(),
        }
    }

    /// The full fit of a structure; each is made once.
    fn fitted(&mut self, start: Point) -> Result<Fit, DiagnoseError> {
        let mut key = start.effects.clone();
        key.sort_unstable();
        if let Some(fit) = self.known.get(&key) {
            // A better start than the known fit's end means that fit was caught in a side valley.
            let here = self.problem.cost(&start)?;
            if here > fit.cost - 0.1 * MIN_GAIN {
                return Ok(fit.clone());
            }
        }
        let full = fit(self.problem, start, Effort::FULL)?;
        self.known.insert(
            key,
            Fit {
                sensitivity: None,
                ..full.clone()
            },
        );
        Ok(full)
    }

    fn held_out(&self, fit: &Fit) -> Vec<f64> {
        fit.held_out(self.problem).to_vec()
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

    /// Mean gain per block of the logarithm of the cost and its standard error: fair where a few blocks hold nearly all
    /// of the misfit, and the raw gain is as scattered as they are.
    fn logarithmic_gain(before: &[f64], after: &[f64]) -> (f64, f64) {
        let n = before.len() as f64;
        let gains: Vec<f64> = before
            .iter()
            .zip(after)
            .map(|(b, a)| libm::log(b.max(1e-9) / a.max(1e-9)))
            .collect();
        let mean = gains.iter().sum::<f64>() / n;
        let variance = gains.iter().map(|g| (g - mean) * (g - mean)).sum::<f64>() / (n - 1.0).max(1.0);
        (mean, (variance / n).sqrt())
    }

    /// Many blocks better and hardly one worse: the sign test for an effect that acts in some blocks only.
    fn rarely_worse(before: &[f64], after: &[f64]) -> bool {
        let (mut wins, mut losses) = (0, 0);
        for (b, a) in before.iter().zip(after) {
            wins += usize::from(b - a > BLOCK_GAIN);
            losses += usize::from(a - b > BLOCK_GAIN);
        }
        wins >= 3 * losses + 4
    }

    /// Whether a gain is worth a name, `share` being the least part of the unexplained cost.
    fn worth(&self, before: &[f64], after: &[f64], share: f64, margin: f64) -> bool {
        let (gain, error) = Self::gain(before, after);
        let unexplained = (before.iter().sum::<f64>() - self.count).max(0.0);
        let (logarithmic, logarithmic_error) = Self::logarithmic_gain(before, after);
        let sigmas = margin * MIN_GAIN_SIGMAS;
        // A screened fit (margin below 1) is linear in the model's own parameters: single blocks may look worse than they are.
        let certain = margin < 1.0
            || gain > sigmas * error
            || logarithmic > sigmas * logarithmic_error
            || Self::rarely_worse(before, after);
        let least = MIN_GAIN.max(MIN_GAIN_PER_RESIDUAL * self.count);
        gain > margin * least && certain && gain > margin * share * unexplained
    }

    /// Candidates not in the model and not excluded by a group member that is; laws without a name only when asked for.
    fn open(&self, point: &Point, laws: bool) -> Vec<usize> {
        let all = self.problem.specimen.candidates();
        let excluded = |c: usize| {
            (all[c].is_unlisted() && !laws) || point.effects.iter().any(|&e| e == c || all[e].excludes(&all[c]))
        };
        self.testable.iter().copied().filter(|&c| !excluded(c)).collect()
    }

    fn screen(&self, fit: &Fit, candidates: Vec<usize>) -> Result<Screened, DiagnoseError> {
        let fits = Screen::new(self.problem, fit)?.all(&candidates)?;
        Ok(candidates.into_iter().zip(fits).collect())
    }

    /// Costs of the blocks as a screened fit reaches them. Held-out costs would be too much to ask of it: it has not
    /// converged, and where one edge of a valve holds most of the misfit, the rest says little about it in a linear picture.
    fn reached(fit: &Fit) -> Vec<f64> {
        fit.normals.iter().map(|n| n.cost).collect()
    }

    /// Screened fits, best first by the cost that they reach.
    fn ranked(&self, screened: &Screened) -> Vec<(f64, Fit)> {
        let mut order: Vec<(f64, Fit)> = screened
            .iter()
            .filter_map(|(_, f)| f.as_ref().map(|f| (Self::reached(f).iter().sum::<f64>(), f.clone())))
            .collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        order
    }

    /// Least share for a candidate. A law without a name bends to much, and so does an instrument where the model stays
    /// incomplete: both must explain more.
    fn share(&self, candidate: usize, share: f64) -> f64 {
        let c = &self.problem.specimen.candidates()[candidate];
        let demanding = c.is_unlisted() || (c.is_instrument_fault() && share > MIN_SHARE);
        if demanding {
            share.max(MIN_SHARE_INCOMPLETE)
        } else {
            share
        }
    }

    /// The best of the screened candidates after a full fit, if it is worth a name.
    fn strongest(&mut self, screened: &Screened, best: &Fit) -> Result<Option<Fit>, DiagnoseError> {
        let before = self.held_out(best);
        let total: f64 = before.iter().sum();
        let mut winner: Option<(f64, Fit)> = None;
        for (screened_cost, start) in self.ranked(screened).into_iter().take(FINALISTS) {
            let share = start
                .point
                .effects
                .last()
                .map_or(MIN_SHARE, |&c| self.share(c, MIN_SHARE));
            if !self.worth(&before, &Self::reached(&start), share, SCREEN_MARGIN) {
                continue;
            }
            if winner
                .as_ref()
                .is_some_and(|(b, _)| total - screened_cost < 0.5 * (total - b))
            {
                continue;
            }
            let full = self.fitted(start.point)?;
            if self.too_small(&full) {
                continue;
            }
            let costs = self.held_out(&full);
            let cost = costs.iter().sum::<f64>();
            if self.worth(&before, &costs, share, 1.0) && winner.as_ref().is_none_or(|(b, _)| cost < *b) {
                winner = Some((cost, full));
            }
        }
        Ok(winner.map(|(_, f)| f))
    }

    /// True if the effect that came last is a fault of an instrument too small to name.
    fn too_small(&self, fit: &Fit) -> bool {
        fit.point.effects.last().is_some_and(|&c| {
            let candidate = &self.problem.specimen.candidates()[c];
            let own = &fit.point.z[fit.point.z.len() - candidate.parameters.len()..];
            candidate.is_instrument_fault() && !own.is_empty() && own.iter().all(|z| z.abs() < LEAST_FAULT)
        })
    }

    /// Noise ratio that the model would reach if it were complete.
    fn floor(&self, fit: &Fit) -> f64 {
        self.problem.specimen.noise_floor(&self.problem.hypothesis(&fit.point))
    }

    /// Noise ratio up to which a model counts as complete.
    fn complete(&self, fit: &Fit) -> f64 {
        COMPLETE_NOISE_RATIO.max(COMPLETE_OVER_FLOOR * self.floor(fit))
    }

    /// Drops effects that the others have made superfluous.
    fn eliminate(&mut self, mut best: Fit, share: f64) -> Result<Fit, DiagnoseError> {
        loop {
            let laws = best
                .point
                .effects
                .iter()
                .filter(|&&e| self.problem.specimen.candidates()[e].is_unlisted())
                .count();
            let costs = self.held_out(&best);
            let mut weakest: Option<(f64, Fit)> = None;
            let all = self.problem.specimen.candidates();
            // Laws without a name go first: what a name explains as well needs none.
            let mut order: Vec<usize> = (0..best.point.effects.len()).collect();
            order.sort_by_key(|&p| !all[best.point.effects[p]].is_unlisted());
            for position in order {
                let nameless = all[best.point.effects[position]].is_unlisted();
                if !nameless
                    && weakest
                        .as_ref()
                        .is_some_and(|(_, f)| f.point.effects.iter().filter(|&&e| all[e].is_unlisted()).count() < laws)
                {
                    break;
                }
                let less = self.fitted(self.problem.without(&best.point, position))?;
                let without = self.held_out(&less);
                if self.worth(&without, &costs, self.share(best.point.effects[position], share), 1.0) {
                    continue;
                }
                let (gain, _) = Self::gain(&without, &costs);
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

    /// True if the other candidate holds the first in itself: a law without a name in its place, or the same effect
    /// there and elsewhere too.
    fn repeats(&self, candidate: usize, other: usize) -> bool {
        let all = self.problem.specimen.candidates();
        let (one, two) = (&all[candidate], &all[other]);
        let law = !one.is_unlisted() && two.is_unlisted() && one.place == two.place;
        let wider = one.id == two.id && one.parameters.len() < two.parameters.len() && two.place.contains(&one.place);
        law || wider
    }

    /// For each effect of a model what it is worth, and its strongest rival, fitted in its place.
    fn explain(&mut self, best: &Fit, laws: bool) -> Result<(Vec<Chosen>, Option<Fit>), DiagnoseError> {
        let costs = self.held_out(best);
        let total: f64 = costs.iter().sum();
        let mut chosen = Vec::new();
        let mut better: Option<(f64, Fit)> = None;
        for (position, &candidate) in best.point.effects.iter().enumerate() {
            let less = self.fitted(self.problem.without(&best.point, position))?;
            let without = self.held_out(&less);
            let (gain, gain_error) = Self::gain(&without, &costs);
            let rivals: Vec<usize> = self
                .open(&less.point, laws)
                .into_iter()
                // What holds the candidate in itself is no rival.
                .filter(|&c| c != candidate && !self.repeats(candidate, c))
                .collect();
            let screened = self.screen(&less, rivals)?;
            let mut rival = None;
            let mut ambiguous = false;
            if let Some((cost, start)) = self.ranked(&screened).into_iter().next() {
                let id = *start.point.effects.last().unwrap_or(&candidate);
                let full = if cost - total < 0.5 * gain {
                    self.fitted(start.point)?
                } else {
                    start
                };
                let held_out = self.held_out(&full);
                let (lead, error) = Self::gain(&held_out, &costs);
                let named = |f: &Fit| {
                    f.point
                        .effects
                        .iter()
                        .all(|&e| !self.problem.specimen.candidates()[e].is_unlisted())
                };
                // A name gives way to a law without one only if the law is clearly better.
                let least = if named(best) && !named(&full) { 0.1 * gain } else { 0.0 };
                let clearly = lead < -(MIN_GAIN_PER_RESIDUAL * self.count).max(MIN_GAIN).max(least);
                // The same effect in fewer places that does as well is what is said: one damper fades, not both.
                let all = self.problem.specimen.candidates();
                let simpler = all[id].id == all[candidate].id
                    && all[id].parameters.len() < all[candidate].parameters.len()
                    && !self.worth(&held_out, &costs, 0.0, 1.0);
                if (clearly || simpler) && better.as_ref().is_none_or(|(l, _)| lead < *l) {
                    better = Some((lead, full));
                }
                rival = Some((id, lead, error));
                // A rival that explains nearly nothing itself is no ambiguity, however scattered the blocks.
                ambiguous = !self.worth(&held_out, &costs, 0.0, AMBIGUITY_MARGIN) && lead < 0.2 * gain;
            }
            chosen.push(Chosen {
                candidate,
                gain,
                gain_error,
                without: self.ratio(&without),
                rival,
                ambiguous,
            });
        }
        chosen.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        Ok((chosen, better.map(|(_, f)| f)))
    }
}

/// Runs the whole selection.
///
/// # Errors
/// A nominal model that cannot be simulated, or the wish to stop.
pub fn select(problem: &Problem<'_>, report: Report<'_>) -> Result<Selection, DiagnoseError> {
    let mut judge = Judge::new(problem);
    report("calibrating within tolerance", 0.02);
    let calibrated = judge.fitted(problem.nominal())?;
    let calibrated_costs = judge.held_out(&calibrated);

    let mut best = calibrated.clone();
    let mut laws = false;
    let mut trials: Vec<Trial> = Vec::new();
    let mut screened: Screened;
    loop {
        let done = 0.1 + 0.12 * best.point.effects.len() as f64;
        report("screening every candidate", done);
        screened = judge.screen(&best, judge.open(&best.point, laws))?;
        if best.point.effects.is_empty() {
            record_alone(&judge, &screened, &mut trials);
        }
        report("fitting the strongest candidates", done + 0.06);
        let full = best.point.effects.len() >= MAX_EFFECTS;
        if let Some(next) = if full { None } else { judge.strongest(&screened, &best)? } {
            best = next;
        } else if !laws && !full && judge.ratio(&judge.held_out(&best)) > LAW_NOISE_RATIO.max(judge.floor(&best)) {
            laws = true;
        } else {
            break;
        }
    }
    report("dropping what the others explain", 0.8);
    let before = best.point.effects.len();
    best = judge.eliminate(best, MIN_SHARE)?;
    if judge.ratio(&judge.held_out(&best)) > judge.complete(&best) {
        let share = if problem.specimen.recordings() == 1 || !problem.specimen.is_cheap() {
            MIN_SHARE_INCOMPLETE
        } else {
            MIN_SHARE_CONDITIONS
        };
        best = judge.eliminate(best, share)?;
    }

    report("testing rivals in the place of each effect", 0.88);
    let (mut chosen, mut better) = judge.explain(&best, laws)?;
    let mut exchanged = false;
    for _ in 0..2 {
        let Some(next) = better else { break };
        best = judge.eliminate(next, MIN_SHARE)?;
        exchanged = true;
        (chosen, better) = judge.explain(&best, laws)?;
    }
    if exchanged || best.point.effects.len() != before {
        screened = judge.screen(&best, judge.open(&best.point, laws))?;
    }
    for (candidate, fit) in &screened {
        if let (Some(trial), Some(fit)) = (trials.iter_mut().find(|t| t.candidate == *candidate), fit) {
            trial.added = Some(judge.ratio(&judge.held_out(fit)));
        }
    }
    let noise_ratio = (judge.ratio(&calibrated_costs), judge.ratio(&judge.held_out(&best)));
    let complete = judge.complete(&best);
    Ok(Selection {
        calibrated,
        best,
        chosen,
        trials,
        noise_ratio,
        incomplete: noise_ratio.1 > complete,
    })
}

fn record_alone(judge: &Judge<'_, '_>, screened: &Screened, trials: &mut Vec<Trial>) {
    for (candidate, fit) in screened {
        if trials.iter().all(|t| t.candidate != *candidate) {
            let alone = fit.as_ref().map_or(f64::INFINITY, |f| judge.ratio(&judge.held_out(f)));
            trials.push(Trial {
                candidate: *candidate,
                alone,
                added: None,
            });
        }
    }
}
