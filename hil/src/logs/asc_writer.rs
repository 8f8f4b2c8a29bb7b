//! Writes Vector ASC, as CANoe, CANalyzer, python-can and asammdf read it.

use std::io::{self, Write};

use chrono::{DateTime, Utc};
use embedded_can::Id;

use super::bus_numbers::BusNumbers;
use super::frame::{Entry, FrameKind, fd_code};
use super::hex;

/// Flags of the message in a line of CAN FD: the frame is CAN FD, its bit rate was switched, its sender was error-passive.
const FD_MESSAGE: [u32; 3] = [1 << 12, 1 << 13, 1 << 14];

/// Writes the entries of a log as ASC. Times count from the first entry; the head states when that was, in UTC.
pub struct AscWriter<W: Write> {
    out: W,
    first_us: Option<u64>,
    buses: BusNumbers,
}

impl<W: Write> AscWriter<W> {
    /// A writer that has written nothing yet.
    pub fn new(out: W) -> Self {
        Self {
            out,
            first_us: None,
            buses: BusNumbers::default(),
        }
    }

    /// Writes one frame.
    ///
    /// # Errors
    /// The writer fails.
    pub fn write(&mut self, entry: &Entry) -> io::Result<()> {
        let first_us = match self.first_us {
            Some(first_us) => first_us,
            None => {
                self.head(entry.time_us)?;
                *self.first_us.insert(entry.time_us)
            }
        };
        let since_us = entry.time_us.saturating_sub(first_us);
        let (seconds, micros) = (since_us / 1_000_000, since_us % 1_000_000);
        let channel = self.buses.of(entry.bus);
        let frame = &entry.frame;
        let id = match frame.id {
            Id::Standard(id) => format!("{:X}", id.as_raw()),
            Id::Extended(id) => format!("{:X}x", id.as_raw()),
        };
        let length = frame.data().len();
        match frame.kind {
            FrameKind::Classic => {
                write!(
                    self.out,
                    "{seconds:4}.{micros:06} {channel}  {id:<15} Rx   d {length:X}"
                )?;
                hex::write_spaced(&mut self.out, frame.data())?;
            }
            FrameKind::Remote(length) => write!(
                self.out,
                "{seconds:4}.{micros:06} {channel}  {id:<15} Rx   r {length:X}"
            )?,
            FrameKind::Fd(flags) => {
                let (brs, esi) = (flags & 1, flags >> 1 & 1);
                let code = fd_code(length);
                write!(
                    self.out,
                    "{seconds:4}.{micros:06} CANFD {channel:>3} Rx   {id:>9} {brs} {esi} {code:x} {length:2}"
                )?;
                hex::write_spaced(&mut self.out, frame.data())?;
                let [is_fd, is_switched, is_passive] = FD_MESSAGE;
                let flags = is_fd | (is_switched * u32::from(brs)) | (is_passive * u32::from(esi));
                write!(self.out, " {:>8} {:>4} {flags:>8X} 0 0 0 0 0", 0, 0)?;
            }
        }
        writeln!(self.out)
    }

    /// Writes the end, and gives the writer back.
    ///
    /// # Errors
    /// The writer fails.
    pub fn finish(mut self) -> io::Result<W> {
        if self.first_us.is_none() {
            self.head(0)?;
        }
        writeln!(self.out, "End TriggerBlock")?;
        Ok(self.out)
    }

    fn head(&mut self, first_us: u64) -> io::Result<()> {
        let begins = i64::try_from(first_us)
            .ok()
            .and_then(DateTime::<Utc>::from_timestamp_micros)
            .unwrap_or_default();
        let date = begins.format("%a %b %d %H:%M:%S%.3f %Y");
        writeln!(
            self.out,
            "date {date}\nbase hex  timestamps absolute\nno internal events logged\nBegin Triggerblock {date}"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::logs::frame::tests::any_frame;
    use crate::logs::{Account, in_memory};
    use proptest::prelude::*;
    use std::ops::ControlFlow;

    proptest! {
        #[test]
        fn every_frame_is_read_as_it_was_written(frames in prop::collection::vec((any_frame(), 0_u64..1 << 40), 1..20)) {
            let mut frames = frames;
            frames.sort_by_key(|(_, time_us)| *time_us);
            let mut writer = AscWriter::new(Vec::new());
            for (frame, time_us) in &frames {
                writer.write(&Entry { time_us: *time_us, bus: "can7", frame: *frame }).expect("memory takes it");
            }
            let text = writer.finish().expect("memory takes it");
            let mut read = Vec::new();
            let account = in_memory(&text).and_then(|mut log| log.read(&mut |entry| {
                read.push((entry.frame, entry.time_us, entry.bus.to_owned()));
                ControlFlow::Continue(())
            })).expect("a log");
            let expected: Vec<_> = frames.iter().map(|(f, t)| (*f, t - frames[0].1, "1".to_owned())).collect();
            prop_assert_eq!(read, expected);
            let Account { unreadable, without_frame, .. } = account;
            prop_assert_eq!((unreadable, without_frame), (0, 5));
        }
    }

    #[test]
    fn the_head_says_when_the_log_began() {
        let log = crate::logs::candump::parse_line("(1682503200.500000) can0 123#01").expect("a line");
        let mut writer = AscWriter::new(Vec::new());
        writer
            .write(&Entry {
                time_us: log.time_us,
                bus: "can0",
                frame: log.frame,
            })
            .expect("memory takes it");
        let text = String::from_utf8(writer.finish().expect("memory takes it")).expect("ASCII");
        assert!(
            text.starts_with("date Wed Apr 26 10:00:00.500 2023\nbase hex  timestamps absolute\n"),
            "{text}"
        );
        assert!(
            text.contains("\n   0.000000 1  123             Rx   d 1 01\nEnd TriggerBlock\n"),
            "{text}"
        );
    }
}
