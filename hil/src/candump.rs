//! `candump -L` log lines, which `canplayer`, cantools, python-can and SavvyCAN read.
//!
//! ```text
//!   (0000000001.005270) vcan0 110#0011223344556677
//!   (0000000001.005500) vcan0 1FFF01E0#R4
//! ```
//!
//! Source: can-utils, `candump.c` and `lib.c` (`sprint_canframe`, `parse_canframe`). Times are seconds since the start of the run.

use std::io::{self, Write};

use crate::Frame;
use crate::frame::{extended, standard};

/// One line of a candump log: a frame with its time and interface.
#[derive(Clone, Debug, PartialEq)]
pub struct LogLine {
    /// Time since the start, microseconds.
    pub time_us: u64,
    /// Name of the interface.
    pub interface: String,
    /// The logged frame.
    pub frame: Frame,
}

/// Writes one line.
///
/// # Errors
/// The writer fails.
pub fn write_line(out: &mut impl Write, time_us: u64, interface: &str, frame: &Frame) -> io::Result<()> {
    let (seconds, micros) = (time_us / 1_000_000, time_us % 1_000_000);
    write!(out, "({seconds:010}.{micros:06}) {interface} ")?;
    if frame.is_extended() {
        write!(out, "{:08X}#", frame.raw_id())?;
    } else {
        write!(out, "{:03X}#", frame.raw_id())?;
    }
    if frame.is_remote() {
        return match frame.dlc() {
            0 => writeln!(out, "R"),
            length => writeln!(out, "R{length}"),
        };
    }
    for byte in frame.data() {
        write!(out, "{byte:02X}")?;
    }
    writeln!(out)
}

/// Reads one line; `None` if it is not that of a classic frame.
pub fn parse_line(line: &str) -> Option<LogLine> {
    let mut words = line.split_ascii_whitespace();
    let time = words.next()?.strip_prefix('(')?.strip_suffix(')')?;
    let interface = words.next()?.to_owned();
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

fn parse_frame(text: &str) -> Option<Frame> {
    let (id, data) = text.split_once('#')?;
    let number = u32::from_str_radix(id, 16).ok().filter(|_| !id.starts_with('+'))?;
    let id: embedded_can::Id = match id.len() {
        3 if number <= 0x7FF => standard(number as u16).into(),
        8 if number <= 0x1FFF_FFFF => extended(number).into(),
        _ => return None,
    };
    if let Some(length) = data.strip_prefix('R') {
        return match length {
            "" => Frame::remote(id, 0),
            _ => Frame::remote(id, usize::from(length.parse::<u8>().ok()?)),
        };
    }
    if !data.len().is_multiple_of(2) || !data.bytes().all(|b| b.is_ascii_hexdigit()) {
        return None;
    }
    let bytes: Option<Vec<u8>> = (0..data.len())
        .step_by(2)
        .map(|at| u8::from_str_radix(data.get(at..at + 2)?, 16).ok())
        .collect();
    Frame::new(id, &bytes?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::tests::any_frame;
    use proptest::prelude::*;

    #[test]
    fn as_candump_writes_it() {
        let mut out = Vec::new();
        let frame = Frame::new(standard(0x44), &[0x2A, 0x36]).unwrap();
        write_line(&mut out, 1_436_509_052_249_713, "vcan0", &frame).unwrap();
        assert_eq!(String::from_utf8(out).unwrap(), "(1436509052.249713) vcan0 044#2A36\n");
    }

    #[test]
    fn what_is_no_line_is_refused() {
        for line in [
            "",
            "(1.0) vcan0 044#",
            "(1.000000) vcan0 44#",
            "(1.000000) vcan0 044#2",
            "(1.000000) vcan0 044##1AB",
            "(1.000000) vcan0 800#",
            "(+1.000000) vcan0 044#",
            "(1.000000) v 044#112233445566778899",
            "(1.000000) v 044# X",
        ] {
            assert_eq!(parse_line(line), None, "{line}");
        }
    }

    proptest! {
        #[test]
        fn every_frame_survives(frame in any_frame(), time_us in 0u64..1 << 50) {
            let mut out = Vec::new();
            write_line(&mut out, time_us, "can0", &frame).unwrap();
            let line = parse_line(std::str::from_utf8(&out).unwrap()).unwrap();
            prop_assert_eq!(line, LogLine { time_us, interface: "can0".into(), frame });
        }

        #[test]
        fn no_text_does_harm(text in "\\PC{0,60}") {
            let _ = parse_line(&text);
        }
    }
}
