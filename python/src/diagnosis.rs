//! The diagnosis of a campaign in memory.

use std::path::PathBuf;
use std::time::Instant;

use oleo_diagnose::specimen::ModelFile;
use oleo_diagnose::{Campaign, DiagnoseError, KeptBack, MODEL_FILE};
use oleo_report::{Origin, OutputDirectory};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::complaint;
use crate::frame::Frame;
use crate::watched::watched;

/// A recording from Python: its name, its columns of numbers, name and type of each other column.
type PyRecording<'py> = (String, Bound<'py, PyDict>, Vec<(String, String)>);

/// What was found in a campaign.
#[pyclass(frozen, module = "oleo._oleo")]
pub struct Findings {
    findings: oleo_diagnose::Findings,
    seed: Option<u64>,
    model_file: PathBuf,
}

/// Diagnoses recordings.
#[pyfunction]
#[pyo3(signature = (recordings, model_toml, model_file, hold_out, fit_until, seed, progress))]
#[allow(clippy::too_many_arguments, reason = "Python's package gives them all, by name")]
pub fn diagnose(
    py: Python<'_>,
    recordings: Vec<PyRecording<'_>>,
    model_toml: String,
    model_file: String,
    hold_out: Vec<String>,
    fit_until: Option<f64>,
    seed: Option<u64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Findings> {
    let begun = Instant::now();
    let frames = recordings
        .into_iter()
        .map(|(name, columns, others)| Frame::of(name, &columns, others))
        .collect::<PyResult<Vec<_>>>()?;
    let kept_back = KeptBack {
        fit_until,
        recordings: hold_out,
    };
    let findings = watched(py, progress, |stop, tell| {
        let specs = ModelFile::read(&model_toml, &model_file)?.model.columns();
        let needed = || std::iter::once("time_s").chain(specs.iter().map(|spec| spec.name.as_str()));
        for frame in &frames {
            frame.without_numbers(needed()).map_err(DiagnoseError::Model)?;
        }
        let tables: Vec<_> = frames
            .iter()
            .map(|frame| (frame.name.clone(), frame.columns()))
            .collect();
        let (campaign, complete) = Campaign::of_tables(&model_toml, &model_file, &tables, &kept_back)?;
        oleo_diagnose::Findings::of(campaign, complete.as_ref(), kept_back, begun, stop, tell)
    })?;
    Ok(Findings {
        findings: findings.map_err(|error| complaint(&error))?,
        seed,
        model_file: model_file.into(),
    })
}

#[pymethods]
impl Findings {
    #[getter]
    fn name(&self) -> &str {
        &self.findings.campaign.name
    }

    #[getter]
    fn verdict(&self) -> String {
        self.findings.diagnosis.verdict().to_string()
    }

    #[getter]
    fn model_toml(&self) -> &str {
        &self.findings.diagnosis.model_toml
    }

    /// The result in a sentence and tables.
    fn text(&self) -> String {
        self.findings.text()
    }

    /// The content of report.json.
    fn report_json(&self) -> String {
        self.findings.report().to_string()
    }

    /// Writes report.json, report.html and model.toml into a folder, and returns the path of the page.
    fn write(&self, py: Python<'_>, out: PathBuf, force: bool) -> PyResult<PathBuf> {
        py.detach(|| {
            let origin = Origin {
                command: "oleo.diagnose".to_owned(),
                version: format!("{} (Python)", env!("CARGO_PKG_VERSION")),
                inputs: Some(&self.model_file)
                    .filter(|file| file.is_file())
                    .cloned()
                    .into_iter()
                    .collect(),
            };
            let mut out = OutputDirectory::stage(out, origin, force)?;
            out.refuse(MODEL_FILE)?;
            self.findings.write(&mut out, self.seed, "oleo.diagnose")?;
            Ok(out.commit()?.join("report.html"))
        })
        .map_err(|error: oleo_report::OutputError| complaint(&error))
    }
}
