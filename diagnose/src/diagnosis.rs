//! One campaign diagnosed: the selection, put into figures a person or a program can judge.

use rayon::prelude::*;

use crate::confidence::Evidence;
use crate::error::DiagnoseError;
use crate::fit::Fit;
use crate::locate::{Location, Reach, Relation, locate, reaches, relations};
use crate::problem::Problem;
use crate::select::{Chosen, Report, Selection, select};
use crate::specimen::Series;
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
    /// Index of the chosen candidate, `None` for something seen but not modelled.
    pub chosen: Option<Chosen>,
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
    pub relations: Vec<Relation>,
    /// What changing one relation of the model alone explains.
    pub reaches: Vec<Reach>,
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
    pub fn of(problem: &Problem<'_>, report: Report<'_>) -> Result<Self, DiagnoseError> {
        let selection = select(problem, report)?;
        report("judging on held-out blocks", 0.95);
        let given = problem.residuals(&problem.predict(&problem.nominal())?);
        let calibrated = problem.residuals(&problem.predict(&selection.calibrated.point)?);
        let improved = problem.residuals(&problem.predict(&selection.best.point)?);
        let held_out_before = held_out_residuals(problem, &selection.calibrated)?;
        let held_out_after = held_out_residuals(problem, &selection.best)?;
        let channels = (problem.specimen.channels().iter().enumerate())
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
        if selection.incomplete && !seen && problem.specimen.kind().contains("strut") {
            effects.push(Effect {
                id: EffectId::Unlisted,
                place: Site::Unknown.into(),
                label: "remaining misfit".into(),
                chosen: None,
                confidence: 0.6,
                parameters: vec![],
                law: None,
                held_out: (selection.noise_ratio.1, selection.noise_ratio.1),
            });
        }
        let all = problem.specimen.candidates();
        let mut ambiguous: Vec<[EffectId; 2]> = Vec::new();
        let mut next = Vec::new();
        for chosen in selection.chosen.iter().filter(|c| c.ambiguous) {
            if let Some((rival, ..)) = chosen.rival {
                let pair = [all[chosen.candidate].id, all[rival].id];
                next.push(crate::experiment::separate(
                    problem.specimen.kind(),
                    &all[chosen.candidate],
                    &all[rival],
                ));
                if pair[0] != pair[1] && !ambiguous.contains(&pair) {
                    ambiguous.push(pair);
                }
            }
        }
        let locations = locate(problem, &selection, &calibrated, &improved)?;
        if let Some(left) = locations.iter().find(|l| l.candidate.is_none()) {
            next.push(crate::experiment::isolate(problem.specimen, left));
        }
        let calibration_count = problem.specimen.calibration().len();
        let calibration = (estimates.iter().take(calibration_count).cloned())
            .zip(selection.best.point.z.iter().copied())
            .collect();
        let hypothesis = problem.hypothesis(&selection.best.point);
        let model_toml = problem
            .specimen
            .model_toml(&hypothesis)
            .map_err(DiagnoseError::Output)?;
        let given_toml = problem
            .specimen
            .model_toml(&problem.hypothesis(&problem.nominal()))
            .map_err(DiagnoseError::Output)?;
        Ok(Self {
            relations: relations(problem.specimen),
            reaches: reaches(problem.specimen, &selection),
            whiteness: whiteness(problem.specimen, &held_out_after),
            held_out: (held_out_before, held_out_after),
            effects,
            ambiguous,
            next_experiment: (!next.is_empty()).then(|| next.join(" ")),
            locations,
            channels,
            calibration,
            correlated,
            residuals: (calibrated, improved),
            simulated: problem.simulated(),
            given_toml,
            model_toml,
            selection,
        })
    }

    /// `consistent`, `missing_physics` or `unexplained`.
    #[must_use]
    pub fn verdict(&self) -> &'static str {
        match (
            self.effects.iter().any(|e| e.chosen.is_some()),
            self.selection.incomplete,
        ) {
            (true, _) => "missing_physics",
            (false, true) => "unexplained",
            (false, false) => "consistent",
        }
    }
}

/// Residuals of every block from a simulation whose parameters that block's fold had no say in.
fn held_out_residuals(problem: &Problem<'_>, fit: &Fit) -> Result<Vec<Series>, DiagnoseError> {
    let folds: Vec<Vec<Series>> = fit
        .fold_points(problem)
        .par_iter()
        .map(|point| Ok(problem.residuals(&problem.predict(point)?)))
        .collect::<Result<_, DiagnoseError>>()?;
    let mut out = folds[0].clone();
    for b in &problem.blocks {
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

fn estimates(problem: &Problem<'_>, fit: &Fit) -> Result<Estimates, DiagnoseError> {
    let parameters = problem.parameters(&fit.point.effects);
    let deviations = crate::interval::deviations(problem, fit)?;
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
    if let Some(c) = fit.covariance() {
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

fn effects(problem: &Problem<'_>, selection: &Selection, estimates: &[Estimate]) -> Vec<Effect> {
    let all = problem.specimen.candidates();
    let hypothesis = problem.hypothesis(&selection.best.point);
    let mut out = Vec::new();
    for chosen in &selection.chosen {
        let candidate = &all[chosen.candidate];
        let position = selection
            .best
            .point
            .effects
            .iter()
            .position(|&e| e == chosen.candidate)
            .unwrap_or(0);
        let before: usize = selection.best.point.effects[..position]
            .iter()
            .map(|&e| all[e].parameters.len())
            .sum();
        let from = problem.specimen.calibration().len() + before;
        let own = &estimates[from..from + candidate.parameters.len()];
        let law = (candidate.is_unlisted())
            .then(|| problem.specimen.law(chosen.candidate, &hypothesis.effects[position].1))
            .flatten();
        let evidence = Evidence {
            gain: (chosen.gain, chosen.gain_error),
            lead: chosen.rival.map(|(_, lead, error)| (lead, error)),
        };
        let confidence = evidence.confidence();
        for (place, which) in places(&candidate.place, own.len()) {
            out.push(Effect {
                id: candidate.id,
                place,
                label: candidate.label.clone(),
                chosen: Some(chosen.clone()),
                confidence,
                parameters: which.iter().map(|&k| own[k].clone()).collect(),
                law: law.clone(),
                held_out: (chosen.without, selection.noise_ratio.1),
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
