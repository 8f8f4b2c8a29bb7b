//! What else is served on the bus of the controller's node, beside the controller, such as a tool that looks on.
//!
//! A companion is off the path from sensors to valves: it is asked after the controller has decided and its frames are on their way, and
//! its own frames are sent only where there is room at once. Without one, and with one that only looks on, the commands are the same.

use oleo_controller::{Node, Outputs};

use crate::Frame;

/// Something that answers frames of its own on the controller's bus.
pub trait Companion: Send {
    /// Takes a frame if it is for this companion, and says whether it was.
    fn receive(&mut self, frame: &Frame) -> bool;

    /// Looks at what the controller was told and has decided in a tick, and hands over what is to be sent.
    fn end_of_tick(&mut self, tick: u32, node: &mut Node, outputs: &Outputs, send: &mut dyn FnMut(Frame));

    /// The controller was restarted.
    fn restart(&mut self);
}
