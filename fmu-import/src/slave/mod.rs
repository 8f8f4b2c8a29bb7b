//! An instance of an FMU: the calls of FMI 2.0 and 3.0 behind one trait. What is not a success is a text.
//!
//! | file | what it holds |
//! |---|---|
//! | `fmi2`, `fmi3` | the functions of either version |
//! | `log` | what the FMU last said of an error |
//!
//! This is the only unsafe code of the crate but for the end of the child. Nobody can check that a foreign library does what FMI asks of it: that it writes as many values as
//! it is asked for, and touches no memory but its own. This is why it is loaded only by a process that has nothing to lose.
#![allow(unsafe_code, reason = "FMI is a C interface; each block says why it is sound")]

mod fmi2;
mod fmi3;
mod log;

use std::path::Path;

use libloading::Library;

use crate::description::{FmiVersion, NumberKind};
use crate::message::VariableId;

/// One instance, from its initialization to its end.
pub trait Slave {
    /// Begins the initialization at a time, s, of a simulation that ends at another.
    fn enter_initialization(&mut self, start_s: f64, stop_s: f64) -> Result<(), String>;
    /// Ends it.
    fn exit_initialization(&mut self) -> Result<(), String>;
    /// Sets a variable.
    fn set(&mut self, variable: VariableId, value: f64) -> Result<(), String>;
    /// Reads a variable.
    fn get(&mut self, variable: VariableId) -> Result<f64, String>;
    /// Makes a step from a time, both in s.
    fn step(&mut self, time_s: f64, step_s: f64) -> Result<(), String>;
    /// Ends the simulation. What the FMU says to it no longer matters.
    fn terminate(&mut self);
}

/// Loads a shared library.
pub fn load(path: &Path) -> Result<Library, String> {
    // SAFETY: what the library does as it is loaded, it does in a process that has nothing to lose.
    unsafe { Library::new(path) }.map_err(|error| {
        // What the loader of the system says of it is the source of the error.
        let why = std::error::Error::source(&error).map_or_else(|| error.to_string(), ToString::to_string);
        format!("cannot be used, because its library cannot be loaded: {why}")
    })
}

/// Makes an instance. The library must stay loaded while it lives.
pub fn instantiate<'l>(
    library: &'l Library,
    version: FmiVersion,
    name: &str,
    token: &str,
    resources: &Path,
) -> Result<Box<dyn Slave + 'l>, String> {
    Ok(match version {
        FmiVersion::Two => Box::new(fmi2::Instance::new(library, name, token, resources)?),
        FmiVersion::Three => Box::new(fmi3::Instance::new(library, name, token, resources)?),
    })
}

/// A function of a library by its name.
fn function<'l, F>(library: &'l Library, name: &str) -> Result<libloading::Symbol<'l, F>, String> {
    // SAFETY: FMI says what type the function of this name has.
    unsafe { library.get(name) }.map_err(|_| format!("its library has no function {name}"))
}

/// What a status means: 0 is success and 1 a warning in both versions.
fn checked(status: std::ffi::c_int, what: &str) -> Result<(), String> {
    match status {
        0 | 1 => Ok(()),
        _ => {
            let named = match status {
                2 => "discards it",
                4 => "calls it a fatal error",
                5 => "has not finished it",
                _ => "calls it an error",
            };
            let said = log::take().map_or(String::new(), |said| format!(": {said}"));
            Err(format!("{what}: the FMU {named}{said}"))
        }
    }
}

/// A number as an integer of a type, refused where it is none of its values.
fn integer<I: TryFrom<i64>>(value: f64) -> Result<I, String> {
    let whole = value as i64;
    match I::try_from(whole) {
        Ok(integer) if whole as f64 == value => Ok(integer),
        _ => Err(format!("{value} is not an integer of the variable's type")),
    }
}

/// Whether a switch is on.
fn switch(value: f64) -> bool {
    value != 0.0
}

/// What a type is that this version does not have.
fn foreign(kind: NumberKind) -> String {
    format!("this version of FMI has no variables of the type {kind:?}")
}
