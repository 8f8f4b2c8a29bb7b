//! The other end of the bus: it sends the sensor messages and receives the valve command.
//!
//! Simulations, benchmarks and tests need a node opposite the controller. They all use this one, so that what they send is what the
//! database says.

use oleo_interface::{Axle, Axles, Corner, Corners, Side};

use super::contract::{COMMAND, DISPLACEMENT, PRESSURE};
use super::e2e::{CheckStatus, Checker, Protector};
use super::frame::{FRAME_BYTES, Frame};
use super::signals::{CommandMessage, DisplacementMessage, PressureMessage};
use crate::reading::Inputs;
use crate::sensor_message::SensorMessage;

/// The node opposite the controller: it protects six sensor messages and checks the command. See
/// [`Node`](crate::Node) for an example.
#[derive(Clone, Copy, Debug)]
pub struct PlantEnd {
    pressure: Corners<Protector>,
    displacement: Axles<Protector>,
    command: Checker,
}

impl Default for PlantEnd {
    fn default() -> Self {
        Self::new()
    }
}

impl PlantEnd {
    /// A node that has sent and received nothing.
    pub fn new() -> Self {
        Self {
            pressure: PRESSURE.map(|contract| Protector::new(&contract)),
            displacement: DISPLACEMENT.map(|contract| Protector::new(&contract)),
            command: Checker::new(&COMMAND),
        }
    }

    /// The six frames of one tick in sending order. `plant_tick` is the tick modulo 65536. Invalid readings are sent as sensor
    /// errors.
    pub fn encode(&mut self, plant_tick: u16, inputs: &Inputs) -> [Frame; 6] {
        SensorMessage::ALL.map(|message| {
            let (mut data, protector) = match message {
                SensorMessage::Pressure(corner) => (pressures(inputs, corner), &mut self.pressure[corner]),
                SensorMessage::Displacement(axle) => {
                    (displacements(plant_tick, inputs, axle), &mut self.displacement[axle])
                }
            };
            protector.protect(&mut data);
            Frame {
                id: message.contract().id,
                data,
            }
        })
    }

    /// Takes a received frame. Returns `None` for any identifier but the command's, and otherwise the outcome of its check and
    /// its content. The content is `Some` whenever CRC and complement are right, so that the echo of a first or late command
    /// can be seen; drive valves only if the status is usable or [`CheckStatus::Initial`].
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

    /// Notes that a tick has passed without a command.
    pub fn no_command(&mut self) {
        self.command.no_new_data();
    }
}

fn pressures(inputs: &Inputs, corner: Corner) -> [u8; FRAME_BYTES] {
    let pressure = inputs.pressure[corner];
    PressureMessage { pressure }.encode()
}

fn displacements(plant_tick: u16, inputs: &Inputs, axle: Axle) -> [u8; FRAME_BYTES] {
    DisplacementMessage {
        plant_tick,
        left: inputs.displacement[axle.corner(Side::Left)],
        right: inputs.displacement[axle.corner(Side::Right)],
    }
    .encode()
}
