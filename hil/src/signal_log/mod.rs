//! Reads what a vehicle's bus carried from a log of frames with messages of any CAN database: a map says which signal is what.
//!
//! ```text
//!   FILE.dbc --> Database --+
//!                           +--> Selection
//!   MAP.toml --> SignalMap -+        |
//!   log --> readings in the order of time --> beat --> stretches --> survey, samples of all struts at the same instants --> drives
//! ```
//!
//! A log is read three times, because how the readings follow each other is known at its end: for the beat, for the survey of the drives,
//! and for the samples. Each time it is held for two seconds only, so that a log of any length needs the memory of a short one.
//!
//! Check values and counters that a message may have are not looked at, because every manufacturer has others: a frame is believed if
//! the logger received it. For messages of our own database, `drive_log` does look at them.
//!
//! | file | what it holds |
//! |---|---|
//! | `map` | the map file |
//! | `database` | messages and signals of a DBC file by name |
//! | `decoder` | the value of a signal from the bytes of a frame |
//! | `selection` | what is taken of a log: map and database together |
//! | `readings` | the frames of a log that the map names, in the order of time |
//! | `intervals` | the median time between frames |
//! | `beat` | the displacement that beats the time |
//! | `stretches` | the stretches of a log in which it does, and the time of every frame in samples |
//! | `survey` | which stretches are drives, and how their readings follow the beat |
//! | `samples` | the sample to which each reading belongs |
//! | `content` | what a log holds |

mod beat;
mod content;
mod database;
mod decoder;
mod intervals;
mod map;
mod readings;
mod samples;
mod selection;
mod stretches;
mod survey;

use std::ops::ControlFlow;
use std::path::Path;

pub use content::{SignalAccount, SignalDrive, SignalLog, SignalMessage, SignalPart, SignalSink, StrutSample};
pub use database::{Database, Definition};
pub use decoder::Decoder;
pub use map::{COLUMNS, SignalMap};
pub use selection::{Selection, Steps};
pub use survey::Survey;

use crate::logs::{self, FrameSource, LogError};
use beat::Search;
use samples::Samples;
use stretches::{StepSink, Stretches};
use survey::Surveyor;

/// Opens a log from its beginning.
type Open<'a> = &'a dyn Fn() -> Result<Box<dyn FrameSource>, LogError>;

/// Finds out what must be known of a log file before it can be given on.
///
/// # Errors
/// The file cannot be read, or is a pipe, or holds no drive.
pub fn survey(path: &Path, selection: &Selection) -> Result<Survey, LogError> {
    if std::fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir()) {
        let what = "is no file, and by a map of signals a log is read three times; save it to a file, and give that";
        return Err(LogError::new(path, what));
    }
    survey_of(&|| logs::open(path), selection, path)
}

/// Gives the drives of a log file to `sink` piece by piece, after its [`survey()`].
///
/// # Errors
/// The file cannot be read.
pub fn stream(
    path: &Path,
    selection: &Selection,
    survey: &Survey,
    sink: &mut SignalSink,
) -> Result<SignalAccount, LogError> {
    stream_of(&|| logs::open(path), selection, survey, path, sink)
}

/// Reads a log from memory.
///
/// # Errors
/// The bytes hold no drive.
pub fn parse(log: &[u8], selection: &Selection) -> Result<SignalLog, LogError> {
    let (open, path) = (|| logs::in_memory(log), Path::new("log"));
    let survey = survey_of(&open, selection, path)?;
    let mut drives: Vec<SignalDrive> = Vec::new();
    let account = stream_of(&open, selection, &survey, path, &mut |part| {
        match (part, drives.last_mut()) {
            (SignalPart::Begins(begins_s), _) => drives.push(SignalDrive {
                begins_s,
                period_s: survey.period_s(),
                samples: Vec::new(),
            }),
            (SignalPart::Sample(struts), Some(drive)) => drive.samples.push(*struts),
            (SignalPart::Sample(_), None) => {}
        }
        ControlFlow::Continue(())
    })?;
    Ok(SignalLog {
        drives,
        steps: selection.steps,
        account,
    })
}

fn survey_of(open: Open, selection: &Selection, path: &Path) -> Result<Survey, LogError> {
    let wrong = |what: String| LogError::new(path, what);
    let mut search = Search::of(selection);
    let account = readings::read(&mut *open()?, selection, path, &mut |frame| {
        search.take(frame);
        ControlFlow::Continue(())
    })?;
    let beat = search.found(&account).map_err(wrong)?;
    let mut surveyor = Surveyor::new(selection, beat);
    let stretches = Stretches::new(selection, beat);
    steps(open, selection, path, stretches, &mut |step| surveyor.take(&step))?;
    surveyor.found().map_err(wrong)
}

fn stream_of(
    open: Open,
    selection: &Selection,
    survey: &Survey,
    path: &Path,
    sink: &mut SignalSink,
) -> Result<SignalAccount, LogError> {
    let mut samples = Samples::new(selection, survey);
    let stretches = Stretches::new(selection, survey.beat);
    let mut account = steps(open, selection, path, stretches, &mut |step| samples.take(&step, sink))?;
    samples.account(&mut account);
    Ok(account)
}

/// Reads a log step by step.
fn steps(
    open: Open,
    selection: &Selection,
    path: &Path,
    mut stretches: Stretches,
    sink: &mut StepSink,
) -> Result<SignalAccount, LogError> {
    let mut flow = ControlFlow::Continue(());
    let account = readings::read(&mut *open()?, selection, path, &mut |frame| {
        flow = stretches.take(frame, sink);
        flow
    })?;
    if flow.is_continue() {
        // Nothing comes after it that a sink could refuse.
        let _ = stretches.end(sink);
    }
    Ok(account)
}

#[cfg(test)]
mod tests;
