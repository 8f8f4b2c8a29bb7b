//! Which relation of the model must change to explain the misfit.

use oleo_interface::Valve;

use crate::search::Selection;
use crate::specimen::{Candidate, Specimen};
use crate::vocabulary::{EffectId, Site};

/// What changing one relation of the model, and nothing else, can explain.
#[derive(Debug, Clone)]
pub struct ChangedRelation {
    /// The relation.
    pub relation: String,
    /// Part of the held-out misfit beyond noise that disappears, at most 1.
    pub share_of_excess: f64,
    /// Candidate that does it.
    pub candidate: usize,
}

/// The relation of the model that a candidate changes.
#[must_use]
pub fn changed_by(candidate: &Candidate) -> String {
    let words = || candidate.place.site.to_string().replace('-', " ");
    match (&candidate.place.site, candidate.id) {
        (Site::Sensor(column), _) => format!("instrument {column}"),
        (Site::MainSeal | Site::EndStop, _) => "force balance".into(),
        (Site::Mount, _) => "motion of the strut (mount)".into(),
        (Site::MainChamber, _) => "continuity of the oil".into(),
        (Site::Chamber | Site::Accumulators, _) => "gas law".into(),
        (_, EffectId::AccumulatorPistonFriction) => format!("piston of {}", words()),
        (Site::Accumulator(_), _) => format!("gas law of {}", words()),
        (Site::Valves, _) => "valve timing".into(),
        (Site::Valve(Valve::Spring), _) => "flow through valve 3".into(),
        (Site::Paths, _) => "flow in both paths".into(),
        (Site::Path(_) | Site::Valve(_) | Site::Unknown, _) => format!("flow in {}", words()),
    }
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
        let relation = changed_by(&specimen.candidates()[score.candidate]);
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
