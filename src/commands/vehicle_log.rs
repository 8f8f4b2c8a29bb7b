//! Reads the log of a vehicle: with our own database, or with any other by a map of signals.

use std::path::{Path, PathBuf};

use oleo_controller::Reading;
use oleo_controller::can::{DISPLACEMENT_STEP_M, PRESSURE_STEP_PA};
use oleo_diagnose::vehicle::{Drive, Resolution, StrutSamples};
use oleo_hil::drive_log::{self, LogAccount, LoggedDrive};
use oleo_hil::logs::Account;
use oleo_hil::signal_log::{self, Database, Selection, SignalAccount, SignalDrive, SignalMap};
use oleo_interface::tick::{TICK_MS, TICK_S};
use oleo_interface::{Corner, Corners, PressurePoint, StrutPressures};

use crate::failure::Failure;

/// The database of a log, where it is not our own.
#[derive(clap::Args, Clone)]
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
        let (Some(dbc), Some(signals)) = (&self.dbc, &self.signals) else {
            return Ok(Reader(None));
        };
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
        Ok(Reader(Some(
            Selection::of(&map, &database, &map_file).map_err(Failure::new)?,
        )))
    }
}

/// Reads logs.
pub struct Reader(Option<Selection>);

/// What a log holds.
pub struct VehicleLog {
    /// The drives in the order of the log, at least one.
    pub drives: Vec<Drive>,
    /// What was read, in one sentence.
    pub in_words: String,
}

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
            Some(selection) => {
                let log = signal_log::read(path, selection).map_err(failed)?;
                VehicleLog {
                    in_words: by_map_in_words(&log.account, &log.drives),
                    drives: (log.drives.into_iter().enumerate())
                        .map(|(k, d)| of_map(named(k), k == 0, d))
                        .collect(),
                }
            }
        })
    }

    /// Steps to which the readings are rounded.
    pub fn resolution(&self) -> Corners<Resolution> {
        match &self.0 {
            None => Corners::splat(Resolution {
                displacement_m: DISPLACEMENT_STEP_M.into(),
                pressure_pa: StrutPressures::splat(PRESSURE_STEP_PA.into()),
            }),
            Some(selection) => selection.steps.map(|steps| Resolution {
                displacement_m: steps.displacement_m,
                pressure_pa: steps.pressure_pa,
            }),
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

fn plural(n: usize) -> &'static str {
    if n == 1 { "" } else { "s" }
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

/// What was read of a log by a map, in one sentence.
fn by_map_in_words(account: &SignalAccount, drives: &[SignalDrive]) -> String {
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

fn others(foreign_frames: u64, log: &Account) -> String {
    format!(
        "{foreign_frames} frames of other devices, {} error frames, {} unreadable entries",
        log.error_frames, log.unreadable
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

/// A drive read by a map.
fn of_map(name: String, is_first: bool, drive: SignalDrive) -> Drive {
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
