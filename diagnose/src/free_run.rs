//! What a model predicts of a recording: the readings that follow from its inputs alone.
//!
//! The inputs of a strut are its displacement and its switching signals. A gas spring also takes its first recorded
//! pressure, which says how much gas there is. A cylinder also takes its recorded pressures, because its model has no
//! accumulator from which they would follow. The input of a damper is its displacement. The input of a drive is its force, with
//! the recorded position and speed at the start of each window.

use std::collections::BTreeMap;

use oleo_interface::Valve;
use oleo_plant_sim::rig::{Columns, RecordedStrut, RecordingError};
use oleo_plant_sim::specimen::{CylinderModel, DamperModel, DriveModel, GasSpringModel, smooth_motion, specimen_name};
use oleo_plant_sim::strut::{StrutModel, replay};

use crate::error::DiagnoseError;
use crate::vehicle::VEHICLE;

/// What is predicted, beside what it was predicted from.
pub struct FreeRun {
    /// Inputs by name, in the order of a recording: the time first.
    pub inputs: Vec<(String, Vec<f64>)>,
    /// Predicted channels.
    pub channels: Vec<Channel>,
}

/// A channel: its name, recorded and predicted values, and the standard deviation of its noise.
pub struct Channel {
    /// Name with unit, as in a recording.
    pub name: String,
    /// What was recorded, if it was.
    pub recorded: Option<Vec<f64>>,
    /// What the model predicts.
    pub predicted: Vec<f64>,
    /// Standard deviation of its sensor's noise, where the model states one.
    pub noise: Option<f64>,
}

/// Gives the columns of a recording: the needed ones, and those that are welcome where there are any.
pub type Recorded<'r> = &'r dyn Fn(&[&str], &[&str]) -> Result<Columns, RecordingError>;

impl FreeRun {
    /// Simulates the inputs of a recording with a model, of which `model_toml` is the text and `model_file` the name. `file` names the
    /// recording.
    ///
    /// # Errors
    /// A wrong model, the model of a vehicle, a recording without the inputs of the model; one line each.
    pub fn of(model_toml: &str, model_file: &str, recorded: Recorded, file: &str) -> Result<Self, DiagnoseError> {
        let predicted = match specimen_name(model_toml, model_file)?.kind.as_str() {
            "gas spring" => gas_spring,
            "cylinder" => cylinder,
            "damper" => damper,
            "drive" => drive,
            VEHICLE => {
                return Err(DiagnoseError::file(
                    model_file,
                    "is the model of a vehicle, and logs cannot be predicted; give the model file of one of its struts and a recording \
                     of it as CSV",
                ));
            }
            _ => strut,
        };
        let (inputs, channels) = predicted(model_toml, model_file, recorded, file)?;
        Ok(Self { inputs, channels })
    }

    /// Name and values of each column, in the order of a recording: time and displacement, predicted channels, other inputs.
    pub fn columns(&self) -> impl Iterator<Item = (&str, &[f64])> {
        let (before, after) = self.inputs.split_at(2.min(self.inputs.len()));
        let channels = self.channels.iter();
        (before.iter().map(named))
            .chain(channels.map(|channel| (channel.name.as_str(), channel.predicted.as_slice())))
            .chain(after.iter().map(named))
    }
}

fn named((name, values): &(String, Vec<f64>)) -> (&str, &[f64]) {
    (name, values)
}

impl Channel {
    /// RMS of recording minus prediction, in the unit of the channel.
    #[must_use]
    pub fn rms(&self) -> Option<f64> {
        let recorded = self.recorded.as_ref()?;
        let pairs = recorded.iter().zip(&self.predicted);
        Some((pairs.map(|(a, b)| (a - b) * (a - b)).sum::<f64>() / recorded.len() as f64).sqrt())
    }
}

/// Half-width in samples of the window over which a cylinder's motion is smoothed, as in its diagnosis.
const CYLINDER_WINDOW: f64 = 5.0;

/// Inputs and channels.
type Predicted = (Vec<(String, Vec<f64>)>, Vec<Channel>);

fn strut(text: &str, model_file: &str, recorded: Recorded, _: &str) -> Result<Predicted, DiagnoseError> {
    let model = StrutModel::from_toml(text, model_file)?;
    let recording = RecordedStrut::of(&recorded(&RecordedStrut::NEEDED, &RecordedStrut::WELCOME)?);
    let noise = |name: &str| model.noise.get(name).copied();
    let inputs = recording.inputs(noise("displacement_m").unwrap_or(0.0));
    let predicted = replay(&model, &inputs).map_err(|invalid| DiagnoseError::Model(invalid.to_string()))?;
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

fn gas_spring(text: &str, model_file: &str, recorded: Recorded, file: &str) -> Result<Predicted, DiagnoseError> {
    let model = GasSpringModel::from_toml(text, model_file)?;
    let recording = recorded(&["displacement_m", "p_Pa"], &[])?;
    let (time, x) = (recording.time_s(), column(&recording, "displacement_m"));
    let first_pa = column(&recording, "p_Pa")[0];
    let pressure = model
        .pressure_pa(time, x, first_pa)
        .map_err(|what| DiagnoseError::file(file, what))?;
    let inputs = inputs(&recording, &["displacement_m"]);
    let channel = channel("p_Pa", &recording, model.shown(time, pressure), &model.noise);
    Ok((inputs, vec![channel]))
}

fn cylinder(text: &str, model_file: &str, recorded: Recorded, _: &str) -> Result<Predicted, DiagnoseError> {
    let model = CylinderModel::from_toml(text, model_file)?;
    let mut needed = vec!["displacement_m"];
    needed.extend(model.chamber.iter().map(|chamber| chamber.column.as_str()));
    let recording = recorded(&needed, &["force_N"])?;
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

fn damper(text: &str, model_file: &str, recorded: Recorded, file: &str) -> Result<Predicted, DiagnoseError> {
    let model = DamperModel::from_toml(text, model_file)?;
    let recording = recorded(&["displacement_m"], &["force_N"])?;
    let (time, x) = (recording.time_s(), column(&recording, "displacement_m"));
    let force = model
        .force_n(&DamperModel::motion(time, x))
        .map_err(|what| DiagnoseError::file(file, what))?;
    let inputs = inputs(&recording, &["displacement_m"]);
    let channel = channel("force_N", &recording, model.shown(time, force), &model.noise);
    Ok((inputs, vec![channel]))
}

fn drive(text: &str, model_file: &str, recorded: Recorded, file: &str) -> Result<Predicted, DiagnoseError> {
    let model = DriveModel::from_toml(text, model_file)?;
    let recording = recorded(&["force_N", "position_m"], &[])?;
    let (time, force) = (recording.time_s(), column(&recording, "force_N"));
    let position = model
        .position_m(time, force, &DriveModel::motion(time, column(&recording, "position_m")))
        .map_err(|what| DiagnoseError::file(file, what))?;
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
