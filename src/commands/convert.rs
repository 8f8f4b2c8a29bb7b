//! `oleo convert`: writes a log of a bus in another format, or the columns of its drives.

mod columns;
mod frames;
#[cfg(feature = "parquet")]
mod parquet;
#[cfg(not(feature = "parquet"))]
#[path = "convert/without_parquet.rs"]
mod parquet;
mod rereadable;

use std::path::PathBuf;
use std::process::ExitCode;

use oleo_hil::logs::Format;
use oleo_report::OutputFile;

use self::columns::{ColumnFormat, has_end};
use self::rereadable::Rereadable;
use super::vehicle_log::DatabaseArgs;
use crate::failure::Failure;
use crate::results::say;

/// Convert a log of a CAN bus, or write the displacements, pressures and valves of its drives.
///
/// The content of IN decides how it is read, the end of the name of OUT what is written.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  oleo convert drive.mf4 drive.log                                  frames, as text of candump -L\n  \
    oleo convert drive.log.gz drive.asc                               frames, as Vector ASC\n  \
    oleo convert drive.blf drive.mf4                                  frames, from Vector BLF to ASAM MDF 4\n  \
    oleo convert drive.log drive.blf                                  frames, as Vector BLF\n  \
    oleo convert drive.log drive.csv                                  columns in SI units, one row every 5 ms\n  \
    oleo convert drive.log drive.csv --imu                            and what the inertial unit of oleo hil --imu read\n  \
    oleo convert drive.log drive.mcap                                 the same for Foxglove and PlotJuggler\n  \
    oleo convert drive.log drive.parquet                              the same for pandas and DuckDB\n  \
    oleo convert drive.mf4 drive.csv --dbc car.dbc --signals map.toml   the same of messages of another database\n\n\
    Read are candump -L (.log), Vector ASC (.asc) and BLF (.blf), all three also with .gz, and ASAM MDF 4 (.mf4), CAN FD included. A log of any \
    length needs no more memory than a short one. For .mcap, and with --dbc, a log is read twice or more, so that one from a pipe is copied first. \
    Error frames, statistics and unreadable entries are counted and left out. In columns, what is missing is NaN; in .mcap it is left out. .mcap and .parquet need features of their own."
)]
pub struct Args {
    /// Log that is read
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// File that is written: .log (candump), .asc (Vector ASC), .blf (Vector BLF), .mf4 (ASAM MDF 4), .csv, .mcap or .parquet (columns)
    #[arg(value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    database: DatabaseArgs,
    /// Columns also for the inertial unit whose messages the log has (database: oleo show imu-dbc)
    #[arg(long, conflicts_with = "dbc")]
    imu: bool,
    /// Replace a file of a campaign. Inputs are never replaced
    #[arg(long)]
    force: bool,
}

impl Args {
    /// Converts a log with messages of our own database.
    pub fn of(input: PathBuf, output: PathBuf) -> Self {
        Self {
            input,
            output,
            database: DatabaseArgs::default(),
            imu: false,
            force: false,
        }
    }

    /// The file that is written.
    pub fn output(&self) -> &PathBuf {
        &self.output
    }
}

/// Runs the command.
pub fn run(args: &Args) -> Result<ExitCode, Failure> {
    say(&convert(args)?)?;
    Ok(ExitCode::SUCCESS)
}

/// Writes the file, and says what is in it.
pub fn convert(args: &Args) -> Result<String, Failure> {
    let inputs: Vec<PathBuf> = std::iter::once(args.input.clone())
        .chain(args.database.inputs())
        .collect();
    let stage = || OutputFile::stage(&args.output, &inputs, args.force);
    if let Some(format) = ColumnFormat::of_name(&args.output) {
        format.is_built(&args.output)?;
        let (reader, staged) = (args.database.reader()?, stage()?);
        let log = match reader.reads_again(format.names_drives()) {
            true => Rereadable::of(&args.input, &staged)?,
            false => Rereadable::as_it_is(&args.input),
        };
        let (path, said) = format.write(staged, args.imu, |sink| {
            let read = reader.stream(log.path(), format.names_drives(), sink);
            read.map_err(|failure| log.named(&failure))
        })?;
        return Ok(format!("{said}\n{}\n", path.display()));
    }
    let format = match Format::of_name(&args.output) {
        Some(format) if !has_end(&args.output, "gz") => format,
        _ => {
            return Err(Failure::new(format!(
                "{}: is no format that is written; give a name that ends in .log, .asc, .blf, .mf4, .csv, .mcap or .parquet",
                args.output.display()
            )));
        }
    };
    if args.database.is_given() {
        return Err(Failure::new(
            "--dbc and --signals: frames are converted as they are; leave the options out, or write columns to a file that ends in .csv, .mcap or .parquet",
        ));
    }
    if args.imu {
        return Err(Failure::new(
            "--imu: frames are converted as they are; leave the option out, or write columns to a file that ends in .csv, .mcap or .parquet",
        ));
    }
    frames::write(&args.input, stage()?, format)
}
