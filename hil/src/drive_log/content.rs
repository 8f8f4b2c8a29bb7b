//! What a log holds: drives with their samples, and an account of what was read.

use std::ops::ControlFlow;

use oleo_controller::{Reading, ValveCommand};
use oleo_interface::{Corners, StrutPressures};

use crate::imu::InertialReadings;
use crate::logs::Account;

/// A piece of the drives of a log, in the order of the log.
#[derive(Clone, Copy, Debug)]
pub enum DrivePart<'a> {
    /// A drive begins, and the one before has ended. Time of its first displacement message as the log says it, s.
    Begins(f64),
    /// The next sample of the drive, one tick (5 ms) after the last.
    Sample(&'a LoggedSample),
}

/// Takes the drives of a log piece by piece, and may end the reading.
pub type DriveSink<'a> = dyn FnMut(DrivePart) -> ControlFlow<()> + 'a;

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
    /// What the inertial unit read, in its own axes.
    pub inertial: InertialReadings,
}

/// What was read from a log, and what could not be used.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LogAccount {
    /// Entries of the log, of whatever kind.
    pub log: Account,
    /// Number of frames whose identifier is in no database of ours.
    pub foreign_frames: u64,
    /// One entry for each message of the database except `STATUS` and `BOARD`, in the order of [`oleo_controller::can::MESSAGES`]; then, where
    /// an inertial unit was heard, one for each of its two.
    pub messages: Vec<MessageAccount>,
}

impl LogAccount {
    /// The sum of one figure over all messages.
    pub fn total(&self, figure: impl Fn(&MessageAccount) -> u64) -> u64 {
        self.messages.iter().map(figure).sum()
    }
}

/// What became of the frames of one message.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MessageAccount {
    /// Name of the message in the database.
    pub name: &'static str,
    /// Number of frames with a right CRC.
    pub received: u64,
    /// Number of frames with a wrong CRC or length, or with a content that cannot be.
    pub corrupted: u64,
    /// Number of frames that came once more for the same tick.
    pub repeated: u64,
    /// Number of frames that were logged after the frame of a later tick.
    pub late: u64,
    /// Number of frames whose tick fits into no drive.
    pub out_of_sequence: u64,
    /// Number of ticks of all drives for which there is no frame.
    pub lost: u64,
    /// Most ticks in a row without a frame.
    pub longest_gap_ticks: u64,
}
