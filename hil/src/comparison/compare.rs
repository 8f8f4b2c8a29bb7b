//! Every setting on every drive, on all threads, and resumed where an earlier run was interrupted.

use oleo_interface::StrutValves;
use oleo_plant_sim::course::Ending;
use oleo_plant_sim::study::{Records, RecordsError};
use rayon::prelude::*;

use super::bench::Bench;
use super::case::DriveCase;
use super::drive::{ComparisonError, beginning_s, drive};
use super::figures::Figures;
use super::plan::Group;
use super::setting::Setting;

/// Raised with every change of the models, of the controller or of the figures that changes results.
const MODEL_VERSION: u32 = 2;

/// A comparison that ended early.
#[derive(Debug, thiserror::Error)]
pub enum CompareError {
    /// A drive could not be made.
    #[error("{name}: {error}")]
    Drive {
        /// The group of drives.
        name: String,
        /// Why.
        error: ComparisonError,
    },
    /// Results could not be kept.
    #[error(transparent)]
    Records(#[from] RecordsError),
    /// The user asked for the end. What had ended is kept.
    #[error("interrupted; the same command goes on where this one stopped")]
    Interrupted,
}

/// Figures by group, setting and seed, in the order of the arguments.
pub type Results = Vec<Vec<Vec<Figures>>>;

/// The groups with the time at which each manoeuvre begins, which the oracle knows.
///
/// # Errors
/// A vehicle that its springs do not carry.
pub fn with_beginnings(bench: &Bench, mut groups: Vec<Group>) -> Result<Vec<Group>, CompareError> {
    groups.par_iter_mut().try_for_each(|group| {
        let Some(first) = group.cases.first() else {
            return Ok(());
        };
        let begins_s = beginning_s(bench, first).map_err(|error| CompareError::Drive {
            name: group.name.clone(),
            error,
        })?;
        group.cases.iter_mut().for_each(|case| case.begins_s = begins_s);
        Ok::<(), CompareError>(())
    })?;
    Ok(groups)
}

/// One drive of a comparison.
#[derive(Clone, Copy, Debug)]
pub struct Job<'a> {
    /// The group of the drive.
    pub group: &'a Group,
    /// What is driven.
    pub case: &'a DriveCase,
    /// With what.
    pub setting: &'a Setting,
}

/// All drives by group, setting and seed.
pub fn jobs<'a>(groups: &'a [Group], settings: &'a [Setting]) -> Vec<Job<'a>> {
    let of_group = |group: &'a Group| {
        settings.iter().flat_map(move |setting| {
            let job = move |case| Job { group, case, setting };
            group.cases.iter().map(job)
        })
    };
    groups.iter().flat_map(of_group).collect()
}

/// Drives what `records` do not hold yet of some jobs.
///
/// # Errors
/// A drive that cannot be made, a file that cannot be written, or `stop`.
pub fn compare(
    bench: &Bench,
    jobs: &[Job],
    records: &Records,
    done: impl Fn() + Sync,
    stop: impl Fn() -> bool + Sync,
) -> Result<Vec<Figures>, CompareError> {
    jobs.par_iter()
        .map(|job| {
            let figures = run_once(bench, &job.group.name, job.case, job.setting, records, &stop)?;
            done();
            Ok(figures)
        })
        .collect()
}

/// The figures of all [`jobs`], in their order, by group, setting and seed.
pub fn by_group(groups: &[Group], settings: &[Setting], figures: Vec<Figures>) -> Results {
    let mut figures = figures.into_iter();
    groups
        .iter()
        .map(|group| {
            let seeds = group.cases.len();
            settings
                .iter()
                .map(|_| figures.by_ref().take(seeds).collect())
                .collect()
        })
        .collect()
}

/// One drive, from the records or driven now and recorded.
pub(super) fn run_once(
    bench: &Bench,
    name: &str,
    case: &DriveCase,
    setting: &Setting,
    records: &Records,
    stop: &impl Fn() -> bool,
) -> Result<Figures, CompareError> {
    let key = Records::key(&format!("{MODEL_VERSION}|{bench:?}|{case:?}|{setting:?}"));
    if let Some(figures) = records.get(&key).and_then(|record| figures_of(record.iter().skip(3))) {
        return Ok(figures);
    }
    if stop() {
        return Err(CompareError::Interrupted);
    }
    let figures = drive(bench, case, setting).map_err(|error| CompareError::Drive {
        name: name.into(),
        error,
    })?;
    let what = [name.to_owned(), setting.name()];
    records.add(&key, what.into_iter().chain(fields_of(&figures)))?;
    Ok(figures)
}

/// Figures as fields of a record. Every float is written so that it is read back to the bit.
fn fields_of(figures: &Figures) -> [String; 10] {
    let (ending, at_s) = match figures.ending {
        Ending::Completed => ("completed", 0.0),
        Ending::RolledOver(at_s) => ("rolled-over", at_s),
        Ending::Spun(at_s) => ("spun", at_s),
        Ending::LostTrack(at_s) => ("lost-track", at_s),
    };
    let [v1, v2, v3] = figures.valve_changes;
    [
        ending.into(),
        at_s.to_string(),
        figures.weighted_rms_m_s2.to_string(),
        figures.peak_roll_deg.to_string(),
        figures.decision_s.map_or_else(String::new, |s| s.to_string()),
        figures.entries.to_string(),
        figures.distance_km.to_string(),
        v1.to_string(),
        v2.to_string(),
        v3.to_string(),
    ]
}

/// The reverse of [`fields_of`]; `None` for a record that is not whole.
fn figures_of<'a>(fields: impl Iterator<Item = &'a str>) -> Option<Figures> {
    let fields: Vec<&str> = fields.collect();
    let [ending, at_s, rms, roll, decision, entries, distance, v1, v2, v3] = fields[..] else {
        return None;
    };
    let at_s = at_s.parse().ok()?;
    Some(Figures {
        ending: match ending {
            "completed" => Ending::Completed,
            "rolled-over" => Ending::RolledOver(at_s),
            "spun" => Ending::Spun(at_s),
            "lost-track" => Ending::LostTrack(at_s),
            _ => return None,
        },
        weighted_rms_m_s2: rms.parse().ok()?,
        peak_roll_deg: roll.parse().ok()?,
        decision_s: if decision.is_empty() {
            None
        } else {
            Some(decision.parse().ok()?)
        },
        entries: entries.parse().ok()?,
        distance_km: distance.parse().ok()?,
        valve_changes: [v1.parse().ok()?, v2.parse().ok()?, v3.parse().ok()?],
    })
}

/// The settings of every comparison: the vehicle as sold, the eight fixed ones, the oracle, and the controllers given.
pub fn settings(controllers: impl IntoIterator<Item = Setting>) -> Vec<Setting> {
    let oracle = Setting::Oracle {
        before: StrutValves::splat(true),
        delay_s: 0.0,
    };
    [Setting::AsSold]
        .into_iter()
        .chain(Setting::all_fixed())
        .chain([oracle])
        .chain(controllers)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_survive_their_record_to_the_bit() {
        let figures = Figures {
            ending: Ending::RolledOver(3.1),
            weighted_rms_m_s2: 1.0 / 3.0,
            peak_roll_deg: 90.0,
            decision_s: Some(0.1 + 0.2),
            entries: 3,
            distance_km: 0.2,
            valve_changes: [1, 2, 3],
        };
        for figures in [
            figures,
            Figures {
                decision_s: None,
                ending: Ending::Completed,
                ..figures
            },
        ] {
            let fields = fields_of(&figures);
            assert_eq!(figures_of(fields.iter().map(String::as_str)), Some(figures));
            assert_eq!(figures_of(fields.iter().skip(1).map(String::as_str)), None);
        }
    }
}
