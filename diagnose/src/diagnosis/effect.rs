//! Effects as they are reported: one entry for each place, with the parameters that belong to it.

use super::estimate::Estimate;
use crate::confidence::{Evidence, upper_limit, upper_limit_beside_a_law, upper_limit_of_law};
use crate::effect::{of, unlisted};
use crate::estimation::LeastSquares;
use crate::search::{SelectedEffect, Selection};
use crate::vocabulary::{EffectId, Place, Site};

/// Confidence in a misfit that stays and that no law was found for: it is seen, but it may be an instrument's.
const REMAINDER_CONFIDENCE: f64 = 0.6;

/// An effect as reported.
#[derive(Debug, Clone)]
pub struct Effect {
    /// Id of the effect in the vocabulary.
    pub id: EffectId,
    /// Place where the effect acts.
    pub place: Place,
    /// What tells laws without a name apart; empty for everything else.
    pub label: String,
    /// The effect of the improved model; `None` for a misfit that is seen but not modelled.
    pub selected: Option<SelectedEffect>,
    /// Chance that it is there, at its place, 0.05 to 0.99.
    pub confidence: f64,
    /// Parameters of the effect with their intervals.
    pub parameters: Vec<Estimate>,
    /// The law without a name, where one was fitted.
    pub law: Option<serde_json::Value>,
    /// The same as an equation with its numbers, where its form is one.
    pub equation: Option<String>,
    /// Held-out noise ratio of the best model without it.
    pub ratio_without: f64,
    /// Held-out noise ratio of the improved model.
    pub ratio_with: f64,
}

impl Effect {
    /// Index of the candidate; `None` for a misfit that is not modelled.
    #[must_use]
    pub fn candidate(&self) -> Option<usize> {
        self.selected.as_ref().map(|s| s.candidate)
    }
}

impl Effect {
    /// Whether it is a number of the model that is other than believed, and no law.
    #[must_use]
    pub fn is_wrong_number(&self) -> bool {
        self.id == EffectId::Unlisted && unlisted::is_believed_number(&self.label)
    }
}

/// The effects of the improved model, and the remaining misfit if the model is stated to be complete.
pub(super) fn effects(problem: &LeastSquares<'_>, selection: &Selection, estimates: &[Estimate]) -> Vec<Effect> {
    let mut out = modelled(problem, selection, estimates);
    let has_law = out.iter().any(|e| e.id == EffectId::Unlisted);
    if selection.incomplete && !has_law && problem.specimen().is_believed_complete() {
        out.push(Effect {
            id: EffectId::Unlisted,
            place: Site::Unknown.into(),
            label: "remaining misfit".into(),
            selected: None,
            confidence: REMAINDER_CONFIDENCE,
            parameters: vec![],
            law: None,
            equation: None,
            ratio_without: selection.improved_ratio,
            ratio_with: selection.improved_ratio,
        });
    }
    out
}

fn modelled(problem: &LeastSquares<'_>, selection: &Selection, estimates: &[Estimate]) -> Vec<Effect> {
    let specimen = problem.specimen();
    let point = &selection.best.point;
    let hypothesis = point.hypothesis(specimen);
    let most = upper_limit(selection.improved_ratio, selection.calibrated_ratio);
    let laws = (selection.effects.iter()).filter(|e| specimen.candidates()[e.candidate].is_law());
    let gain_of_law = laws.map(|law| law.gain.total).fold(0.0, f64::max);
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
        let equation = (candidate.is_unlisted())
            .then(|| unlisted::equation(candidate, &hypothesis.effects[position].1))
            .flatten();
        let evidence = Evidence {
            gain: (selected.gain.total, selected.gain.standard_error),
            lead: selected.rival.map(|r| (r.lead.total, r.lead.standard_error)),
        };
        let mut most = most.min(upper_limit_beside_a_law(selected.gain.total, gain_of_law));
        if candidate.is_law() {
            most = most.min(upper_limit_of_law(own.iter().map(|number| number.ci95)));
        }
        for (site, numbers) in of(candidate.id).reported(&candidate.place.site, own.len()) {
            out.push(Effect {
                id: candidate.id,
                place: candidate.place.with_site(site),
                label: candidate.label.clone(),
                selected: Some(selected.clone()),
                confidence: evidence.confidence().min(most),
                parameters: numbers.iter().map(|&k| own[k].clone()).collect(),
                law: law.clone(),
                equation: equation.clone(),
                ratio_without: selected.ratio_without,
                ratio_with: selection.improved_ratio,
            });
        }
    }
    out
}
