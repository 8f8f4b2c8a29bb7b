//! One campaign diagnosed: the selection, put into figures a person or a program can judge.

use rayon::prelude::*;

use crate::confidence::Evidence;
use crate::error::DiagnoseError;
use crate::estimation::covariance::covariance;
use crate::estimation::{Fit, LeastSquares, Point, held_out, interval};
use crate::locate::{ChangedRelation, Location, locate, relations_changed_alone};
use crate::search::{Progress, SelectedEffect, Selection, select};
use crate::specimen::{MeasuredRelation, Series};
use crate::vocabulary::{Branch, Column, EffectId, Place, Site};
use crate::whiteness::{Whiteness, whiteness};

/// Noise ratios of one channel.
#[derive(Debug, Clone)]
pub struct ChannelFigures {
    /// Its column.
    pub column: Column,
    /// Model as given.
    pub before: f64,
    /// Improved model, all recordings in the fit.
    pub after: f64,
    /// Given model, recalibrated within tolerance without the block it is judged on.
    pub held_out_before: f64,
    /// Improved model, fitted without the block it is judged on.
    pub held_out_after: f64,
    /// Correlation of neighbouring residuals of the improved model: 0 is white.
    pub lag_one: f64,
}

/// A fitted number with its interval.
#[derive(Debug, Clone)]
pub struct Estimate {
    /// Key with unit.
    pub key: String,
    /// Value.
    pub value: f64,
    /// 95 % interval from blocks; not finite where the recordings do not determine it.
    pub ci95: [f64; 2],
}

/// An effect as reported: one place, its numbers.
#[derive(Debug, Clone)]
pub struct Effect {
    /// Id of the vocabulary.
    pub id: EffectId,
    /// Where it acts.
    pub place: Place,
    /// Distinguishes laws without a name.
    pub label: String,
    /// The effect of the improved model; `None` for something seen but not modelled.
    pub selected: Option<SelectedEffect>,
    /// Chance that it is there, 0.05 to 0.99.
    pub confidence: f64,
    /// Numbers.
    pub parameters: Vec<Estimate>,
    /// Law without a name, where one was fitted.
    pub law: Option<serde_json::Value>,
    /// Held-out noise ratio without and with it.
    pub held_out: (f64, f64),
}

/// Everything found out about a campaign.
pub struct Diagnosis {
    /// The selection.
    pub selection: Selection,
    /// Effects as reported, strongest first.
    pub effects: Vec<Effect>,
    /// Pairs of ids that the recordings cannot tell apart.
    pub ambiguous: Vec<[EffectId; 2]>,
    /// What to record to separate them.
    pub next_experiment: Option<String>,
    /// Where the misfit is.
    pub locations: Vec<Location>,
    /// Relations between measured neighbours, tested without simulation.
    pub relations: Vec<MeasuredRelation>,
    /// What changing one relation of the model alone explains.
    pub changed_relations: Vec<ChangedRelation>,
    /// Per channel.
    pub channels: Vec<ChannelFigures>,
    /// Calibration: key, deviation, interval, in units of the tolerance's standard deviation.
    pub calibration: Vec<(Estimate, f64)>,
    /// Strongly correlated pairs of estimates.
    pub correlated: Vec<(String, String, f64)>,
    /// Residuals of the calibrated and the improved model, in noise units.
    pub residuals: (Vec<Series>, Vec<Series>),
    /// Held-out residuals of the recalibrated and of the improved model.
    pub held_out: (Vec<Series>, Vec<Series>),
    /// Whether the held-out residuals of the improved model are noise, per channel.
    pub whiteness: Vec<Whiteness>,
    /// Recordings simulated.
    pub simulated: usize,
    /// The model file as given, in the form of the improved one.
    pub given_toml: String,
    /// The improved model file.
    pub model_toml: String,
}

impl Diagnosis {
    /// Diagnoses a campaign.
    ///
    /// # Errors
    /// A model that cannot be simulated, or the wish to stop.
    pub fn of(problem: &LeastSquares<'_>, progress: Progress<'_>) -> Result<Self, DiagnoseError> {
        let selection = select(problem, progress)?;
        progress("judging on held-out blocks", 0.95);
        let (specimen, evaluation) = (problem.specimen(), &problem.evaluation);
        let given = evaluation.residuals_at(&Point::nominal(specimen))?;
        let calibrated = evaluation.residuals_at(&selection.calibrated.point)?;
        let improved = evaluation.residuals_at(&selection.best.point)?;
        let held_out_before = held_out_residuals(problem, &selection.calibrated)?;
        let held_out_after = held_out_residuals(problem, &selection.best)?;
        let channels = (specimen.channels().iter().enumerate())
            .map(|(c, channel)| ChannelFigures {
                column: channel.column.clone(),
                before: ratio(&given, c),
                after: ratio(&improved, c),
                held_out_before: ratio(&held_out_before, c),
                held_out_after: ratio(&held_out_after, c),
                lag_one: lag_one(&improved, c),
            })
            .collect();
        let (estimates, correlated) = estimates(problem, &selection.best)?;
        let mut effects = effects(problem, &selection, &estimates);
        let seen = effects.iter().any(|e| e.id == EffectId::Unlisted);
        // A strut's model is said to be complete but for what is missing: what is left then has no name.
        if selection.incomplete && !seen && specimen.is_believed_complete() {
            effects.push(Effect {
                id: EffectId::Unlisted,
                place: Site::Unknown.into(),
                label: "remaining misfit".into(),
                selected: None,
                confidence: 0.6,
                parameters: vec![],
                law: None,
                held_out: (selection.improved_ratio, selection.improved_ratio),
            });
        }
        let all = specimen.candidates();
        let mut ambiguous: Vec<[EffectId; 2]> = Vec::new();
        let mut next = Vec::new();
        for effect in &selection.effects {
            let Some(rival) = effect.ambiguous_rival() else {
                continue;
            };
            let (effect, rival) = (&all[effect.candidate], &all[rival]);
            next.push(crate::experiment::separate(specimen.kind(), effect, rival));
            let pair = [effect.id, rival.id];
            if pair[0] != pair[1] && !ambiguous.contains(&pair) {
                ambiguous.push(pair);
            }
        }
        let locations = locate(problem, &selection, &calibrated, &improved)?;
        if let Some(left) = locations.iter().find(|l| l.candidate.is_none()) {
            next.push(crate::experiment::isolate(specimen, left));
        }
        let calibration_count = specimen.calibration().len();
        let calibration = (estimates.iter().take(calibration_count).cloned())
            .zip(selection.best.point.z.iter().copied())
            .collect();
        let toml = |point: &Point| (specimen.model_toml(&point.hypothesis(specimen))).map_err(DiagnoseError::Output);
        let (model_toml, given_toml) = (toml(&selection.best.point)?, toml(&Point::nominal(specimen))?);
        Ok(Self {
            relations: specimen.measured_relations(),
            changed_relations: relations_changed_alone(specimen, &selection),
            whiteness: whiteness(specimen, &held_out_after),
            held_out: (held_out_before, held_out_after),
            effects,
            ambiguous,
            next_experiment: (!next.is_empty()).then(|| next.join(" ")),
            locations,
            channels,
            calibration,
            correlated,
            residuals: (calibrated, improved),
            simulated: evaluation.simulated(),
            given_toml,
            model_toml,
            selection,
        })
    }

    /// `consistent`, `missing_physics` or `unexplained`.
    #[must_use]
    pub fn verdict(&self) -> &'static str {
        match (
            self.effects.iter().any(|e| e.selected.is_some()),
            self.selection.incomplete,
        ) {
            (true, _) => "missing_physics",
            (false, true) => "unexplained",
            (false, false) => "consistent",
        }
    }
}

/// Residuals of every block from a simulation whose parameters that block's fold had no say in.
fn held_out_residuals(problem: &LeastSquares<'_>, fit: &Fit) -> Result<Vec<Series>, DiagnoseError> {
    let folds: Vec<Vec<Series>> = (held_out(fit, problem).points.par_iter())
        .map(|point| problem.evaluation.residuals_at(point))
        .collect::<Result<_, DiagnoseError>>()?;
    let mut out = folds[0].clone();
    for b in problem.blocks.as_slice() {
        for (to, from) in out[b.recording].iter_mut().zip(&folds[b.fold][b.recording]) {
            to[b.start..b.end].copy_from_slice(&from[b.start..b.end]);
        }
    }
    Ok(out)
}

fn ratio(residuals: &[Series], channel: usize) -> f64 {
    let n: usize = residuals.iter().map(|r| r[channel].len()).sum();
    let sum: f64 = residuals
        .iter()
        .map(|r| r[channel].iter().map(|v| v * v).sum::<f64>())
        .sum();
    (sum / n as f64).sqrt()
}

fn lag_one(residuals: &[Series], channel: usize) -> f64 {
    let (mut product, mut square) = (0.0, 0.0);
    for r in residuals {
        product += r[channel].windows(2).map(|w| w[0] * w[1]).sum::<f64>();
        square += r[channel].iter().map(|v| v * v).sum::<f64>();
    }
    product / square.max(1e-300)
}

/// Values and intervals of all parameters, and which are strongly correlated.
type Estimates = (Vec<Estimate>, Vec<(String, String, f64)>);

fn estimates(problem: &LeastSquares<'_>, fit: &Fit) -> Result<Estimates, DiagnoseError> {
    let parameters = fit.point.parameters(problem.specimen());
    let deviations = interval::deviations(problem, fit)?;
    let estimates = (parameters.iter().zip(&fit.point.z).zip(deviations.iter()))
        .map(|((p, &z), &sd)| {
            let (low, high) = (p.value(z - 1.96 * sd), p.value(z + 1.96 * sd));
            match p.inverse_of {
                Some(key) => Estimate {
                    key: key.into(),
                    value: 1.0 / p.value(z),
                    ci95: [1.0 / high, 1.0 / low],
                },
                None => Estimate {
                    key: p.key.clone(),
                    value: p.value(z),
                    ci95: [low, high],
                },
            }
        })
        .collect();
    let mut correlated = Vec::new();
    if let Some(c) = covariance(fit) {
        for i in 0..parameters.len() {
            for j in 0..i {
                let r = c[(i, j)] / (c[(i, i)] * c[(j, j)]).sqrt();
                if r.abs() > 0.9 {
                    correlated.push((parameters[j].key.clone(), parameters[i].key.clone(), r));
                }
            }
        }
    }
    Ok((estimates, correlated))
}

fn effects(problem: &LeastSquares<'_>, selection: &Selection, estimates: &[Estimate]) -> Vec<Effect> {
    let specimen = problem.specimen();
    let point = &selection.best.point;
    let hypothesis = point.hypothesis(specimen);
    let mut out = Vec::new();
    for selected in &selection.effects {
        let Some(position) = point.effects.iter().position(|&e| e == selected.candidate) else {
            continue;
        };
        let candidate = &specimen.candidates()[selected.candidate];
        let own = &estimates[point.coordinates_of(specimen, position)];
        let law = (candidate.is_unlisted())
            .then(|| specimen.law(selected.candidate, &hypothesis.effects[position].1))
            .flatten();
        let evidence = Evidence {
            gain: (selected.gain.total, selected.gain.standard_error),
            lead: selected.rival.map(|r| (r.lead.total, r.lead.standard_error)),
        };
        let confidence = evidence.confidence();
        for (place, which) in places(&candidate.place, own.len()) {
            out.push(Effect {
                id: candidate.id,
                place,
                label: candidate.label.clone(),
                selected: Some(selected.clone()),
                confidence,
                parameters: which.iter().map(|&k| own[k].clone()).collect(),
                law: law.clone(),
                held_out: (selected.ratio_without, selection.improved_ratio),
            });
        }
    }
    out
}

/// A candidate that acts in several places is reported once a place, each with its own numbers.
fn places(place: &Place, count: usize) -> Vec<(Place, Vec<usize>)> {
    let at = |site: Site, numbers: Vec<usize>| (place.with_site(site), numbers);
    match (&place.site, count) {
        (Site::Accumulators, 2) => Branch::ALL
            .map(|branch| at(Site::Accumulator(branch), vec![branch.number() - 1]))
            .to_vec(),
        (Site::Paths, 3) => Branch::ALL
            .map(|branch| at(Site::Path(branch), vec![branch.number() - 1, 2]))
            .to_vec(),
        (_, n) => vec![(place.clone(), (0..n).collect())],
    }
}
