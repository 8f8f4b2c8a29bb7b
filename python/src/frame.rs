//! Columns of a recording from Python, and columns for Python.

use numpy::{IntoPyArray, PyArray1, PyArrayMethods, PyReadonlyArray1};
use oleo_diagnose::recording::NamedColumn;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::complaint;

/// A recording: its columns of numbers, and the names of those that hold something else.
pub struct Frame {
    pub name: String,
    columns: Vec<(String, Vec<f64>)>,
    /// Name and type of columns that hold no numbers.
    others: Vec<(String, String)>,
}

impl Frame {
    /// Takes the columns of numbers and the types of the others, by name.
    pub fn of(name: String, columns: &Bound<'_, PyDict>, others: Vec<(String, String)>) -> PyResult<Self> {
        let column = |(name, values): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
            let values: PyReadonlyArray1<'_, f64> = values.extract()?;
            Ok((name.extract()?, values.as_array().to_vec()))
        };
        Ok(Self {
            name,
            columns: columns.iter().map(column).collect::<PyResult<_>>()?,
            others,
        })
    }

    /// The columns of numbers.
    pub fn columns(&self) -> Vec<NamedColumn<'_>> {
        (self.columns.iter())
            .map(|(name, values)| (name.as_str(), values.as_slice()))
            .collect()
    }

    /// What is wrong with the first of the needed columns that holds no numbers.
    pub fn without_numbers<'n>(&self, needed: impl IntoIterator<Item = &'n str>) -> Result<(), String> {
        let other = |name: &str| self.others.iter().find(|(other, _)| other == name);
        match needed.into_iter().find_map(other) {
            Some((column, kind)) => Err(format!(
                "{}: column '{column}' holds {kind}, not numbers; convert it with pandas.to_numeric",
                self.name
            )),
            None => Ok(()),
        }
    }
}

/// Columns for Python, in their order.
pub fn for_python<'py>(
    py: Python<'py>,
    columns: impl IntoIterator<Item = (String, Vec<f64>)>,
) -> Vec<(String, Bound<'py, PyArray1<f64>>)> {
    (columns.into_iter())
        .map(|(name, values)| (name, values.into_pyarray(py)))
        .collect()
}

/// Values of an array that must be of one dimension and finite.
pub fn finite(name: &str, values: &Bound<'_, PyArray1<f64>>) -> PyResult<Vec<f64>> {
    let values = values.readonly().as_array().to_vec();
    match values.iter().position(|value| !value.is_finite()) {
        Some(row) => Err(complaint(&format!(
            "{name}, row {row}: is {}, not a finite number; repair or cut the recording there",
            values[row]
        ))),
        None => Ok(values),
    }
}
