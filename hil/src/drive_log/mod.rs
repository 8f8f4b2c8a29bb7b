//! Reads what a vehicle's bus carried from a log of frames with messages of our database: drives, each with one sample of the four struts for every tick.
//!
//! A log is not a recording made on purpose. Frames are missing, repeated, late or corrupted, other devices talk in between, the log
//! may begin in the middle of a line and end there, and several drives may follow each other in one file. The reader uses a frame
//! only if its CRC is right, puts it at the tick that it was measured in, and counts everything else.
//!
//! ```text
//!   frame of a log --CRC--> heard frame --drive--> sorted frame --tick--> window of samples --> sample of a drive
//! ```
//!
//! A sample is given on when nothing can come for it any more, so that a log of any length needs the memory of 22 s of driving.
//!
//! * `PlantTick` has eight bits and wraps every 1.28 s. Together with the time of the frame it gives the tick, which also finds a
//!   frame that was logged late. (The first edition of the database had sixteen bits; only their lower half is used, so that its
//!   logs are read too.)
//! * A pressure message has no tick. It belongs to the pair of displacement messages that follows it; its 4-bit counter, which
//!   advances by one in every tick, corrects this where frames are missing or late.
//! * A message of an inertial unit (`hil/imu.dbc`) has no tick either. It is sent behind the displacement messages of its tick, and its counter
//!   corrects that as above.
//! * A command is entered at the tick that it echoes, which is the tick at whose end it acts.
//! * A drive ends where the bus is silent for a second, or where the tick starts again.
//! * Frames may come out of order: displacement messages by a second, others within the 20 s in which their neighbours settle their
//!   tick. What cannot be placed by then, or waits behind 65,000 others for a displacement message, is counted as out of sequence.
//!
//! | file | what it holds |
//! |---|---|
//! | `content` | what a log holds |
//! | `heard` | the frames of the database in a log, and an account of all others |
//! | `ticks` | the tick of every displacement message, and the drives |
//! | `place` | the tick of every other message, from its neighbours |
//! | `queue` | the same, from its counter |
//! | `window` | the samples that are not complete yet |

mod content;
mod heard;
mod place;
mod queue;
mod ticks;
mod window;

use std::ops::ControlFlow;
use std::path::Path;

use crate::logs::{self, Entry, FrameSource, LogError};

pub use content::{DriveLog, DrivePart, DriveSink, LogAccount, LoggedDrive, LoggedSample, MessageAccount};
use place::Places;
use ticks::{Sorted, Ticks};

/// Gives the drives of a log file, of any format that [`logs`] reads, to `sink` piece by piece.
///
/// # Errors
/// The file cannot be read, or holds no drive.
pub fn stream(path: &Path, sink: &mut DriveSink) -> Result<LogAccount, LogError> {
    of(&mut *logs::open(path)?, path, sink)
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
    let mut drives: Vec<LoggedDrive> = Vec::new();
    let mut collect = |part: DrivePart| {
        match (part, drives.last_mut()) {
            (DrivePart::Begins(begins_s), _) => drives.push(LoggedDrive {
                begins_s,
                samples: Vec::new(),
            }),
            (DrivePart::Sample(sample), Some(drive)) => drive.samples.push(*sample),
            (DrivePart::Sample(_), None) => {}
        }
        ControlFlow::Continue(())
    };
    let read = logs::in_memory(log).and_then(|mut log| of(&mut *log, Path::new("log"), &mut collect));
    let account = read.map_err(|error| error.what)?;
    Ok(DriveLog { drives, account })
}

fn of(log: &mut dyn FrameSource, path: &Path, sink: &mut DriveSink) -> Result<LogAccount, LogError> {
    let mut drives = Drives::new();
    let mut flow = ControlFlow::Continue(());
    let read = log.read(&mut |entry| {
        flow = drives.take(&entry, sink);
        flow
    })?;
    let (mut account, is_empty) = match flow {
        ControlFlow::Continue(()) => drives.end(sink),
        // The sink has had enough, and knows why.
        ControlFlow::Break(()) => (drives.account, false),
    };
    heard::without_silent_unit(&mut account);
    account.log = read;
    if is_empty {
        return Err(LogError::new(path, nothing_of_ours(&account)));
    }
    Ok(account)
}

/// The drives of a log that is being read.
struct Drives {
    ticks: Ticks,
    places: Places,
    account: LogAccount,
    /// Frames on their way from `ticks` to `places`.
    sorted: Vec<Sorted>,
    is_empty: bool,
}

impl Drives {
    fn new() -> Self {
        Self {
            ticks: Ticks::default(),
            places: Places::default(),
            account: heard::empty_account(),
            sorted: Vec::new(),
            is_empty: true,
        }
    }

    fn take(&mut self, entry: &Entry, sink: &mut DriveSink) -> ControlFlow<()> {
        if let Some(frame) = heard::hear(entry, &mut self.account) {
            self.ticks.take(frame, &mut self.account, &mut self.sorted);
        }
        self.place(sink)
    }

    fn place(&mut self, sink: &mut DriveSink) -> ControlFlow<()> {
        for frame in self.sorted.drain(..) {
            self.is_empty &= !matches!(frame, Sorted::Begins);
            self.places.take(frame, &mut self.account, sink)?;
        }
        ControlFlow::Continue(())
    }

    /// The end of the log. Returns the account, and whether there was no drive.
    fn end(mut self, sink: &mut DriveSink) -> (LogAccount, bool) {
        self.ticks.end(&mut self.account, &mut self.sorted);
        if self.place(sink).is_continue() {
            // Nothing comes after it that a sink could refuse.
            let _ = self.places.end(&mut self.account, sink);
        }
        (self.account, self.is_empty)
    }

    /// Number of frames and samples that are held.
    #[cfg(test)]
    fn held(&self) -> usize {
        self.ticks.held() + self.places.held()
    }
}

fn nothing_of_ours(account: &LogAccount) -> String {
    let plural = |n: u64, one: &str, several: &str| format!("{n} {}", if n == 1 { one } else { several });
    let received = account.total(|m| m.received);
    let advice = if received == 0 {
        "; log the bus of the suspension (controller/oleo.dbc) for at least a second, or name the database of the log with --dbc and \
         --signals"
    } else {
        ", of which no six displacements in a row are in sequence; log the displacements too, and keep the frames in the order in which \
         they came"
    };
    format!(
        "holds no drive: {}, of which {} unreadable; {} with other identifiers, {} of the suspension's database with a wrong check \
         value, {received} with a right one{advice}",
        plural(account.log.entries, "entry", "entries"),
        plural(account.log.unreadable, "is", "are"),
        plural(account.foreign_frames, "frame", "frames"),
        account.total(|m| m.corrupted),
    )
}

#[cfg(test)]
mod tests;
