//! What a log holds by a map: drives with their samples, and an account of what was read.

use std::ops::ControlFlow;

use oleo_interface::{Corners, StrutPressures, StrutValves};

use super::selection::Steps;
use crate::logs::Account;

/// A piece of the drives of a log, in the order of the log.
#[derive(Clone, Copy, Debug)]
pub enum SignalPart<'a> {
    /// A drive begins, and the one before has ended. Time of its first displacement as the log says it, s.
    Begins(f64),
    /// The next sample of the drive.
    Sample(&'a Corners<StrutSample>),
}

/// Takes the drives of a log piece by piece, and may end the reading.
pub type SignalSink<'a> = dyn FnMut(SignalPart) -> ControlFlow<()> + 'a;

/// A sample of one strut.
#[derive(Clone, Copy, Debug)]
pub struct StrutSample {
    /// Displacement, m, compression positive; NaN where it is missing.
    pub displacement_m: f64,
    /// Gauge pressures, Pa; NaN where one is missing.
    pub pressure_pa: StrutPressures<f64>,
    /// Switching signals from this sample to the next; `None` where one is missing.
    pub valves: Option<StrutValves<bool>>,
}

/// What a log holds.
#[derive(Clone, Debug)]
pub struct SignalLog {
    /// The drives in the order of the log, at least one.
    pub drives: Vec<SignalDrive>,
    /// Steps between two readings.
    pub steps: Corners<Steps>,
    /// What was read, and what could not be used.
    pub account: SignalAccount,
}

/// One drive, sample by sample.
#[derive(Clone, Debug)]
pub struct SignalDrive {
    /// Time of the first displacement as the log says it, s.
    pub begins_s: f64,
    /// Time between two samples, s.
    pub period_s: f64,
    /// The samples.
    pub samples: Vec<Corners<StrutSample>>,
}

/// What was read of a log, and what could not be used.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SignalAccount {
    /// Entries of the log, of whatever kind.
    pub log: Account,
    /// Number of frames that the map does not name.
    pub foreign_frames: u64,
    /// What became of the frames of each message.
    pub messages: Vec<SignalMessage>,
}

impl SignalAccount {
    /// The sum of one figure over all messages.
    pub fn total(&self, figure: impl Fn(&SignalMessage) -> u64) -> u64 {
        self.messages.iter().map(figure).sum()
    }
}

/// What became of the frames of one message.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SignalMessage {
    /// Name of the message in the database.
    pub name: String,
    /// Number of frames.
    pub received: u64,
    /// Number of frames of which no reading means anything: too short, out of range, called invalid, another multiplexed content.
    pub without_reading: u64,
    /// Number of frames that came once more for the same sample; the one nearest to its time is used.
    pub repeated: u64,
    /// Number of frames outside all drives, or too late to be put in order.
    pub outside: u64,
}

impl SignalMessage {
    /// A message of which nothing was read yet.
    pub fn new(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            ..Self::default()
        }
    }
}
