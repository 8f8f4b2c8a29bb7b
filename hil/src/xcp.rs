//! XCP on the bus of the controller's node: [`oleo_xcp::Slave`] as a companion.

use oleo_controller::{Builder, Node, Outputs};
use oleo_xcp::{Budget, REQUEST_ID, RESPONSE_ID, Sample, Slave};

use crate::Frame;
use crate::companion::Companion;
use crate::frame::standard;

/// An XCP slave beside the controller.
#[derive(Debug)]
pub struct Xcp {
    slave: Slave,
}

impl Xcp {
    /// A slave for the controller that was built from this, on a bus of this bit rate, bit/s. It does not write.
    pub fn new(builder: Builder, bit_rate: u32) -> Self {
        Self {
            slave: Slave::new(builder, Budget::at(bit_rate)),
        }
    }

    /// The same, and the tool may write the tuning.
    #[cfg(feature = "calibration")]
    #[must_use]
    pub fn writable(mut self) -> Self {
        self.slave = self.slave.writable();
        self
    }
}

/// Whether the controller's node would take another tuning now.
fn may_reconfigure(#[cfg_attr(not(feature = "calibration"), expect(unused_variables))] node: &Node) -> bool {
    #[cfg(feature = "calibration")]
    return node.may_reconfigure();
    #[cfg(not(feature = "calibration"))]
    false
}

impl Companion for Xcp {
    fn receive(&mut self, frame: &Frame) -> bool {
        let is_for_us = frame.standard_id() == Some(REQUEST_ID) && !frame.is_remote();
        if is_for_us {
            self.slave.receive(frame.data());
        }
        is_for_us
    }

    fn end_of_tick(&mut self, tick: u32, node: &mut Node, outputs: &Outputs, send: &mut dyn FnMut(Frame)) {
        let packets = self.slave.end_of_tick(&Sample {
            tick,
            plant_tick: node.plant_tick(),
            inputs: node.inputs(),
            outputs,
            writable: may_reconfigure(node),
        });
        #[cfg(feature = "calibration")]
        if let Some(configuration) = self.slave.take_changed() {
            // The slave has asked the same question in this tick, so the node takes it.
            node.reconfigure(configuration);
        }
        for frame in packets
            .iter()
            .filter_map(|packet| Frame::new(standard(RESPONSE_ID), packet))
        {
            send(frame);
        }
    }

    fn restart(&mut self) {
        self.slave.restart();
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::bus::{Bus, in_process_pair};
    use crate::controller_node::ControllerNode;
    use oleo_controller::{Configuration, Corners, Gauge, Inputs, PlantEnd, StrutPressures};

    /// A controller's node at rest with a tool at the other end of its bus; returns the words that it commanded and what the tool got.
    fn driven(xcp: Option<Xcp>, tool: impl Fn(u16) -> Option<Vec<u8>>) -> (Vec<u16>, Vec<Frame>) {
        let (mut far, near) = in_process_pair();
        let mut controller = ControllerNode::new(near, Configuration::defender110(), &[], 400);
        if let Some(xcp) = xcp {
            controller.serve(Box::new(xcp));
        }
        let (mut plant, mut answers) = (PlantEnd::new(), Vec::new());
        let pressure = Corners::splat(StrutPressures::splat(Gauge(2.0e6)));
        let inputs = Inputs::from_values(Corners::splat(0.0), pressure);
        for tick in 0..400 {
            for frame in plant.encode(tick, &inputs) {
                far.send(&frame.into()).unwrap();
            }
            if let Some(request) = tool(tick) {
                far.send(&Frame::new(standard(REQUEST_ID), &request).unwrap()).unwrap();
            }
            controller.listen(Duration::ZERO).unwrap();
            controller.set_tick(tick.into());
            controller.decide().unwrap();
            while let Some(frame) = far.receive(Duration::ZERO).unwrap() {
                match frame.standard_id() {
                    Some(RESPONSE_ID) => answers.push(frame),
                    Some(id) => drop(plant.receive(id, frame.data())),
                    None => {}
                }
            }
            plant.end_of_tick();
        }
        (controller.words().to_vec(), answers)
    }

    #[test]
    fn a_tool_that_looks_on_changes_no_command() {
        let tool = |tick: u16| match tick {
            0 => Some(vec![0xFF, 0]),
            1.. => Some(vec![0xF4, 7, 0, 0, (tick % 90) as u8, 0x10, 0, 0]),
        };
        let (words, answers) = driven(Some(Xcp::new(Builder::default(), 500_000)), tool);
        let (alone, none) = driven(None, tool);
        assert_eq!(words, alone);
        assert_eq!((answers.len(), none.len()), (400, 0));
        assert!(answers[1..].iter().all(|answer| answer.data()[0] == 0xFF));
    }

    #[cfg(feature = "calibration")]
    #[test]
    fn a_written_value_takes_effect_while_the_valves_are_closed() {
        let tool = |tick: u16| match tick {
            0 => Some(vec![0xFF, 0]),
            300 => Some(vec![0xF6, 0, 0, 0, 0x08, 0x20, 0, 0]),
            301 => Some([&[0xF0, 4][..], &0.02_f32.to_le_bytes()].concat()),
            302 => Some(vec![0xF4, 4, 0, 0, 0x08, 0x20, 0, 0]),
            _ => None,
        };
        let (_, answers) = driven(Some(Xcp::new(Builder::default(), 500_000).writable()), tool);
        assert_eq!(answers[2].data(), [0xFF]);
        assert_eq!(answers[3].data()[1..], 0.02_f32.to_le_bytes());
        let (_, answers) = driven(Some(Xcp::new(Builder::default(), 500_000)), tool);
        assert_eq!(
            answers[2].data(),
            [0xFE, 0x23],
            "without being asked for, nothing is written"
        );
    }
}
