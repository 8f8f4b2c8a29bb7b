//! `candump -L` log lines, which `canplayer`, cantools, python-can and SavvyCAN read.
//!
//! ```text
//!   (0000000001.005270) vcan0 110#0011223344556677
//!   (0000000001.005500) vcan0 1FFF01E0#R4
//!   (0000000001.005900) vcan0 123##1AABBCC                  CAN FD: two crosses and the flags
//! ```
//!
//! Source: can-utils, `candump.c` and `lib.c` (`sprint_canframe`, `parse_canframe`). Times are seconds since the start of the run.

use std::io::{self, Write};
use std::path::PathBuf;

use embedded_can::Id;

use super::account::Account;
use super::error::LogError;
use super::frame::{Entry, FD_FLAGS, FrameKind, LoggedFrame, Payload, identifier};
use super::hex;
use super::source::{FrameSource, Sink};
use super::text::Lines;

/// One line of a candump log: a frame with its time and interface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogLine<'a> {
    /// Time since the start, microseconds.
    pub time_us: u64,
    /// Name of the interface.
    pub interface: &'a str,
    /// The logged frame.
    pub frame: LoggedFrame,
}

/// Writes one line.
///
/// # Errors
/// The writer fails.
pub fn write_line(
    out: &mut impl Write,
    time_us: u64,
    interface: &str,
    frame: impl Into<LoggedFrame>,
) -> io::Result<()> {
    let frame = frame.into();
    let (seconds, micros) = (time_us / 1_000_000, time_us % 1_000_000);
    write!(out, "({seconds:010}.{micros:06}) {interface} ")?;
    match frame.id {
        Id::Extended(id) => write!(out, "{:08X}#", id.as_raw())?,
        Id::Standard(id) => write!(out, "{:03X}#", id.as_raw())?,
    }
    match frame.kind {
        FrameKind::Remote(0) => return writeln!(out, "R"),
        FrameKind::Remote(length) => return writeln!(out, "R{length}"),
        FrameKind::Fd(flags) => write!(out, "#{:X}", flags & FD_FLAGS)?,
        FrameKind::Classic => {}
    }
    hex::write(out, frame.data())?;
    out.write_all(b"\n")
}

/// Reads one line; `None` if it is not that of a frame.
#[must_use]
pub fn parse_line(line: &str) -> Option<LogLine<'_>> {
    let mut words = line.split_ascii_whitespace();
    let time = words.next()?.strip_prefix('(')?.strip_suffix(')')?;
    let interface = words.next()?;
    let frame = parse_frame(words.next()?)?;
    let (seconds, fraction) = time.split_once('.')?;
    let digits_only = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    if !digits_only(seconds) || !digits_only(fraction) || fraction.len() != 6 {
        return None;
    }
    let seconds: u64 = seconds.parse().ok()?;
    let time_us = seconds.checked_mul(1_000_000)?.checked_add(fraction.parse().ok()?)?;
    // A mark of the direction may follow.
    matches!(words.next(), None | Some("T" | "R")).then_some(LogLine {
        time_us,
        interface,
        frame,
    })
}

fn parse_frame(text: &str) -> Option<LoggedFrame> {
    let (id, data) = text.split_once('#')?;
    let number = u32::from_str_radix(id, 16).ok().filter(|_| !id.starts_with('+'))?;
    let id = match id.len() {
        3 => identifier(number, false)?,
        8 => identifier(number, true)?,
        _ => return None,
    };
    if let Some(length) = data.strip_prefix('R') {
        let length = match length {
            "" => 0,
            _ => length.parse().ok().filter(|length| *length <= 8)?,
        };
        return LoggedFrame::new(id, FrameKind::Remote(length), Payload::EMPTY);
    }
    let (kind, data) = match data.strip_prefix('#') {
        None => (FrameKind::Classic, data),
        Some(fd) => {
            let flags = fd.chars().next()?.to_digit(16)? as u8;
            (FrameKind::Fd(flags & FD_FLAGS), fd.get(1..)?)
        }
    };
    let mut payload = Payload::EMPTY;
    for digits in data.as_bytes().chunks(2) {
        payload.push(hex::byte(digits)?)?;
    }
    LoggedFrame::new(id, kind, payload)
}

/// The frames of a candump log.
pub struct Candump {
    lines: Lines,
    path: PathBuf,
}

impl Candump {
    /// A log whose text is given. `path` is the name that appears in errors.
    pub fn new(lines: Lines, path: PathBuf) -> Self {
        Self { lines, path }
    }
}

impl FrameSource for Candump {
    fn read(&mut self, sink: &mut Sink) -> Result<Account, LogError> {
        let mut account = Account::default();
        while let Some(line) = (self.lines.next()).map_err(|e| LogError::unreadable(&self.path, &e))? {
            account.entries += 1;
            let Some(line) = parse_line(&line) else {
                account.unreadable += 1;
                continue;
            };
            account.remote_frames += u64::from(matches!(line.frame.kind, FrameKind::Remote(_)));
            let entry = Entry {
                time_us: line.time_us,
                bus: line.interface,
                frame: line.frame,
            };
            if sink(entry).is_break() {
                break;
            }
        }
        Ok(account)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Frame;
    use crate::frame::standard;
    use crate::logs::frame::tests::any_frame;
    use proptest::prelude::*;

    #[test]
    fn as_candump_writes_it() {
        let mut out = Vec::new();
        let frame = Frame::new(standard(0x44), &[0x2A, 0x36]).unwrap();
        write_line(&mut out, 1_436_509_052_249_713, "vcan0", &frame).unwrap();
        assert_eq!(String::from_utf8(out).unwrap(), "(1436509052.249713) vcan0 044#2A36\n");
        let fd = parse_line("(1.000000) can1 123##9AB R").unwrap();
        assert_eq!((fd.frame.kind, fd.frame.data()), (FrameKind::Fd(1), &[0xAB][..]));
    }

    #[test]
    fn what_is_no_line_is_refused() {
        for line in [
            "",
            "(1.0) vcan0 044#",
            "(1.000000) vcan0 44#",
            "(1.000000) vcan0 044#2",
            "(1.000000) vcan0 044##",
            "(1.000000) vcan0 044##G00",
            "(1.000000) vcan0 044##\u{e4}00",
            "(1.000000) vcan0 044#R9",
            "(1.000000) vcan0 800#",
            "(+1.000000) vcan0 044#",
            "(1.000000) v 044#112233445566778899",
            "(1.000000) v 044# X",
        ] {
            assert_eq!(parse_line(line), None, "{line}");
        }
        let too_long = format!("(1.000000) v 044##0{}", "00".repeat(65));
        assert_eq!(parse_line(&too_long), None);
    }

    proptest! {
        #[test]
        fn every_frame_survives(frame in any_frame(), time_us in 0u64..1 << 50) {
            let mut out = Vec::new();
            write_line(&mut out, time_us, "can0", frame).unwrap();
            let line = parse_line(std::str::from_utf8(&out).unwrap()).unwrap();
            prop_assert_eq!(line, LogLine { time_us, interface: "can0", frame });
        }

        #[test]
        fn no_text_does_harm(text in "\\PC{0,60}") {
            let _ = parse_line(&text);
        }
    }
}
