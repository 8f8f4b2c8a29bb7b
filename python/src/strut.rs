//! One strut, simulated from motion and switching signals.

use std::path::Path;

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use oleo_hil::parameter_files;
use oleo_interface::StrutValves;
use oleo_plant_sim::strut::{Inputs, StrutModel, replay};
use pyo3::prelude::*;

use crate::error::complaint;
use crate::frame::finite;
use crate::watched::watched;

/// Columns of a replay: force and four pressures.
const CHANNELS: usize = 5;

/// A strut that a model file describes.
#[pyclass(frozen, module = "oleo._oleo")]
pub struct Strut {
    model: StrutModel,
}

#[pymethods]
impl Strut {
    #[new]
    fn new(model_toml: &str, model_file: &str) -> PyResult<Self> {
        let model = StrutModel::from_toml(model_toml, model_file).map_err(|error| complaint(&error))?;
        Ok(Self { model })
    }

    /// Force and pressures at each time; `noise_m` is that of the displacement, which is smoothed by it.
    fn replay<'py>(
        &self,
        py: Python<'py>,
        time_s: &Bound<'py, PyArray1<f64>>,
        displacement_m: &Bound<'py, PyArray1<f64>>,
        valves: &Bound<'py, PyArray2<bool>>,
        noise_m: f64,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (time_s, displacement_m) = (finite("t", time_s)?, finite("x", displacement_m)?);
        if let Some(row) = time_s.windows(2).position(|pair| pair[1] <= pair[0]) {
            return Err(complaint(&format!(
                "t, row {}: {} comes after {}; time must increase, sort the rows and drop duplicates",
                row + 1,
                time_s[row + 1],
                time_s[row]
            )));
        }
        let signals: Vec<StrutValves<bool>> = (valves.readonly().as_array().rows().into_iter())
            .map(|row| StrutValves::new(row[0], row[1], row[2]))
            .collect();
        let predicted = watched(py, None, |_, _| {
            replay(
                &self.model,
                &Inputs::from_recording(&time_s, &displacement_m, &signals, noise_m),
            )
        })?;
        let predicted = predicted.map_err(|error| complaint(&error))?;
        let rows: Vec<Vec<f64>> = (0..time_s.len())
            .map(|at| {
                let pressures = predicted.pressure_pa.iter().map(|pressure| pressure[at]);
                std::iter::once(predicted.force_n[at]).chain(pressures).collect()
            })
            .collect();
        debug_assert!(rows.iter().all(|row| row.len() == CHANNELS));
        PyArray2::from_vec2(py, &rows).map_err(|error| complaint(&error))
    }
}

/// The text of a model file.
#[pyfunction]
pub fn read_model(path: &str) -> PyResult<String> {
    match parameter_files::read(Path::new(path), "model") {
        Ok((text, _)) => Ok(text),
        Err(error) => Err(complaint(&error)),
    }
}

/// The model of the built-in strut.
#[pyfunction]
pub fn built_in_strut() -> &'static str {
    StrutModel::DEFENDER110_TOML
}
