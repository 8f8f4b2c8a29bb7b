//! The records of a group of frames: their layout as channels of the bus-logging standard (ASAM MDF, Bus Logging, 1.0), and their data in
//! deflated blocks.
//!
//! All frames of a group have the same length, so classic frames, frames of CAN FD and requests are groups of their own.

use std::io::{self, Write};

use flate2::Compression;
use flate2::write::ZlibEncoder;

use super::super::frame::{FrameKind, LoggedFrame, MOST_BYTES, fd_code};
use super::block::BlockFile;

/// Bytes of a record before the data of the frame: time, identifier, bus, code of the length, length, flags.
const FIXED: usize = 16;
/// Most bytes of records in a block, which is the most that the standard recommends.
const BLOCK: usize = 4 << 20;

/// Kinds of data of a channel.
const UNSIGNED: u8 = 0;
const FLOAT: u8 = 4;
const BYTES: u8 = 10;
/// Flag of a channel and of a group that belong to a bus.
const CHANNEL_OF_A_BUS: u32 = 1 << 10;
const GROUP_OF_A_BUS: u16 = 0b110;
/// A source that is a CAN bus.
const SOURCE: [u8; 8] = [2, 2, 0, 0, 0, 0, 0, 0];
/// Extended identifiers have this bit of the four bytes of the identifier, and a channel for it.
const EXTENDED: u32 = 1 << 31;
/// Records are transposed before they are deflated: byte by byte, over all records.
const TRANSPOSED: u8 = 1;

/// Which frames a group has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GroupKind {
    Classic,
    Fd,
    Remote,
}

impl GroupKind {
    pub const ALL: [Self; 3] = [Self::Classic, Self::Fd, Self::Remote];

    /// The group that a frame goes to.
    pub fn of(frame: &LoggedFrame) -> Self {
        match frame.kind {
            FrameKind::Classic => Self::Classic,
            FrameKind::Fd(_) => Self::Fd,
            FrameKind::Remote(_) => Self::Remote,
        }
    }

    const fn data_bytes(self) -> usize {
        match self {
            Self::Classic => 8,
            Self::Fd => MOST_BYTES,
            Self::Remote => 0,
        }
    }

    const fn record_bytes(self) -> usize {
        FIXED + self.data_bytes()
    }

    const fn frame(self) -> &'static str {
        match self {
            Self::Classic | Self::Fd => "CAN_DataFrame",
            Self::Remote => "CAN_RemoteFrame",
        }
    }

    /// The fields of a frame: name, byte and bit where they begin, and number of bits.
    fn fields(self) -> Vec<(&'static str, u8, u32, u8, u32)> {
        let mut fields = vec![
            ("ID", UNSIGNED, 8, 0, 29),
            ("IDE", UNSIGNED, 11, 7, 1),
            ("BusChannel", UNSIGNED, 12, 0, 8),
            ("DLC", UNSIGNED, 13, 0, 8),
            ("DataLength", UNSIGNED, 14, 0, 8),
            ("Dir", UNSIGNED, 15, 0, 1),
        ];
        if self != Self::Remote {
            fields.extend([
                ("EDL", UNSIGNED, 15, 1, 1),
                ("BRS", UNSIGNED, 15, 2, 1),
                ("ESI", UNSIGNED, 15, 3, 1),
                ("DataBytes", BYTES, FIXED as u32, 0, 8 * self.data_bytes() as u32),
            ]);
        }
        fields
    }
}

/// A group that is being written. Its memory is that of a block, and eight bytes for each block that was written.
pub struct Records {
    kind: GroupKind,
    waiting: Vec<u8>,
    transposed: Vec<u8>,
    written: u64,
    blocks: Vec<u64>,
}

impl Records {
    /// A group without records.
    pub fn new(kind: GroupKind) -> Self {
        Self {
            kind,
            waiting: Vec::new(),
            transposed: Vec::new(),
            written: 0,
            blocks: Vec::new(),
        }
    }

    /// Bytes of records in a whole block: all but the last are of this length.
    const fn whole(&self) -> usize {
        BLOCK - BLOCK % self.kind.record_bytes()
    }

    /// Adds a record, and writes a block where it is the last that fits in.
    pub fn add<W: Write>(
        &mut self,
        file: &mut BlockFile<W>,
        time_s: f64,
        bus: u8,
        frame: &LoggedFrame,
    ) -> io::Result<()> {
        let (id, is_extended) = match frame.id {
            embedded_can::Id::Standard(id) => (u32::from(id.as_raw()), 0),
            embedded_can::Id::Extended(id) => (id.as_raw(), EXTENDED),
        };
        let (code, length, flags) = match frame.kind {
            FrameKind::Classic => (frame.data().len() as u8, frame.data().len() as u8, 0),
            FrameKind::Remote(length) => (length, length, 0),
            FrameKind::Fd(flags) => (
                fd_code(frame.data().len()),
                frame.data().len() as u8,
                0b10 | (flags & 0b11) << 2,
            ),
        };
        self.waiting.extend(time_s.to_le_bytes());
        self.waiting.extend((id | is_extended).to_le_bytes());
        self.waiting.extend([bus, code, length, flags]);
        if self.kind != GroupKind::Remote {
            self.waiting.extend(frame.data());
        }
        let whole = self.waiting.len().next_multiple_of(self.kind.record_bytes());
        self.waiting.resize(whole, 0);
        self.written += 1;
        if self.waiting.len() >= self.whole() {
            self.flush(file)?;
        }
        Ok(())
    }

    /// Writes the records that wait as a block.
    fn flush<W: Write>(&mut self, file: &mut BlockFile<W>) -> io::Result<()> {
        let size = self.kind.record_bytes();
        self.transposed.clear();
        for byte in 0..size {
            self.transposed.extend(self.waiting.iter().skip(byte).step_by(size));
        }
        let mut deflated = ZlibEncoder::new(Vec::new(), Compression::fast());
        deflated.write_all(&self.transposed)?;
        let deflated = deflated.finish()?;
        let mut head = [0; 24];
        head[..4].copy_from_slice(&[b'D', b'T', TRANSPOSED, 0]);
        head[4..8].copy_from_slice(&(size as u32).to_le_bytes());
        head[8..16].copy_from_slice(&(self.waiting.len() as u64).to_le_bytes());
        head[16..].copy_from_slice(&(deflated.len() as u64).to_le_bytes());
        self.blocks.push(file.block(*b"DZ", &[], &[&head, &deflated])?);
        self.waiting.clear();
        Ok(())
    }

    /// Writes the rest of the records and the description of the group, and gives its place; `next` is the group behind it. `None` for a
    /// group without records.
    pub fn finish<W: Write>(mut self, file: &mut BlockFile<W>, next: u64) -> io::Result<Option<u64>> {
        if self.written == 0 {
            return Ok(None);
        }
        if !self.waiting.is_empty() {
            self.flush(file)?;
        }
        let links: Vec<u64> = std::iter::once(0).chain(self.blocks.iter().copied()).collect();
        // All blocks but the last are of the same length, which stands for the list of their places.
        let count = (self.blocks.len() as u32).to_le_bytes();
        let whole = (self.whole() as u64).to_le_bytes();
        let list = file.block(*b"DL", &links, &[&[1, 0, 0, 0], &count, &whole])?;
        let data = file.block(*b"HL", &[list], &[&[1, 0, TRANSPOSED, 0, 0, 0, 0, 0]])?;
        let group = self.channel_group(file)?;
        file.block(*b"DG", &[next, group, data, 0], &[&[0; 8]]).map(Some)
    }

    fn channel_group<W: Write>(&self, file: &mut BlockFile<W>) -> io::Result<u64> {
        let kind = self.kind;
        let name = file.text(*b"TX", kind.frame())?;
        let bus = file.text(*b"TX", "CAN")?;
        let source = file.block(*b"SI", &[bus, bus, 0], &[&SOURCE])?;
        let mut field = 0;
        for (name, data, byte, bit, bits) in kind.fields().into_iter().rev() {
            let channel = Channel {
                name: format!("{}.{name}", kind.frame()),
                data,
                byte,
                bit,
                bits,
                flags: CHANNEL_OF_A_BUS,
                ..Channel::default()
            };
            field = channel.write(file, field, source)?;
        }
        let frame = Channel {
            name: kind.frame().to_owned(),
            data: BYTES,
            byte: 8,
            bits: 8 * (kind.record_bytes() as u32 - 8),
            flags: CHANNEL_OF_A_BUS,
            composition: field,
            ..Channel::default()
        };
        let frame = frame.write(file, 0, source)?;
        let time = Channel {
            name: "Timestamp".to_owned(),
            is_time: true,
            data: FLOAT,
            bits: 64,
            ..Channel::default()
        };
        let time = time.write(file, frame, source)?;
        let flags = GROUP_OF_A_BUS.to_le_bytes();
        let separator = u16::from(b'.').to_le_bytes();
        let size = (kind.record_bytes() as u32).to_le_bytes();
        file.block(
            *b"CG",
            &[0, time, name, source, 0, 0],
            &[
                &[0; 8],
                &self.written.to_le_bytes(),
                &flags,
                &separator,
                &[0; 4],
                &size,
                &[0; 4],
            ],
        )
    }
}

/// A channel of a group.
#[derive(Default)]
struct Channel {
    name: String,
    /// Whether it is the time of the records.
    is_time: bool,
    data: u8,
    byte: u32,
    bit: u8,
    bits: u32,
    flags: u32,
    /// The first of the channels that are parts of it.
    composition: u64,
}

impl Channel {
    /// Writes the channel; `next` is the one behind it.
    fn write<W: Write>(&self, file: &mut BlockFile<W>, next: u64, source: u64) -> io::Result<u64> {
        let name = file.text(*b"TX", &self.name)?;
        let unit = if self.is_time { file.text(*b"TX", "s")? } else { 0 };
        let (kind, synchronises) = if self.is_time { (2, 1) } else { (0, 0) };
        let numbers = [self.byte, self.bits, self.flags, 0].map(u32::to_le_bytes).concat();
        // Precision, attachments and six limits, none of which is stated.
        let rest = [0; 4 + 6 * 8];
        file.block(
            *b"CN",
            &[next, self.composition, name, source, 0, 0, unit, 0],
            &[&[kind, synchronises, self.data, self.bit], &numbers, &rest],
        )
    }
}
