//! Campaigns that conceal what the search is not allowed to name.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::effect::in_struts;
use crate::median::median;
use crate::selftest::statistics::Rate;
use crate::selftest::trial::Trial;
use crate::vocabulary::EffectId;

/// A model predicts unseen recordings as well as can be asked if it comes within this multiple of the true model.
pub const NEAR_FLOOR: f64 = 1.2;

/// What was said of a term that the search was not allowed.
#[derive(Debug, Clone, Serialize)]
pub struct Nameless {
    /// Effect that was removed from the search.
    pub term: EffectId,
    /// Campaigns in which `unlisted` was reported instead.
    pub unlisted: Rate,
    /// With a law at the place of the effect, or laws at its parts.
    pub placed: Rate,
    /// Another name reported instead or beside.
    pub misnamed: Rate,
    /// Median noise ratio on unseen recordings, recalibrated model.
    pub before: f64,
    /// The same with what was reported.
    pub after: f64,
    /// The same of the true model.
    pub floor: f64,
    /// Campaigns in which what was reported predicts unseen recordings to within [`NEAR_FLOOR`] times what the true model reaches.
    pub near_floor: Rate,
    /// Places reported, with counts.
    pub places: BTreeMap<String, usize>,
}

/// A row for each term that was removed.
pub(super) fn nameless(trials: &[&Trial]) -> Vec<Nameless> {
    in_struts()
        .into_iter()
        .filter_map(|term| {
            let own: Vec<&&Trial> = trials.iter().filter(|t| t.left_out == Some(term)).collect();
            if own.is_empty() {
                return None;
            }
            let mut row = Nameless {
                term,
                unlisted: Rate::default(),
                placed: Rate::default(),
                misnamed: Rate::default(),
                places: BTreeMap::new(),
                before: median(own.iter().map(|t| t.unseen.0).collect()),
                after: median(own.iter().map(|t| t.unseen.1).collect()),
                floor: median(own.iter().map(|t| t.unseen_floor).collect()),
                near_floor: Rate::default(),
            };
            for t in own {
                row.unlisted.count(t.found(EffectId::Unlisted));
                row.placed.count(t.law_is_placed());
                row.near_floor.count(t.unseen.1 <= NEAR_FLOOR * t.unseen_floor);
                row.misnamed
                    .count(t.reported.iter().any(|r| r.id != EffectId::Unlisted));
                for r in &t.reported {
                    *row.places
                        .entry(format!("{}@{}", r.id, r.place.as_reported()))
                        .or_default() += 1;
                }
            }
            Some(row)
        })
        .collect()
}
