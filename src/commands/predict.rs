//! `oleo predict`: the readings that a model predicts from the inputs of a recording alone (see [`super::prediction`]).

use std::path::PathBuf;
use std::process::ExitCode;

use oleo_diagnose::free_run::Channel;
use oleo_report::{Column, OutputDirectory, OutputFile, Table};

use super::column_map::column_map;
use super::prediction::predict;
use crate::failure::Failure;
use crate::results::{default_path, origin, say};

/// Simulate the inputs of a recording with a model, and write the predicted columns.
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  oleo predict --model found/model.toml campaign/slow_hold.csv --out slow_hold.sim.csv\n\n\
                  The command prints the noise ratio of each recorded channel: the RMS of recording minus prediction, divided \
                  by the sensor noise that the model states. A ratio of 1 means that only noise is left."
)]
pub struct Args {
    /// Model file of a two-stage hydropneumatic strut, a gas spring, a cylinder, a damper or a drive
    #[arg(long, value_name = "MODEL.toml")]
    model: PathBuf,
    /// Recording whose inputs are simulated
    #[arg(value_name = "RECORDING.csv")]
    recording: PathBuf,
    /// Map of the columns of a recording that another program wrote: separator, decimal commas, titles and units (docs/diagnose.md)
    #[arg(long, value_name = "MAP.toml")]
    columns: Option<PathBuf>,
    /// CSV file that is written, with the columns of the recording [default: a file in oleo-out/predict]
    #[arg(long, value_name = "SIM.csv")]
    out: Option<PathBuf>,
    /// Replace a file of a campaign. Inputs are never replaced
    #[arg(long)]
    force: bool,
}

/// Runs the command.
pub fn run(args: Args) -> Result<ExitCode, Failure> {
    let map = args.columns.as_deref().map(column_map).transpose()?;
    let target = Target::of(&args)?;
    let free_run = predict(&args.model, &args.recording, map.as_ref())?;

    let columns: Vec<(&str, &[f64])> = free_run.columns().collect();
    let written = target.write(&columns)?;
    let table = compare(&free_run.channels);
    let table = if table.is_empty() {
        String::new()
    } else {
        table.to_string()
    };
    say(&format!("{table}{}\n", written.display()))?;
    Ok(ExitCode::SUCCESS)
}

/// Noise ratio of each channel that was recorded.
fn compare(channels: &[Channel]) -> Table {
    let mut table = Table::new([
        Column::text("Channel"),
        Column::number("RMS of recording - prediction"),
        Column::number("Stated noise"),
        Column::number("Noise ratio"),
    ]);
    for channel in channels {
        let Some(rms) = channel.rms() else { continue };
        let noise = channel.noise.filter(|noise| *noise > 0.0);
        table.row([
            channel.name.clone(),
            oleo_report::significant(rms, 4),
            noise.map_or("-".into(), |noise| oleo_report::significant(noise, 3)),
            noise.map_or("-".into(), |noise| format!("{:.2}", rms / noise)),
        ]);
    }
    table
}

/// Where the prediction goes.
enum Target {
    /// The file of `--out`.
    File(OutputFile),
    /// A file of this name in a folder of its own.
    Folder(Box<OutputDirectory>, String),
}

impl Target {
    /// Refuses what cannot be written, before the work.
    fn of(args: &Args) -> Result<Self, Failure> {
        let mut inputs = vec![args.model.clone(), args.recording.clone()];
        inputs.extend(args.columns.clone());
        if let Some(out) = &args.out {
            return Ok(Self::File(OutputFile::stage(out, &inputs, args.force)?));
        }
        let stem = args
            .recording
            .file_stem()
            .map_or("recording".into(), |stem| stem.to_string_lossy());
        let folder = default_path(&format!("predict-{stem}"))?;
        let out = OutputDirectory::stage(folder, origin("oleo predict", inputs), args.force)?;
        Ok(Self::Folder(Box::new(out), format!("{stem}.csv")))
    }

    /// Writes the columns and returns the path of the file.
    fn write(self, columns: &[(&str, &[f64])]) -> Result<PathBuf, Failure> {
        match self {
            Self::File(file) => Ok(file.csv(columns)?),
            Self::Folder(mut folder, name) => {
                folder.csv(&name, columns)?;
                Ok(folder.commit()?.join(name))
            }
        }
    }
}
