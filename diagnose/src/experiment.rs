//! What to record next: the excitation in which two effects that cannot be distinguished differ most, or the excitation that
//! isolates an unexplained misfit, with amplitude, speed and valve state.

use crate::effect::{Candidate, of};
use crate::locate::Location;
use crate::specimen::Specimen;
use crate::vocabulary::{SpecimenKind, State};

/// What to record to separate two candidates: amplitude, speed, valve state, and what each of the two causes then. Each
/// effect has an experiment of its own; if one experiment separates a pair better, one of the two effects names it.
#[must_use]
pub fn separate(kind: SpecimenKind, a: &Candidate, b: &Candidate) -> String {
    let (one, other) = (of(a.id), of(b.id));
    let how = if kind == SpecimenKind::TwoStageStrut {
        one.told_from(b.id).or_else(|| other.told_from(a.id))
    } else {
        None
    };
    let how = how.map_or_else(|| in_turn(kind, a, b), str::to_owned);
    format!("To separate {} from {}, record {how}.", a.name(), b.name())
}

/// The experiments of two effects one after the other, and what each effect causes in its own.
fn in_turn(kind: SpecimenKind, a: &Candidate, b: &Candidate) -> String {
    let own = |c: &Candidate| of(c.id).experiment_in(kind);
    let name = |c: &Candidate| of(c.id).named(kind, &c.label);
    match (own(a), own(b)) {
        (Some(first), _) if a.id == b.id && a.place == b.place => format!(
            "{}. Each of the two laws depends on its own quantity ({}; {})",
            first.record, a.label, b.label
        ),
        (Some(first), _) if a.id == b.id => format!(
            "{}. In this recording {} {}. If it acts at {there}, the channels next to {there} show it; if it acts at \
             {elsewhere}, the channels next to {elsewhere} show it",
            first.record,
            name(a),
            first.shows,
            there = a.place,
            elsewhere = b.place
        ),
        (Some(first), Some(second)) if first.record == second.record => format!(
            "{}. In this recording {} {}, whereas {} {}",
            first.record,
            name(a),
            first.shows,
            name(b),
            second.shows
        ),
        (Some(first), Some(second)) => format!(
            "{}. In this recording {} {}. Record also {}. In that recording {} {}",
            first.record,
            name(a),
            first.shows,
            second.record,
            name(b),
            second.shows
        ),
        _ => "these two do not occur in one kind of specimen".to_owned(),
    }
}

/// What to record about an unexplained misfit: the condition in which it occurs, with one quantity changed at a time.
#[must_use]
pub fn isolate(specimen: &dyn Specimen, left: &Location) -> String {
    let r = left.recording;
    let place = format!(
        "The unexplained misfit is largest in {} of {} from {:.2} to {:.2} s (condition: {}).",
        specimen.channels()[left.channel].column,
        specimen.recording_name(r),
        left.t_s[0],
        left.t_s[1],
        left.condition.text
    );
    if left.condition.decays {
        return format!(
            "{place} Record the step before it on its own, held ten times as long ({:.0} s), in both directions, at 1x and 0.5x \
             amplitude and at 1x and 0.1x speed{}.",
            10.0 * (left.t_s[1] - left.t_s[0]),
            valves(specimen, r, left.t_s).map_or(String::new(), |v| format!(", {v}"))
        );
    }
    let time = specimen.time_s(r);
    let within: Vec<usize> = (0..time.len())
        .filter(|&k| time[k] >= left.t_s[0] && time[k] <= left.t_s[1])
        .collect();
    let states = specimen.states(r);
    let series = |state: State| states.iter().find(|s| s.state == state).map(|s| &s.values);
    let mut how = Vec::new();
    if let Some(x) = series(State::Displacement) {
        let (low, high) = within
            .iter()
            .fold((f64::MAX, f64::MIN), |(a, b), &k| (a.min(x[k]), b.max(x[k])));
        how.push(format!("from {:.0} to {:.0} mm", 1e3 * low, 1e3 * high));
    }
    if let Some(v) = series(State::Speed) {
        let fastest = within.iter().fold(0.0_f64, |m, &k| m.max(v[k].abs()));
        let speeds = [0.3, 1.0, 3.0].map(|f| oleo_report::significant(f * fastest, 2));
        how.push(format!("at {} m/s in turn", speeds.join(", ")));
    }
    how.push(valves(specimen, r, left.t_s).unwrap_or_else(|| "with all other conditions unchanged".into()));
    format!("{place} Record strokes {}, each twice.", how.join(", "))
}

/// The valve states in the middle of a stretch, and then the opposite states.
fn valves(specimen: &dyn Specimen, recording: usize, t_s: [f64; 2]) -> Option<String> {
    let time = specimen.time_s(recording);
    let middle = time
        .partition_point(|t| *t < 0.5 * (t_s[0] + t_s[1]))
        .min(time.len() - 1);
    let valves = specimen.settings(recording, middle);
    (!valves.is_empty()).then(|| {
        format!(
            "with {}, and then with each valve in its other state",
            valves.join(", ")
        )
    })
}
