//! Whether the flash holds what was built: its check value is compared at every start.
//!
//! `oleo seal` (`hil/src/image.rs`) writes length and check value into the record below, after the image was linked. The check value is
//! CRC-32/ISO-HDLC over the flash from its beginning, in which its own word counts as erased. Flash errors are what it is against; it is
//! no protection against somebody who wants to change the image, because anybody can compute it.

use crc::{CRC_32_ISO_HDLC, Crc, NoTable};
use oleo_controller::can::ImageState;

/// Beginning and size of the flash (RM0090, section 3.3).
const FLASH: usize = 0x0800_0000;
const FLASH_BYTES: usize = 1 << 20;
/// Without a table, which would be a kilobyte: some 10 ms at 168 MHz for 32 KiB.
const CHECK: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);
/// Bytes between two feeds of the watchdog: 3 ms at 16 MHz.
const BLOCK: usize = 1024;
/// What stands in a record that nobody has filled in.
const UNSEALED: u32 = u32::MAX;

/// The record, as `oleo seal` finds it.
#[repr(C)]
struct Record {
    mark: [u8; 8],
    /// Bytes of flash that are checked.
    length: u32,
    check: u32,
}

#[used]
static RECORD: Record = Record {
    mark: *b"OLEOSEAL",
    length: UNSEALED,
    check: UNSEALED,
};

/// Checks the flash; `None` if it is wrong. `feed` is called all along.
pub fn check(mut feed: impl FnMut()) -> Option<ImageState> {
    let record = &raw const RECORD;
    #[allow(unsafe_code)]
    // SAFETY: the static is there. The compiler must not take the values for those above.
    let (length, check) = unsafe {
        (
            (&raw const (*record).length).read_volatile(),
            (&raw const (*record).check).read_volatile(),
        )
    };
    if length == UNSEALED {
        return Some(ImageState::Unsealed);
    }
    let length = length as usize;
    if length > FLASH_BYTES {
        return None;
    }
    #[allow(unsafe_code)]
    // SAFETY: all of the flash can be read, and nothing writes it.
    let flash = unsafe { core::slice::from_raw_parts(FLASH as *const u8, length) };
    let hole = (record as usize)
        .checked_add(core::mem::offset_of!(Record, check))?
        .checked_sub(FLASH)?;
    let (before, behind) = (flash.get(..hole)?, flash.get(hole.checked_add(4)?..)?);
    let mut digest = CHECK.digest();
    for (part, hole) in [(before, [0xFF; 4].as_slice()), (behind, [].as_slice())] {
        for block in part.chunks(BLOCK) {
            digest.update(block);
            feed();
        }
        digest.update(hole);
    }
    (digest.finalize() == check).then_some(ImageState::Sealed)
}
