//! Where results come from: the command, its version and its inputs.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::digest::of_file as digest;

/// What a command says of itself before it writes results.
#[derive(Clone, Debug, Default)]
pub struct Origin {
    /// The command, such as `oleo hil` or `oleo rig spring`.
    pub command: String,
    /// Version of the program.
    pub version: String,
    /// Files that the command reads. Names of files that do not exist (such as those of built-in things) are no inputs.
    pub inputs: Vec<PathBuf>,
}

/// The first keys of every summary.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Provenance {
    /// Version of the layout of the file.
    schema: u32,
    command: String,
    version: String,
    inputs: Vec<Input>,
    /// Seed of everything random; `null` where nothing is.
    seed: Option<u64>,
}

/// An input, by its name without the folder, so that results do not depend on where it lies.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Input {
    name: String,
    /// Hexadecimal; `null` for what is no regular file.
    sha256: Option<String>,
}

impl Input {
    /// As it is now.
    pub fn of(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_string_lossy().into_owned();
        path.exists().then(|| Self {
            name,
            sha256: digest(path),
        })
    }
}

/// A summary with its provenance in front.
#[derive(Serialize)]
pub(super) struct Stamped<'a, T> {
    #[serde(flatten)]
    provenance: Provenance,
    #[serde(flatten)]
    content: &'a T,
}

impl<'a, T: Serialize> Stamped<'a, T> {
    pub fn new(origin: &Origin, inputs: &[Input], seed: Option<u64>, content: &'a T) -> Self {
        Self {
            provenance: Provenance {
                schema: 1,
                command: origin.command.clone(),
                version: origin.version.clone(),
                inputs: inputs.to_vec(),
                seed,
            },
            content,
        }
    }
}
