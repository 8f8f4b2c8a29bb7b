//! The contract of every message: its identifier, period and protection, and the time-out after which its silence is a
//! fault.
//!
//! Sender and receiver must agree on all of this. Node, plant end, bus load and the test of the database read this one table.
//! Identifiers are priorities on CAN. The command has the highest, because it is what closes valves in time; then come the sensors
//! in the order in which the controller needs them, and the two states last.

use oleo_interface::tick::TICK_MS;
use oleo_interface::{Axles, Corners};

use super::frame::FRAME_BYTES;
use crate::sensor_message::SensorMessage;

/// What sender and receiver of a message agree on.
///
/// ```
/// use oleo_controller::can::{COMMAND, MESSAGES};
/// assert_eq!((COMMAND.id, COMMAND.period_ms, COMMAND.timeout_ticks), (0x0A0, 5, 4));
/// assert!(MESSAGES.iter().all(|contract| contract.id >= COMMAND.id)); // it wins every arbitration
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contract {
    /// Name in the database. With the feature `comparison`: a board needs no names, and has no place for them.
    #[cfg(feature = "comparison")]
    pub name: &'static str,
    /// Standard identifier, 0 to 0x7FF. The lower one wins arbitration.
    pub id: u16,
    /// Number of data bytes.
    pub length: usize,
    /// Period at which the message is sent, ms.
    pub period_ms: u32,
    /// Data identifiers of AUTOSAR profile 2, by counter. They are never sent but are part of the CRC, so that a frame under
    /// the wrong identifier fails its check.
    pub data_ids: [u8; 16],
    /// Number of lost frames in a row that the counter check tolerates, plus one (`MaxDeltaCounterInit`).
    pub max_delta: u8,
    /// Number of ticks without an accepted frame after which the message is lost. Until then its last values are used.
    pub timeout_ticks: u8,
}

impl Contract {
    /// The contract of the message of a number, counted from 0 over all databases of a bus, from which its data identifiers follow.
    ///
    /// ```
    /// use oleo_controller::can::Contract;
    /// const RATES: Contract = Contract::numbered(10, "IMU_RATE", 0x121, 5);
    /// assert_eq!((RATES.id, RATES.data_ids[0]), (0x121, 173));
    /// ```
    #[must_use]
    pub const fn numbered(number: u16, name: &'static str, id: u16, period_ms: u32) -> Self {
        let mut data_ids = [0; 16];
        let mut counter = 0;
        // Distinct between messages at the same counter, and between neighbouring counters of a message; below 251, which
        // the profile recommends for lists.
        while counter < 16 {
            data_ids[counter as usize] = ((3 + 17 * number + 29 * counter) % 251) as u8;
            counter += 1;
        }
        #[cfg(not(feature = "comparison"))]
        let _ = name;
        Self {
            #[cfg(feature = "comparison")]
            name,
            id,
            length: FRAME_BYTES,
            period_ms,
            data_ids,
            max_delta: 3,
            timeout_ticks: 4,
        }
    }
}

/// Pressures p1 to p4 of the strut at each corner.
pub const PRESSURE: Corners<Contract> = Corners::from_array([
    Contract::numbered(0, "PRESSURE_FRONT_LEFT", 0x110, TICK_MS),
    Contract::numbered(1, "PRESSURE_FRONT_RIGHT", 0x111, TICK_MS),
    Contract::numbered(2, "PRESSURE_REAR_LEFT", 0x112, TICK_MS),
    Contract::numbered(3, "PRESSURE_REAR_RIGHT", 0x113, TICK_MS),
]);

/// Displacements of the two struts of each axle, and the sender's tick.
pub const DISPLACEMENT: Axles<Contract> = Axles::new(
    Contract::numbered(4, "DISPLACEMENT_FRONT", 0x114, TICK_MS),
    Contract::numbered(5, "DISPLACEMENT_REAR", 0x115, TICK_MS),
);

/// The valve command, from the controller to the output stage.
pub const COMMAND: Contract = Contract::numbered(6, "COMMAND", 0x0A0, TICK_MS);

/// The controller's state, for people and loggers.
pub const STATUS: Contract = Contract::numbered(7, "STATUS", 0x300, 100);

/// The state of the controller's board, for people and loggers. A simulated controller has none and does not send it.
pub const BOARD: Contract = Contract::numbered(8, "BOARD", 0x301, 1000);

/// Everything on the bus: what sensors send, in sending order, then the controller's three messages.
pub const MESSAGES: [Contract; 9] = {
    let [front_left, front_right, rear_left, rear_right] = *PRESSURE.as_array();
    [
        front_left,
        front_right,
        rear_left,
        rear_right,
        DISPLACEMENT.front,
        DISPLACEMENT.rear,
        COMMAND,
        STATUS,
        BOARD,
    ]
};

impl SensorMessage {
    /// What sender and receiver of this message agree on.
    pub fn contract(self) -> &'static Contract {
        match self {
            Self::Pressure(corner) => &PRESSURE[corner],
            Self::Displacement(axle) => &DISPLACEMENT[axle],
        }
    }
}

/// The sensor message with a standard identifier, if there is one.
///
/// ```
/// use oleo_controller::can::sensor_message;
/// use oleo_controller::{Corner, SensorMessage};
/// assert_eq!(sensor_message(0x112), Some(SensorMessage::Pressure(Corner::RearLeft)));
/// assert_eq!(sensor_message(0x0A0), None); // the command
/// ```
pub fn sensor_message(id: u16) -> Option<SensorMessage> {
    SensorMessage::ALL
        .into_iter()
        .find(|message| message.contract().id == id)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identifiers_lead_to_sensor_messages() {
        for message in SensorMessage::ALL {
            assert_eq!(sensor_message(message.contract().id), Some(message));
        }
        assert_eq!(sensor_message(COMMAND.id), None);
        assert!(
            MESSAGES
                .iter()
                .zip(SensorMessage::ALL)
                .all(|(contract, message)| contract == message.contract())
        );
    }

    /// By hand, of the tenth message: 3 + 17 * 10 = 173 at counter 0, 29 more at each, modulo 251.
    #[test]
    fn a_number_makes_a_contract() {
        let number = core::hint::black_box(10);
        let contract = Contract::numbered(number, "IMU_RATE", 0x121, 5);
        assert_eq!((contract.id, contract.period_ms), (0x121, 5));
        #[cfg(feature = "comparison")]
        assert_eq!(contract.name, "IMU_RATE");
        assert_eq!((contract.length, contract.max_delta, contract.timeout_ticks), (8, 3, 4));
        assert_eq!(contract.data_ids[..4], [173, 202, 231, 9]);
        assert_eq!(contract.data_ids[15], 106, "3 + 170 + 435 = 608");
    }

    #[test]
    fn data_ids_tell_messages_and_counters_apart() {
        for counter in 0..16 {
            let mut seen = [false; 251];
            for message in &MESSAGES {
                let id = usize::from(message.data_ids[counter]);
                assert!(
                    !core::mem::replace(&mut seen[id], true),
                    "{:#x} at counter {counter}",
                    message.id
                );
            }
        }
        for message in &MESSAGES {
            let mut ids = message.data_ids;
            ids.sort_unstable();
            assert!(ids.windows(2).all(|w| w[0] != w[1]), "{:#x}", message.id);
        }
    }
}
