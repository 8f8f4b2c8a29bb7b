//! The diagnosis of a campaign: the result of the search as figures for readers and programs.

mod channel_figures;
mod effect;
mod estimate;

use serde::Serialize;
use strum::Display;

use crate::error::DiagnoseError;
use crate::estimation::{LeastSquares, Point, interval};
use crate::experiment;
use crate::locate::{ChangedRelation, Location, locate, relations_changed_alone};
use crate::search::{Progress, Selection, select};
use crate::specimen::{MeasuredRelation, Specimen};
use crate::vocabulary::EffectId;
use crate::whiteness::{Whiteness, whiteness};
use channel_figures::held_out_residuals;

pub use channel_figures::{ChannelFigures, Residuals};
pub use effect::Effect;
pub use estimate::{CalibratedValue, Correlation, Estimate};

/// The answer in one word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Display, Serialize)]
#[strum(serialize_all = "snake_case")]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The model matches the recordings within its tolerances.
    Consistent,
    /// The model leaves out effects that were found.
    MissingPhysics,
    /// The model does not match the recordings, and none of the effects that were tried explains it.
    Unexplained,
}

/// The result of the diagnosis of a campaign.
pub struct Diagnosis {
    /// The outcome of the search.
    pub selection: Selection,
    /// Effects as reported, the one of largest gain first.
    pub effects: Vec<Effect>,
    /// Pairs of ids that the recordings cannot tell apart.
    pub ambiguous: Vec<[EffectId; 2]>,
    /// What to record to separate them, or to isolate what is left.
    pub next_experiment: Option<String>,
    /// Places of the misfit, with time and condition.
    pub locations: Vec<Location>,
    /// Relations between measured neighbours, tested without simulation.
    pub relations: Vec<MeasuredRelation>,
    /// The part of the misfit that changing only one relation of the model explains, for each relation.
    pub changed_relations: Vec<ChangedRelation>,
    /// Noise ratios of each channel.
    pub channels: Vec<ChannelFigures>,
    /// Values that calibration re-estimated.
    pub calibration: Vec<CalibratedValue>,
    /// Strongly correlated pairs of estimates.
    pub correlations: Vec<Correlation>,
    /// Residuals of the calibrated and the improved model.
    pub residuals: Residuals,
    /// Held-out residuals of both models: each block is simulated with parameters that were fitted without its fold.
    pub held_out: Residuals,
    /// Whether the held-out residuals of the improved model are noise, one entry a channel.
    pub whiteness: Vec<Whiteness>,
    /// Number of recordings that were simulated during the search.
    pub simulated: usize,
    /// The model file as given, in the form of the improved one.
    pub given_toml: String,
    /// The improved model file.
    pub model_toml: String,
}

impl Diagnosis {
    /// Diagnoses a campaign.
    ///
    /// ```no_run
    /// use std::sync::atomic::AtomicBool;
    /// use oleo_diagnose::estimation::LeastSquares;
    /// use oleo_diagnose::{Campaign, Diagnosis};
    ///
    /// let campaign = Campaign::open("recordings/strut-7".as_ref())?;
    /// let stop = AtomicBool::new(false);
    /// let problem = LeastSquares::new(&*campaign.specimen, &stop);
    /// let diagnosis = Diagnosis::of(&problem, &|doing, done| eprintln!("{doing}: {:.0} %", 100.0 * done))?;
    /// println!("{}", diagnosis.verdict());
    /// for effect in &diagnosis.effects {
    ///     println!("{} at {}, confidence {:.2}", effect.id, effect.place, effect.confidence);
    /// }
    /// # Ok::<(), oleo_diagnose::DiagnoseError>(())
    /// ```
    ///
    /// # Errors
    /// A model that cannot be simulated; [`DiagnoseError::Interrupted`] once the caller asked to stop.
    pub fn of(problem: &LeastSquares<'_>, progress: Progress<'_>) -> Result<Self, DiagnoseError> {
        let selection = select(problem, progress)?;
        progress("judging on held-out blocks", 0.95);
        Self::of_selection(problem, selection)
    }

    /// The figures of a search that has been made.
    ///
    /// # Errors
    /// As [`Diagnosis::of`].
    pub fn of_selection(problem: &LeastSquares<'_>, selection: Selection) -> Result<Self, DiagnoseError> {
        let (specimen, evaluation) = (problem.specimen(), &problem.evaluation);
        let (calibrated, best) = (&selection.calibrated, &selection.best);
        let given = evaluation.residuals_at(&Point::nominal(specimen))?;
        let residuals = Residuals {
            calibrated: evaluation.residuals_at(&calibrated.point)?,
            improved: evaluation.residuals_at(&best.point)?,
        };
        let held_out = Residuals {
            calibrated: held_out_residuals(problem, calibrated)?,
            improved: held_out_residuals(problem, best)?,
        };
        let derived = interval::derived_from_both_sides(problem, best)?;
        let estimates = estimate::estimates(problem, &derived)?;
        let locations = locate(problem, &selection, &residuals.calibrated, &residuals.improved)?;
        let toml = |point: &Point| (specimen.model_toml(&point.hypothesis(specimen))).map_err(DiagnoseError::Output);
        Ok(Self {
            effects: effect::effects(problem, &selection, &estimates),
            ambiguous: ambiguous(specimen, &selection),
            next_experiment: next_experiment(specimen, &selection, &locations),
            locations,
            relations: specimen.measured_relations(),
            changed_relations: relations_changed_alone(specimen, &selection),
            channels: ChannelFigures::of(problem, &given, &residuals, &held_out),
            calibration: estimate::calibration(problem, best, &estimates),
            correlations: estimate::correlations(problem, &derived),
            whiteness: whiteness(specimen, &held_out.improved),
            residuals,
            held_out,
            simulated: evaluation.simulated(),
            given_toml: toml(&Point::nominal(specimen))?,
            model_toml: toml(&best.point)?,
            selection,
        })
    }

    /// The answer in one word.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        let found = self.effects.iter().any(|e| e.selected.is_some());
        match (found, self.selection.incomplete) {
            (true, _) => Verdict::MissingPhysics,
            (false, true) => Verdict::Unexplained,
            (false, false) => Verdict::Consistent,
        }
    }
}

/// Pairs of different ids that the recordings cannot tell apart, each once.
fn ambiguous(specimen: &dyn Specimen, selection: &Selection) -> Vec<[EffectId; 2]> {
    let all = specimen.candidates();
    let mut pairs: Vec<[EffectId; 2]> = Vec::new();
    for effect in &selection.effects {
        for other in effect.indistinguishable() {
            let pair = [all[effect.candidate].id, all[other].id];
            if pair[0] != pair[1] && !pairs.contains(&pair) {
                pairs.push(pair);
            }
        }
    }
    pairs
}

/// What to record next: one sentence for each pair that cannot be told apart, one for what nothing explains.
fn next_experiment(specimen: &dyn Specimen, selection: &Selection, locations: &[Location]) -> Option<String> {
    let all = specimen.candidates();
    let mut sentences: Vec<String> = (selection.effects.iter())
        .flat_map(|effect| effect.indistinguishable().map(|other| (effect.candidate, other)))
        .map(|(effect, other)| experiment::separate(specimen.kind(), &all[effect], &all[other]))
        .collect();
    sentences.extend(experiment::at_another_frequency(&selection.of_excitation_hz));
    if let Some(left) = locations.iter().find(|l| l.candidate.is_none()) {
        sentences.push(experiment::isolate(specimen, left));
    }
    (!sentences.is_empty()).then(|| sentences.join(" "))
}
