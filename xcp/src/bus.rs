//! The slave's two identifiers, and its share of the bus.
//!
//! The identifiers lie above all messages of the vehicle: on CAN, a frame of the slave or of the tool never wins arbitration against
//! one of them. They are outside of 0x7DF to 0x7EF, which diagnostic testers use (ISO 15765-4).

use oleo_controller::can::MESSAGES;
use oleo_controller::can::bus_load::{bits_a_second, worst_case_bits};
use oleo_controller::interface::tick::TICKS_PER_SECOND;

/// Standard identifier of what the tool sends: commands.
pub const REQUEST_ID: u16 = 0x3F0;

/// Standard identifier of what the slave sends: answers and measured data.
pub const RESPONSE_ID: u16 = 0x3F1;

const _: () = {
    let mut i = 0;
    while i < MESSAGES.len() {
        assert!(
            MESSAGES[i].id < REQUEST_ID,
            "every message of the vehicle comes before XCP"
        );
        i += 1;
    }
};

/// Part of the bus that all messages together may take in the worst case, in thousandths.
const MOST_PERMILLE: u64 = 600;

/// Most frames of measured data in a tick, at any bit rate. It bounds the work of a tick.
pub const MOST_DATA_FRAMES: usize = 13;

/// How much the slave may send.
///
/// ```
/// use oleo_xcp::Budget;
/// assert_eq!(Budget::at(500_000).data_frames(), 2);
/// assert_eq!(Budget::at(1_000_000).data_frames(), 13);
/// assert_eq!(Budget::at(250_000).data_frames(), 0); // the vehicle's messages alone fill this bus
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    data_frames: usize,
}

impl Budget {
    /// What a bus of this bit rate (bit/s) has room for: the messages of the vehicle, one command of the tool and one answer every
    /// tick, and measured data in the rest, so that the load stays below 60 % in the worst case.
    pub const fn at(bit_rate: u32) -> Self {
        let free = (bit_rate as u64 * MOST_PERMILLE / 1000).saturating_sub(bits_a_second(&MESSAGES) as u64);
        let frames = free / (worst_case_bits(8) as u64 * TICKS_PER_SECOND as u64);
        let data = frames.saturating_sub(2);
        Self {
            data_frames: if data < MOST_DATA_FRAMES as u64 {
                data as usize
            } else {
                MOST_DATA_FRAMES
            },
        }
    }

    /// Most frames of measured data in a tick.
    pub const fn data_frames(self) -> usize {
        self.data_frames
    }

    /// Worst-case load of a bus of this bit rate (bit/s, above 0) with the vehicle's messages and all that tool and slave send, in
    /// tenths of a per cent.
    ///
    /// ```
    /// use oleo_xcp::Budget;
    /// assert_eq!(Budget::at(500_000).load_permille(500_000), 596);
    /// assert_eq!(Budget::at(1_000_000).load_permille(1_000_000), 595);
    /// ```
    pub const fn load_permille(self, bit_rate: u32) -> u32 {
        let xcp = (self.data_frames as u64 + 2) * worst_case_bits(8) as u64 * TICKS_PER_SECOND as u64;
        ((bits_a_second(&MESSAGES) as u64 + xcp) * 1000 / bit_rate as u64) as u32
    }
}

const _: () = assert!(
    Budget::at(500_000).load_permille(500_000) < 600,
    "bus load with XCP at 500 kbit/s must stay below 60 %"
);
const _: () = assert!(
    Budget::at(1_000_000).load_permille(1_000_000) < 600,
    "bus load with XCP at 1 Mbit/s must stay below 60 %"
);
