//! What to record next: the excitation in which two effects that cannot be distinguished differ most, or the excitation that
//! isolates an unexplained misfit, with amplitude, speed and valve state.

mod command;

use crate::effect::{Candidate, of};
use crate::locate::Location;
use crate::search::Selection;
use crate::specimen::Specimen;
use crate::vocabulary::{EffectId, SpecimenKind, State};
pub use command::{Motion, Part, Trace};

/// An experiment that is asked for, to be drawn and downloaded.
pub struct Asked {
    /// What it is for: "seal friction".
    pub purpose: String,
    /// File name of the command, without `.csv`.
    pub name: String,
    /// Its parts.
    pub parts: Vec<Part>,
}

/// The experiments that the text on what to record next asks for, as commands: those of the effects of a strut that cannot be
/// distinguished, and the strokes that isolate an unexplained misfit.
#[must_use]
pub fn asked(specimen: &dyn Specimen, selection: &Selection, locations: &[Location]) -> Vec<Asked> {
    let all = specimen.candidates();
    let mut out: Vec<Asked> = Vec::new();
    if specimen.kind() == SpecimenKind::TwoStageStrut {
        let travel_mm = travel_mm(specimen);
        let pairs = (selection.effects.iter()).filter_map(|e| e.ambiguous_rival().map(|rival| [e.candidate, rival]));
        // A number is measured by itself.
        let pairs = pairs.filter(|pair| pair.iter().all(|&c| !all[c].is_believed_number));
        let mut ids: Vec<EffectId> = Vec::new();
        for id in pairs.flatten().map(|candidate| all[candidate].id) {
            if !ids.contains(&id) {
                ids.push(id);
            }
        }
        for id in ids {
            let Some(parts) = command::of_strut(id, travel_mm) else {
                continue;
            };
            // Two effects of one experiment are told apart by what it shows.
            if let Some(same) = out.iter_mut().find(|asked| asked.parts == parts) {
                same.purpose += &format!(" and {}", of(id).named(specimen.kind(), ""));
                continue;
            }
            out.push(Asked {
                purpose: of(id).named(specimen.kind(), "").to_owned(),
                name: format!("record-{id}").replace('_', "-"),
                parts,
            });
        }
    }
    let strokes = locations
        .iter()
        .find(|l| l.candidate.is_none())
        .and_then(|left| Strokes::of(specimen, left));
    if let Some(strokes) = strokes {
        out.push(Asked {
            purpose: "the unexplained misfit".to_owned(),
            name: "record-unexplained".to_owned(),
            parts: strokes.parts(),
        });
    }
    out
}

/// What to record where what is left swings at frequencies at which the motion or the valves repeat too, one sentence for each.
pub fn at_another_frequency(of_excitation_hz: &[f64]) -> impl Iterator<Item = String> + '_ {
    of_excitation_hz.iter().map(|f| {
        let f = oleo_report::significant(*f, 3);
        format!(
            "What is left swings at {f} Hz, at which the displacement or a valve repeats too, or at a multiple of its frequency, so that time \
             and motion cannot be told apart: record the same motion at another frequency, and once at rest."
        )
    })
}

/// The range of the recorded displacements, mm.
fn travel_mm(specimen: &dyn Specimen) -> [f64; 2] {
    let values = (0..specimen.recordings().len())
        .flat_map(|r| specimen.states(r))
        .filter(|series| series.state == State::Displacement)
        .flat_map(|series| series.values);
    values.fold([0.0, 0.0], |[low, high], x| [low.min(1e3 * x), high.max(1e3 * x)])
}

/// The strokes that repeat a stretch of a recording at several speeds.
struct Strokes {
    from_mm: f64,
    to_mm: f64,
    fastest_m_s: f64,
}

/// The speeds of the strokes, in parts of the fastest that was recorded.
const SPEEDS: [f64; 3] = [0.3, 1.0, 3.0];

impl Strokes {
    /// Those of an unexplained misfit; `None` where displacement and speed are not known, or nothing moves.
    fn of(specimen: &dyn Specimen, left: &Location) -> Option<Self> {
        if left.condition.decays {
            return None;
        }
        let time = specimen.time_s(left.recording);
        let states = specimen.states(left.recording);
        let within = |state: State| -> Option<Vec<f64>> {
            let series = states.iter().find(|s| s.state == state)?;
            let inside = time
                .iter()
                .zip(&series.values)
                .filter(|(t, _)| (left.t_s[0]..=left.t_s[1]).contains(t));
            Some(inside.map(|(_, value)| *value).collect())
        };
        let (x, v) = (within(State::Displacement)?, within(State::Speed)?);
        let extreme = |pick: fn(f64, f64) -> f64| x.iter().copied().reduce(pick);
        let fastest_m_s = v.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let (from_mm, to_mm) = (1e3 * extreme(f64::min)?, 1e3 * extreme(f64::max)?);
        (fastest_m_s > 0.0 && to_mm > from_mm).then_some(Self {
            from_mm,
            to_mm,
            fastest_m_s,
        })
    }

    fn parts(&self) -> Vec<Part> {
        SPEEDS
            .map(|speed| Part {
                motion: Motion::Triangles {
                    about: 0.5 * (self.from_mm + self.to_mm),
                    amplitude: 0.5 * (self.to_mm - self.from_mm),
                    speed: 1e3 * speed * self.fastest_m_s,
                    count: 2,
                },
                valves: None,
            })
            .to_vec()
    }
}

/// What to record to separate two candidates: amplitude, speed, valve state, and what each of the two causes then. Each
/// effect has an experiment of its own; if one experiment separates a pair better, one of the two effects names it. A number that may be wrong is measured.
#[must_use]
pub fn separate(kind: SpecimenKind, a: &Candidate, b: &Candidate) -> String {
    if let Some(number) = [a, b].into_iter().find(|c| c.is_believed_number) {
        return format!(
            "To separate {} from {}, measure {} itself, and state it in the model with the tolerance of this measurement.",
            a.name(),
            b.name(),
            number.label.replacen("a wrong", "the", 1)
        );
    }
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
    if specimen.kind() == SpecimenKind::CoSimulation {
        return format!(
            "{place} Record this stretch again with one input changed at a time, at half and at twice its size and at a third and at three \
             times its rate."
        );
    }
    let mut how = Vec::new();
    if let Some(strokes) = Strokes::of(specimen, left) {
        let speeds = SPEEDS.map(|part| oleo_report::significant(part * strokes.fastest_m_s, 2));
        how.push(format!("from {:.0} to {:.0} mm", strokes.from_mm, strokes.to_mm));
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
