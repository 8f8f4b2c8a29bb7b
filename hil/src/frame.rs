//! One classic CAN frame, as every bus here carries it.
//!
//! The vehicle's own messages all have 11-bit identifiers and eight bytes. A real bus also carries frames of other devices, so this is a
//! complete CAN 2.0 frame. It takes 16 bytes and no heap, because a loop sends a million of them a second.

use embedded_can::{ExtendedId, Id, StandardId};

/// A data or remote frame with 0 to 8 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    id: Id,
    length: u8,
    remote: bool,
    data: [u8; 8],
}

impl Frame {
    /// A data frame; `None` for more than 8 bytes.
    pub fn new(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
        let mut padded = [0; 8];
        padded.get_mut(..data.len())?.copy_from_slice(data);
        Some(Self {
            id: id.into(),
            length: data.len() as u8,
            remote: false,
            data: padded,
        })
    }

    /// A data frame of eight bytes.
    pub fn whole(id: impl Into<Id>, data: [u8; 8]) -> Self {
        Self {
            id: id.into(),
            length: 8,
            remote: false,
            data,
        }
    }

    /// A remote frame asking for `length` bytes; `None` above 8.
    pub fn remote(id: impl Into<Id>, length: usize) -> Option<Self> {
        (length <= 8).then(|| Self {
            id: id.into(),
            length: length as u8,
            remote: true,
            data: [0; 8],
        })
    }

    /// The CAN identifier, 11 or 29 bits.
    pub fn id(&self) -> Id {
        self.id
    }

    /// The 11-bit identifier, if the frame has one.
    pub fn standard_id(&self) -> Option<u16> {
        match self.id {
            Id::Standard(id) => Some(id.as_raw()),
            Id::Extended(_) => None,
        }
    }

    /// The identifier as a number of 11 or 29 bits.
    pub fn raw_id(&self) -> u32 {
        match self.id {
            Id::Standard(id) => u32::from(id.as_raw()),
            Id::Extended(id) => id.as_raw(),
        }
    }

    /// Whether the identifier has 29 bits.
    pub fn is_extended(&self) -> bool {
        matches!(self.id, Id::Extended(_))
    }

    /// Whether this is a remote frame.
    pub fn is_remote(&self) -> bool {
        self.remote
    }

    /// The data length code, 0 to 8.
    pub fn dlc(&self) -> usize {
        usize::from(self.length)
    }

    /// The data, which are empty for a remote frame.
    pub fn data(&self) -> &[u8] {
        if self.remote {
            &[]
        } else {
            self.data.get(..self.dlc()).unwrap_or(&[])
        }
    }

    /// The same frame with one bit of its data inverted, counted from bit 0 of byte 0. Beyond the data nothing changes.
    pub fn with_flipped_bit(mut self, bit: usize) -> Self {
        if bit / 8 < self.data().len()
            && let Some(byte) = self.data.get_mut(bit / 8)
        {
            *byte ^= 1 << (bit % 8);
        }
        self
    }
}

/// A standard identifier from a number that fits in 11 bits, such as those of the message table.
pub fn standard(id: u16) -> StandardId {
    StandardId::new(id & 0x7FF).unwrap_or(StandardId::MAX)
}

/// An extended identifier from a number that fits in 29 bits.
pub fn extended(id: u32) -> ExtendedId {
    ExtendedId::new(id & 0x1FFF_FFFF).unwrap_or(ExtendedId::MAX)
}

impl From<oleo_controller::can::Frame> for Frame {
    fn from(frame: oleo_controller::can::Frame) -> Self {
        Self::whole(standard(frame.id), frame.data)
    }
}

impl embedded_can::Frame for Frame {
    fn new(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
        Frame::new(id, data)
    }

    fn new_remote(id: impl Into<Id>, dlc: usize) -> Option<Self> {
        Frame::remote(id, dlc)
    }

    fn is_extended(&self) -> bool {
        Frame::is_extended(self)
    }

    fn is_remote_frame(&self) -> bool {
        self.remote
    }

    fn id(&self) -> Id {
        self.id
    }

    fn dlc(&self) -> usize {
        Frame::dlc(self)
    }

    fn data(&self) -> &[u8] {
        Frame::data(self)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Every classic CAN frame.
    pub(crate) fn any_frame() -> impl Strategy<Value = Frame> {
        let id = prop_oneof![
            (0u16..=0x7FF).prop_map(|id| Id::Standard(standard(id))),
            (0u32..=0x1FFF_FFFF).prop_map(|id| Id::Extended(extended(id))),
        ];
        (id, prop::collection::vec(any::<u8>(), 0..=8), any::<bool>()).prop_map(|(id, data, remote)| {
            let frame = if remote {
                Frame::remote(id, data.len())
            } else {
                Frame::new(id, &data)
            };
            frame.unwrap()
        })
    }

    #[test]
    fn nine_bytes_are_no_frame() {
        assert_eq!(Frame::new(standard(1), &[0; 9]), None);
        assert_eq!(Frame::remote(standard(1), 9), None);
        assert!(size_of::<Frame>() <= 20);
    }

    #[test]
    fn a_bit_flips_and_flips_back() {
        let frame = Frame::whole(standard(0x110), [0; 8]);
        assert_eq!(frame.with_flipped_bit(63).data()[7], 0x80);
        assert_eq!(frame.with_flipped_bit(17).with_flipped_bit(17), frame);
        assert_eq!(frame.with_flipped_bit(64), frame);
    }
}
