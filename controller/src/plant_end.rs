//! The plant's end of the bus: it sends the sensor messages and receives the valve command.
//!
//! Simulations, benchmarks and tests need a node opposite the controller. They all use this one, so that what they send is what the
//! database says.

use oleo_interface::{Axles, Corner, Corners, Side};

use crate::can::{
    COMMAND, CheckStatus, CommandMessage, DISPLACEMENT, DisplacementMessage, FRAME_BYTES, Frame, PRESSURE,
    PressureMessage, Protector, sensor_message,
};
use crate::output_stage::OutputStage;
use crate::reading::Inputs;
use crate::sensor_message::SensorMessage;
use crate::valves::ValveCommand;

/// The node opposite the controller: it protects six sensor messages, and obeys the command as [`OutputStage`] does. See
/// [`Node`](crate::Node) for an example.
#[derive(Clone, Copy, Debug)]
pub struct PlantEnd {
    pressure: Corners<Protector>,
    displacement: Axles<Protector>,
    output: OutputStage,
    plant_tick: u8,
    /// The challenge of the last command that was received.
    answer: u8,
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
            output: OutputStage::new(),
            plant_tick: 0,
            answer: 0,
        }
    }

    /// The six frames of one tick in sending order; `tick` is the number of the tick, of which the low byte is sent. Invalid
    /// readings are sent as sensor errors.
    pub fn encode(&mut self, tick: u16, inputs: &Inputs) -> [Frame; 6] {
        let [plant_tick, _] = tick.to_le_bytes();
        self.plant_tick = plant_tick;
        let answer = self.answer;
        SensorMessage::ALL.map(|message| {
            let (mut data, protector) = match message {
                SensorMessage::Pressure(corner) => (pressures(inputs, corner), &mut self.pressure[corner]),
                SensorMessage::Displacement(axle) => {
                    let message = DisplacementMessage {
                        plant_tick,
                        answer,
                        left: inputs.displacement[axle.corner(Side::Left)],
                        right: inputs.displacement[axle.corner(Side::Right)],
                    };
                    (message.encode(), &mut self.displacement[axle])
                }
            };
            protector.protect(&mut data);
            Frame {
                id: message.contract().id,
                data,
            }
        })
    }

    /// Takes a received frame, any number of times in a tick. Returns the outcome of its check if it is a command. A frame with the
    /// identifier of a sensor message comes from somebody else and counts against the bus.
    pub fn receive(&mut self, id: u16, data: &[u8]) -> Option<CheckStatus> {
        if id != COMMAND.id {
            if sensor_message(id).is_some() {
                self.output.distrust();
            }
            return None;
        }
        let status = self.output.receive(data);
        if !status.is_error()
            && let Some(command) = <&[u8; FRAME_BYTES]>::try_from(data)
                .ok()
                .and_then(CommandMessage::decode)
        {
            self.answer = command.challenge;
        }
        Some(status)
    }

    /// Ends a tick; returns the command to obey.
    pub fn end_of_tick(&mut self) -> ValveCommand {
        self.output.end_of_tick(self.plant_tick)
    }

    /// The reception of the command.
    pub fn output(&self) -> &OutputStage {
        &self.output
    }
}

fn pressures(inputs: &Inputs, corner: Corner) -> [u8; FRAME_BYTES] {
    let pressure = inputs.pressure[corner];
    PressureMessage { pressure }.encode()
}
