//! What a model predicts of a recording: the readings that follow from its inputs alone.
//!
//! The inputs of a strut are its displacement and its switching signals. A gas spring also takes its first recorded
//! pressure, which says how much gas there is. A cylinder also takes its recorded pressures, because its model has no
//! accumulator from which they would follow. The input of a damper is its displacement. The input of a drive is its force, with
//! the recorded position and speed at the start of each window.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Cursor, Read};
use std::path::Path;

use oleo_interface::Valve;
use oleo_plant_sim::rig::{ColumnMap, Columns, RecordedStrut};
use oleo_plant_sim::specimen::{CylinderModel, DamperModel, DriveModel, GasSpringModel, smooth_motion, specimen_name};
use oleo_plant_sim::strut::{StrutModel, replay};

use super::parameter_files;
use crate::failure::Failure;

/// The text of a recording.
type Source = Box<dyn Read>;

/// What is predicted, beside what it was predicted from.
pub struct Prediction {
    /// Inputs by name, in the order of a recording: the time first.
    pub inputs: Vec<(String, Vec<f64>)>,
    /// Predicted channels.
    pub channels: Vec<Channel>,
}

/// A channel: its name, recorded and predicted values, and the standard deviation of its noise.
pub struct Channel {
    pub name: String,
    pub recorded: Option<Vec<f64>>,
    pub predicted: Vec<f64>,
    pub noise: Option<f64>,
}

/// Simulates the inputs of a recording with a model. A recording of another program is translated by the map of its columns.
pub fn predict(model: &Path, recording: &Path, map: Option<&ColumnMap>) -> Result<Prediction, Failure> {
    let (text, model_file) = parameter_files::read(model, "model")?;
    let file = recording.display().to_string();
    let source = source(recording, &file, map)?;
    let predicted = match specimen_name(&text, &model_file)?.kind.as_str() {
        "gas spring" => gas_spring,
        "cylinder" => cylinder,
        "damper" => damper,
        "drive" => drive,
        oleo_diagnose::vehicle::VEHICLE => {
            return Err(Failure::new(format!(
                "{model_file}: is the model of a vehicle, and logs cannot be predicted; give the model file of one of its struts and a \
                 recording of it as CSV"
            )));
        }
        _ => strut,
    };
    let (inputs, channels) = predicted(&text, &model_file, source, &file)?;
    Ok(Prediction { inputs, channels })
}

/// Opens the recording.
fn source(recording: &Path, file: &str, map: Option<&ColumnMap>) -> Result<Source, Failure> {
    let unreadable = |error| Failure::new(format!("{file}: cannot read the recording: {error}; check the path"));
    let Some(map) = map else {
        return Ok(Box::new(File::open(recording).map_err(unreadable)?));
    };
    let bytes = std::fs::read(recording).map_err(unreadable)?;
    Ok(Box::new(Cursor::new(map.translate(&bytes, file)?)))
}

/// Half-width in samples of the window over which a cylinder's motion is smoothed, as in its diagnosis.
const CYLINDER_WINDOW: f64 = 5.0;

/// Inputs and channels.
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
    let inputs = inputs(&recording, &["displacement_m"]);
    let channel = channel("p_Pa", &recording, model.shown(time, pressure), &model.noise);
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
    let inputs = inputs(&recording, &needed);
    let channel = channel("force_N", &recording, model.shown(time, force), &model.noise);
    Ok((inputs, vec![channel]))
}

fn damper(text: &str, model_file: &str, source: Source, file: &str) -> Result<Predicted, Failure> {
    let model = DamperModel::from_toml(text, model_file)?;
    let recording = Columns::read(source, file, &["displacement_m"], &["force_N"])?;
    let (time, x) = (recording.time_s(), column(&recording, "displacement_m"));
    let force = model
        .force_n(&DamperModel::motion(time, x))
        .map_err(|what| Failure::new(format!("{file}: {what}")))?;
    let inputs = inputs(&recording, &["displacement_m"]);
    let channel = channel("force_N", &recording, model.shown(time, force), &model.noise);
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
    let inputs = inputs(&recording, &["force_N"]);
    let channel = channel("position_m", &recording, model.shown(time, position), &model.noise);
    Ok((inputs, vec![channel]))
}

/// A column that was asked for as needed.
fn column<'a>(recording: &'a Columns, name: &str) -> &'a [f64] {
    recording.column(name).unwrap_or_default()
}

/// Columns of a recording by name, the time before them.
fn inputs(recording: &Columns, names: &[&str]) -> Vec<(String, Vec<f64>)> {
    std::iter::once("time_s")
        .chain(names.iter().copied())
        .map(|name| (name.to_owned(), column(recording, name).to_vec()))
        .collect()
}

/// A predicted channel beside what the recording has of it.
fn channel(name: &str, recording: &Columns, predicted: Vec<f64>, noise: &BTreeMap<String, f64>) -> Channel {
    Channel {
        name: name.to_owned(),
        recorded: recording.column(name).map(<[f64]>::to_vec),
        predicted,
        noise: noise.get(name).copied(),
    }
}
