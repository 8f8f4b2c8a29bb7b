//! The work of a point, in this process or in one of its own.

use std::path::Path;
use std::process::Command;
use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::point::Point;
use super::resources;
use super::work;
use crate::failure::Failure;

/// What the work of a point cost once.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spent {
    /// Processor time of the work on all threads, s.
    pub processor_s: f64,
    /// Time on the clock, s.
    pub wall_s: f64,
    /// Largest memory of the process from its start, bytes; `None` where the system does not tell.
    pub peak_memory_bytes: Option<u64>,
    /// Number of operations that were done.
    pub operations: u64,
    /// Digest of what was computed.
    pub outcome: String,
}

/// A part of what a process does, whose instructions are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, strum::EnumString, strum::IntoStaticStr)]
#[strum(serialize_all = "kebab-case")]
pub enum Part {
    /// Gets ready for the work.
    Preparation,
    /// Gets ready and does the work; what was computed is not looked at.
    Work,
}

/// Does the work in this process. The text tells [`apart`] what it cost; it is empty where only a part is asked for.
pub fn here(point: Point, scratch: &Path, only: Option<Part>) -> Result<String, Failure> {
    let mut work = work::prepare(point, scratch)?;
    if let Some(part) = only {
        if part == Part::Work {
            work.run()?;
        }
        return Ok(String::new());
    }
    let (processor_s, begun) = (resources::processor_s()?, Instant::now());
    let operations = work.run()?;
    let spent = Spent {
        wall_s: begun.elapsed().as_secs_f64(),
        processor_s: resources::processor_s()? - processor_s,
        peak_memory_bytes: resources::peak_memory_bytes(),
        operations,
        outcome: work.outcome()?,
    };
    Ok(serde_json::to_string(&spent)?)
}

/// Does the work in a process of its own.
pub fn apart(point: Point, scratch: &Path) -> Result<Spent, Failure> {
    let output = command(point, scratch)?.output();
    let output = output.map_err(|error| point.failed(&format!("its process cannot be started: {error}")))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(point.failed(said.trim().trim_start_matches("error: ")));
    }
    serde_json::from_slice(&output.stdout).map_err(|error| point.failed(&error.to_string()))
}

/// The command that does the work.
pub fn command(point: Point, scratch: &Path) -> Result<Command, Failure> {
    let program = std::env::current_exe()
        .map_err(|error| point.failed(&format!("the path of this program is not known: {error}")))?;
    let mut command = Command::new(program);
    command.args(["bench", "--point", &point.to_string(), "--scratch"]);
    command.arg(scratch);
    Ok(command)
}
