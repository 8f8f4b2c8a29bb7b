//! The frames of the database in a log, and an account of all other frames.

use std::ops::ControlFlow;

use oleo_controller::can::{BOARD, COMMAND, CheckStatus, Checker, FRAME_BYTES, MESSAGES, STATUS};

use super::content::{LogAccount, MessageAccount};
use crate::logs::{FrameSource, LogError};

/// The low half of byte 1 is the counter of the end-to-end protection.
const COUNTER_BYTE: usize = 1;
/// Bits of the counter.
const COUNTER_MASK: u8 = 0x0F;

/// Positions of the messages in [`MESSAGES`]: four pressures, two displacements, then the command.
pub const DISPLACEMENT: std::ops::Range<usize> = 4..6;
/// Position of the command in [`MESSAGES`].
pub const COMMAND_AT: usize = 6;
/// Number of messages that make up a sample.
pub const MESSAGES_OF_A_SAMPLE: usize = 7;

/// A frame of the database whose CRC is right.
#[derive(Clone, Copy, Debug)]
pub struct HeardFrame {
    /// Time of its entry in the log, microseconds.
    pub time_us: u64,
    /// Position of its message in [`MESSAGES`].
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

/// All frames that can be used, in the order of the log.
pub type Heard = Vec<HeardFrame>;

/// Reads a whole log.
pub fn hear(log: &mut dyn FrameSource) -> Result<(Heard, LogAccount), LogError> {
    let of_sample = &MESSAGES[..MESSAGES_OF_A_SAMPLE];
    debug_assert_eq!(of_sample[COMMAND_AT].id, COMMAND.id);
    let mut messages: Vec<MessageAccount> = (of_sample.iter())
        .map(|contract| MessageAccount {
            name: contract.name,
            ..MessageAccount::default()
        })
        .collect();
    let (mut heard, mut foreign_frames) = (Vec::new(), 0);
    let log = log.read(&mut |entry| {
        let id = entry.frame.standard_id();
        if id == Some(STATUS.id) || id == Some(BOARD.id) {
            return ControlFlow::Continue(());
        }
        let Some(message) = of_sample.iter().position(|contract| Some(contract.id) == id) else {
            foreign_frames += 1;
            return ControlFlow::Continue(());
        };
        let intact = <[u8; FRAME_BYTES]>::try_from(entry.frame.data())
            .ok()
            .filter(|data| Checker::new(&of_sample[message]).check(data) != CheckStatus::WrongCrc);
        match intact {
            Some(data) => {
                messages[message].received += 1;
                heard.push(HeardFrame {
                    time_us: entry.time_us,
                    message,
                    data,
                });
            }
            None => messages[message].corrupted += 1,
        }
        ControlFlow::Continue(())
    })?;
    let account = LogAccount {
        log,
        foreign_frames,
        messages,
    };
    Ok((heard, account))
}
