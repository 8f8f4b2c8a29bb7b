//! Bytes as hexadecimal digits, and back. A long log has billions of them, and the formatter takes ten times as long.

use std::io::{self, Write};

use super::frame::MOST_BYTES;

const DIGITS: &[u8; 16] = b"0123456789ABCDEF";

/// Writes two digits for each byte of a frame.
pub fn write(out: &mut impl Write, data: &[u8]) -> io::Result<()> {
    let mut text = [0; 2 * MOST_BYTES];
    for (place, byte) in text.chunks_exact_mut(2).zip(data) {
        place.copy_from_slice(&digits(*byte));
    }
    out.write_all(text.get(..2 * data.len()).unwrap_or(&text))
}

/// Writes a blank and two digits for each byte of a frame.
pub fn write_spaced(out: &mut impl Write, data: &[u8]) -> io::Result<()> {
    let mut text = [b' '; 3 * MOST_BYTES];
    for (place, byte) in text.chunks_exact_mut(3).zip(data) {
        place[1..].copy_from_slice(&digits(*byte));
    }
    out.write_all(text.get(..3 * data.len()).unwrap_or(&text))
}

/// The byte of two digits; `None` if they are none.
pub fn byte(digits: &[u8]) -> Option<u8> {
    let [high, low] = *digits else { return None };
    let digit = |letter: u8| char::from(letter).to_digit(16);
    Some((digit(high)? << 4 | digit(low)?) as u8)
}

fn digits(byte: u8) -> [u8; 2] {
    [byte >> 4, byte & 0xF].map(|digit| DIGITS[usize::from(digit)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_has_its_digits() {
        for number in 0..=u8::MAX {
            let (mut plain, mut spaced) = (Vec::new(), Vec::new());
            write(&mut plain, &[number, 0]).expect("memory");
            write_spaced(&mut spaced, &[number, 0]).expect("memory");
            assert_eq!(plain, format!("{number:02X}00").into_bytes());
            assert_eq!(spaced, format!(" {number:02X} 00").into_bytes());
            assert_eq!(byte(&plain[..2]), Some(number));
            assert_eq!(byte(format!("{number:02x}").as_bytes()), Some(number));
        }
        for wrong in ["", "1", "+1", "1g", "G1", "123", "\u{e4}"] {
            assert_eq!(byte(wrong.as_bytes()), None, "{wrong}");
        }
    }
}
