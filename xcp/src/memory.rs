//! The addresses that a tool sees. There is no way from an address to anything but these three pieces.
//!
//! | from | what | |
//! |---|---|---|
//! | 0x1000 | measured quantities | read |
//! | 0x2000 | parameters | read; written only as `calibration` says |
//! | 0x3000 | the text that identifies this slave | read |

use core::fmt::Write as _;

use crc::{CRC_32_ISO_HDLC, Crc};
use heapless::String;
use oleo_controller::Builder;

use crate::calibration::{self, Working};
use crate::measurement::{self, Image};
use crate::packet::Refusal;

/// Where the text begins that identifies this slave, and by which a tool knows the description file that fits it (`EPK`).
pub const IDENTITY_ADDRESS: u32 = 0x3000;

/// Most bytes of that text.
const IDENTITY_BYTES: usize = 40;

/// Most bytes that one checksum covers, so that it costs less than a tick's other work.
pub const MOST_CHECKED: u32 = 1024;

/// The text that identifies this slave: its version, and a check value of names, kinds and places of all quantities.
///
/// ```
/// assert!(oleo_xcp::identity().starts_with("oleo-xcp "));
/// ```
pub fn identity() -> String<IDENTITY_BYTES> {
    let crc = Crc::<u32>::new(&CRC_32_ISO_HDLC);
    let mut digest = crc.digest();
    for quantity in measurement::quantities().chain(calibration::quantities()) {
        digest.update(quantity.name.as_bytes());
        digest.update(&quantity.address.to_le_bytes());
        digest.update(&[quantity.kind as u8]);
    }
    let mut text = String::new();
    // It fits: a version of up to twenty characters.
    let _ = write!(text, "oleo-xcp {} {:08x}", env!("CARGO_PKG_VERSION"), digest.finalize());
    text
}

/// What a tool can read.
#[derive(Clone, Debug)]
pub(crate) struct Memory {
    pub measured: Image,
    pub tuning: Working,
    identity: String<IDENTITY_BYTES>,
}

impl Memory {
    pub fn new(builder: Builder) -> Self {
        Self {
            measured: Image::INITIAL,
            tuning: Working::new(builder),
            identity: identity(),
        }
    }

    /// Number of bytes of the text that identifies this slave.
    pub fn identity_bytes(&self) -> u32 {
        self.identity.len() as u32
    }

    /// The bytes at an address, all in one piece of memory.
    pub fn read(&self, address: u32, bytes: u32) -> Result<&[u8], Refusal> {
        let pieces = [
            (measurement::ADDRESS, self.measured.bytes()),
            (calibration::ADDRESS, self.tuning.bytes()),
            (IDENTITY_ADDRESS, self.identity.as_bytes()),
        ];
        pieces
            .into_iter()
            .find_map(|(begin, piece)| {
                let from = address.checked_sub(begin)? as usize;
                piece.get(from..from.checked_add(bytes as usize)?)
            })
            .ok_or(Refusal::AccessDenied)
    }

    /// Check value of a block (CRC-32 as in Ethernet).
    pub fn checksum(&self, address: u32, bytes: u32) -> Result<u32, Refusal> {
        if bytes == 0 || bytes > MOST_CHECKED {
            return Err(Refusal::OutOfRange);
        }
        Ok(Crc::<u32>::new(&CRC_32_ISO_HDLC).checksum(self.read(address, bytes)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_read_beyond_a_piece() {
        let memory = Memory::new(Builder::default());
        let last = measurement::ADDRESS + measurement::BYTES as u32;
        assert_eq!(memory.read(last - 4, 4).map(<[u8]>::len), Ok(4));
        for (address, bytes) in [
            (last - 3, 4),
            (last, 1),
            (0, 1),
            (0xFFF, 2),
            (u32::MAX, 7),
            (calibration::ADDRESS + calibration::BYTES as u32 - 2, 4),
            (0x3030, 1),
        ] {
            assert_eq!(memory.read(address, bytes), Err(Refusal::AccessDenied), "{address:#x}");
        }
    }

    /// "123456789" has the published check value; here the text of the identity stands for it.
    #[test]
    fn the_checksum_is_the_one_of_ethernet() {
        let memory = Memory::new(Builder::default());
        assert_eq!(Crc::<u32>::new(&CRC_32_ISO_HDLC).checksum(b"123456789"), 0xCBF4_3926);
        let identity = Crc::<u32>::new(&CRC_32_ISO_HDLC).checksum(identity().as_bytes());
        assert_eq!(memory.checksum(IDENTITY_ADDRESS, memory.identity_bytes()), Ok(identity));
        assert_eq!(memory.checksum(IDENTITY_ADDRESS, 0), Err(Refusal::OutOfRange));
        assert_eq!(
            memory.checksum(measurement::ADDRESS, MOST_CHECKED + 1),
            Err(Refusal::OutOfRange)
        );
    }
}
