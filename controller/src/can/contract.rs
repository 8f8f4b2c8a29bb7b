//! One line for every message: identifier, period, protection and what silence means.
//!
//! Sender and receiver must agree on these; the mode machine, the bus-load computation and the database test all read this table, so it cannot say two things.
//! Identifiers are priorities on CAN: the command comes first (it can only make things safer in time), then the sensors in the order in which
//! the controller needs them, status last.

use oleo_interface::tick::TICK_MS;
use oleo_interface::{Axle, Axles, Corner, Corners};

use super::frame::FRAME_BYTES;
use crate::sensor_message::SensorMessage;

/// The agreement about one message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contract {
    /// Name in the database.
    pub name: &'static str,
    /// Standard (11-bit) identifier; lower wins arbitration.
    pub id: u16,
    /// Data length, bytes.
    pub length: usize,
    /// Sending period, ms.
    pub period_ms: u32,
    /// Data identifiers of AUTOSAR profile 2, by counter: never sent, part of the CRC, so that a frame under the wrong
    /// identifier fails its check.
    pub data_ids: [u8; 16],
    /// Lost frames in a row that the counter check tolerates, plus one (`MaxDeltaCounterInit`).
    pub max_delta: u8,
    /// Ticks without an accepted frame after which the content is no longer substituted by the last value but invalid.
    pub timeout_ticks: u8,
}

const fn contract(number: u16, name: &'static str, id: u16, period_ms: u32) -> Contract {
    let mut data_ids = [0; 16];
    let mut counter = 0;
    // Distinct between messages at the same counter, and between neighbouring counters of a message; below 251, which
    // the profile recommends for lists.
    while counter < 16 {
        data_ids[counter as usize] = ((3 + 17 * number + 29 * counter) % 251) as u8;
        counter += 1;
    }
    Contract {
        name,
        id,
        length: FRAME_BYTES,
        period_ms,
        data_ids,
        max_delta: 3,
        timeout_ticks: 4,
    }
}

/// Pressures p1 to p4 of the strut at each corner.
pub const PRESSURE: Corners<Contract> = Corners::from_array([
    contract(0, "PRESSURE_FRONT_LEFT", 0x110, TICK_MS),
    contract(1, "PRESSURE_FRONT_RIGHT", 0x111, TICK_MS),
    contract(2, "PRESSURE_REAR_LEFT", 0x112, TICK_MS),
    contract(3, "PRESSURE_REAR_RIGHT", 0x113, TICK_MS),
]);

/// Displacements of the two struts of each axle, and the sender's tick.
pub const DISPLACEMENT: Axles<Contract> = Axles::new(
    contract(4, "DISPLACEMENT_FRONT", 0x114, TICK_MS),
    contract(5, "DISPLACEMENT_REAR", 0x115, TICK_MS),
);

/// The valve command, controller to output stage.
pub const COMMAND: Contract = contract(6, "COMMAND", 0x0A0, TICK_MS);

/// The controller's state, for people and loggers.
pub const STATUS: Contract = contract(7, "STATUS", 0x300, 100);

/// Everything on the bus: what sensors send, in sending order, then the controller's two messages.
pub const MESSAGES: [Contract; 8] = {
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
    ]
};

impl SensorMessage {
    /// The agreement about this message.
    pub const fn contract(self) -> Contract {
        let [front_left, front_right, rear_left, rear_right] = *PRESSURE.as_array();
        match self {
            Self::Pressure(Corner::FrontLeft) => front_left,
            Self::Pressure(Corner::FrontRight) => front_right,
            Self::Pressure(Corner::RearLeft) => rear_left,
            Self::Pressure(Corner::RearRight) => rear_right,
            Self::Displacement(Axle::Front) => DISPLACEMENT.front,
            Self::Displacement(Axle::Rear) => DISPLACEMENT.rear,
        }
    }
}

/// The sensor message with an identifier, if there is one.
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
                .all(|(contract, message)| *contract == message.contract())
        );
    }

    #[test]
    fn data_ids_tell_messages_and_counters_apart() {
        for counter in 0..16 {
            let mut seen = [false; 251];
            for message in &MESSAGES {
                let id = usize::from(message.data_ids[counter]);
                assert!(
                    !core::mem::replace(&mut seen[id], true),
                    "{} at counter {counter}",
                    message.name
                );
            }
        }
        for message in &MESSAGES {
            let mut ids = message.data_ids;
            ids.sort_unstable();
            assert!(ids.windows(2).all(|w| w[0] != w[1]), "{}", message.name);
        }
    }
}
