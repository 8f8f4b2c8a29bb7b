//! A frame of the suspension bus.

/// Bytes of every frame of this bus.
pub const FRAME_BYTES: usize = 8;

/// A data frame of this bus: an 11-bit identifier and eight bytes.
///
/// ```
/// use oleo_controller::can::{FRAME_BYTES, Frame};
/// let frame = Frame { id: 0x110, data: [0; FRAME_BYTES] };
/// assert_eq!(frame.data.len(), 8);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
// It fills three words, so that it is copied in words.
#[repr(align(4))]
pub struct Frame {
    /// Standard identifier, 0 to 0x7FF.
    pub id: u16,
    /// Payload, 8 bytes, with the counter and the CRC of the end-to-end protection.
    pub data: [u8; FRAME_BYTES],
}
