//! Reads the log of a vehicle: with our own database, or with any other by a map of signals.

#[cfg(feature = "logs")]
mod by_map;
mod content;
#[cfg(not(feature = "logs"))]
mod without_map;

use std::path::{Path, PathBuf};

use oleo_controller::Reading;
use oleo_controller::can::{DISPLACEMENT_STEP_M, PRESSURE_STEP_PA};
use oleo_diagnose::vehicle::{Drive, Resolution, StrutSamples};
use oleo_hil::drive_log::{self, LogAccount, LoggedDrive};
use oleo_interface::tick::{TICK_MS, TICK_S};
use oleo_interface::{Corner, Corners, PressurePoint, StrutPressures};

#[cfg(feature = "logs")]
use by_map::ByMap;
use content::{VehicleLog, others, plural};
#[cfg(not(feature = "logs"))]
use without_map::ByMap;

use crate::failure::Failure;

/// The database of a log, where it is not our own.
#[derive(clap::Args, Clone, Default)]
pub struct DatabaseArgs {
    /// CAN database (DBC) of the logs, where it is not our own
    #[arg(long, value_name = "FILE.dbc", requires = "signals")]
    dbc: Option<PathBuf>,
    /// Map from signals of the CAN database to displacements (m, mm), pressures (Pa, bar) and valves (docs/diagnose.md)
    #[arg(long, value_name = "MAP.toml", requires = "dbc")]
    signals: Option<PathBuf>,
}

impl DatabaseArgs {
    /// The files that are read.
    pub fn inputs(&self) -> impl Iterator<Item = PathBuf> {
        self.dbc.clone().into_iter().chain(self.signals.clone())
    }

    /// Whether another database than our own is named.
    pub fn is_given(&self) -> bool {
        self.dbc.is_some()
    }

    /// The reader for the logs.
    pub fn reader(&self) -> Result<Reader, Failure> {
        Ok(Reader(match (&self.dbc, &self.signals) {
            (Some(dbc), Some(signals)) => Some(ByMap::of(dbc, signals)?),
            _ => None,
        }))
    }
}

/// Reads logs.
pub struct Reader(Option<ByMap>);

impl Reader {
    /// Reads a log. Its first drive is named as the log is.
    pub fn read(&self, path: &Path) -> Result<VehicleLog, Failure> {
        let failed = |error: oleo_hil::logs::LogError| Failure::new(error.to_string());
        let name = name_of(path);
        let named = |k: usize| match k {
            0 => name.clone(),
            _ => format!("{name}, drive {}", k + 1),
        };
        Ok(match &self.0 {
            None => {
                let log = drive_log::read(path).map_err(failed)?;
                VehicleLog {
                    in_words: in_words(&log.account, log.drives.len()),
                    drives: (log.drives.iter().enumerate())
                        .map(|(k, d)| of_our_database(named(k), k == 0, d))
                        .collect(),
                }
            }
            Some(by_map) => by_map.read(path, named)?,
        })
    }

    /// Steps to which the readings are rounded.
    pub fn resolution(&self) -> Corners<Resolution> {
        match &self.0 {
            None => Corners::splat(Resolution {
                displacement_m: DISPLACEMENT_STEP_M.into(),
                pressure_pa: StrutPressures::splat(PRESSURE_STEP_PA.into()),
            }),
            Some(by_map) => by_map.resolution(),
        }
    }
}

/// The name of a log without its end.
fn name_of(path: &Path) -> String {
    let name = path
        .file_name()
        .map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    let end = oleo_hil::logs::Format::ENDS
        .iter()
        .find(|(end, _)| name.to_ascii_lowercase().ends_with(end));
    end.and_then(|(end, _)| name.get(..name.len() - end.len()))
        .unwrap_or(name)
        .to_owned()
}

/// What was read of a log with our own database, in one sentence.
fn in_words(account: &LogAccount, drives: usize) -> String {
    let longest = account.messages.iter().map(|m| m.longest_gap_ticks).max().unwrap_or(0);
    format!(
        "{drives} drive{}, {} frames of the suspension; {} lost, {} repeated, {} late, {} corrupted, {} out of sequence, longest gap {} ms; {}.",
        plural(drives),
        account.total(|m| m.received),
        account.total(|m| m.lost),
        account.total(|m| m.repeated),
        account.total(|m| m.late),
        account.total(|m| m.corrupted),
        account.total(|m| m.out_of_sequence),
        longest * u64::from(TICK_MS),
        others(account.foreign_frames, &account.log),
    )
}

/// A drive read with our own database as series, strut by strut.
fn of_our_database(name: String, is_first: bool, logged: &LoggedDrive) -> Drive {
    let number = |reading: Reading| reading.value().map_or(f64::NAN, f64::from);
    let samples = || logged.samples.iter();
    let strut = |corner: Corner| StrutSamples {
        displacement_m: samples().map(|s| number(s.displacement_m[corner])).collect(),
        pressure_pa: PressurePoint::ALL.map(|point| samples().map(|s| number(s.pressure_pa[corner][point])).collect()),
        valves: samples()
            .map(|s| s.command.map(|command| command.strut(corner)))
            .collect(),
    };
    Drive {
        name,
        is_first,
        period_s: TICK_S,
        struts: Corners::from_fn(strut),
    }
}
