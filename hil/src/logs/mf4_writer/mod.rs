//! Writes ASAM MDF 4.1 with the frames of CAN buses, in the layout of the bus-logging standard, sorted, in deflated blocks.
//!
//! ```text
//!   ID HD FH  DZ DZ DZ ... DZ   DL HL CN.. CG DG   (for each of at most three groups)
//!      |______________________________________^    the only link that is known at the end
//! ```
//!
//! Frames pass through; what is kept is a block of each group, and the places of the blocks.

mod block;
mod records;

use std::io::{self, Seek, SeekFrom, Write};

use self::block::{BlockFile, place_of_link};
use self::records::{GroupKind, Records};
use super::bus_numbers::BusNumbers;
use super::frame::Entry;

/// Bytes of the block that identifies the file, behind which the head is.
const IDENTIFICATION: usize = 64;
/// Time zone and daylight saving are stated, both as zero.
const OFFSETS_ARE_VALID: u8 = 2;

/// Writes the entries of a log as MDF 4. The head states when the first was; times count from there.
pub struct Mf4Writer<W: Write + Seek> {
    file: BlockFile<W>,
    groups: [Records; 3],
    buses: BusNumbers,
    first_us: Option<u64>,
}

impl<W: Write + Seek> Mf4Writer<W> {
    /// A writer that has written nothing yet.
    pub fn new(out: W) -> Self {
        Self {
            file: BlockFile::new(out),
            groups: GroupKind::ALL.map(Records::new),
            buses: BusNumbers::default(),
            first_us: None,
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
        // A frame may be earlier than the first of the log. Whole microseconds below 2^53 are exact.
        let since_us = i128::from(entry.time_us) - i128::from(first_us);
        let bus = self.buses.of(entry.bus);
        let group = &mut self.groups[GroupKind::of(&entry.frame) as usize];
        group.add(&mut self.file, since_us as f64 / 1e6, bus, &entry.frame)
    }

    /// Writes the descriptions of the groups, and gives the writer back.
    ///
    /// # Errors
    /// The writer fails.
    pub fn finish(mut self) -> io::Result<W> {
        if self.first_us.is_none() {
            self.head(0)?;
        }
        let mut first = 0;
        for group in self.groups.into_iter().rev() {
            first = group.finish(&mut self.file, first)?.unwrap_or(first);
        }
        let mut out = self.file.into_inner();
        out.seek(SeekFrom::Start(place_of_link(IDENTIFICATION as u64, 0)))?;
        out.write_all(&first.to_le_bytes())?;
        out.seek(SeekFrom::End(0))?;
        Ok(out)
    }

    /// Identification, head and history. The history is dated as the log is: a file says nothing of when it was converted.
    fn head(&mut self, first_us: u64) -> io::Result<()> {
        let mut identification = [0; IDENTIFICATION];
        identification[..24].copy_from_slice(b"MDF     4.10    oleo    ");
        identification[28..30].copy_from_slice(&410_u16.to_le_bytes());
        self.file.raw(&identification)?;
        let begun = first_us.saturating_mul(1000).to_le_bytes();
        // The head links to the history behind it.
        const HEAD_BYTES: u64 = 24 + 6 * 8 + 32;
        let history = IDENTIFICATION as u64 + HEAD_BYTES;
        let links = [0, history, 0, 0, 0, 0];
        let flags = [0, 0, 0, 0, OFFSETS_ARE_VALID, 0, 0, 0];
        self.file.block(*b"HD", &links, &[&begun, &flags, &[0; 16]])?;
        const HISTORY_BYTES: u64 = 24 + 2 * 8 + 16;
        let flags = [0, 0, 0, 0, OFFSETS_ARE_VALID, 0, 0, 0];
        self.file
            .block(*b"FH", &[0, history + HISTORY_BYTES], &[&begun, &flags])?;
        let comment = concat!(
            "<FHcomment><TX>converted</TX><tool_id>oleo</tool_id><tool_vendor>oleo</tool_vendor><tool_version>",
            env!("CARGO_PKG_VERSION"),
            "</tool_version></FHcomment>"
        );
        self.file.text(*b"MD", comment)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::super::frame::{FrameKind, LoggedFrame, Payload, identifier};
    use super::*;

    fn frame(number: u32) -> LoggedFrame {
        let (kind, length) = match number % 3 {
            0 => (FrameKind::Classic, 8),
            1 => (FrameKind::Fd(1), 12),
            _ => (FrameKind::Remote(2), 0),
        };
        let data = [number as u8; 12];
        let payload = Payload::new(&data[..length]).expect("short");
        LoggedFrame::new(identifier(number % 0x800, false).expect("small"), kind, payload).expect("as long as its kind")
    }

    fn written(frames: u32) -> Vec<u8> {
        let mut writer = Mf4Writer::new(Cursor::new(Vec::new()));
        for number in 0..frames {
            let time_us = 1_000_000 + 10 * u64::from(number);
            let entry = Entry {
                time_us,
                bus: "can0",
                frame: frame(number),
            };
            writer.write(&entry).expect("memory");
        }
        writer.finish().expect("memory").into_inner()
    }

    /// Every link leads to a block at a multiple of eight, and blocks fill the file.
    #[test]
    fn a_file_is_a_chain_of_blocks() {
        let bytes = written(300);
        let number = |at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().expect("eight")) as usize;
        let mut at = IDENTIFICATION;
        let (mut places, mut links) = (vec![], vec![]);
        while at < bytes.len() {
            assert_eq!(&bytes[at..at + 2], b"##", "at {at}");
            places.push(at);
            links.extend(
                (0..number(at + 16))
                    .map(|k| number(at + 24 + 8 * k))
                    .filter(|to| *to != 0),
            );
            at += number(at + 8).next_multiple_of(8);
        }
        assert!(links.iter().all(|to| places.contains(to)));
        // All but the head are linked to.
        assert!(places[1..].iter().all(|place| links.contains(place)));
        assert!(written(0).len() < 500);
    }

    #[cfg(feature = "logs")]
    mod read_again {
        use std::ops::ControlFlow;

        use proptest::prelude::*;

        use super::*;
        use crate::logs::frame::tests::any_frame;
        use crate::logs::{Account, in_memory};

        type Read = (u64, String, LoggedFrame);

        fn read(bytes: &[u8]) -> (Account, Vec<Read>) {
            let mut frames = Vec::new();
            let account = in_memory(bytes).expect("MDF 4").read(&mut |entry| {
                frames.push((entry.time_us, entry.bus.to_owned(), entry.frame));
                ControlFlow::Continue(())
            });
            (account.expect("read"), frames)
        }

        proptest! {
            #[test]
            fn every_frame_is_read_as_it_was_written(frames in prop::collection::vec((any_frame(), 1_u64..1 << 40), 1..20)) {
                let mut time_us = 0;
                let mut writer = Mf4Writer::new(Cursor::new(Vec::new()));
                let mut expected = Vec::new();
                for (k, (frame, more_us)) in frames.iter().enumerate() {
                    let bus = ["can7", "vcan0"][k % 2];
                    writer.write(&Entry { time_us: 5 + time_us, bus, frame: *frame }).expect("memory");
                    expected.push((time_us, (k % 2 + 1).to_string(), *frame));
                    time_us += more_us;
                }
                let bytes = writer.finish().expect("memory").into_inner();
                prop_assert_eq!(read(&bytes).1, expected);
            }
        }

        /// More than a block of each kind.
        #[test]
        fn blocks_follow_each_other() {
            const FRAMES: u32 = 800_000;
            let (account, frames) = read(&written(FRAMES));
            assert_eq!((account.entries, account.unreadable), (FRAMES.into(), 0));
            for (number, (time_us, _, found)) in (0..).zip(&frames) {
                assert_eq!((*time_us, *found), (10 * u64::from(number), frame(number)));
            }
        }
    }
}
