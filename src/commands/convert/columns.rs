//! Columns of the drives of a log, in SI units, written as the samples come.

use std::fs::File;
use std::io::{self, BufWriter};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use oleo_hil::telemetry::{Column, McapFile, Value, nanoseconds};
use oleo_interface::Corner;
use oleo_report::{CsvRows, OutputFile};

use super::parquet::{self, ParquetRows};
use crate::commands::mcap::{self, program};
use crate::commands::vehicle_log::{Part, PartSink, VehicleSample};
use crate::failure::Failure;

/// Formats of columns.
#[derive(Clone, Copy, PartialEq, Eq)]
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

    /// Whether the writer must know beforehand if there are several drives: the topics of viewers are named by it.
    pub fn names_drives(self) -> bool {
        self == Self::Mcap
    }

    /// Writes the columns of the drives that `read` gives, with those of an inertial unit if they are wanted, and moves the file into place. Returns its path, and what `read` says.
    pub fn write(
        self,
        staged: OutputFile,
        with_unit: bool,
        read: impl FnOnce(&mut PartSink) -> Result<String, Failure>,
    ) -> Result<(PathBuf, String), Failure> {
        let mut said = String::new();
        let path = staged.stream(|out| {
            let mut columns = Columns::begin(self, with_unit, out)?;
            let mut refused = None;
            let read = read(&mut |part| match columns.take(part) {
                Ok(()) => ControlFlow::Continue(()),
                Err(error) => {
                    refused = Some(error);
                    ControlFlow::Break(())
                }
            });
            let read = match columns.lacks_unit() {
                true => read.and_then(|_| Err(no_unit())),
                false => read,
            };
            match refused {
                Some(error) => Err(error),
                None => columns.finish().map(|()| read.map(|words| said = words)),
            }
        })??;
        Ok((path, said))
    }
}

/// A file of columns that is being written.
struct Columns<'f> {
    file: RowFile<'f>,
    names: Vec<String>,
    /// Number of the drive, from 1 on.
    drive: u32,
    /// Number of samples of this drive.
    samples: u64,
    period_s: f64,
    /// Whether an inertial unit is wanted, and whether it has said something.
    unit: Option<bool>,
    row: Vec<f64>,
}

/// A file in one of the formats.
enum RowFile<'f> {
    Csv(CsvRows<&'f mut BufWriter<File>>),
    Mcap(Box<McapFile<&'f mut BufWriter<File>>>, Vec<Value>),
    Parquet(ParquetRows<&'f mut BufWriter<File>>),
}

impl<'f> Columns<'f> {
    fn begin(format: ColumnFormat, with_unit: bool, out: &'f mut BufWriter<File>) -> io::Result<Self> {
        let names = names(with_unit);
        Ok(Self {
            file: match format {
                ColumnFormat::Csv => RowFile::Csv(CsvRows::begin(out, &names)?),
                ColumnFormat::Mcap => RowFile::Mcap(Box::new(McapFile::new(out, &program())?), Vec::new()),
                ColumnFormat::Parquet => RowFile::Parquet(ParquetRows::begin(out, &program(), &names)?),
            },
            names,
            drive: 0,
            samples: 0,
            period_s: 0.0,
            unit: with_unit.then_some(false),
            row: Vec::new(),
        })
    }

    fn take(&mut self, part: Part) -> io::Result<()> {
        match part {
            Part::Begins { period_s, of_several } => {
                self.drive += 1;
                self.samples = 0;
                self.period_s = period_s;
                match &mut self.file {
                    RowFile::Mcap(file, _) => {
                        let columns: Vec<Column> = self.names.iter().map(Column::number).collect();
                        let run = (of_several || self.drive > 1).then(|| format!("drive_{}", self.drive));
                        file.add(run.as_deref(), &columns)
                    }
                    RowFile::Csv(_) | RowFile::Parquet(_) => Ok(()),
                }
            }
            Part::Sample(sample) => self.sample(sample),
        }
    }

    fn sample(&mut self, sample: &VehicleSample) -> io::Result<()> {
        let time_s = self.samples as f64 * self.period_s;
        self.samples += 1;
        self.row.clear();
        self.row.extend([f64::from(self.drive), time_s]);
        for strut in sample.struts.values() {
            self.row.push(strut.displacement_m);
            self.row.extend(strut.pressure_pa);
            match strut.valves {
                Some(signals) => self
                    .row
                    .extend(signals.into_array().map(|open| f64::from(u8::from(open)))),
                None => self.row.extend([f64::NAN; 3]),
            }
        }
        if let Some(heard) = &mut self.unit {
            let read = [sample.inertial.specific_force_m_s2, sample.inertial.rate_rad_s];
            *heard |= read.as_flattened().iter().any(|value| value.is_finite());
            self.row.extend(read.as_flattened());
        }
        match &mut self.file {
            RowFile::Csv(file) => file.row(&self.row),
            RowFile::Parquet(file) => file.row(&self.row),
            RowFile::Mcap(file, values) => {
                values.clear();
                values.extend(self.row.iter().map(|value| Value::Number(*value)));
                // Runs are numbered from 0.
                file.row(self.drive as usize - 1, nanoseconds(time_s), values)
            }
        }
    }

    /// Whether a unit is wanted that has said nothing.
    fn lacks_unit(&self) -> bool {
        self.unit == Some(false)
    }

    fn finish(self) -> io::Result<()> {
        match self.file {
            RowFile::Csv(_) => Ok(()),
            RowFile::Mcap(file, _) => file.finish(),
            RowFile::Parquet(file) => file.finish(),
        }
    }
}

fn no_unit() -> Failure {
    Failure::new("--imu: the log has no message of an inertial unit (oleo show imu-dbc): leave the option out")
}

/// The names of the columns: number of the drive, time in it, everything of every corner, and the inertial unit if it is wanted.
fn names(with_unit: bool) -> Vec<String> {
    let mut names = vec!["drive".to_owned(), "time_s".to_owned()];
    for corner in Corner::ALL.map(Corner::key) {
        names.push(format!("displacement_{corner}_m"));
        names.extend((1..=4).map(|point| format!("p{point}_{corner}_Pa")));
        names.extend((1..=3).map(|valve| format!("valve{valve}_{corner}")));
    }
    if with_unit {
        names.extend(["x", "y", "z"].map(|axis| format!("imu_specific_force_{axis}_m_s2")));
        names.extend(["x", "y", "z"].map(|axis| format!("imu_rate_{axis}_rad_s")));
    }
    names
}

/// Whether a file's name has this end, in small or in capital letters.
pub fn has_end(path: &Path, end: &str) -> bool {
    path.extension().is_some_and(|own| own.eq_ignore_ascii_case(end))
}
