//! How figures show a place and its series: title, digits, and the unit in which people read it.

use super::words;
use crate::diagnosis::Diagnosis;
use crate::effect::of;
use crate::locate::Location;
use crate::vocabulary::SpecimenKind;

/// Title of the figures of a location: its effect and its place.
pub(super) fn title(kind: SpecimenKind, diagnosis: &Diagnosis, location: &Location) -> String {
    let effect =
        (diagnosis.effects.iter()).find(|e| e.candidate() == location.candidate && location.candidate.is_some());
    match effect {
        Some(e) => format!(
            "{} {}",
            words::sentence(of(e.id).named(kind, &e.label)),
            words::at(&location.place)
        ),
        None => "Unexplained misfit".into(),
    }
}

/// Values rounded to five digits, which is all that a figure shows.
pub(super) fn brief(values: &[f64]) -> Vec<f64> {
    values
        .iter()
        .map(|v| format!("{v:.4e}").parse().unwrap_or(*v))
        .collect()
}

/// Factor and unit in which people read a quantity.
pub(super) fn scaled(unit: &str) -> (f64, &str) {
    match unit {
        "Pa" => (1e-6, "MPa"),
        "m" => (1e3, "mm"),
        other => (1.0, other),
    }
}
