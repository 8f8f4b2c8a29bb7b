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
//! | `heard` | the frames of the database in a log, and an account of all others |
//! | `ticks` | the tick of every displacement message, and the drives |
//! | `place` | the tick of every other message, and the samples of a drive |

mod heard;
mod place;
mod ticks;

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use flate2::read::MultiGzDecoder;
use oleo_controller::{Reading, ValveCommand};
use oleo_interface::{Corners, StrutPressures};

pub use heard::MessageAccount;

/// What a log holds.
#[derive(Clone, Debug)]
pub struct DriveLog {
    /// The drives in the order of the log, at least one.
    pub drives: Vec<LoggedDrive>,
    /// What was read, and what could not be used.
    pub account: LogAccount,
}

/// One drive: a sample for every tick from the first displacement message to the last.
#[derive(Clone, Debug)]
pub struct LoggedDrive {
    /// Time of the first displacement message as the log says it, s.
    pub begins_s: f64,
    /// The samples, one tick (5 ms) apart.
    pub samples: Vec<LoggedSample>,
}

/// What was logged for one tick. A reading that is missing, or that its sensor called invalid, is [`Reading::INVALID`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoggedSample {
    /// Strut displacement, m, compression positive.
    pub displacement_m: Corners<Reading>,
    /// Gauge pressures, Pa.
    pub pressure_pa: Corners<StrutPressures<Reading>>,
    /// The command that echoes this tick; `None` if it is missing.
    pub command: Option<ValveCommand>,
}

/// What was read from a log, and what could not be used.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LogAccount {
    /// Number of lines.
    pub lines: u64,
    /// Number of lines that are not a classic CAN frame, such as a last line that was cut off.
    pub unreadable_lines: u64,
    /// Number of frames whose identifier is not in the database.
    pub foreign_frames: u64,
    /// One entry for each message of the database except `STATUS`, in the order of [`oleo_controller::can::MESSAGES`].
    pub messages: Vec<MessageAccount>,
}

impl LogAccount {
    /// The sum of one figure over all messages.
    pub fn total(&self, figure: impl Fn(&MessageAccount) -> u64) -> u64 {
        self.messages.iter().map(figure).sum()
    }
}

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
