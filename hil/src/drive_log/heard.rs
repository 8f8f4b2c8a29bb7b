//! The frames of the suspension's database and of an inertial unit's in a log, and an account of all other frames.

use oleo_controller::can::{BOARD, COMMAND, CheckStatus, Checker, Contract, FRAME_BYTES, MESSAGES, STATUS};

use super::content::{LogAccount, MessageAccount};
use crate::imu;
use crate::logs::Entry;

/// The low half of byte 1 is the counter of the end-to-end protection.
const COUNTER_BYTE: usize = 1;
/// Bits of the counter.
const COUNTER_MASK: u8 = 0x0F;

/// Positions of the messages of a sample: four pressures, two displacements, the command as in [`MESSAGES`], then the unit's two.
pub const DISPLACEMENT: std::ops::Range<usize> = 4..6;
/// Position of the command.
pub const COMMAND_AT: usize = 6;
/// Positions of the messages of an inertial unit.
pub const UNIT: std::ops::Range<usize> = 7..9;
/// Number of messages that make up a sample.
pub const MESSAGES_OF_A_SAMPLE: usize = UNIT.end;

/// What is agreed on each of them.
const OF_A_SAMPLE: [Contract; MESSAGES_OF_A_SAMPLE] = {
    let mut contracts = [COMMAND; MESSAGES_OF_A_SAMPLE];
    let mut at = 0;
    while at < MESSAGES_OF_A_SAMPLE {
        contracts[at] = if at < UNIT.start {
            MESSAGES[at]
        } else {
            imu::MESSAGES[at - UNIT.start]
        };
        at += 1;
    }
    contracts
};

/// A frame of the database whose CRC is right.
#[derive(Clone, Copy, Debug)]
pub struct HeardFrame {
    /// Time of its entry in the log, microseconds.
    pub time_us: i64,
    /// Position of its message in a sample.
    pub message: usize,
    /// Content of the frame.
    pub data: [u8; FRAME_BYTES],
}

impl HeardFrame {
    /// Counter of the end-to-end protection, 0 to 15.
    pub const fn counter(&self) -> i64 {
        (self.data[COUNTER_BYTE] & COUNTER_MASK) as i64
    }
}

/// An account of nothing.
pub fn empty_account() -> LogAccount {
    debug_assert_eq!(MESSAGES[COMMAND_AT].id, COMMAND.id);
    let of_message = |contract: &oleo_controller::can::Contract| MessageAccount {
        name: contract.name,
        ..MessageAccount::default()
    };
    LogAccount {
        messages: OF_A_SAMPLE.iter().map(of_message).collect(),
        ..LogAccount::default()
    }
}

/// Leaves out an inertial unit of which nothing was heard.
pub fn without_silent_unit(account: &mut LogAccount) {
    if account.messages[UNIT].iter().all(|message| message.received == 0) {
        let corrupted: u64 = account.messages[UNIT].iter().map(|message| message.corrupted).sum();
        account.foreign_frames += corrupted;
        account.messages.truncate(UNIT.start);
    }
}

/// The frame of an entry, if it can be used; all others are counted.
pub fn hear(entry: &Entry, account: &mut LogAccount) -> Option<HeardFrame> {
    let id = entry.frame.standard_id();
    if id == Some(STATUS.id) || id == Some(BOARD.id) {
        return None;
    }
    let Some(message) = OF_A_SAMPLE.iter().position(|contract| Some(contract.id) == id) else {
        account.foreign_frames += 1;
        return None;
    };
    let intact = <[u8; FRAME_BYTES]>::try_from(entry.frame.data())
        .ok()
        .filter(|data| Checker::new(&OF_A_SAMPLE[message]).check(data) != CheckStatus::WrongCrc);
    let Some(data) = intact else {
        account.messages[message].corrupted += 1;
        return None;
    };
    account.messages[message].received += 1;
    Some(HeardFrame {
        time_us: entry.time_us.min(i64::MAX as u64) as i64,
        message,
        data,
    })
}
