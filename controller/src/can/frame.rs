//! A frame of the suspension bus.

/// Bytes of every frame of this bus.
pub const FRAME_BYTES: usize = 8;

/// A data frame of this bus: 11-bit identifier and eight bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Standard identifier, 0 to 0x7FF.
    pub id: u16,
    /// Protected payload.
    pub data: [u8; FRAME_BYTES],
}
