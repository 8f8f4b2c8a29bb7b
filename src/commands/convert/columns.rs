//! Columns of the drives of a log, in SI units.

use std::path::Path;

use oleo_diagnose::vehicle::Drive;
use oleo_hil::telemetry::{Series, write_series};
use oleo_interface::Corner;
use oleo_report::OutputFile;

use super::parquet;
use crate::commands::mcap::{self, program};
use crate::failure::Failure;

/// Formats of columns.
#[derive(Clone, Copy)]
pub enum ColumnFormat {
    /// Text, one row for each sample.
    Csv,
    /// Messages for viewers.
    Mcap,
    /// Columns for pandas, Spark and DuckDB.
    Parquet,
}

impl ColumnFormat {
    /// The format that the end of a file's name stands for.
    pub fn of_name(path: &Path) -> Option<Self> {
        [("csv", Self::Csv), ("mcap", Self::Mcap), ("parquet", Self::Parquet)]
            .into_iter()
            .find_map(|(end, format)| has_end(path, end).then_some(format))
    }

    /// Whether this program writes it. `path` is named in the refusal.
    pub fn is_built(self, path: &Path) -> Result<(), Failure> {
        match self {
            Self::Csv => Ok(()),
            Self::Mcap => mcap::is_built(path),
            Self::Parquet => parquet::is_built(path),
        }
    }

    /// Writes the columns of drives, and gives the path as words.
    pub fn write(self, staged: OutputFile, drives: &[Drive]) -> Result<String, Failure> {
        let path = match self {
            Self::Csv => {
                let columns = columns(drives);
                let borrowed: Vec<(&str, &[f64])> = (columns.iter())
                    .map(|(name, values)| (name.as_str(), values.as_slice()))
                    .collect();
                staged.csv(&borrowed)?
            }
            Self::Mcap => mcap::stream(staged, |out| write_series(out, &program(), &series(drives)))?,
            Self::Parquet => mcap::stream(staged, |out| parquet::write(out, &program(), &columns(drives)))?,
        };
        Ok(path.display().to_string())
    }
}

/// The drives for viewers. Each begins at zero and has topics of its own where there are several.
fn series(drives: &[Drive]) -> Vec<Series> {
    let of_drive = |(k, drive): (usize, &Drive)| {
        let mut columns = columns(std::slice::from_ref(drive));
        let time = columns.iter_mut().find(|(name, _)| name == TIME);
        Series {
            run: (drives.len() > 1).then(|| format!("drive_{}", k + 1)),
            time_s: time.map(|(_, values)| std::mem::take(values)).unwrap_or_default(),
            columns,
        }
    };
    drives.iter().enumerate().map(of_drive).collect()
}

/// Time in the drive.
const TIME: &str = "time_s";

/// The columns of all drives, one below the other: number of the drive, time in it, and everything of every corner.
fn columns(drives: &[Drive]) -> Vec<(String, Vec<f64>)> {
    let rows = || {
        drives
            .iter()
            .enumerate()
            .flat_map(|(k, drive)| (0..drive.len()).map(move |row| (k, drive, row)))
    };
    let number: Vec<f64> = rows().map(|(k, _, _)| k as f64 + 1.0).collect();
    let time_s = rows().map(|(_, drive, row)| row as f64 * drive.period_s).collect();
    let mut columns = vec![("drive".to_owned(), number), (TIME.to_owned(), time_s)];
    for corner in Corner::ALL {
        let displacement = rows().map(|(_, drive, row)| drive.struts[corner].displacement_m[row]);
        columns.push((format!("displacement_{}_m", corner.key()), displacement.collect()));
        for point in 0..4 {
            let pressure = rows().map(|(_, drive, row)| drive.struts[corner].pressure_pa[point][row]);
            columns.push((format!("p{}_{}_Pa", point + 1, corner.key()), pressure.collect()));
        }
        for (number, valve) in (1..).zip(oleo_interface::Valve::ALL) {
            let signal = |drive: &Drive, row: usize| {
                drive.struts[corner].valves[row].map_or(f64::NAN, |signals| f64::from(u8::from(signals[valve])))
            };
            let signals = rows().map(|(_, drive, row)| signal(drive, row));
            columns.push((format!("valve{number}_{}", corner.key()), signals.collect()));
        }
    }
    columns
}

/// Whether a file's name has this end, in small or in capital letters.
pub fn has_end(path: &Path, end: &str) -> bool {
    path.extension().is_some_and(|own| own.eq_ignore_ascii_case(end))
}
