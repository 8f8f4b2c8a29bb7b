//! Reads the log of a vehicle with any CAN database, by a map of signals.

use std::path::Path;

use oleo_diagnose::vehicle::{Drive, Resolution, StrutSamples};
use oleo_hil::signal_log::{self, Database, Selection, SignalAccount, SignalDrive, SignalMap};
use oleo_interface::Corners;

use super::content::{VehicleLog, others, plural};
use crate::failure::Failure;

/// The signals that are taken of a log.
pub struct ByMap(Selection);

impl ByMap {
    /// Reads a database, and the map of its signals.
    pub fn of(dbc: &Path, signals: &Path) -> Result<Self, Failure> {
        let read = |path: &Path, what: &str| {
            let cannot = |e| {
                Failure::new(format!(
                    "{}: cannot read the {what}: {e}; check the path",
                    path.display()
                ))
            };
            std::fs::read(path).map_err(cannot)
        };
        let map_file = signals.display().to_string();
        let text = String::from_utf8(read(signals, "map of signals")?)
            .map_err(|_| Failure::new(format!("{map_file}: is not text in UTF-8; save it as such")))?;
        let map = SignalMap::from_toml(&text, &map_file).map_err(Failure::new)?;
        let database =
            Database::from_bytes(&read(dbc, "database")?, &dbc.display().to_string()).map_err(Failure::new)?;
        Ok(Self(Selection::of(&map, &database, &map_file).map_err(Failure::new)?))
    }

    /// Reads a log. `named` names its drives.
    pub fn read(&self, path: &Path, named: impl Fn(usize) -> String) -> Result<VehicleLog, Failure> {
        let log = signal_log::read(path, &self.0)?;
        Ok(VehicleLog {
            in_words: in_words(&log.account, &log.drives),
            drives: (log.drives.into_iter().enumerate())
                .map(|(k, d)| drive(named(k), k == 0, d))
                .collect(),
        })
    }

    /// Steps to which the readings are rounded.
    pub fn resolution(&self) -> Corners<Resolution> {
        self.0.steps.map(|steps| Resolution {
            displacement_m: steps.displacement_m,
            pressure_pa: steps.pressure_pa,
        })
    }
}

/// What was read of a log, in one sentence.
fn in_words(account: &SignalAccount, drives: &[SignalDrive]) -> String {
    format!(
        "{} drive{} with a sample every {:.1} ms, {} frames of the map; {} without a reading, {} repeated, {} outside the drives; {}.",
        drives.len(),
        plural(drives.len()),
        drives.first().map_or(0.0, |drive| 1e3 * drive.period_s),
        account.total(|m| m.received),
        account.total(|m| m.without_reading),
        account.total(|m| m.repeated),
        account.total(|m| m.outside),
        others(account.foreign_frames, &account.log),
    )
}

/// A drive read by a map.
fn drive(name: String, is_first: bool, drive: SignalDrive) -> Drive {
    Drive {
        name,
        is_first,
        period_s: drive.period_s,
        struts: drive.struts.map(|strut| StrutSamples {
            displacement_m: strut.displacement_m,
            pressure_pa: strut.pressure_pa.into_array(),
            valves: strut.valves,
        }),
    }
}
