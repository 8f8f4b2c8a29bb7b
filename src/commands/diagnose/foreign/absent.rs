//! What a program without FMUs says.

use std::path::Path;
use std::process::ExitCode;

use super::arguments::Recordings;
use crate::failure::Failure;
use crate::results::ResultsArgs;

/// Runs the command.
pub fn run(
    fmu: &Path,
    _map: Option<&Path>,
    _recordings: &Recordings,
    _results: &ResultsArgs,
) -> Result<ExitCode, Failure> {
    Err(Failure::new(format!(
        "{}: this program was built without FMUs; build it with `cargo build --release --features fmu -p oleo -p oleo-fmu`",
        fmu.display()
    )))
}
