//! Which relation of the model must change to explain the misfit.

use crate::effect::of;
use crate::search::Selection;
use crate::specimen::Specimen;

/// What changing one relation of the model, and nothing else, can explain.
#[derive(Debug, Clone)]
pub struct ChangedRelation {
    /// The relation of the model, in words.
    pub relation: String,
    /// Part of the held-out misfit beyond noise that disappears, at most 1.
    pub share_of_excess: f64,
    /// Index of the best candidate that changes the relation.
    pub candidate: usize,
}

/// Every relation with the share of the excess misfit that its best candidate explains alone, largest first.
#[must_use]
pub fn relations_changed_alone(specimen: &dyn Specimen, selection: &Selection) -> Vec<ChangedRelation> {
    let before = selection.calibrated_ratio * selection.calibrated_ratio;
    let excess = before - 1.0;
    let mut out: Vec<ChangedRelation> = Vec::new();
    if excess < super::LEAST_EXCESS {
        return out;
    }
    for score in &selection.scores {
        let candidate = &specimen.candidates()[score.candidate];
        let relation = of(candidate.id).changed_relation(&candidate.place.site);
        let share = ((before - score.alone * score.alone) / excess).clamp(0.0, 1.0);
        match out.iter_mut().find(|r| r.relation == relation) {
            Some(known) if known.share_of_excess >= share => {}
            Some(known) => (known.share_of_excess, known.candidate) = (share, score.candidate),
            None => out.push(ChangedRelation {
                relation,
                share_of_excess: share,
                candidate: score.candidate,
            }),
        }
    }
    out.sort_by(|a, b| b.share_of_excess.total_cmp(&a.share_of_excess));
    out
}
