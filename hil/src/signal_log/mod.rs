//! Reads what a vehicle's bus carried from a log of frames with messages of any CAN database: a map says which signal is what.
//!
//! ```text
//!   FILE.dbc --> Database --+
//!                           +--> Selection --------+
//!   MAP.toml --> SignalMap -+                      |
//!   log --frames--> readings of each message, with their times --> samples of all struts at the same instants --> drives
//! ```
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
//! | `series` | the readings of a log, message by message |
//! | `samples` | the drives, and the sample to which each reading belongs |
//! | `content` | what a log holds |

mod content;
mod database;
mod decoder;
mod map;
mod samples;
mod selection;
mod series;

use std::path::Path;

pub use content::{SignalAccount, SignalDrive, SignalLog, SignalMessage, StrutSeries};
pub use database::{Database, Definition};
pub use decoder::Decoder;
pub use map::{COLUMNS, SignalMap};
pub use selection::{Selection, Steps};

use crate::logs::{self, FrameSource, LogError};

/// Reads a log file.
///
/// # Errors
/// The file cannot be read, or holds no drive.
pub fn read(path: &Path, selection: &Selection) -> Result<SignalLog, LogError> {
    of(&mut *logs::open(path)?, selection, path)
}

/// Reads a log from memory.
///
/// # Errors
/// The bytes hold no drive.
pub fn parse(log: &[u8], selection: &Selection) -> Result<SignalLog, LogError> {
    of(&mut *logs::in_memory(log)?, selection, Path::new("log"))
}

fn of(log: &mut dyn FrameSource, selection: &Selection, path: &Path) -> Result<SignalLog, LogError> {
    let (series, mut account) = series::read(log, selection, path)?;
    let drives = samples::drives(&series, &selection.fixed, &mut account).map_err(|what| LogError::new(path, what))?;
    Ok(SignalLog {
        drives,
        steps: selection.steps,
        account,
    })
}

#[cfg(test)]
mod tests;
