//! What is compared: runs with their figures and traces, read from folders of results, from CSV files, or made of a recording
//! and models.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use oleo_diagnose::free_run::FreeRun;
use oleo_plant_sim::model_file::names::suggestion;
use oleo_plant_sim::rig::ColumnMap;
use serde_json::Value;

use super::difference::at_places;
use super::figures::{Figure, figures};
use super::traces::{Trace, Traces};
use crate::commands::prediction::predict;
use crate::failure::Failure;

/// A run.
pub struct Run {
    pub name: String,
    pub figures: Vec<(String, Figure)>,
    pub traces: Traces,
}

impl Run {
    /// A figure.
    pub fn figure(&self, name: &str) -> Option<&Figure> {
        (self.figures.iter().find(|(known, _)| known == name)).map(|(_, figure)| figure)
    }

    /// The values of a quantity at some places of an axis; `None` if the run does not have it.
    pub fn quantity_at(&self, name: &str, axis: &str, places: &[f64]) -> Result<Option<Vec<f64>>, Failure> {
        let Some(Trace::Quantity(values)) = self.traces.trace(name) else {
            return Ok(None);
        };
        let own = self.traces.axis(axis, &self.name)?;
        Ok(Some(at_places(places, own, values)))
    }
}

/// Runs that are compared with each other: all others with the first.
pub struct Group {
    /// Name of the recording; empty for runs of the vehicle.
    pub name: String,
    pub runs: Vec<Run>,
    /// Sensor noise of each channel, where a model states it.
    pub noise: BTreeMap<String, f64>,
}

impl Group {
    /// Makes the run of this name the one that the others are compared with.
    pub fn put_first(&mut self, name: &str) -> Result<(), Failure> {
        let names: Vec<&str> = self.runs.iter().map(|run| run.name.as_str()).collect();
        let Some(at) = names.iter().position(|known| *known == name) else {
            let hint = suggestion(name, &names, "runs");
            return Err(Failure::new(format!("--reference {name}: is no run: {hint}")));
        };
        self.runs[..=at].rotate_right(1);
        Ok(())
    }
}

/// A name that needs no quotes in a header or as the name of a file.
pub fn plain(name: &str) -> String {
    let kept = |c: char| match c.is_ascii_alphanumeric() || "-_".contains(c) {
        true => c,
        false => '-',
    };
    name.replace(": ", "-").chars().map(kept).collect()
}

/// Numbers those of several names that are alike when they are plain.
fn tell_apart<'a>(names: impl Iterator<Item = &'a mut String>) {
    let mut taken: Vec<String> = Vec::new();
    for name in names {
        let (given, mut number) = (name.clone(), 2);
        while taken.contains(&plain(name)) {
            *name = format!("{given} {number}");
            number += 1;
        }
        taken.push(plain(name));
    }
}

/// Refuses an operand that is given twice: it can only be equal to itself.
pub fn check_operands(operands: &[PathBuf]) -> Result<(), Failure> {
    let places: Vec<_> = operands.iter().map(|path| std::fs::canonicalize(path).ok()).collect();
    for (i, place) in places.iter().enumerate().filter(|(_, place)| place.is_some()) {
        if places[..i].contains(place) {
            return Err(Failure::new(format!(
                "{}: is given twice; give each run once",
                operands[i].display()
            )));
        }
    }
    Ok(())
}

/// The runs in folders of results and CSV files, as one group.
pub fn of_results(operands: &[PathBuf]) -> Result<Group, Failure> {
    let mut runs = Vec::new();
    for (operand, name) in operands.iter().zip(names(operands)) {
        if operand.is_dir() {
            runs.extend(of_folder(operand, &name, operands.len() == 1)?);
        } else {
            runs.push(Run {
                name,
                figures: Vec::new(),
                traces: Traces::read(operand)?,
            });
        }
    }
    if runs.len() < 2 {
        return Err(Failure::new(format!(
            "{}: is one run; give a second one to compare it with, or --model for a recording",
            operands[0].display()
        )));
    }
    tell_apart(runs.iter_mut().map(|run: &mut Run| &mut run.name));
    Ok(Group {
        name: String::new(),
        runs,
        noise: BTreeMap::new(),
    })
}

/// The files that are read of an operand.
pub fn files(operand: &Path) -> Vec<PathBuf> {
    if !operand.is_dir() {
        return vec![operand.to_path_buf()];
    }
    let listed = std::fs::read_dir(operand)
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.path());
    let read = |path: &PathBuf| {
        path.extension().is_some_and(|extension| extension == "csv")
            || path.file_name().is_some_and(|name| name == SUMMARY)
    };
    let mut files: Vec<PathBuf> = listed.filter(read).collect();
    files.sort();
    files
}

const SUMMARY: &str = "summary.json";

/// The last part of each path, or the whole path where two end alike.
fn names(operands: &[PathBuf]) -> Vec<String> {
    let last = |path: &PathBuf| {
        path.file_name()
            .map_or(path.display().to_string(), |name| name.to_string_lossy().into_owned())
    };
    let short: Vec<String> = operands.iter().map(last).collect();
    (operands.iter().zip(&short))
        .map(
            |(path, name)| match short.iter().filter(|other| *other == name).count() {
                1 => name.clone(),
                _ => path.display().to_string(),
            },
        )
        .collect()
}

/// The run of `oleo hil`, or the runs of `oleo drive`. An only folder's name need not be said.
fn of_folder(folder: &Path, name: &str, only: bool) -> Result<Vec<Run>, Failure> {
    let path = folder.join(SUMMARY);
    let file = path.display();
    let refuse = |what: String| {
        Failure::new(format!(
            "{file}: {what}; give a folder of results of oleo hil or oleo drive, or a CSV file"
        ))
    };
    let text = std::fs::read_to_string(&path).map_err(|error| refuse(format!("cannot read it: {error}")))?;
    let summary: Value = serde_json::from_str(&text).map_err(|error| refuse(format!("is no summary: {error}")))?;
    match summary["command"].as_str() {
        Some("oleo hil") => Ok(vec![Run {
            name: name.to_owned(),
            figures: figures(&summary),
            traces: Traces::read(&folder.join("timeseries.csv"))?,
        }]),
        Some("oleo drive") => {
            let drives = summary
                .as_object()
                .into_iter()
                .flatten()
                .filter(|(_, value)| value.is_object());
            let drives: Vec<_> = drives.collect();
            let several = drives.len() > 1;
            (drives.into_iter())
                .map(|(key, measures)| {
                    let drive = key.replace('_', " ");
                    Ok(Run {
                        name: match (only, several) {
                            (true, _) => drive,
                            (false, true) => format!("{name}: {drive}"),
                            (false, false) => name.to_owned(),
                        },
                        figures: figures(measures),
                        traces: Traces::read(&folder.join(format!("{}.csv", key.replace('_', "-"))))?,
                    })
                })
                .collect()
        }
        Some(other) => Err(refuse(format!("is of {other}, whose runs have no common axis"))),
        None => Err(refuse("does not say which command wrote it".into())),
    }
}

/// Each recording with what every model predicts of it, as a group.
pub fn of_recordings(
    recordings: &[PathBuf],
    models: &[PathBuf],
    map: Option<&ColumnMap>,
) -> Result<Vec<Group>, Failure> {
    let mut names = names(recordings);
    names
        .iter_mut()
        .for_each(|name| *name = name.trim_end_matches(".csv").to_owned());
    tell_apart(names.iter_mut());
    (recordings.iter().zip(names))
        .map(|(recording, name)| of_recording(recording, name, models, map))
        .collect()
}

fn of_recording(recording: &Path, name: String, models: &[PathBuf], map: Option<&ColumnMap>) -> Result<Group, Failure> {
    let mut runs: Vec<Run> = Vec::new();
    let mut noise = BTreeMap::new();
    for (model, name) in models.iter().zip(names(models)) {
        let FreeRun { inputs, channels } = predict(model, recording, map)?;
        // The other inputs are those of the recording, whatever the model.
        let inputs: Vec<_> = inputs.into_iter().filter(|(name, _)| name == "time_s").collect();
        if runs.is_empty() {
            let recorded =
                (channels.iter()).filter_map(|channel| Some((channel.name.clone(), channel.recorded.clone()?)));
            runs.push(Run {
                name: "recording".into(),
                figures: Vec::new(),
                traces: Traces::of(inputs.iter().cloned().chain(recorded)),
            });
            let stated = channels
                .iter()
                .filter_map(|channel| Some((channel.name.clone(), channel.noise?)));
            noise = stated.filter(|(_, noise)| *noise > 0.0).collect();
        }
        let predicted = channels.into_iter().map(|channel| (channel.name, channel.predicted));
        runs.push(Run {
            name,
            figures: Vec::new(),
            traces: Traces::of(inputs.into_iter().chain(predicted)),
        });
    }
    tell_apart(runs.iter_mut().map(|run| &mut run.name));
    Ok(Group { name, runs, noise })
}
