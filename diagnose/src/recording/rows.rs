//! The rows of a recording, wherever they come from: each is checked and kept or thinned.

use std::path::Path;

use oleo_plant_sim::rig::implausible;

use super::columns::{ColumnKind, ColumnSpec, GapPolicy};
use super::series::Recording;
use super::thinning::{Room, Thinner};
use crate::error::DiagnoseError;

/// Fewest samples from which anything can be concluded.
pub const MIN_SAMPLES: usize = 50;
/// A step this many times the usual one is a hole.
const GAP_RATIO: f64 = 4.5;

/// Takes the rows of a recording one after the other.
pub(super) struct Rows<'s> {
    specs: &'s [ColumnSpec],
    thinner: Thinner,
    last_time: f64,
}

impl<'s> Rows<'s> {
    /// For about `rows` rows.
    pub fn new(specs: &'s [ColumnSpec], rows: usize) -> Self {
        Self {
            specs,
            thinner: Thinner::new(specs, rows),
            last_time: f64::NEG_INFINITY,
        }
    }

    /// Takes a row of finite numbers, and NaN where a column is not recorded; says whether more are wanted, or what is wrong with it and what to do.
    pub fn push(&mut self, time: f64, values: &[f64]) -> Result<Room, String> {
        let last_time = self.last_time;
        if time <= last_time {
            let how = if time == last_time {
                "is repeated"
            } else {
                "goes backwards"
            };
            return Err(format!(
                "time_s {how} ({time} after {last_time}); sort the rows and drop duplicates"
            ));
        }
        self.last_time = time;
        for (value, spec) in values.iter().zip(self.specs) {
            if spec.kind == ColumnKind::Switch && *value != 0.0 && *value != 1.0 {
                return Err(format!(
                    "{} is {value}; a switching signal is 0 (closed) or 1 (open)",
                    spec.name
                ));
            }
        }
        Ok(self.thinner.push(time, values))
    }

    /// The recording. `path` names it in errors.
    pub fn finish(self, name: String, path: &Path, gaps: GapPolicy) -> Result<Recording, DiagnoseError> {
        let displacement = self.specs.iter().position(|spec| spec.name == "displacement_m");
        let mut recording = self.thinner.finish(name);
        let displacement_m = displacement.map(|at| recording.columns[at].as_slice());
        if let Some(what) = implausible(&recording.time_s, displacement_m) {
            return Err(DiagnoseError::file(path, what));
        }
        if gaps == GapPolicy::Cut {
            cut_at_gap(&mut recording);
        }
        if recording.len() < MIN_SAMPLES {
            let why = recording.notes.first().map_or(String::new(), |n| format!(" ({n})"));
            return Err(DiagnoseError::TooShort {
                path: path.to_path_buf(),
                what: format!(
                    "there are {} usable samples{why}, but at least {MIN_SAMPLES} are needed; record longer or leave the file out",
                    recording.len()
                ),
            });
        }
        Ok(recording)
    }
}

/// What is wrong with a value that is no finite number.
pub(super) fn not_finite(name: &str, text: &str) -> String {
    format!("{name} is '{text}', not a finite number; repair or cut the recording there")
}

/// Index of a column among the titles; a column of the same quantity in another unit gets the message it deserves.
pub(super) fn place(titles: &[&str], name: &str) -> Result<usize, String> {
    if let Some(found) = titles.iter().position(|title| *title == name) {
        return Ok(found);
    }
    Err(match in_another_unit(titles, name) {
        Some(other) => format!("column '{other}' has an unknown unit; '{name}' is expected (SI, unit in the name)"),
        None => format!("column '{name}' is missing; the file has: {}", titles.join(", ")),
    })
}

/// Index of a column among the titles; `None` if it is in no unit among them, and a recording may do without it.
pub(super) fn place_of(titles: &[&str], spec: &ColumnSpec) -> Result<Option<usize>, String> {
    match place(titles, &spec.name) {
        Err(_) if spec.optional && in_another_unit(titles, &spec.name).is_none() => Ok(None),
        found => found.map(Some),
    }
}

/// The column that has the quantity of another column's name in another unit.
fn in_another_unit<'t>(titles: &[&'t str], name: &str) -> Option<&'t str> {
    let quantity = |name: &str| name.rsplit_once('_').map_or(name.len(), |(quantity, _)| quantity.len());
    let wanted = &name[..quantity(name)];
    (titles.iter().copied()).find(|title| title[..quantity(title)].eq_ignore_ascii_case(wanted))
}

fn cut_at_gap(recording: &mut Recording) {
    let usual = recording.interval_s();
    if let Some(gap) = recording
        .time_s
        .windows(2)
        .position(|w| w[1] - w[0] > GAP_RATIO * usual)
    {
        let (from, to) = (recording.time_s[gap], recording.time_s[gap + 1]);
        let lost = recording.len() - gap - 1;
        recording.time_s.truncate(gap + 1);
        recording.columns.iter_mut().for_each(|c| c.truncate(gap + 1));
        recording.notes.push(format!(
            "there is a gap from {from} s to {to} s; the {lost} samples after it were not used"
        ));
    }
}
