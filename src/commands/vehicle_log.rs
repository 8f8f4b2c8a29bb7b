//! Reads the log of a vehicle: with our own database, or with any other by a map of signals.

#[cfg(feature = "logs")]
mod by_map;
mod content;
#[cfg(not(feature = "logs"))]
mod without_map;

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use oleo_controller::Reading;
use oleo_controller::can::{DISPLACEMENT_STEP_M, MESSAGES, PRESSURE_STEP_PA};
use oleo_diagnose::vehicle::Resolution;
use oleo_hil::drive_log::{self, DrivePart, LogAccount, LoggedSample, MessageAccount};
use oleo_interface::tick::{TICK_MS, TICK_S};
use oleo_interface::{Corner, Corners, StrutPressures};

#[cfg(feature = "logs")]
use by_map::ByMap;
use content::{Collected, VehicleLog, others, plural};
pub use content::{InertialSample, Part, PartSink, StrutSample, VehicleSample};
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
    /// Reads a log whole. Its first drive is named as the log is.
    pub fn read(&self, path: &Path) -> Result<VehicleLog, Failure> {
        let mut drives = Collected::new(name_of(path));
        let in_words = self.stream(path, false, &mut |part| {
            drives.take(part);
            ControlFlow::Continue(())
        })?;
        Ok(VehicleLog {
            drives: drives.into_drives(),
            in_words,
        })
    }

    /// Gives the drives of a log to `sink` piece by piece, and says in one sentence what was read. With `names_drives` each drive comes with
    /// whether there are several.
    pub fn stream(&self, path: &Path, names_drives: bool, sink: &mut PartSink) -> Result<String, Failure> {
        match &self.0 {
            None => of_our_database(path, names_drives, sink),
            Some(by_map) => by_map.stream(path, sink),
        }
    }

    /// Whether a log is read more than once, so that it cannot be a pipe.
    pub fn reads_again(&self, names_drives: bool) -> bool {
        names_drives || self.0.is_some()
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
    let suspension = MESSAGES.iter().map(|contract| contract.name);
    let (of_suspension, of_unit): (Vec<_>, Vec<_>) = account
        .messages
        .iter()
        .partition(|m| suspension.clone().any(|name| name == m.name));
    let received = |messages: &[&MessageAccount]| messages.iter().map(|m| m.received).sum::<u64>();
    let unit = match of_unit.is_empty() {
        true => String::new(),
        false => format!(" and {} of an inertial unit", received(&of_unit)),
    };
    format!(
        "{drives} drive{}, {} frames of the suspension{unit}; {} lost, {} repeated, {} late, {} corrupted, {} out of sequence, longest gap {} ms; {}.",
        plural(drives),
        received(&of_suspension),
        account.total(|m| m.lost),
        account.total(|m| m.repeated),
        account.total(|m| m.late),
        account.total(|m| m.corrupted),
        account.total(|m| m.out_of_sequence),
        longest * u64::from(TICK_MS),
        others(account.foreign_frames, &account.log),
    )
}

/// Gives the drives of a log with our own database to `sink`.
fn of_our_database(path: &Path, names_drives: bool, sink: &mut PartSink) -> Result<String, Failure> {
    let of_several = names_drives && number_of_drives(path)? > 1;
    let mut drives = 0;
    let account = drive_log::stream(path, &mut |part| match part {
        DrivePart::Begins(_) => {
            drives += 1;
            sink(Part::Begins {
                period_s: TICK_S,
                of_several,
            })
        }
        DrivePart::Sample(sample) => sink(Part::Sample(&VehicleSample {
            struts: Corners::from_fn(|corner| strut_sample(sample, corner)),
            inertial: InertialSample {
                specific_force_m_s2: sample.inertial.specific_force_m_s2.map(number),
                rate_rad_s: sample.inertial.rate_rad_s.map(number),
            },
        })),
    })?;
    Ok(in_words(&account, drives))
}

/// Counts the drives of a log with our own database.
fn number_of_drives(path: &Path) -> Result<usize, Failure> {
    let mut drives = 0;
    drive_log::stream(path, &mut |part| {
        drives += usize::from(matches!(part, DrivePart::Begins(_)));
        ControlFlow::Continue(())
    })?;
    Ok(drives)
}

/// A sample of one strut.
fn strut_sample(sample: &LoggedSample, corner: Corner) -> StrutSample {
    StrutSample {
        displacement_m: number(sample.displacement_m[corner]),
        pressure_pa: sample.pressure_pa[corner].into_array().map(number),
        valves: sample.command.map(|command| command.strut(corner)),
    }
}

/// A reading, or NaN.
fn number(reading: Reading) -> f64 {
    reading.value().map_or(f64::NAN, f64::from)
}
