//! A run as an MCAP file, for Foxglove and PlotJuggler.

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use oleo_hil::telemetry::{HOW_TO_BUILD, IS_BUILT};
use oleo_report::OutputFile;

use crate::failure::Failure;
use crate::results::VERSION;

/// Where the messages of a run are written.
#[derive(clap::Args)]
pub struct McapArgs {
    /// Write the run also as MCAP, which Foxglove and PlotJuggler show (docs/viewers.md)
    #[arg(long, value_name = "FILE.mcap", help_heading = "Results")]
    mcap: Option<PathBuf>,
}

impl McapArgs {
    /// Whether a file is wanted.
    pub fn is_given(&self) -> bool {
        self.mcap.is_some()
    }

    /// The file that was asked for. One that cannot be written is refused here, before the run.
    pub fn stage(&self, inputs: &[PathBuf], force: bool) -> Result<Option<McapOutput>, Failure> {
        (self.mcap.as_ref())
            .map(|path| McapOutput::stage(path, inputs, force))
            .transpose()
    }
}

/// An MCAP file that will be written.
pub struct McapOutput(OutputFile);

impl McapOutput {
    /// Checks that the file can be written by this program, and where it is to be.
    fn stage(path: &Path, inputs: &[PathBuf], force: bool) -> Result<Self, Failure> {
        is_built(path)?;
        Ok(Self(OutputFile::stage(path, inputs, force)?))
    }

    /// Lets `write` write it, and moves it into place.
    pub fn write(self, write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> Result<PathBuf, Failure> {
        stream(self.0, write)
    }
}

/// Whether this program writes MCAP. `path` is named in the refusal.
pub fn is_built(path: &Path) -> Result<(), Failure> {
    match IS_BUILT {
        true => Ok(()),
        false => Err(Failure::new(format!(
            "{}: this oleo was built without MCAP; {HOW_TO_BUILD}",
            path.display()
        ))),
    }
}

/// Lets `write` write a file that only the disk can refuse, and moves it into place.
pub fn stream(
    staged: OutputFile,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<PathBuf, Failure> {
    staged.stream(|out| write(out).map(Ok::<(), Failure>))?
}

/// What the file says of the program that wrote it.
pub fn program() -> String {
    format!("oleo {VERSION}")
}
