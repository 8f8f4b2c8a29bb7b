//! A classic data frame with a standard identifier, as the drivers take and give it.

use embedded_can::{Id, StandardId};

/// A data frame with up to eight bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame {
    id: StandardId,
    length: u8,
    data: [u8; 8],
}

impl Frame {
    /// From what was received. A length code above 8 is legal on the wire and means 8 (ISO 11898-1).
    pub fn received(id: StandardId, length: u8, data: [u8; 8]) -> Self {
        Self {
            id,
            length: length.min(8),
            data,
        }
    }

    /// The identifier, the length and all eight bytes, of which those from the length on mean nothing.
    pub fn parts(&self) -> (u16, u8, [u8; 8]) {
        (self.id.as_raw(), self.length, self.data)
    }
}

impl embedded_can::Frame for Frame {
    /// `None` for extended identifiers and more than eight bytes: the controller's bus has neither.
    fn new(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
        let Id::Standard(id) = id.into() else { return None };
        let length = u8::try_from(data.len()).ok().filter(|length| *length <= 8)?;
        let mut bytes = [0; 8];
        for (to, from) in bytes.iter_mut().zip(data) {
            *to = *from;
        }
        Some(Self {
            id,
            length,
            data: bytes,
        })
    }

    /// Always `None`: nobody here sends remote frames.
    fn new_remote(_id: impl Into<Id>, _dlc: usize) -> Option<Self> {
        None
    }

    fn is_extended(&self) -> bool {
        false
    }

    fn is_remote_frame(&self) -> bool {
        false
    }

    fn id(&self) -> Id {
        Id::Standard(self.id)
    }

    fn dlc(&self) -> usize {
        usize::from(self.length)
    }

    fn data(&self) -> &[u8] {
        self.data.get(..self.dlc()).unwrap_or(&[])
    }
}
