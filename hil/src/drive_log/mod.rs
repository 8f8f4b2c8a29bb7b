//! Reads what a vehicle's bus carried from a candump log: drives, each with one sample of the four struts for every tick.
//!
//! A log is not a recording made on purpose. Frames are missing, repeated, late or corrupted, other devices talk in between, the log
//! may begin in the middle of a line and end there, and several drives may follow each other in one file. The reader uses a frame
//! only if its CRC is right, puts it at the tick that it was measured in, and counts everything else.
//!
//! ```text
//!   line --candump--> frame --CRC--> heard frame --tick--> its place in a drive
//! ```
//!
//! * `PlantTick` has eight bits and wraps every 1.28 s. Together with the time of the line it gives the tick, which also finds a
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

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use flate2::read::MultiGzDecoder;

pub use content::{DriveLog, LogAccount, LoggedDrive, LoggedSample, MessageAccount};

/// A log that holds no drive.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The file cannot be read.
    #[error("{}: {source}", path.display())]
    Unreadable {
        /// Path of the log.
        path: PathBuf,
        /// Why it cannot be read.
        source: std::io::Error,
    },
    /// No drive is in the log.
    #[error("{}: {what}", path.display())]
    NoDrive {
        /// Path of the log.
        path: PathBuf,
        /// What the log holds instead, and what to do.
        what: String,
    },
}

/// Reads a log file, plain or compressed with gzip.
///
/// # Errors
/// The file cannot be read, or holds no drive.
pub fn read(path: &Path) -> Result<DriveLog, LogError> {
    let unreadable = |source| LogError::Unreadable {
        path: path.to_path_buf(),
        source,
    };
    let mut file = BufReader::with_capacity(1 << 20, std::fs::File::open(path).map_err(unreadable)?);
    let is_gzip = file.fill_buf().map_err(unreadable)?.starts_with(&[0x1F, 0x8B]);
    let source: Box<dyn Read> = if is_gzip {
        Box::new(MultiGzDecoder::new(file))
    } else {
        Box::new(file)
    };
    let (heard, account) = heard::hear(BufReader::with_capacity(1 << 20, source)).map_err(unreadable)?;
    drives(&heard, account).map_err(|what| LogError::NoDrive {
        path: path.to_path_buf(),
        what,
    })
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
    let (heard, account) = heard::hear(log).map_err(|e| e.to_string())?;
    drives(&heard, account)
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
        "holds no drive: {}, of which {} no CAN frame of candump -L; {} with other identifiers, {} of the suspension's database with \
         a wrong check value, {} with a right one; log the bus of the suspension (controller/oleo.dbc) for at least a second",
        plural(account.lines, "line", "lines"),
        plural(account.unreadable_lines, "is", "are"),
        plural(account.foreign_frames, "frame", "frames"),
        account.total(|m| m.corrupted),
        received,
    )
}

#[cfg(test)]
mod tests;
