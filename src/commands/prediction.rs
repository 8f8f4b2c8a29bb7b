//! What a model predicts of a recording in a file.

use std::fs::File;
use std::path::Path;

use oleo_diagnose::free_run::FreeRun;
use oleo_hil::parameter_files;
use oleo_plant_sim::rig::{ColumnMap, Columns, RecordingError};

use crate::failure::Failure;

/// Simulates the inputs of a recording with a model. A recording of another program is translated by the map of its columns.
pub fn predict(model: &Path, recording: &Path, map: Option<&ColumnMap>) -> Result<FreeRun, Failure> {
    let (text, model_file) = parameter_files::read(model, "model")?;
    let file = recording.display().to_string();
    let unreadable = |error: std::io::Error| RecordingError::Csv {
        file: file.clone(),
        reason: format!("cannot read the recording: {error}; check the path"),
    };
    let translated = match map {
        Some(map) => Some(map.translate(&std::fs::read(recording).map_err(unreadable)?, &file)?),
        None => None,
    };
    let recorded = |needed: &[&str], welcome: &[&str]| match &translated {
        Some(text) => Columns::read(text.as_bytes(), &file, needed, welcome),
        None => Columns::read(File::open(recording).map_err(unreadable)?, &file, needed, welcome),
    };
    Ok(FreeRun::of(&text, &model_file, &recorded, &file)?)
}
