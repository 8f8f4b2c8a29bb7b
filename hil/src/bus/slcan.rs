//! The Lawicel ASCII protocol ("slcan"): one line for each frame.
//!
//! ```text
//!   t 110 8 0011223344556677 \r      data, 11-bit identifier      (spaces only here)
//!   T 1FFF01E0 2 ABCD \r             data, 29-bit identifier
//!   r 110 8 \r   R 1FFF01E0 0 \r     remote
//!   z \r  Z \r  \r  BEL              an adapter's answers: sent, sent, ok, error
//! ```
//!
//! Source: Lawicel "CANUSB manual" (2011), commands t, T, r, R, O, C, S, Z; the Linux driver `slcan.c` reads the same. A decoder takes
//! bytes as they come, in pieces of any size. What is not a frame is skipped to the end of its line, and counted.

use crate::Frame;
use crate::frame::{extended, standard};

/// Longest line with a frame: `T`, 8 + 1 + 16 digits, and a time stamp of 4 digits.
const LONGEST: usize = 1 + 8 + 1 + 16 + 4;

/// Length of the longest encoded frame with its carriage return.
pub const ENCODED_BYTES: usize = 1 + 8 + 1 + 16 + 1;

/// The line of a frame, carriage return included.
///
/// ```
/// # use oleo_hil::{Frame, bus::slcan_encode};
/// let frame = Frame::new(embedded_can::StandardId::new(0x110).unwrap(), &[0xAB, 1]).unwrap();
/// assert_eq!(slcan_encode(&frame).as_bytes(), b"t1102AB01\r");
/// ```
pub fn encode(frame: &Frame) -> String {
    let kind = match (frame.is_extended(), frame.is_remote()) {
        (false, false) => 't',
        (false, true) => 'r',
        (true, false) => 'T',
        (true, true) => 'R',
    };
    let digits = if frame.is_extended() { 8 } else { 3 };
    let mut line = String::with_capacity(ENCODED_BYTES);
    line.push(kind);
    push_hex(&mut line, frame.raw_id(), digits);
    push_hex(&mut line, frame.dlc() as u32, 1);
    for byte in frame.data() {
        push_hex(&mut line, u32::from(*byte), 2);
    }
    line.push('\r');
    line
}

/// Writes hexadecimal digits without `format!`, so that a small machine keeps pace with a serial line.
fn push_hex(line: &mut String, value: u32, digits: u32) {
    for place in (0..digits).rev() {
        line.push(
            char::from_digit((value >> (4 * place)) & 0xF, 16)
                .unwrap_or('0')
                .to_ascii_uppercase(),
        );
    }
}

/// Collects bytes into frames.
#[derive(Clone, Debug, Default)]
pub struct Decoder {
    line: Vec<u8>,
    overlong: bool,
    unreadable: u64,
}

impl Decoder {
    /// Takes one byte; returns a frame if the byte ends one.
    pub fn push(&mut self, byte: u8) -> Option<Frame> {
        if !matches!(byte, b'\r' | b'\n' | 0x07) {
            if self.line.len() < LONGEST {
                self.line.push(byte);
            } else {
                self.overlong = true;
            }
            return None;
        }
        let overlong = std::mem::take(&mut self.overlong);
        let frame = (!overlong).then(|| parse(&self.line)).flatten();
        if overlong || (frame.is_none() && !is_adapter_traffic(&self.line)) {
            self.unreadable += 1;
        }
        self.line.clear();
        frame
    }

    /// Number of lines that were neither a frame nor an adapter's answer or command.
    pub fn unreadable(&self) -> u64 {
        self.unreadable
    }
}

/// Whether a line is an answer of an adapter, or a command to one from another host on the line.
fn is_adapter_traffic(line: &[u8]) -> bool {
    matches!(
        line.first(),
        None | Some(b'z' | b'Z' | b'V' | b'N' | b'F' | b'O' | b'C' | b'S' | b'L' | b'A')
    )
}

/// Reads a line without its end. A time stamp may follow the frame.
fn parse(line: &[u8]) -> Option<Frame> {
    let (&kind, rest) = line.split_first()?;
    let (id_digits, remote) = match kind {
        b't' => (3, false),
        b'r' => (3, true),
        b'T' => (8, false),
        b'R' => (8, true),
        _ => return None,
    };
    let (id, rest) = rest.split_at_checked(id_digits)?;
    let id = hex(id)?;
    let id: embedded_can::Id = match id_digits {
        3 if id <= 0x7FF => standard(id as u16).into(),
        8 if id <= 0x1FFF_FFFF => extended(id).into(),
        _ => return None,
    };
    let (length, rest) = rest.split_at_checked(1)?;
    let length = hex(length)? as usize;
    if length > 8 {
        return None;
    }
    let (digits, stamp) = rest.split_at_checked(if remote { 0 } else { 2 * length })?;
    if !(stamp.is_empty() || stamp.len() == 4 && hex(stamp).is_some()) {
        return None;
    }
    if remote {
        return Frame::remote(id, length);
    }
    let mut data = [0u8; 8];
    for (byte, pair) in data.iter_mut().zip(digits.chunks_exact(2)) {
        *byte = hex(pair)? as u8;
    }
    Frame::new(id, data.get(..length)?)
}

fn hex(digits: &[u8]) -> Option<u32> {
    digits
        .iter()
        .try_fold(0, |value, &digit| Some(value << 4 | char::from(digit).to_digit(16)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::tests::any_frame;
    use proptest::prelude::*;

    fn decode(bytes: &[u8]) -> (Vec<Frame>, u64) {
        let mut decoder = Decoder::default();
        let frames = bytes.iter().filter_map(|byte| decoder.push(*byte)).collect();
        (frames, decoder.unreadable())
    }

    #[test]
    fn lines_of_the_manual() {
        assert_eq!(
            decode(b"t10021133\r").0,
            [Frame::new(standard(0x100), &[0x11, 0x33]).unwrap()]
        );
        assert_eq!(
            decode(b"T0000010021133\r").0,
            [Frame::new(extended(0x100), &[0x11, 0x33]).unwrap()]
        );
        assert_eq!(decode(b"r1002\rR000001002\r").0.len(), 2);
        assert_eq!(decode(b"t100211335AF0\r").0.len(), 1, "time stamp");
        assert_eq!(decode(b"\rz\rZ\r\x07V1013\rNA123\rF00\rC\rS6\rO\r"), (vec![], 0));
    }

    #[test]
    fn nonsense_is_counted_and_the_next_frame_is_read() {
        let (frames, unreadable) = decode(b"t10g0\rt8000\rt1009\rt10021\rTFFFFFFFF0\rt1000\r");
        assert_eq!((frames.len(), unreadable), (1, 5));
        let mut long = vec![b't'; 5000];
        long.extend_from_slice(b"\rt1000\r");
        assert_eq!(decode(&long), (vec![Frame::new(standard(0x100), &[]).unwrap()], 1));
    }

    proptest! {
        #[test]
        fn every_frame_survives(frames in prop::collection::vec(any_frame(), 1..20)) {
            let text: String = frames.iter().map(encode).collect();
            let (back, unreadable) = decode(text.as_bytes());
            prop_assert_eq!(back, frames);
            prop_assert_eq!(unreadable, 0);
        }

        #[test]
        fn no_bytes_do_harm(noise in prop::collection::vec(any::<u8>(), 0..400), frame in any_frame()) {
            let mut bytes = noise;
            bytes.push(b'\r');
            bytes.extend_from_slice(encode(&frame).as_bytes());
            let (frames, _) = decode(&bytes);
            prop_assert_eq!(frames.last(), Some(&frame));
        }
    }
}
