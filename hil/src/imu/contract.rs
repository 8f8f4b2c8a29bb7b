//! The two messages of the unit, and what they add to the load of the bus.
//!
//! Their identifiers come after those of all sensors of the suspension and before the controller's states, so that on the wire no frame that
//! the controller waits for waits for them longer than one frame takes.

use oleo_controller::can::bus_load::{BIT_RATES, bits_a_second};
use oleo_controller::can::{Contract, FRAME_BYTES, MESSAGES as OF_SUSPENSION};
use oleo_interface::tick::TICK_MS;

/// Three specific forces, then three rates.
pub const MESSAGES: [Contract; 2] = [contract(0, "IMU_SPECIFIC_FORCE", 0x120), contract(1, "IMU_RATE", 0x121)];

/// The lists of data identifiers go on where those of the suspension's messages end.
const fn contract(number: u16, name: &'static str, id: u16) -> Contract {
    let number = OF_SUSPENSION.len() as u16 + number;
    let mut data_ids = [0; 16];
    let mut counter = 0;
    while counter < 16 {
        data_ids[counter as usize] = ((3 + 17 * number + 29 * counter) % 251) as u8;
        counter += 1;
    }
    Contract {
        name,
        id,
        length: FRAME_BYTES,
        period_ms: TICK_MS,
        data_ids,
        max_delta: 3,
        timeout_ticks: 4,
    }
}

/// Position in [`MESSAGES`] of the message with a standard identifier, if it is one of the unit's.
pub fn of_unit(id: Option<u16>) -> Option<usize> {
    MESSAGES.iter().position(|contract| Some(contract.id) == id)
}

/// Worst-case load at 500 kbit/s of the suspension's messages and the unit's together, in tenths of a per cent.
pub const LOAD_500K_PERMILLE: u32 = load_permille(BIT_RATES[0]);
/// The same at 1 Mbit/s.
pub const LOAD_1M_PERMILLE: u32 = load_permille(BIT_RATES[1]);

const fn load_permille(bit_rate: u32) -> u32 {
    let bits = bits_a_second(&OF_SUSPENSION) + bits_a_second(&MESSAGES);
    (bits as u64 * 1000 / bit_rate as u64) as u32
}

const _: () = assert!(
    LOAD_500K_PERMILLE < 600,
    "bus load with the unit at 500 kbit/s must stay below 60 %"
);
const _: () = assert!(
    LOAD_1M_PERMILLE < 600,
    "bus load with the unit at 1 Mbit/s must stay below 60 %"
);

#[cfg(test)]
mod tests {
    use super::*;

    /// 135 bits for each of nine messages every 5 ms, one every 100 ms and one every second.
    #[test]
    fn load_by_hand() {
        assert_eq!(LOAD_500K_PERMILLE, (135 * (9 * 200 + 10 + 1)) / 500);
        assert_eq!(LOAD_1M_PERMILLE, LOAD_500K_PERMILLE / 2);
    }

    #[test]
    fn no_identifier_of_the_suspension_is_taken() {
        for unit in &MESSAGES {
            assert!(OF_SUSPENSION.iter().all(|message| message.id != unit.id));
            for counter in 0..16 {
                let own = unit.data_ids[counter];
                let others = OF_SUSPENSION
                    .iter()
                    .chain(MESSAGES.iter().filter(|other| other.id != unit.id));
                assert!(
                    others.into_iter().all(|other| other.data_ids[counter] != own),
                    "{}",
                    unit.name
                );
            }
        }
    }
}
