//! The controller on a CAN bus: frames in, frames out.
//!
//! `cargo run -p oleo-controller --example frames` puts a node opposite the controller that sends the sensor messages of a
//! vehicle at rest. After 1 s the cable of the rear left pressures is cut for 0.5 s, and between 3 s and 3.2 s nothing arrives
//! at all. A line is printed whenever the command frame says something new.

use oleo_controller::can::CommandMessage;
use oleo_controller::interface::tick::{TICK_S, TICKS_PER_SECOND};
use oleo_controller::{Configuration, Corner, Corners, Gauge, Inputs, Node, PlantEnd, SensorMessage, StrutPressures};

/// Whether a message reaches the controller at a time.
fn arrives(message: SensorMessage, time_s: f64) -> bool {
    let cut = (1.0..1.5).contains(&time_s) && message == SensorMessage::Pressure(Corner::RearLeft);
    let silence = (3.0..3.2).contains(&time_s);
    !cut && !silence
}

fn main() {
    let mut node = Node::new(Configuration::defender110());
    let mut plant = PlantEnd::new();
    let at_rest = Inputs::from_values(Corners::splat(0.0), Corners::splat(StrutPressures::splat(Gauge(2.0e6))));
    let mut before = None;
    println!("time, s  mode      first cause   valve word");
    for number in 0..7 * TICKS_PER_SECOND {
        let time_s = f64::from(number) * TICK_S;

        // The six sensor messages of this tick. Counter and check value are in the frames already.
        let frames = plant.encode(number as u16, &at_rest);
        for (message, frame) in SensorMessage::ALL.into_iter().zip(frames) {
            if arrives(message, time_s) {
                node.receive(frame.id, &frame.data);
            }
        }

        // One period. Each tick sends a command, and every twentieth a status as well.
        let (_, frames) = node.tick();
        for frame in frames {
            // `plant` checks commands as an output stage does, and echoes them in its next frames.
            if plant.receive(frame.id, &frame.data).is_none() {
                continue;
            }
            let Some(CommandMessage {
                command, mode, fault, ..
            }) = CommandMessage::decode(&frame.data)
            else {
                continue;
            };
            if before != Some((command, mode, fault)) {
                println!(
                    "{time_s:7.3}  {:<9} {:<13} {:012b}",
                    mode.name(),
                    fault.name(),
                    command.word()
                );
                before = Some((command, mode, fault));
            }
        }
        plant.end_of_tick();
    }
    let counters = node.counters();
    println!(
        "{} frames received, {} gaps in their counters",
        counters.received, counters.gaps
    );
}
