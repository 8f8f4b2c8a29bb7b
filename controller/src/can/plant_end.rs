//! The other end of the bus: sensors out, valve command in.
//!
//! Simulations, benches and tests all have to stand opposite the controller. They use this, so that what
//! they send is what the database says.

use super::{
    COMMAND, CheckStatus, Checker, CommandMessage, DISPLACEMENT, DisplacementMessage, FRAME_BYTES, Frame, PRESSURE,
    PressureMessage, Protector,
};
use crate::reading::Inputs;

/// Sensor side of the bus: six protectors and the checker of the command.
#[derive(Clone, Copy, Debug)]
pub struct PlantEnd {
    pressure: [Protector; 4],
    displacement: [Protector; 2],
    command: Checker,
}

impl Default for PlantEnd {
    fn default() -> Self {
        Self::new()
    }
}

impl PlantEnd {
    /// Nothing sent, nothing received.
    pub const fn new() -> Self {
        let [p0, p1, p2, p3] = &PRESSURE;
        let [front, rear] = &DISPLACEMENT;
        Self {
            pressure: [
                Protector::new(p0),
                Protector::new(p1),
                Protector::new(p2),
                Protector::new(p3),
            ],
            displacement: [Protector::new(front), Protector::new(rear)],
            command: Checker::new(&COMMAND),
        }
    }

    /// The six frames of one tick in sending order. `plant_tick` is the tick modulo 65536; readings that are invalid are sent as such.
    pub fn encode(&mut self, plant_tick: u16, inputs: &Inputs) -> [Frame; 6] {
        let [fl, fr, rl, rr] = inputs.pressure.map(|pressure| PressureMessage { pressure }.encode());
        let [left_front, right_front, left_rear, right_rear] = inputs.displacement;
        let front = DisplacementMessage {
            plant_tick,
            left: left_front,
            right: right_front,
        }
        .encode();
        let rear = DisplacementMessage {
            plant_tick,
            left: left_rear,
            right: right_rear,
        }
        .encode();
        let [i0, i1, i2, i3] = PRESSURE.map(|c| c.id);
        let [i4, i5] = DISPLACEMENT.map(|c| c.id);
        let [e0, e1, e2, e3] = &mut self.pressure;
        let [e4, e5] = &mut self.displacement;
        let seal = |id: u16, protector: &mut Protector, mut data: [u8; FRAME_BYTES]| {
            protector.protect(&mut data);
            Frame { id, data }
        };
        [
            seal(i0, e0, fl),
            seal(i1, e1, fr),
            seal(i2, e2, rl),
            seal(i3, e3, rr),
            seal(i4, e4, front),
            seal(i5, e5, rear),
        ]
    }

    /// A received frame: the command if it is one, with the outcome of its check; `None` for any other identifier. The
    /// message is `Some` where its CRC and complement are right, so that a first or late command's echo
    /// can be seen; drive valves only where the status is usable or initial.
    pub fn receive(&mut self, id: u16, data: &[u8]) -> Option<(CheckStatus, Option<CommandMessage>)> {
        if id != COMMAND.id {
            return None;
        }
        let Ok(data) = <&[u8; FRAME_BYTES]>::try_from(data) else {
            return Some((CheckStatus::WrongCrc, None));
        };
        let status = self.command.check(data);
        let message = if status == CheckStatus::WrongCrc {
            None
        } else {
            CommandMessage::decode(data)
        };
        Some((status, message))
    }

    /// A tick without a command.
    pub fn no_command(&mut self) {
        self.command.no_new_data();
    }
}
