//! `oleo convert`: writes a log of a bus in another format, or the columns of its drives.

use std::io::Write;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use oleo_diagnose::vehicle::Drive;
use oleo_hil::logs::{self, Account, AscWriter, Entry, Format, LogError, candump};
use oleo_interface::Corner;
use oleo_report::OutputFile;

use super::vehicle_log::DatabaseArgs;
use crate::failure::Failure;
use crate::results::say;

/// Convert a log of a CAN bus, or write the displacements, pressures and valves of its drives as CSV.
///
/// The content of IN decides how it is read, the end of the name of OUT what is written.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  oleo convert drive.mf4 drive.log                                  frames, as text of candump -L\n  \
    oleo convert drive.log.gz drive.asc                               frames, as Vector ASC\n  \
    oleo convert drive.log drive.csv                                  columns in SI units, one row every 5 ms\n  \
    oleo convert drive.mf4 drive.csv --dbc car.dbc --signals map.toml   the same of messages of another database\n\n\
    Read are candump -L (.log), Vector ASC (.asc), both also with .gz, and ASAM MDF 4 (.mf4), CAN FD included. Frames pass through \
    one at a time, so that a log of any length needs no more memory than a short one; columns need the memory of the drives. \
    Error frames, statistics and unreadable entries are counted and left out. In CSV, what is missing is NaN."
)]
pub struct Args {
    /// Log that is read
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// File that is written: .log (candump), .asc (Vector ASC) or .csv (columns)
    #[arg(value_name = "OUT")]
    output: PathBuf,
    #[command(flatten)]
    database: DatabaseArgs,
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
    let is_csv = (args.output.extension()).is_some_and(|end| end.eq_ignore_ascii_case("csv"));
    if is_csv {
        let log = args.database.reader()?.read(&args.input)?;
        let (names, columns) = columns(&log.drives);
        let columns: Vec<(&str, &[f64])> = names
            .iter()
            .map(String::as_str)
            .zip(columns.iter().map(Vec::as_slice))
            .collect();
        let written = stage()?.csv(&columns)?;
        return Ok(format!("{}\n{}\n", log.in_words, written.display()));
    }
    let format = match Format::of_name(&args.output) {
        Some(format @ (Format::Candump | Format::Asc)) if !has_end(&args.output, "gz") => format,
        _ => {
            return Err(Failure::new(format!(
                "{}: is no format that is written; give a name that ends in .log, .asc or .csv",
                args.output.display()
            )));
        }
    };
    if args.database.is_given() {
        return Err(Failure::new(
            "--dbc and --signals: frames are converted as they are; leave the options out, or write columns to a file that ends in .csv",
        ));
    }
    let mut log = logs::open(&args.input)?;
    let mut account = Account::default();
    let mut frames: u64 = 0;
    let written = stage()?.stream(|out| {
        let mut write_error = None;
        let mut writer = FrameWriter::of(format, out);
        let read = log.read(&mut |entry| match writer.write(&entry) {
            Ok(()) => {
                frames += 1;
                ControlFlow::Continue(())
            }
            Err(error) => {
                write_error = Some(error);
                ControlFlow::Break(())
            }
        });
        if let Some(error) = write_error {
            return Err(error);
        }
        writer.finish()?;
        Ok(read
            .map(|read| account = read)
            .and_then(|()| some_frame(frames, &args.input)))
    })??;
    Ok(format!(
        "{frames} frames of {} entries; {} error frames, {} unreadable entries.\n{}\n",
        account.entries,
        account.error_frames,
        account.unreadable,
        written.display()
    ))
}

fn has_end(path: &Path, end: &str) -> bool {
    path.extension().is_some_and(|own| own.eq_ignore_ascii_case(end))
}

/// Refuses a log without a frame, which is most often a file of another kind.
fn some_frame(frames: u64, input: &Path) -> Result<(), LogError> {
    match frames {
        0 => Err(LogError::new(
            input,
            "holds no frame; give a log of candump -L, Vector ASC or MDF 4",
        )),
        _ => Ok(()),
    }
}

/// Writes frames in one of the formats.
enum FrameWriter<W: Write> {
    Candump(W),
    Asc(AscWriter<W>),
}

impl<W: Write> FrameWriter<W> {
    fn of(format: Format, out: W) -> Self {
        match format {
            Format::Asc => Self::Asc(AscWriter::new(out)),
            _ => Self::Candump(out),
        }
    }

    fn write(&mut self, entry: &Entry) -> std::io::Result<()> {
        match self {
            // Where buses have numbers, the interfaces are called as those of SocketCAN.
            Self::Candump(out) if entry.bus.bytes().all(|b| b.is_ascii_digit()) => {
                candump::write_line(out, entry.time_us, &format!("can{}", entry.bus), entry.frame)
            }
            Self::Candump(out) => candump::write_line(out, entry.time_us, entry.bus, entry.frame),
            Self::Asc(writer) => writer.write(entry),
        }
    }

    fn finish(self) -> std::io::Result<()> {
        match self {
            Self::Candump(_) => Ok(()),
            Self::Asc(writer) => writer.finish().map(|_| ()),
        }
    }
}

/// The columns of all drives, one below the other: number of the drive, time in it, and everything of every corner.
fn columns(drives: &[Drive]) -> (Vec<String>, Vec<Vec<f64>>) {
    let rows = || {
        drives
            .iter()
            .enumerate()
            .flat_map(|(k, drive)| (0..drive.len()).map(move |row| (k, drive, row)))
    };
    let mut names = vec!["drive".to_owned(), "time_s".to_owned()];
    let mut columns = vec![
        rows().map(|(k, _, _)| k as f64 + 1.0).collect(),
        rows().map(|(_, drive, row)| row as f64 * drive.period_s).collect(),
    ];
    for corner in Corner::ALL {
        names.push(format!("displacement_{}_m", corner.key()));
        columns.push(
            rows()
                .map(|(_, drive, row)| drive.struts[corner].displacement_m[row])
                .collect(),
        );
        for point in 0..4 {
            names.push(format!("p{}_{}_Pa", point + 1, corner.key()));
            columns.push(
                rows()
                    .map(|(_, drive, row)| drive.struts[corner].pressure_pa[point][row])
                    .collect(),
            );
        }
        for (number, valve) in (1..).zip(oleo_interface::Valve::ALL) {
            names.push(format!("valve{number}_{}", corner.key()));
            let signal = |drive: &Drive, row: usize| {
                drive.struts[corner].valves[row].map_or(f64::NAN, |signals| f64::from(u8::from(signals[valve])))
            };
            columns.push(rows().map(|(_, drive, row)| signal(drive, row)).collect());
        }
    }
    (names, columns)
}
