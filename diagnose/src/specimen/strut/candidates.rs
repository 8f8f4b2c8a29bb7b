//! Everything that a strut's model may lack.

use oleo_plant_sim::strut::{COLUMNS, StrutModel};

use super::channels::Layout;
use crate::effect::{ALL, Candidate, of, sensor};
use crate::excitation;
use crate::vocabulary::EffectId;

/// Physics, then the instruments column by column, then laws without a name.
pub(super) fn candidates(model: &StrutModel, excitation: &excitation::Strut, layout: Layout) -> Vec<Candidate> {
    let of_effect = |id: EffectId| of(id).in_strut().map_or(vec![], |e| e.candidates(model, excitation));
    let physics = ALL.iter().filter(|id| id.is_physics()).flat_map(|&id| of_effect(id));
    let mut faults: Vec<Candidate> = sensor::IN_ORDER.into_iter().flat_map(of_effect).collect();
    faults.sort_by_key(|fault| {
        COLUMNS
            .iter()
            .position(|name| fault.place.sensor().is_some_and(|c| c == name))
    });
    let nameless = of_effect(EffectId::Unlisted);
    (physics.chain(faults).chain(nameless))
        .filter(|candidate| {
            let sensor = candidate.place.sensor();
            sensor.is_none_or(|sensor| layout.unrecorded().all(|name| *sensor != name))
        })
        .map(|candidate| {
            let unseen = layout.unseen(&candidate.place.site);
            candidate.testable_unless(excitation.still().or(unseen))
        })
        .collect()
}
