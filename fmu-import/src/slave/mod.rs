//! An instance of an FMU: the calls of FMI 2.0 and 3.0 behind one trait. What is not a success is a text.
//!
//! | file | what it holds |
//! |---|---|
//! | `contract` | the trait |
//! | `call` | looking up a function, and what its status means |
//! | `fmi2`, `fmi3` | the functions of either version |
//! | `log` | what the FMU last said of an error |
//!
//! This is the only unsafe code of the crate but for the end of the child. Nobody can check that a foreign library does what FMI asks of it: that it writes as many values as
//! it is asked for, and touches no memory but its own. This is why it is loaded only by a process that has nothing to lose.
#![allow(unsafe_code, reason = "FMI is a C interface; each block says why it is sound")]

mod call;
mod contract;
mod fmi2;
mod fmi3;
mod log;

use std::path::Path;

use libloading::Library;

pub use contract::Slave;

use crate::description::FmiVersion;

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
