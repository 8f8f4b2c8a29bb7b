//! The vehicle with its controller: over the bus (`hil`) and without it (`drive`).

use std::collections::BTreeMap;
use std::fmt::Display;
use std::path::PathBuf;
use std::str::FromStr;
use std::sync::atomic::Ordering;

use numpy::PyArray1;
use oleo_controller::DamperPolicy;
use oleo_hil::drive::{COLUMNS, Plan, Request, Setting, column, measures};
use oleo_hil::metrics::Metrics;
use oleo_hil::output::Summary;
use oleo_hil::parameter_files::Parameters;
use oleo_hil::run::{self, RunError};
use oleo_hil::scenario::{self, Clock, Overrides};
use oleo_hil::time_series;
use oleo_interface::Corner;
use oleo_plant_sim::course::CourseChanges;
use oleo_plant_sim::model_file::names::suggestion;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::{Map, Value, json};
use strum::{VariantArray, VariantNames};

use crate::error::complaint;
use crate::frame::for_python;
use crate::watched::watched;

/// Columns for Python.
type PyColumns<'py> = Vec<(String, Bound<'py, PyArray1<f64>>)>;

/// Settings by name, as Python gave them. Each is taken once; the package has checked the names.
struct Settings<'py>(&'py Bound<'py, PyDict>);

impl<'py> Settings<'py> {
    /// A value of a kind that Python knows: `kind` says which.
    fn value<T>(&self, name: &str, kind: &str) -> PyResult<Option<T>>
    where
        T: for<'a> FromPyObject<'a, 'py>,
    {
        match self.0.get_item(name)?.filter(|value| !value.is_none()) {
            Some(value) => match value.extract() {
                Ok(value) => Ok(Some(value)),
                Err(_) => Err(complaint(&format!("{name} is {value}: give {kind}"))),
            },
            None => Ok(None),
        }
    }

    fn number(&self, name: &str) -> PyResult<Option<f64>> {
        self.value(name, "a number")
    }

    /// A name, or the path of a file.
    fn text(&self, name: &str) -> PyResult<Option<String>> {
        let path: Option<PathBuf> = self.value(name, "a text or a path")?;
        Ok(path.map(|path| path.display().to_string()))
    }

    fn path(&self, name: &str) -> PyResult<Option<PathBuf>> {
        self.value(name, "a path")
    }

    fn seed(&self) -> PyResult<Option<u64>> {
        let seed: Option<u64> = self.value("seed", "a whole number from 0 to 2^63 - 1")?;
        match seed.filter(|seed| *seed > i64::MAX.cast_unsigned()) {
            Some(seed) => Err(complaint(&format!(
                "seed is {seed}: give a whole number from 0 to 2^63 - 1"
            ))),
            None => Ok(seed),
        }
    }

    /// One of the words of a library's enum.
    fn word<T: Word>(&self, name: &str) -> PyResult<Option<T>> {
        self.text(name)?.map(|word| one_of(name, &word)).transpose()
    }

    fn damper_policy(&self) -> PyResult<Option<DamperPolicy>> {
        let Some(word) = self.text("damper_policy")? else {
            return Ok(None);
        };
        let names = suggestion(&word, DamperPolicy::VARIANTS, "words");
        match word.parse() {
            Ok(policy) => Ok(Some(policy)),
            Err(_) => Err(complaint(&format!("damper_policy is {word}: {names}"))),
        }
    }

    /// Paths of struts by the names of their corners.
    fn struts_at(&self) -> PyResult<Vec<(Corner, String)>> {
        let given: Option<BTreeMap<String, PathBuf>> = self.value("strut_at", "corners with paths of strut models")?;
        let named = given.unwrap_or_default().into_iter().map(|(name, path)| {
            let known = suggestion(&name, &Corner::ALL.map(Corner::name), "corners");
            let corner = Corner::named(&name).ok_or_else(|| complaint(&format!("strut_at has {name}: {known}")))?;
            Ok((corner, path.display().to_string()))
        });
        named.collect()
    }

    fn course(&self) -> PyResult<CourseChanges> {
        Ok(CourseChanges {
            driver: self.word("driver")?,
            entry_m: self.number("entry_m")?,
            radius_m: self.number("radius_m")?,
            steer_deg: self.number("steer_deg")?,
            change_m_s2: self.number("change_m_s2")?,
            begin_s: self.number("begin_s")?,
            side_slope_percent: self.number("side_slope_percent")?,
        })
    }
}

/// An enum of a library that is chosen by its words.
trait Word: FromStr + VariantArray + Copy + Into<&'static str> {}
impl<T: FromStr + VariantArray + Copy + Into<&'static str>> Word for T {}

fn one_of<T: Word>(name: &str, word: &str) -> PyResult<T> {
    let words: Vec<&str> = T::VARIANTS.iter().map(|known| (*known).into()).collect();
    let wrong = |_| complaint(&format!("{name} is {word}: {}", suggestion(word, &words, "words")));
    word.parse().map_err(wrong)
}

fn failed(error: impl Display) -> PyErr {
    complaint(&error)
}

/// Runs a scenario. Returns the columns of numbers, those of words, the summary as JSON, and whether all checks are met.
#[pyfunction]
#[allow(clippy::type_complexity, reason = "it is unpacked at once")]
pub fn hil<'py>(
    py: Python<'py>,
    scenario: &str,
    settings: &Bound<'py, PyDict>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(PyColumns<'py>, Vec<(&'static str, Vec<&'static str>)>, String, bool)> {
    let settings = Settings(settings);
    let overrides = Overrides {
        bus: None,
        clock: Some(Clock::Lockstep),
        road: settings.text("road")?,
        manoeuvre: settings.word("manoeuvre")?,
        course: settings.course()?,
        load: settings.word("load")?,
        speed_km_h: settings.number("speed_km_h")?,
        duration_s: settings.number("duration_s")?,
        strategy: settings.word("strategy")?,
        damper_policy: settings.damper_policy()?,
        strut: settings.text("strut")?,
        strut_at: settings.struts_at()?,
        vehicle: settings.text("vehicle")?,
        handling: settings.text("handling")?,
        imu_m: None,
        seed: settings.seed()?,
    };
    let ran = watched(py, progress, |stop, tell| -> Result<_, RunError> {
        let written = scenario::named(scenario)?;
        let scenario = overrides.of(&written).map_err(RunError::Course)?;
        let vehicle = run::vehicle(&scenario)?;
        let road_measured_m = vehicle.measured_road_m();
        let total = f64::from(scenario.ticks.max(1));
        let outcome = run::both(&scenario, vehicle, 1, &mut |run| {
            if run.ticks % 200 == 0 {
                tell("driving", f64::from(run.ticks) / total);
            }
            !stop.load(Ordering::Relaxed)
        })?;
        let metrics = Metrics::of(&scenario, &outcome);
        let summary = Summary::of(&scenario, &outcome, &metrics, road_measured_m);
        let columns = time_series::columns(&outcome, &metrics);
        Ok((columns, time_series::words(&metrics), summary))
    })?;
    let (columns, words, summary) = ran.map_err(failed)?;
    let text = serde_json::to_string(&summary).map_err(failed)?;
    Ok((for_python(py, columns), words.into(), text, summary.passed()))
}

/// Drives a manoeuvre. Returns, for each drive, its name, its columns and its figures as JSON.
#[pyfunction]
#[allow(clippy::type_complexity, reason = "it is unpacked at once")]
pub fn drive<'py>(
    py: Python<'py>,
    manoeuvre: &str,
    setting: Vec<String>,
    settings: &Bound<'py, PyDict>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Vec<(String, PyColumns<'py>, String)>> {
    let given = Settings(settings);
    let mut request = Request::new(one_of("manoeuvre", manoeuvre)?);
    request.setting = setting
        .iter()
        .map(|word| one_of::<Setting>("setting", word))
        .collect::<PyResult<_>>()?;
    request.model = given.word("model")?.unwrap_or(request.model);
    request.speed_km_h = given.number("speed_km_h")?;
    request.road = given.text("road")?;
    request.course = given.course()?;
    request.load = given.word("load")?;
    request.gas_temperature_c = given.number("gas_temperature_c")?;
    request.duration_s = given.number("duration_s")?;
    request.score_from_s = given.number("score_from_s")?.unwrap_or(request.score_from_s);
    request.seed = given.seed()?.unwrap_or(request.seed);
    let (vehicle, handling, strut) = (given.path("vehicle")?, given.path("handling")?, given.path("strut")?);
    request.has_handling = handling.is_some();
    request.has_strut = strut.is_some();
    let ran = watched(py, progress, |_, _| -> Result<_, RunError> {
        request.refuse_unused()?;
        let parameters = Parameters::read(vehicle.as_ref(), handling.as_ref(), strut.as_ref())?;
        let plan = Plan::new(&request, &parameters)?;
        let drives = oleo_hil::drive::drive(&plan, &request)?;
        Ok((drives.into_iter())
            .map(|driven| {
                let mut figures: Map<String, Value> = measures(&plan, &driven, request.score_from_s)
                    .into_iter()
                    .map(|measure| (measure.0.to_owned(), json!(measure.2)))
                    .collect();
                figures.insert("ending".into(), json!(driven.run.ending.word()));
                let columns: Vec<(String, Vec<f64>)> = (COLUMNS.iter())
                    .map(|(name, of)| ((*name).to_owned(), column(&driven.run, *of)))
                    .collect();
                (driven.name.to_owned(), columns, Value::Object(figures).to_string())
            })
            .collect::<Vec<_>>())
    })?;
    Ok((ran.map_err(failed)?.into_iter())
        .map(|(name, columns, figures)| (name, for_python(py, columns), figures))
        .collect())
}
