//! Writes Vector BLF, as python-can reads it: classic frames of type 1 and CAN FD of type 100, in containers packed with zlib.

use std::io::{self, Seek, SeekFrom, Write};

use chrono::{DateTime, Datelike, Timelike, Utc};
use embedded_can::Id;
use flate2::Compression;
use flate2::write::ZlibEncoder;

use super::blf::SIGNATURE;
use super::blf::object::{self, BASE_HEAD, FD_DATA, HEAD};
use super::bus_numbers::BusNumbers;
use super::frame::{Entry, FrameKind, MOST_BYTES, fd_code};

/// Bytes of the head of the file.
const FILE_HEAD: usize = 144;
/// Most bytes of objects in a container, as Vector's library has it.
const CONTAINER: usize = 128 << 10;
/// Version of Vector's library whose files these are like.
const LIKE_VERSION: [u8; 4] = [2, 6, 8, 1];

/// Writes the entries of a log as BLF. The head states when the first was, down to the millisecond and in UTC; times count from there.
pub struct BlfWriter<W: Write + Seek> {
    out: W,
    buses: BusNumbers,
    /// Objects that wait for their container.
    waiting: Vec<u8>,
    /// Where times count from, and the last time.
    begin_us: Option<u64>,
    last_us: u64,
    objects: u64,
    /// Bytes of the file, and what they would be unpacked.
    size: u64,
    unpacked_size: u64,
}

impl<W: Write + Seek> BlfWriter<W> {
    /// A writer that has written nothing yet.
    pub fn new(out: W) -> Self {
        Self {
            out,
            buses: BusNumbers::default(),
            waiting: Vec::new(),
            begin_us: None,
            last_us: 0,
            objects: 0,
            size: 0,
            unpacked_size: 0,
        }
    }

    /// Writes one frame.
    ///
    /// # Errors
    /// The writer fails.
    pub fn write(&mut self, entry: &Entry) -> io::Result<()> {
        let begin_us = match self.begin_us {
            Some(begin_us) => begin_us,
            None => {
                self.file_head()?;
                *self.begin_us.insert(entry.time_us - entry.time_us % 1000)
            }
        };
        self.last_us = self.last_us.max(entry.time_us);
        // A time before the first of the log cannot be written.
        let since_ns = entry.time_us.saturating_sub(begin_us).saturating_mul(1000);
        let channel = u16::from(self.buses.of(entry.bus)).to_le_bytes();
        let frame = &entry.frame;
        let id = match frame.id {
            Id::Standard(id) => u32::from(id.as_raw()),
            Id::Extended(id) => id.as_raw() | object::IS_EXTENDED,
        };
        let data = frame.data();
        let (flags, code, fd) = match frame.kind {
            FrameKind::Classic => (0, data.len() as u8, None),
            FrameKind::Remote(length) => (object::IS_REMOTE, length, None),
            FrameKind::Fd(flags) => (0, fd_code(data.len()), Some(flags)),
        };
        let (kind, size) = match fd {
            None => (object::CLASSIC, HEAD + 16),
            Some(_) => (object::FD, HEAD + FD_DATA + MOST_BYTES),
        };
        if self.waiting.len() + size > CONTAINER {
            self.container()?;
        }
        let end = self.waiting.len() + size;
        self.waiting.extend(base_head(HEAD, size as u32, kind));
        self.waiting.extend(object::NANOSECOND.to_le_bytes());
        self.waiting.extend([0; 4]);
        self.waiting.extend(since_ns.to_le_bytes());
        self.waiting.extend(channel);
        self.waiting.extend([flags, code]);
        self.waiting.extend(id.to_le_bytes());
        if let Some(flags) = fd {
            let [is_fd, is_switched, is_passive] = object::FD_FLAGS;
            let flags = is_fd | (is_switched * (flags & 1)) | (is_passive * (flags >> 1 & 1));
            // Time on the bus and number of bits are not known.
            self.waiting
                .extend([0, 0, 0, 0, 0, flags, data.len() as u8, 0, 0, 0, 0, 0]);
        }
        self.waiting.extend(data);
        self.waiting.resize(end, 0);
        self.objects += 1;
        Ok(())
    }

    /// Writes what waits and the sizes in the head, and gives the writer back.
    ///
    /// # Errors
    /// The writer fails.
    pub fn finish(mut self) -> io::Result<W> {
        if self.begin_us.is_none() {
            self.file_head()?;
        }
        if !self.waiting.is_empty() {
            self.container()?;
        }
        self.out.seek(SeekFrom::Start(0))?;
        self.file_head()?;
        self.out.seek(SeekFrom::End(0))?;
        Ok(self.out)
    }

    /// The head of the file, with what is known by now.
    fn file_head(&mut self) -> io::Result<()> {
        let is_first = self.size == 0;
        if is_first {
            (self.size, self.unpacked_size) = (FILE_HEAD as u64, FILE_HEAD as u64);
        }
        let mut head = Vec::with_capacity(FILE_HEAD);
        head.extend(SIGNATURE);
        head.extend((FILE_HEAD as u32).to_le_bytes());
        // Which program, of those that Vector knows: none of them.
        head.extend([0; 4]);
        head.extend(LIKE_VERSION);
        head.extend(self.size.to_le_bytes());
        head.extend(self.unpacked_size.to_le_bytes());
        head.extend(u32::try_from(self.objects).unwrap_or(u32::MAX).to_le_bytes());
        head.extend([0; 4]);
        head.extend(date(self.begin_us.unwrap_or(0)));
        head.extend(date(self.last_us));
        head.resize(FILE_HEAD, 0);
        self.out.write_all(&head)
    }

    /// Writes the objects that wait as a container.
    fn container(&mut self) -> io::Result<()> {
        let mut packed = ZlibEncoder::new(Vec::new(), Compression::fast());
        packed.write_all(&self.waiting)?;
        let packed = packed.finish()?;
        let size = BASE_HEAD + 16 + packed.len();
        self.out
            .write_all(&base_head(BASE_HEAD, size as u32, object::CONTAINER))?;
        let [method, nothing] = [2_u32, 0].map(u32::to_le_bytes);
        let unpacked = (self.waiting.len() as u32).to_le_bytes();
        self.out.write_all(&[method, nothing, unpacked, nothing].concat())?;
        self.out.write_all(&packed)?;
        // Not up to a multiple of four, but by the remainder: so readers expect it.
        let filling = size % 4;
        self.out.write_all(&[0; 4][..filling])?;
        self.size += (size + filling) as u64;
        self.unpacked_size += (BASE_HEAD + 16 + self.waiting.len()) as u64;
        self.waiting.clear();
        Ok(())
    }
}

/// The head that every object has.
fn base_head(head_size: usize, size: u32, kind: u32) -> [u8; BASE_HEAD] {
    let mut head = [0; BASE_HEAD];
    head[..4].copy_from_slice(b"LOBJ");
    head[4..6].copy_from_slice(&(head_size as u16).to_le_bytes());
    head[6..8].copy_from_slice(&1_u16.to_le_bytes());
    head[8..12].copy_from_slice(&size.to_le_bytes());
    head[12..].copy_from_slice(&kind.to_le_bytes());
    head
}

/// A date as Windows has it (SYSTEMTIME): year, month, day of the week, day, hour, minute, second, millisecond.
fn date(time_us: u64) -> Vec<u8> {
    let date = (i64::try_from(time_us).ok())
        .and_then(DateTime::<Utc>::from_timestamp_micros)
        .unwrap_or_default();
    let numbers = [
        date.year().clamp(1601, 30_827) as u32,
        date.month(),
        date.weekday().num_days_from_sunday(),
        date.day(),
        date.hour(),
        date.minute(),
        date.second(),
        date.timestamp_subsec_millis(),
    ];
    numbers
        .iter()
        .flat_map(|number| (*number as u16).to_le_bytes())
        .collect()
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;
    use std::ops::ControlFlow;

    use proptest::prelude::*;

    use super::*;
    use crate::logs::frame::tests::any_frame;
    use crate::logs::in_memory;

    proptest! {
        #[test]
        fn every_frame_is_read_as_it_was_written(frames in prop::collection::vec((any_frame(), 0_u64..1 << 40), 1..20)) {
            let mut frames = frames;
            frames.sort_by_key(|(_, time_us)| *time_us);
            let begin_us = frames[0].1 / 1000 * 1000;
            let mut writer = BlfWriter::new(Cursor::new(Vec::new()));
            let mut expected = Vec::new();
            for (k, (frame, time_us)) in frames.iter().enumerate() {
                let bus = ["can7", "vcan0"][k % 2];
                writer.write(&Entry { time_us: *time_us, bus, frame: *frame }).expect("memory");
                expected.push((time_us - begin_us, (k % 2 + 1).to_string(), *frame));
            }
            let bytes = writer.finish().expect("memory").into_inner();
            let mut read = Vec::new();
            let account = in_memory(&bytes).expect("BLF").read(&mut |entry| {
                read.push((entry.time_us, entry.bus.to_owned(), entry.frame));
                ControlFlow::Continue(())
            }).expect("read");
            // A frame of CAN FD has one of sixteen lengths on the bus, but a log may say any.
            prop_assert_eq!(read, expected);
            prop_assert_eq!((account.entries, account.unreadable), (frames.len() as u64, 0));
        }
    }

    #[test]
    fn the_head_says_when_the_log_began_and_how_long_the_file_is() {
        let log = crate::logs::candump::parse_line("(1682503200.500700) can0 123#01").expect("a line");
        let mut writer = BlfWriter::new(Cursor::new(Vec::new()));
        for more_us in [0, 2_000_000] {
            let (time_us, bus, frame) = (log.time_us + more_us, "can0", log.frame);
            writer.write(&Entry { time_us, bus, frame }).expect("memory takes it");
        }
        let bytes = writer.finish().expect("memory takes it").into_inner();
        let number = |at: usize| u16::from_le_bytes([bytes[at], bytes[at + 1]]);
        let date = |at: usize| (0..8).map(|k| number(at + 2 * k)).collect::<Vec<_>>();
        assert_eq!(date(40), [2023, 4, 3, 26, 10, 0, 0, 500]);
        assert_eq!(date(56), [2023, 4, 3, 26, 10, 0, 2, 500]);
        assert_eq!(usize::from(number(16)), bytes.len());
        assert_eq!(number(24), 144 + 32 + 2 * 48);
        assert_eq!(number(32), 2);
    }
}
