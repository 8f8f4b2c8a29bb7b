//! `oleo predict`: the readings that a model predicts from the inputs of a recording alone.
//!
//! The inputs of a strut are its displacement and its switching signals. A gas spring also takes its first recorded
//! pressure, which says how much gas there is. A cylinder also takes its recorded pressures, because its model has no
//! accumulator from which they would follow. The input of a damper is its displacement. The input of a drive is its force, with
//! the recorded position and speed at the start of each window.

use std::fs::File;
use std::io::{Cursor, Read};
use std::path::PathBuf;
use std::process::ExitCode;

use oleo_interface::Valve;
use oleo_plant_sim::rig::{Columns, RecordedStrut};
use oleo_plant_sim::specimen::{CylinderModel, DamperModel, DriveModel, GasSpringModel, smooth_motion, specimen_name};
use oleo_plant_sim::strut::{StrutModel, replay};
use oleo_report::{Column, OutputDirectory, OutputFile, Table};

use super::column_map::column_map;
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

/// The text of a recording.
type Source = Box<dyn Read>;

/// Opens the recording; one of another program is translated by the map of its columns.
fn source(args: &Args) -> Result<Source, Failure> {
    let file = args.recording.display();
    let unreadable = |error| Failure::new(format!("{file}: cannot read the recording: {error}; check the path"));
    let Some(path) = &args.columns else {
        return Ok(Box::new(File::open(&args.recording).map_err(unreadable)?));
    };
    let map = column_map(path)?;
    let bytes = std::fs::read(&args.recording).map_err(unreadable)?;
    let text = map.translate(&bytes, &file.to_string())?;
    Ok(Box::new(Cursor::new(text)))
}

/// A channel: its name, recorded and predicted values, and the standard deviation of its noise.
struct Channel {
    name: String,
    recorded: Option<Vec<f64>>,
    predicted: Vec<f64>,
    noise: Option<f64>,
}

/// Half-width in samples of the window over which a cylinder's motion is smoothed, as in its diagnosis.
const CYLINDER_WINDOW: f64 = 5.0;

/// Runs the command.
pub fn run(args: Args) -> Result<ExitCode, Failure> {
    let (model_file, file) = (args.model.display().to_string(), args.recording.display().to_string());
    let text = std::fs::read_to_string(&args.model)
        .map_err(|error| Failure::new(format!("{model_file}: cannot read the model: {error}; check the path")))?;
    let source = source(&args)?;
    let target = Target::of(&args)?;

    let kind = specimen_name(&text, &model_file)?.kind;
    let (inputs, channels) = match kind.as_str() {
        "gas spring" => gas_spring(&text, &model_file, source, &file)?,
        "cylinder" => cylinder(&text, &model_file, source, &file)?,
        "damper" => damper(&text, &model_file, source, &file)?,
        "drive" => drive(&text, &model_file, source, &file)?,
        oleo_diagnose::vehicle::VEHICLE => {
            return Err(Failure::new(format!(
                "{model_file}: is the model of a vehicle, and logs cannot be predicted; give the model file of one of its struts and a \
                 recording of it as CSV"
            )));
        }
        _ => strut(&text, &model_file, source, &file)?,
    };

    // The columns are in the order of a recording: time and displacement, predicted channels, other inputs.
    let (before, after) = inputs.split_at(2.min(inputs.len()));
    let mut columns: Vec<(&str, &[f64])> = before.iter().map(borrowed).collect();
    columns.extend(
        channels
            .iter()
            .map(|channel| (channel.name.as_str(), channel.predicted.as_slice())),
    );
    columns.extend(after.iter().map(borrowed));
    let written = target.write(&columns)?;
    let table = compare(&channels);
    let table = if table.is_empty() {
        String::new()
    } else {
        table.to_string()
    };
    say(&format!("{table}{}\n", written.display()))?;
    Ok(ExitCode::SUCCESS)
}

/// Inputs by name, in the order of a recording, and predicted channels.
type Predicted = (Vec<(String, Vec<f64>)>, Vec<Channel>);

fn strut(text: &str, model_file: &str, source: Source, file: &str) -> Result<Predicted, Failure> {
    let model = StrutModel::from_toml(text, model_file)?;
    let recording = RecordedStrut::read(source, file)?;
    let noise = |name: &str| model.noise.get(name).copied();
    let predicted = replay(&model, &recording.inputs(noise("displacement_m").unwrap_or(0.0)))?;
    let signal = |valve: Valve| {
        recording
            .signals
            .iter()
            .map(|signals| f64::from(u8::from(signals[valve])))
            .collect()
    };
    let inputs = vec![
        ("time_s".to_owned(), recording.time_s.clone()),
        ("displacement_m".to_owned(), recording.displacement_m.clone()),
        ("valve1".to_owned(), signal(Valve::Bypass1)),
        ("valve2".to_owned(), signal(Valve::Bypass2)),
        ("valve3".to_owned(), signal(Valve::Spring)),
    ];
    let mut channels = vec![Channel {
        name: "force_N".into(),
        recorded: recording.force_n,
        predicted: predicted.force_n,
        noise: noise("force_N"),
    }];
    let names = ["p1_Pa", "p2_Pa", "p3_Pa", "p4_Pa"];
    for ((name, recorded), predicted) in names.into_iter().zip(recording.pressure_pa).zip(predicted.pressure_pa) {
        channels.push(Channel {
            name: name.into(),
            recorded,
            predicted,
            noise: noise(name),
        });
    }
    Ok((inputs, channels))
}

fn gas_spring(text: &str, model_file: &str, source: Source, file: &str) -> Result<Predicted, Failure> {
    let model = GasSpringModel::from_toml(text, model_file)?;
    let recording = Columns::read(source, file, &["displacement_m", "p_Pa"], &[])?;
    let (time, x) = (recording.time_s(), column(&recording, "displacement_m"));
    let recorded = column(&recording, "p_Pa");
    let pressure = model
        .pressure_pa(time, x, recorded[0])
        .map_err(|what| Failure::new(format!("{file}: {what}")))?;
    let inputs = vec![
        ("time_s".to_owned(), time.to_vec()),
        ("displacement_m".to_owned(), x.to_vec()),
    ];
    let channel = Channel {
        name: "p_Pa".into(),
        recorded: Some(recorded.to_vec()),
        predicted: model.shown(time, pressure),
        noise: model.noise.get("p_Pa").copied(),
    };
    Ok((inputs, vec![channel]))
}

fn cylinder(text: &str, model_file: &str, source: Source, file: &str) -> Result<Predicted, Failure> {
    let model = CylinderModel::from_toml(text, model_file)?;
    let mut needed = vec!["displacement_m"];
    needed.extend(model.chamber.iter().map(|chamber| chamber.column.as_str()));
    let recording = Columns::read(source, file, &needed, &["force_N"])?;
    let (time, x) = (recording.time_s(), column(&recording, "displacement_m"));
    let interval = (time[time.len() - 1] - time[0]) / (time.len() - 1) as f64;
    let motion = smooth_motion(time, x, CYLINDER_WINDOW * interval);
    let pressures: Vec<Vec<f64>> = model
        .chamber
        .iter()
        .map(|chamber| column(&recording, &chamber.column).to_vec())
        .collect();
    let force = model.force_n(time, &motion, &pressures);
    let mut inputs = vec![
        ("time_s".to_owned(), time.to_vec()),
        ("displacement_m".to_owned(), x.to_vec()),
    ];
    inputs.extend(
        model
            .chamber
            .iter()
            .map(|chamber| chamber.column.clone())
            .zip(pressures),
    );
    let channel = Channel {
        name: "force_N".into(),
        recorded: recording.column("force_N").map(<[f64]>::to_vec),
        predicted: model.shown(time, force),
        noise: model.noise.get("force_N").copied(),
    };
    Ok((inputs, vec![channel]))
}

fn damper(text: &str, model_file: &str, source: Source, file: &str) -> Result<Predicted, Failure> {
    let model = DamperModel::from_toml(text, model_file)?;
    let recording = Columns::read(source, file, &["displacement_m"], &["force_N"])?;
    let (time, x) = (recording.time_s(), column(&recording, "displacement_m"));
    let force = model
        .force_n(&DamperModel::motion(time, x))
        .map_err(|what| Failure::new(format!("{file}: {what}")))?;
    let inputs = vec![
        ("time_s".to_owned(), time.to_vec()),
        ("displacement_m".to_owned(), x.to_vec()),
    ];
    let channel = Channel {
        name: "force_N".into(),
        recorded: recording.column("force_N").map(<[f64]>::to_vec),
        predicted: model.shown(time, force),
        noise: model.noise.get("force_N").copied(),
    };
    Ok((inputs, vec![channel]))
}

fn drive(text: &str, model_file: &str, source: Source, file: &str) -> Result<Predicted, Failure> {
    let model = DriveModel::from_toml(text, model_file)?;
    let recording = Columns::read(source, file, &["force_N", "position_m"], &[])?;
    let (time, force) = (recording.time_s(), column(&recording, "force_N"));
    let recorded = column(&recording, "position_m");
    let position = model
        .position_m(time, force, &DriveModel::motion(time, recorded))
        .map_err(|what| Failure::new(format!("{file}: {what}")))?;
    let inputs = vec![
        ("time_s".to_owned(), time.to_vec()),
        ("force_N".to_owned(), force.to_vec()),
    ];
    let channel = Channel {
        name: "position_m".into(),
        recorded: Some(recorded.to_vec()),
        predicted: model.shown(time, position),
        noise: model.noise.get("position_m").copied(),
    };
    Ok((inputs, vec![channel]))
}

fn borrowed(column: &(String, Vec<f64>)) -> (&str, &[f64]) {
    (&column.0, &column.1)
}

/// A column that was asked for as needed.
fn column<'a>(recording: &'a Columns, name: &str) -> &'a [f64] {
    recording.column(name).unwrap_or_default()
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
        let Some(recorded) = &channel.recorded else { continue };
        let pairs = recorded.iter().zip(&channel.predicted);
        let rms = (pairs.map(|(a, b)| (a - b) * (a - b)).sum::<f64>() / recorded.len() as f64).sqrt();
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
