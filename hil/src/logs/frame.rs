//! A frame as a log holds it: classic CAN or CAN FD, with its time and the bus that it was on.

use embedded_can::Id;

use crate::Frame;
use crate::frame::{extended, standard};

/// Most data bytes of a CAN FD frame.
pub const MOST_BYTES: usize = 64;

/// The data of a frame, 0 to 64 bytes.
#[derive(Clone, Copy, Debug)]
pub struct Payload {
    length: u8,
    bytes: [u8; MOST_BYTES],
}

impl Payload {
    /// No data.
    pub const EMPTY: Self = Self {
        length: 0,
        bytes: [0; MOST_BYTES],
    };

    /// Copies the data; `None` for more than 64 bytes.
    #[must_use]
    pub fn new(data: &[u8]) -> Option<Self> {
        let mut payload = Self::EMPTY;
        payload.bytes.get_mut(..data.len())?.copy_from_slice(data);
        payload.length = data.len() as u8;
        Some(payload)
    }

    /// Adds a byte; `None` if there are 64 already.
    #[must_use]
    pub fn push(&mut self, byte: u8) -> Option<()> {
        *self.bytes.get_mut(usize::from(self.length))? = byte;
        self.length += 1;
        Some(())
    }

    /// The data.
    #[must_use]
    pub fn data(&self) -> &[u8] {
        self.bytes.get(..usize::from(self.length)).unwrap_or(&[])
    }
}

impl PartialEq for Payload {
    fn eq(&self, other: &Self) -> bool {
        self.data() == other.data()
    }
}

impl Eq for Payload {}

/// What a frame is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameKind {
    /// Classic CAN, at most 8 bytes.
    Classic,
    /// A request for this number of bytes (classic CAN), without data.
    Remote(u8),
    /// CAN FD, with its flags: bit 0 for a switched bit rate, bit 1 for an error-passive sender.
    Fd(u8),
}

/// The flags of CAN FD that a log keeps.
pub const FD_FLAGS: u8 = 0b11;

/// Number of data bytes by the code of CAN FD.
const FD_LENGTHS: [usize; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64];

/// The code of CAN FD for a number of data bytes, or for the next that it has one for.
#[must_use]
pub fn fd_code(length: usize) -> u8 {
    FD_LENGTHS.iter().position(|code| *code >= length).unwrap_or(15) as u8
}

/// The number of data bytes that a code of CAN FD stands for.
#[must_use]
pub fn fd_length(code: u8) -> usize {
    FD_LENGTHS.get(usize::from(code)).copied().unwrap_or(MOST_BYTES)
}

/// A frame of a log, without its time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LoggedFrame {
    /// Identifier of 11 or 29 bits.
    pub id: Id,
    /// Classic, remote or CAN FD.
    pub kind: FrameKind,
    /// The data; empty for a remote frame.
    pub payload: Payload,
}

impl LoggedFrame {
    /// A frame with data; `None` if there are more than 8 bytes (classic) or 64 (CAN FD), or if it is a request with data.
    #[must_use]
    pub fn new(id: Id, kind: FrameKind, payload: Payload) -> Option<Self> {
        let most = match kind {
            FrameKind::Classic => 8,
            FrameKind::Remote(_) => 0,
            FrameKind::Fd(_) => MOST_BYTES,
        };
        (payload.data().len() <= most).then_some(Self { id, kind, payload })
    }

    /// The data bytes.
    #[must_use]
    pub fn data(&self) -> &[u8] {
        self.payload.data()
    }

    /// The 11-bit identifier, if the frame has one.
    #[must_use]
    pub fn standard_id(&self) -> Option<u16> {
        match self.id {
            Id::Standard(id) => Some(id.as_raw()),
            Id::Extended(_) => None,
        }
    }
}

impl From<&Frame> for LoggedFrame {
    fn from(frame: &Frame) -> Self {
        let kind = if frame.is_remote() {
            FrameKind::Remote(frame.dlc() as u8)
        } else {
            FrameKind::Classic
        };
        Self {
            id: frame.id(),
            kind,
            payload: Payload::new(frame.data()).unwrap_or(Payload::EMPTY),
        }
    }
}

/// An identifier from a number; `None` beyond 11 or 29 bits.
#[must_use]
pub fn identifier(number: u32, is_extended: bool) -> Option<Id> {
    match is_extended {
        true if number <= 0x1FFF_FFFF => Some(extended(number).into()),
        false if number <= 0x7FF => Some(standard(number as u16).into()),
        _ => None,
    }
}

/// An entry of a log: a frame, when it was received, and on which bus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry<'a> {
    /// Time as the log says it, microseconds. Its zero is the log's own.
    pub time_us: u64,
    /// The bus: the interface of candump, the number of the channel in ASC, BLF and MF4.
    pub bus: &'a str,
    /// The frame.
    pub frame: LoggedFrame,
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Every frame that a log can hold.
    pub(crate) fn any_frame() -> impl Strategy<Value = LoggedFrame> {
        let id = prop_oneof![
            (0u32..=0x7FF).prop_map(|id| (id, false)),
            (0u32..=0x1FFF_FFFF).prop_map(|id| (id, true)),
        ];
        let content = prop_oneof![
            prop::collection::vec(any::<u8>(), 0..=8).prop_map(|data| (FrameKind::Classic, data)),
            (0u8..=8).prop_map(|length| (FrameKind::Remote(length), vec![])),
            (0u8..=3, prop::collection::vec(any::<u8>(), 0..=64))
                .prop_map(|(flags, data)| (FrameKind::Fd(flags), data)),
        ];
        (id, content).prop_map(|((id, is_extended), (kind, data))| {
            let id = identifier(id, is_extended).expect("within its bits");
            LoggedFrame::new(id, kind, Payload::new(&data).expect("at most 64")).expect("as long as its kind")
        })
    }

    #[test]
    fn a_frame_holds_what_its_kind_can_carry() {
        let id = identifier(1, false).expect("small");
        let long = Payload::new(&[0; 9]).expect("nine");
        assert_eq!(LoggedFrame::new(id, FrameKind::Classic, long), None);
        assert_eq!(LoggedFrame::new(id, FrameKind::Remote(9), long), None);
        assert!(LoggedFrame::new(id, FrameKind::Fd(0), long).is_some());
        assert_eq!(Payload::new(&[0; 65]), None);
        assert_eq!((identifier(0x800, false), identifier(1 << 29, true)), (None, None));
    }
}
