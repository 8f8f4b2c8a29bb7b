//! A log that can be read several times: a file, or a copy of what comes through a pipe.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use oleo_report::OutputFile;

use crate::failure::Failure;

/// A log, by the name that the user gave and the path that is read.
pub struct Rereadable {
    given: PathBuf,
    read: PathBuf,
}

impl Rereadable {
    /// A log that is read once.
    pub fn as_it_is(given: &Path) -> Self {
        let (given, read) = (given.to_path_buf(), given.to_path_buf());
        Self { given, read }
    }

    /// A log that is read several times. What comes through a pipe is copied beside the output until that is written.
    pub fn of(given: &Path, output: &OutputFile) -> Result<Self, Failure> {
        // What cannot be read at all is refused by who reads it.
        let is_pipe = fs::metadata(given).is_ok_and(|found| !found.is_file() && !found.is_dir());
        if !is_pipe {
            return Ok(Self::as_it_is(given));
        }
        // The end of the name may tell the format.
        let name = given
            .file_name()
            .map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        let read = output.scratch(&name);
        let copied = File::open(given).and_then(|mut pipe| io::copy(&mut pipe, &mut File::create(&read)?));
        copied.map_err(|error| {
            Failure::new(format!(
                "{}: cannot be copied beside the output, which is needed because it is read more than once: {error}; make room, or give a file",
                given.display()
            ))
        })?;
        let given = given.to_path_buf();
        Ok(Self { given, read })
    }

    /// The path to read.
    pub fn path(&self) -> &Path {
        &self.read
    }

    /// A failure that names the log as the user did.
    pub fn named(&self, failure: &Failure) -> Failure {
        let (read, given) = (self.read.display().to_string(), self.given.display().to_string());
        Failure::new(failure.to_string().replace(&read, &given))
    }
}
