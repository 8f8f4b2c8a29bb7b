//! The frames of the database in a log, and an account of all other lines.

use std::io::BufRead;

use oleo_controller::can::{BOARD, COMMAND, CheckStatus, Checker, FRAME_BYTES, MESSAGES, STATUS};

use super::content::{LogAccount, MessageAccount};
use crate::candump::parse_line;

/// Longest line that is read as a whole, bytes. A line of `candump -L` has 50.
const LONGEST_LINE: u64 = 4096;
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
    /// Time of its line, microseconds.
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

/// Reads all lines. A byte that is not text makes its line unreadable, and nothing else.
pub fn hear(mut log: impl BufRead) -> std::io::Result<(Heard, LogAccount)> {
    let mut account = LogAccount {
        messages: (MESSAGES[..MESSAGES_OF_A_SAMPLE].iter())
            .map(|contract| MessageAccount {
                name: contract.name,
                ..MessageAccount::default()
            })
            .collect(),
        ..LogAccount::default()
    };
    let (mut heard, mut line) = (Vec::new(), Vec::new());
    loop {
        line.clear();
        let mut part = std::io::Read::take(&mut log, LONGEST_LINE);
        if part.read_until(b'\n', &mut line)? == 0 {
            return Ok((heard, account));
        }
        account.lines += 1;
        let Some(entry) = std::str::from_utf8(&line).ok().and_then(parse_line) else {
            account.unreadable_lines += 1;
            continue;
        };
        let id = entry.frame.standard_id();
        if id == Some(STATUS.id) || id == Some(BOARD.id) {
            continue;
        }
        let of_sample = &MESSAGES[..MESSAGES_OF_A_SAMPLE];
        let Some(message) = of_sample.iter().position(|contract| Some(contract.id) == id) else {
            account.foreign_frames += 1;
            continue;
        };
        debug_assert_eq!(of_sample[COMMAND_AT].id, COMMAND.id);
        let intact = <[u8; FRAME_BYTES]>::try_from(entry.frame.data())
            .ok()
            .filter(|data| Checker::new(&of_sample[message]).check(data) != CheckStatus::WrongCrc);
        match intact {
            Some(data) => {
                account.messages[message].received += 1;
                heard.push(HeardFrame {
                    time_us: entry.time_us,
                    message,
                    data,
                });
            }
            None => account.messages[message].corrupted += 1,
        }
    }
}
