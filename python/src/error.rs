//! Complaints of the libraries as one exception.

use std::fmt::Display;

use pyo3::exceptions::PyValueError;
use pyo3::{PyErr, create_exception};

create_exception!(
    oleo,
    OleoError,
    PyValueError,
    "What is wrong, where, and what to do, in one line, as the command line says it."
);

/// A complaint in one line: some libraries draw pictures of the place in their messages.
pub fn complaint(what: &impl Display) -> PyErr {
    let text = what.to_string();
    OleoError::new_err(text.split_whitespace().collect::<Vec<_>>().join(" "))
}
