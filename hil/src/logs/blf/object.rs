//! The objects of BLF that are frames of CAN, byte by byte. All numbers are little-endian.
//!
//! ```text
//!   0  "LOBJ"   4 size of the head (2)   6 version of the head (2)   8 size (4)   12 type (4)      every object
//!   16 unit of the time (4)   24 time (8)                                                          heads of version 1 to 3
//!
//!   behind the head
//!   1, 86   0 channel (2)  2 flags  3 code of the length  4 identifier (4)  8 data (8)             classic CAN
//!   100     0 channel (2)  2 flags  3 code of the length  4 identifier (4)  13 flags of FD  14 bytes  20 data (64)
//!   101     0 channel  1 code of the length  2 bytes  4 identifier (4)  12 flags (4)  34 direction  35 end of the data  40 data
//! ```

use super::super::frame::{FrameKind, LoggedFrame, Payload, fd_length, identifier};

/// What a BLF log begins with.
pub const SIGNATURE: &[u8] = b"LOGG";
/// Bytes of the head that every object has.
pub const BASE_HEAD: usize = 16;
/// Bytes of the head of an object with a time.
pub const HEAD: usize = 32;

/// Types of objects.
pub const CONTAINER: u32 = 10;
pub const CLASSIC: u32 = 1;
pub const FD: u32 = 100;
const CLASSIC_2: u32 = 86;
const FD_64: u32 = 101;
/// Error frame, the same with details, and that of a CAN FD channel.
const ERROR_FRAMES: [u32; 3] = [2, 73, 104];

/// Units of the time.
const TEN_MICROSECONDS: u32 = 1;
pub const NANOSECOND: u32 = 2;

/// Bit of the identifier that says that it has 29 bits.
pub const IS_EXTENDED: u32 = 1 << 31;
const ID_BITS: u32 = 0x1FFF_FFFF;
/// Flag of a request for data, in the byte of the flags.
pub const IS_REMOTE: u8 = 1 << 7;
/// Direction: a request to transmit, which is not what was on the bus. Received is 0, transmitted is 1.
const TO_BE_TRANSMITTED: u8 = 2;
/// Flags of FD: the frame is CAN FD, its bit rate was switched, its sender was error-passive.
pub const FD_FLAGS: [u8; 3] = [1, 2, 4];
/// Place of these three among the flags of type 101, and its flag of a request for data.
const FD_64_FLAGS: u32 = 12;
const FD_64_IS_REMOTE: u32 = 1 << 4;
/// Where the data begins behind the head.
const CLASSIC_DATA: usize = 8;
pub const FD_DATA: usize = 20;
const FD_64_DATA: usize = 40;

/// What an object is.
pub enum Event {
    /// A frame.
    Frame {
        /// Since the begin of the measurement.
        time_us: u64,
        channel: u16,
        frame: LoggedFrame,
    },
    /// An error frame.
    Error,
    /// Anything else that the format knows, or that a later version of it does.
    Other,
    /// An object of a frame that is none.
    Unreadable,
}

/// Bytes of a number at a place.
pub fn number<const N: usize>(bytes: &[u8], at: usize) -> Option<[u8; N]> {
    bytes.get(at..at.checked_add(N)?)?.try_into().ok()
}

/// What an object is, from its head to its end.
pub fn event(object: &[u8]) -> Event {
    let Some(kind) = number(object, 12).map(u32::from_le_bytes) else {
        return Event::Unreadable;
    };
    let frame = match kind {
        kind if ERROR_FRAMES.contains(&kind) => return Event::Error,
        CLASSIC | CLASSIC_2 | FD | FD_64 => frame(kind, object),
        _ => return Event::Other,
    };
    match frame {
        Some((time_us, Some((channel, frame)))) => Event::Frame {
            time_us,
            channel,
            frame,
        },
        Some((_, None)) => Event::Other,
        None => Event::Unreadable,
    }
}

/// Time, channel and frame; no frame for a request to transmit.
type Found = (u64, Option<(u16, LoggedFrame)>);

fn frame(kind: u32, object: &[u8]) -> Option<Found> {
    let [head_size, version] = [4, 6].map(|at| number(object, at).map(u16::from_le_bytes));
    let head_size = usize::from(head_size?);
    if head_size < HEAD || !(1..=3).contains(&version?) {
        return None;
    }
    let time = u64::from_le_bytes(number(object, 24)?);
    let time_us = match u32::from_le_bytes(number(object, 16)?) {
        TEN_MICROSECONDS => time.checked_mul(10)?,
        _ => time / 1000 + u64::from(time % 1000 >= 500),
    };
    let content = object.get(head_size..)?;
    let id = u32::from_le_bytes(number(content, 4)?);
    let id = identifier(id & ID_BITS, id & IS_EXTENDED != 0)?;
    let byte = |at: usize| content.get(at).copied();
    let described = match kind {
        FD_64 => {
            let flags = u32::from_le_bytes(number(content, 12)?);
            Described {
                channel: byte(0)?.into(),
                code: byte(1)?,
                valid: Some(byte(2)?),
                direction: byte(34)?,
                is_remote: flags & FD_64_IS_REMOTE != 0,
                fd: (flags >> FD_64_FLAGS) as u8,
                data: content.get(FD_64_DATA..fd_64_end(object.len(), head_size, byte(35)?))?,
            }
        }
        _ => {
            let (fd, valid, data) = match kind {
                FD => (byte(13)?, Some(byte(14)?), FD_DATA),
                _ => (0, None, CLASSIC_DATA),
            };
            let flags = byte(2)?;
            Described {
                channel: u16::from_le_bytes(number(content, 0)?),
                code: byte(3)?,
                valid,
                direction: flags & 0xF,
                is_remote: flags & IS_REMOTE != 0,
                fd,
                data: content.get(data..)?,
            }
        }
    };
    if described.direction == TO_BE_TRANSMITTED {
        return Some((time_us, None));
    }
    let (kind, payload) = described.content(kind == FD_64)?;
    Some((time_us, Some((described.channel, LoggedFrame::new(id, kind, payload)?))))
}

/// Where the data of type 101 ends, counted from the end of the head: at the details that may follow, or at the end of the object.
fn fd_64_end(object: usize, head: usize, details: u8) -> usize {
    let end = match usize::from(details) {
        0 => object,
        details => details.min(object),
    };
    end.saturating_sub(head)
}

/// What an object says of its frame.
struct Described<'o> {
    channel: u16,
    /// Code of the length.
    code: u8,
    /// Number of bytes that are data.
    valid: Option<u8>,
    direction: u8,
    is_remote: bool,
    /// Flags of FD.
    fd: u8,
    data: &'o [u8],
}

impl Described<'_> {
    /// Kind and data of the frame. Where an object has less data than it says, as CANoe writes type 101 with zeros at the end left out, it
    /// is filled up if `may_be_short`.
    fn content(&self, may_be_short: bool) -> Option<(FrameKind, Payload)> {
        let [is_fd, is_switched, is_passive] = FD_FLAGS.map(|flag| self.fd & flag != 0);
        let code = self.code & 0xF;
        // A code above 8 is transmitted with eight bytes on classic CAN.
        if !is_fd && self.is_remote {
            return Some((FrameKind::Remote(code.min(8)), Payload::EMPTY));
        }
        let (kind, length) = match is_fd {
            true => {
                let flags = u8::from(is_switched) | u8::from(is_passive) << 1;
                (FrameKind::Fd(flags), fd_length(code))
            }
            false => (FrameKind::Classic, usize::from(code.min(8))),
        };
        let length = self.valid.map_or(length, |valid| length.min(valid.into()));
        let there = self.data.get(..length.min(self.data.len()))?;
        let mut payload = Payload::new(there)?;
        if there.len() < length && !may_be_short {
            return None;
        }
        for _ in there.len()..length {
            payload.push(0)?;
        }
        Some((kind, payload))
    }
}
