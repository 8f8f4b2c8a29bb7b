//! Worst-case load of the bus, at compile time.
//!
//! The longest time that a data frame with an 11-bit identifier and n bytes takes, with stuff bits and the interframe space, in bit
//! times (Davis, Burns, Bril & Lukkien, "Controller Area Network (CAN) schedulability analysis:
//! refuted, revisited and revised", Real-Time Systems 35, 2007, g = 34; *recalled*):
//!
//! ```text
//!   C = g + 8 n + 13 + floor((g + 8 n - 1) / 4)        135 bits for n = 8
//! ```

use super::contract::{Contract, MESSAGES};

/// Bit rates for which this bus is designed, bit/s.
pub const BIT_RATES: [u32; 2] = [500_000, 1_000_000];

/// Longest time that a frame with `bytes` data bytes, 0 to 8, takes on the wire, bit times.
///
/// ```
/// use oleo_controller::can::bus_load::worst_case_bits;
/// assert_eq!(worst_case_bits(8), 135);
/// ```
pub const fn worst_case_bits(bytes: usize) -> u32 {
    let stuffable = 34 + 8 * bytes as u32;
    stuffable + 13 + (stuffable - 1) / 4
}

/// Worst-case rate of a set of messages, bit/s.
///
/// ```
/// use oleo_controller::can::{MESSAGES, bus_load};
/// let bits_a_second = bus_load::bits_a_second(&MESSAGES);
/// assert_eq!(bits_a_second, (7 * 200 + 10 + 1) * 135); // seven messages every 5 ms, one every 100 ms, one every second
/// ```
pub const fn bits_a_second(messages: &[Contract]) -> u32 {
    let mut sum = 0;
    let mut i = 0;
    while i < messages.len() {
        sum += worst_case_bits(messages[i].length) * 1000 / messages[i].period_ms;
        i += 1;
    }
    sum
}

/// Worst-case load of the bus with all messages at a bit rate (bit/s, above 0), in tenths of a per cent.
///
/// ```
/// use oleo_controller::can::bus_load::load_permille;
/// assert_eq!(load_permille(250_000), 761);
/// ```
pub const fn load_permille(bit_rate: u32) -> u32 {
    (bits_a_second(&MESSAGES) as u64 * 1000 / bit_rate as u64) as u32
}

/// Worst-case load at 500 kbit/s, in tenths of a per cent.
pub const LOAD_500K_PERMILLE: u32 = load_permille(500_000);
/// Worst-case load at 1 Mbit/s, in tenths of a per cent.
pub const LOAD_1M_PERMILLE: u32 = load_permille(1_000_000);

const _: () = assert!(LOAD_500K_PERMILLE < 600, "bus load at 500 kbit/s must stay below 60 %");
const _: () = assert!(LOAD_1M_PERMILLE < 600, "bus load at 1 Mbit/s must stay below 60 %");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn longest_frame_is_the_published_one() {
        assert_eq!(worst_case_bits(8), 135);
        assert_eq!(worst_case_bits(1), 65); // Davis et al., section 2.2: 55 + 10 n
        assert_eq!(worst_case_bits(4), 95);
    }

    #[test]
    fn load_by_hand() {
        // seven frames every 5 ms, one every 100 ms and one every second
        assert_eq!(bits_a_second(&MESSAGES), 135 * 7 * 200 + 135 * 10 + 135);
        assert_eq!(LOAD_500K_PERMILLE, 380);
        assert_eq!(LOAD_1M_PERMILLE, 190);
    }
}
