//! The two messages of the unit, and what they add to the load of the bus.
//!
//! Their identifiers come after those of all sensors of the suspension and before the controller's states, so that on the wire no frame that
//! the controller waits for waits for them longer than one frame takes.

use oleo_controller::can::bus_load::{BIT_RATES, bits_a_second};
use oleo_controller::can::{Contract, MESSAGES as OF_SUSPENSION};
use oleo_interface::tick::TICK_MS;

/// Numbers go on where those of the suspension's messages end.
const FIRST: u16 = OF_SUSPENSION.len() as u16;
/// Three specific forces, then three rates.
pub const MESSAGES: [Contract; 2] = [
    Contract::numbered(FIRST, "IMU_SPECIFIC_FORCE", 0x120, TICK_MS),
    Contract::numbered(FIRST + 1, "IMU_RATE", 0x121, TICK_MS),
];

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
