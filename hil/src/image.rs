//! Seals a firmware image: writes a check value over its flash into it, which the board compares when it starts.
//!
//! The image has a record of four words (`firmware/src/image.rs`): two by which it is found, the number of bytes of flash that are
//! checked, and the check value (CRC-32/ISO-HDLC). What no segment of the image fills reads as 0xFF, as erased flash does. The word of
//! the check value counts as 0xFF too.

use crc::{CRC_32_ISO_HDLC, Crc};
use object::LittleEndian;
use object::elf::{FileHeader32, PT_LOAD};
use object::read::elf::{ElfFile, FileHeader, ProgramHeader};

/// The words by which the record is found.
const MARK: [u8; 8] = *b"OLEOSEAL";
/// Bytes from the beginning of the record to the length, and to the check value.
const LENGTH_AT: usize = 8;
const CHECK_AT: usize = 12;
/// Where the flash of the STM32F405 begins, and how large it is, bytes (RM0090, section 3.3).
const FLASH: u64 = 0x0800_0000;
const FLASH_BYTES: u64 = 1 << 20;
const ERASED: u8 = 0xFF;

/// Why an image cannot be sealed.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
pub enum SealError {
    /// The file cannot be read as an ELF file of 32 bits.
    #[error("is no 32-bit ELF file ({0}); give the image that `cargo build --release` has made in firmware/")]
    NoElf(String),
    /// A part of the image lies outside of the flash.
    #[error("has {bytes} bytes at 0x{address:08x}, outside of the flash of an STM32F405")]
    OutsideFlash {
        /// Where the part is to be loaded.
        address: u64,
        /// Its length.
        bytes: u64,
    },
    /// The image has no record, or several.
    #[error("has {0} records for a check value instead of one; it is not an image of this version of oleo")]
    Records(usize),
}

/// What was written into an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Seal {
    /// Bytes of flash that the board checks.
    pub flash_bytes: u32,
    /// The check value.
    pub crc32: u32,
}

/// Seals the image in an ELF file, in place. An image that is sealed already gets the same value again.
///
/// # Errors
/// The file is no image for the board; it is unchanged then.
pub fn seal(elf: &mut [u8]) -> Result<Seal, SealError> {
    let segments = segments(elf)?;
    let end = segments.iter().map(|s| s.flash_at + s.bytes).max().unwrap_or(0);
    let mut flash = vec![ERASED; end];
    for s in &segments {
        flash[s.flash_at..][..s.bytes].copy_from_slice(&elf[s.file_at..][..s.bytes]);
    }
    let found: Vec<usize> = (flash.windows(MARK.len()).enumerate())
        .filter(|(at, bytes)| *bytes == MARK && at + CHECK_AT + 4 <= end)
        .map(|(at, _)| at)
        .collect();
    let [record] = found[..] else {
        return Err(SealError::Records(found.len()));
    };
    // At most FLASH_BYTES.
    let flash_bytes = end as u32;
    flash[record + LENGTH_AT..][..4].copy_from_slice(&flash_bytes.to_le_bytes());
    flash[record + CHECK_AT..][..4].fill(ERASED);
    let crc32 = Crc::<u32>::new(&CRC_32_ISO_HDLC).checksum(&flash);
    for (at, word) in [(record + LENGTH_AT, flash_bytes), (record + CHECK_AT, crc32)] {
        for (k, byte) in word.to_le_bytes().into_iter().enumerate() {
            // Later segments win in the flash as they do here.
            let holds = |s: &&Segment| (s.flash_at..s.flash_at + s.bytes).contains(&(at + k));
            if let Some(s) = segments.iter().rfind(holds) {
                elf[s.file_at + at + k - s.flash_at] = byte;
            }
        }
    }
    Ok(Seal { flash_bytes, crc32 })
}

/// A part of the image that is loaded into the flash.
struct Segment {
    /// Offset in the flash.
    flash_at: usize,
    /// Offset in the file.
    file_at: usize,
    bytes: usize,
}

fn segments(elf: &[u8]) -> Result<Vec<Segment>, SealError> {
    let no_elf = |e: object::Error| SealError::NoElf(e.to_string());
    let file = ElfFile::<FileHeader32<LittleEndian>>::parse(elf).map_err(no_elf)?;
    let endian = file.elf_header().endian().map_err(no_elf)?;
    let mut segments = Vec::new();
    for header in file.elf_program_headers() {
        let bytes = header.p_filesz(endian);
        if header.p_type(endian) != PT_LOAD || bytes == 0 {
            continue;
        }
        let (address, bytes) = (u64::from(header.p_paddr(endian)), u64::from(bytes));
        if address < FLASH || address + bytes > FLASH + FLASH_BYTES {
            return Err(SealError::OutsideFlash { address, bytes });
        }
        let data = header
            .data(endian, elf)
            .map_err(|()| SealError::NoElf("a segment ends behind the file".to_owned()))?;
        segments.push(Segment {
            flash_at: (address - FLASH) as usize,
            file_at: header.p_offset(endian) as usize,
            bytes: data.len(),
        });
    }
    Ok(segments)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The smallest ELF file with these segments: address and content.
    fn elf(segments: &[(u32, &[u8])]) -> Vec<u8> {
        let mut head = vec![0; 52];
        head[..7].copy_from_slice(b"\x7fELF\x01\x01\x01");
        let half = |head: &mut Vec<u8>, at: usize, value: u16| head[at..at + 2].copy_from_slice(&value.to_le_bytes());
        for (at, value) in [
            (16, 2),
            (18, 40),
            (20, 1),
            (28, 52),
            (40, 52),
            (42, 32),
            (44, segments.len() as u16),
        ] {
            half(&mut head, at, value);
        }
        let mut content_at = 52 + 32 * segments.len() as u32;
        let mut content = Vec::new();
        for (address, bytes) in segments {
            for word in [
                1,
                content_at,
                *address,
                *address,
                bytes.len() as u32,
                bytes.len() as u32,
                5,
                4,
            ] {
                head.extend(u32::to_le_bytes(word));
            }
            content_at += bytes.len() as u32;
            content.extend_from_slice(bytes);
        }
        head.extend(content);
        head
    }

    /// An image with the record behind eight bytes, and a second segment behind a gap of four bytes.
    fn image() -> Vec<u8> {
        let mut code = vec![1, 2, 3, 4, 5, 6, 7, 8];
        code.extend(MARK);
        code.extend([ERASED; 8]);
        elf(&[(0x0800_0000, &code), (0x0800_001C, &[9, 10])])
    }

    #[test]
    fn the_check_value_is_that_of_the_flash() {
        let mut image = image();
        let seal = super::seal(&mut image).unwrap();
        let mut flash = vec![1, 2, 3, 4, 5, 6, 7, 8];
        flash.extend(MARK);
        flash.extend([30, 0, 0, 0]);
        flash.extend([ERASED; 4]);
        flash.extend([ERASED; 4]);
        flash.extend([9, 10]);
        // Bit by bit, from the definition: reflected, polynomial 0x04C11DB7, all ones before and after.
        let crc32 = !flash.iter().fold(u32::MAX, |crc, byte| {
            (0..8).fold(crc ^ u32::from(*byte), |c, _| {
                (c >> 1) ^ if c & 1 == 1 { 0xEDB8_8320 } else { 0 }
            })
        });
        assert_eq!(seal, Seal { flash_bytes: 30, crc32 });
        let record = 52 + 64 + 8;
        assert_eq!(image[record + LENGTH_AT..][..4], 30_u32.to_le_bytes());
        assert_eq!(image[record + CHECK_AT..][..4], crc32.to_le_bytes());
        // Sealed again, it stays as it is.
        let before = image.clone();
        assert_eq!((super::seal(&mut image), image), (Ok(seal), before));
    }

    #[test]
    fn what_is_no_image_is_refused_and_left_alone() {
        let twice = [MARK.as_slice(), &[0; 8], &MARK, &[0; 8]].concat();
        for (mut bytes, expected) in [
            (b"#!/bin/sh".to_vec(), "no 32-bit ELF"),
            (elf(&[(0x0800_0000, &[0; 64])]), "0 records"),
            (elf(&[(0x0800_0000, &MARK)]), "0 records"),
            (elf(&[(0x0800_0000, &twice)]), "2 records"),
            (elf(&[(0x2000_0000, &[0; 4])]), "outside of the flash"),
            (elf(&[(0x080F_FFFE, &[0; 4])]), "outside of the flash"),
            (image()[..120].to_vec(), "ends behind the file"),
        ] {
            let before = bytes.clone();
            let error = seal(&mut bytes).unwrap_err().to_string();
            assert!(error.contains(expected) && bytes == before, "{error}");
        }
    }
}
