//! Reads what a vehicle's bus carried from a log of frames with messages of our database: drives, each with one sample of the four struts for every tick.
//!
//! A log is not a recording made on purpose. Frames are missing, repeated, late or corrupted, other devices talk in between, the log
//! may begin in the middle of a line and end there, and several drives may follow each other in one file. The reader uses a frame
//! only if its CRC is right, puts it at the tick that it was measured in, and counts everything else.
//!
//! ```text
//!   frame of a log --CRC--> heard frame --tick--> its place in a drive
//! ```
//!
//! * `PlantTick` has eight bits and wraps every 1.28 s. Together with the time of the frame it gives the tick, which also finds a
//!   frame that was logged late. (The first edition of the database had sixteen bits; only their lower half is used, so that its
//!   logs are read too.)
//! * A pressure message has no tick. It belongs to the pair of displacement messages that follows it; its 4-bit counter, which
//!   advances by one in every tick, corrects this where frames are missing or late.
//! * A command is entered at the tick that it echoes, which is the tick at whose end it acts.
//! * A drive ends where the bus is silent for a second, or where the tick starts again.
//!
//! | file | what it holds |
//! |---|---|
//! | `content` | what a log holds |
//! | `heard` | the frames of the database in a log, and an account of all others |
//! | `ticks` | the tick of every displacement message, and the drives |
//! | `place` | the tick of every other message, and the samples of a drive |

mod content;
mod heard;
mod place;
mod ticks;

use std::path::Path;

use crate::logs::{self, FrameSource, LogError};

pub use content::{DriveLog, LogAccount, LoggedDrive, LoggedSample, MessageAccount};

/// Reads a log file of any format that [`logs`] reads.
///
/// # Errors
/// The file cannot be read, or holds no drive.
pub fn read(path: &Path) -> Result<DriveLog, LogError> {
    of(&mut *logs::open(path)?, path)
}

/// Reads a log from memory. The error says in one sentence what the log holds instead of a drive.
///
/// ```
/// let error = oleo_hil::drive_log::parse(b"(1.000000) can0 123#00\n").unwrap_err();
/// assert!(error.contains("1 frame with other identifiers"), "{error}");
/// ```
///
/// # Errors
/// The bytes hold no drive.
pub fn parse(log: &[u8]) -> Result<DriveLog, String> {
    let read = logs::in_memory(log).and_then(|mut log| of(&mut *log, Path::new("log")));
    read.map_err(|error| error.what)
}

fn of(log: &mut dyn FrameSource, path: &Path) -> Result<DriveLog, LogError> {
    let (heard, account) = heard::hear(log)?;
    drives(&heard, account).map_err(|what| LogError::new(path, what))
}

fn drives(heard: &heard::Heard, mut account: LogAccount) -> Result<DriveLog, String> {
    let runs = ticks::runs(heard, &mut account);
    if runs.is_empty() {
        return Err(nothing_of_ours(&account));
    }
    let drives = place::drives(heard, &runs, &mut account);
    Ok(DriveLog { drives, account })
}

fn nothing_of_ours(account: &LogAccount) -> String {
    let plural = |n: u64, one: &str, several: &str| format!("{n} {}", if n == 1 { one } else { several });
    let received = account.total(|m| m.received);
    format!(
        "holds no drive: {}, of which {} unreadable; {} with other identifiers, {} of the suspension's database with a wrong check \
         value, {} with a right one; log the bus of the suspension (controller/oleo.dbc) for at least a second, or name the database of \
         the log with --dbc and --signals",
        plural(account.log.entries, "entry", "entries"),
        plural(account.log.unreadable, "is", "are"),
        plural(account.foreign_frames, "frame", "frames"),
        account.total(|m| m.corrupted),
        received,
    )
}

#[cfg(test)]
mod tests;
