//! Resources and shared libraries, packed into a file.

use std::path::PathBuf;
use std::process::ExitCode;

use oleo_fmu::{FmiVersion, Packed, Resources, SharedLibrary, pack};
use oleo_report::OutputFile;

use super::arguments::FileArgs;
use crate::failure::Failure;
use crate::results::say;

/// Packs resources and libraries into a file.
pub fn write(resources: &Resources, file: &FileArgs, fmi: u8, inputs: Vec<PathBuf>) -> Result<ExitCode, Failure> {
    let libraries = (libraries(file)?.iter())
        .map(|path| SharedLibrary::read(path))
        .collect::<Result<Vec<_>, _>>()?;
    let inputs = [inputs, file.library.clone()].concat();
    let out = OutputFile::stage(&file.out, &inputs, file.force)?;
    let version = match fmi {
        3 => FmiVersion::Three,
        _ => FmiVersion::Two,
    };
    let Packed {
        bytes,
        counts: [inputs, outputs, parameters],
        platforms,
    } = pack(resources, version, &libraries)?;
    let out = out.bytes(&bytes)?;
    say(&format!(
        "FMI {}.0 for co-simulation, {}: {inputs} inputs, {outputs} outputs, {parameters} parameters\n{}\n",
        fmi,
        platforms.join(", "),
        out.display()
    ))?;
    Ok(ExitCode::SUCCESS)
}

/// The libraries that were given, or the one beside this program.
fn libraries(file: &FileArgs) -> Result<Vec<PathBuf>, Failure> {
    if !file.library.is_empty() {
        return Ok(file.library.clone());
    }
    let program = std::env::current_exe()?;
    let folder = program.parent().unwrap_or(&program);
    let candidates = SharedLibrary::candidates(folder);
    match candidates.iter().find(|path| path.is_file()) {
        Some(path) => Ok(vec![path.clone()]),
        None => Err(Failure::new(format!(
            "{}: the shared library of the FMUs is not there; build it with `cargo build --release --features fmu -p oleo -p oleo-fmu`, or name it with --library",
            candidates[0].display()
        ))),
    }
}
