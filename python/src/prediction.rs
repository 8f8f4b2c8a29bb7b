//! What a model predicts of a recording.

use numpy::PyArray1;
use oleo_diagnose::free_run::FreeRun;
use oleo_plant_sim::rig::{Columns, RecordingError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::complaint;
use crate::frame::{Frame, for_python};
use crate::watched::watched;

/// Columns for Python.
type PyColumns<'py> = Vec<(String, Bound<'py, PyArray1<f64>>)>;

/// Columns of the prediction, and of each recorded channel its name, the RMS of recording minus prediction, and the stated noise.
#[pyfunction]
#[allow(clippy::type_complexity, reason = "it is unpacked at once")]
pub fn predict<'py>(
    py: Python<'py>,
    model_toml: String,
    model_file: String,
    name: String,
    columns: &Bound<'py, PyDict>,
    others: Vec<(String, String)>,
) -> PyResult<(PyColumns<'py>, Vec<(String, f64, Option<f64>)>)> {
    let frame = Frame::of(name, columns, others)?;
    let run = watched(py, None, |_, _| {
        let recorded = |needed: &[&str], welcome: &[&str]| {
            let all = std::iter::once("time_s").chain(needed.iter().chain(welcome).copied());
            frame.without_numbers(all).map_err(|what| RecordingError::Table {
                recording: frame.name.clone(),
                what: what.split_once(": ").map_or(what.clone(), |(_, what)| what.to_owned()),
            })?;
            Columns::of_table(&frame.columns(), &frame.name, needed, welcome)
        };
        FreeRun::of(&model_toml, &model_file, &recorded, &frame.name)
    })?;
    let run = run.map_err(|error| complaint(&error))?;
    let judged = (run.channels.iter())
        .filter_map(|channel| Some((channel.name.clone(), channel.rms()?, channel.noise)))
        .collect();
    let columns = run.columns().map(|(name, values)| (name.to_owned(), values.to_vec()));
    Ok((for_python(py, columns), judged))
}
