//! What Python calls of `oleo`. The package `python/oleo` around it turns data frames into columns and columns into data frames.
//!
//! | file | what it holds |
//! |---|---|
//! | `error` | every complaint as one exception with one line |
//! | `frame` | columns of a recording from Python, and columns for Python |
//! | `watched` | long work beside which Python stays alive: progress, Ctrl-C |
//! | `diagnosis`, `prediction`, `strut`, `loops` | what can be called |
//!
//! The interpreter is released while Rust works.

mod diagnosis;
mod error;
mod frame;
mod loops;
mod prediction;
mod strut;
mod watched;

#[pyo3::pymodule]
mod _oleo {
    #[pymodule_export]
    use crate::diagnosis::{Findings, diagnose};
    #[pymodule_export]
    use crate::error::OleoError;
    #[pymodule_export]
    use crate::loops::{drive, hil};
    #[pymodule_export]
    use crate::prediction::predict;
    #[pymodule_export]
    use crate::strut::{Strut, built_in_strut, read_model};
}
