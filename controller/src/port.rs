//! The node on a real CAN peripheral, over `embedded_can::nb::Can`: polled, and never blocking.
//!
//! A controller must not wait for its bus. What cannot be sent now waits in a queue of a few frames. When the queue is full, the
//! oldest frame is dropped, because an old command is worth less than a new one. One call takes at most as many frames from the
//! peripheral as the bus can deliver in a tick, so that another node that sends all the time cannot keep the controller from
//! deciding.

use crate::can::{BoardMessage, FRAME_BYTES, Frame};
use crate::failsafe::FaultCode;
use crate::node::Node;
use crate::tick::Outputs;
use embedded_can::{Frame as _, Id, StandardId, nb::Can};
use heapless::Deque;

/// Most frames read in one call of [`Port::poll`]: more than a bus of 1 Mbit/s delivers in a tick (5000 bit times, of which the
/// shortest frame takes 47).
const MOST_RECEIVED: usize = 128;

/// Most frames that wait for the transmitter.
const SEND_QUEUE: usize = 4;

/// What went wrong at the peripheral. The counters wrap. See [`Port`] for an example.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PortCounters {
    /// Number of receive and transmit errors that the peripheral reported.
    pub errors: u32,
    /// Number of frames that were dropped because the transmitter did not take them in time.
    pub dropped: u32,
}

/// A node and its CAN peripheral.
///
/// ```
/// use embedded_can::{ErrorKind, Id, nb::Can};
/// use oleo_controller::{Configuration, Mode, Node, Port};
///
/// #[derive(Clone)]
/// struct Frame(Id, [u8; 8]);
/// impl embedded_can::Frame for Frame {
///     fn new(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
///         Some(Self(id.into(), data.try_into().ok()?))
///     }
///     fn new_remote(_: impl Into<Id>, _: usize) -> Option<Self> {
///         None
///     }
///     fn is_extended(&self) -> bool {
///         matches!(self.0, Id::Extended(_))
///     }
///     fn is_remote_frame(&self) -> bool {
///         false
///     }
///     fn id(&self) -> Id {
///         self.0
///     }
///     fn dlc(&self) -> usize {
///         8
///     }
///     fn data(&self) -> &[u8] {
///         &self.1
///     }
/// }
///
/// /// A peripheral on a bus without any other node.
/// struct QuietBus {
///     sent: usize,
/// }
/// impl Can for QuietBus {
///     type Frame = Frame;
///     type Error = ErrorKind;
///     fn transmit(&mut self, _: &Frame) -> nb::Result<Option<Frame>, ErrorKind> {
///         self.sent += 1;
///         Ok(None)
///     }
///     fn receive(&mut self) -> nb::Result<Frame, ErrorKind> {
///         Err(nb::Error::WouldBlock)
///     }
/// }
///
/// let mut port = Port::new(QuietBus { sent: 0 }, Node::new(Configuration::defender110()));
/// let outputs = port.tick();
/// assert_eq!(outputs.mode, Mode::StartUp); // no sensor has been heard
/// assert_eq!(port.can_mut().sent, 2); // the command and the status
/// assert_eq!((port.counters().errors, port.counters().dropped), (0, 0));
/// ```
#[derive(Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Port<C: Can> {
    can: C,
    node: Node,
    queue: Deque<Frame, SEND_QUEUE>,
    counters: PortCounters,
}

impl<C: Can> Port<C> {
    /// A node on a peripheral that is already on the bus.
    pub fn new(can: C, node: Node) -> Self {
        Self {
            can,
            node,
            queue: Deque::new(),
            counters: PortCounters::default(),
        }
    }

    /// Moves waiting frames in and out, and returns at once. Call it as often as there is time. Extended frames, remote frames and
    /// frames with other identifiers are ignored.
    pub fn poll(&mut self) {
        for _ in 0..MOST_RECEIVED {
            match self.can.receive() {
                Ok(frame) => {
                    if let (Id::Standard(id), false) = (frame.id(), frame.is_remote_frame()) {
                        self.node.receive(id.as_raw(), frame.data());
                    }
                }
                Err(nb::Error::WouldBlock) => break,
                Err(nb::Error::Other(_)) => {
                    // The frame is lost, which the counter of its message will show. Trying again at once could go on for
                    // ever.
                    self.counters.errors = self.counters.errors.wrapping_add(1);
                    break;
                }
            }
        }
        self.send();
    }

    /// One period: reads what has come, decides, and hands the frames to the transmitter. Call it every
    /// [`TICK_MS`](oleo_interface::tick::TICK_MS).
    pub fn tick(&mut self) -> Outputs {
        self.poll();
        let outputs = self.node.tick_and_send(|frame| {
            if self.queue.is_full() {
                self.queue.pop_front();
                self.counters.dropped = self.counters.dropped.wrapping_add(1);
            }
            // There is room now.
            let _ = self.queue.push_back(frame);
        });
        self.send();
        outputs
    }

    /// Latches the safe state, see [`State::latch`](crate::State::latch).
    pub fn latch(&mut self, cause: FaultCode) {
        self.node.latch(cause);
    }

    /// Reports that the output stage could not switch a solenoid. The next tick latches.
    pub fn report_solenoid_failure(&mut self) {
        self.node.report_solenoid_failure();
    }

    /// Says what the board knows of itself, see [`Node::report_board`].
    pub fn report_board(&mut self, state: BoardMessage) {
        self.node.report_board(state);
    }

    /// The port whose node has a configuration, see [`Node::under`].
    #[cfg(feature = "serde")]
    #[must_use]
    pub fn under(self, configuration: crate::Configuration) -> Self {
        Self {
            node: self.node.under(configuration),
            ..self
        }
    }

    /// Error counts since the start.
    pub fn counters(&self) -> PortCounters {
        self.counters
    }

    /// The node that runs behind this port.
    pub fn node(&self) -> &Node {
        &self.node
    }

    /// The CAN peripheral, to look at.
    pub fn can(&self) -> &C {
        &self.can
    }

    /// The CAN peripheral, for its own settings and its error counters.
    pub fn can_mut(&mut self) -> &mut C {
        &mut self.can
    }

    fn send(&mut self) {
        while let Some(frame) = self.queue.front() {
            let Some(out) = to_peripheral::<C>(frame.id, &frame.data) else {
                self.queue.pop_front();
                continue;
            };
            match self.can.transmit(&out) {
                // A frame that this one displaced from a mailbox has a lower priority. It belongs to an older tick and is not
                // sent again.
                Ok(displaced) => {
                    if displaced.is_some() {
                        self.counters.dropped = self.counters.dropped.wrapping_add(1);
                    }
                    self.queue.pop_front();
                }
                Err(nb::Error::WouldBlock) => break,
                Err(nb::Error::Other(_)) => {
                    self.counters.errors = self.counters.errors.wrapping_add(1);
                    break;
                }
            }
        }
    }
}

fn to_peripheral<C: Can>(id: u16, data: &[u8; FRAME_BYTES]) -> Option<C::Frame> {
    C::Frame::new(StandardId::new(id)?, data)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::can::COMMAND;
    use crate::{Configuration, Corners, Gauge, Inputs, Mode, PlantEnd, StrutPressures};
    use std::collections::VecDeque;
    use std::vec::Vec;

    #[derive(Clone, Debug)]
    struct TestFrame {
        id: Id,
        data: Vec<u8>,
    }

    impl embedded_can::Frame for TestFrame {
        fn new(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
            Some(Self {
                id: id.into(),
                data: data.to_vec(),
            })
        }
        fn new_remote(_: impl Into<Id>, _: usize) -> Option<Self> {
            None
        }
        fn is_extended(&self) -> bool {
            matches!(self.id, Id::Extended(_))
        }
        fn is_remote_frame(&self) -> bool {
            false
        }
        fn id(&self) -> Id {
            self.id
        }
        fn dlc(&self) -> usize {
            self.data.len()
        }
        fn data(&self) -> &[u8] {
            &self.data
        }
    }

    #[derive(Debug, Default)]
    struct TestCan {
        incoming: VecDeque<Result<TestFrame, ()>>,
        sent: Vec<TestFrame>,
        room: usize,
        /// Whether the next transmission fails.
        broken: bool,
        /// Whether each frame displaces another one from its mailbox.
        displaces: bool,
    }

    impl Can for TestCan {
        type Frame = TestFrame;
        type Error = embedded_can::ErrorKind;
        fn transmit(&mut self, frame: &TestFrame) -> nb::Result<Option<TestFrame>, Self::Error> {
            if core::mem::take(&mut self.broken) {
                return Err(nb::Error::Other(embedded_can::ErrorKind::Other));
            }
            if self.room == 0 {
                return Err(nb::Error::WouldBlock);
            }
            self.room -= 1;
            self.sent.push(frame.clone());
            Ok(self.displaces.then(|| frame.clone()))
        }
        fn receive(&mut self) -> nb::Result<TestFrame, Self::Error> {
            match self.incoming.pop_front() {
                Some(Ok(frame)) => Ok(frame),
                Some(Err(())) => Err(nb::Error::Other(embedded_can::ErrorKind::Crc)),
                None => Err(nb::Error::WouldBlock),
            }
        }
    }

    fn port() -> Port<TestCan> {
        Port::new(
            TestCan {
                room: usize::MAX,
                ..TestCan::default()
            },
            Node::new(Configuration::defender110()),
        )
    }

    #[test]
    fn frames_reach_the_node_and_commands_the_bus() {
        let (mut port, mut plant) = (port(), PlantEnd::new());
        let inputs = Inputs::from_values(Corners::splat(0.0), Corners::splat(StrutPressures::splat(Gauge(2.0e6))));
        let mut mode = Mode::StartUp;
        let command_id = Id::Standard(StandardId::new(COMMAND.id).unwrap());
        for n in 0..60 {
            for frame in plant.encode(n, &inputs) {
                let frame = TestFrame::new(StandardId::new(frame.id).unwrap(), &frame.data).unwrap();
                port.can_mut().incoming.push_back(Ok(frame));
            }
            mode = port.tick().mode;
            if let Some(command) = port.can().sent.iter().rfind(|frame| frame.id == command_id) {
                plant.receive(COMMAND.id, &command.data);
            }
        }
        assert_eq!(mode, Mode::Normal);
        let commands = port.can.sent.iter().filter(|f| f.id == command_id).count();
        assert_eq!((commands, port.can.sent.len()), (60, 63));
    }

    #[test]
    fn a_blocked_transmitter_costs_old_frames_not_time() {
        let mut port = port();
        port.can_mut().room = 0;
        for _ in 0..20 {
            port.tick();
        }
        assert_eq!(port.counters().dropped, 21 - SEND_QUEUE as u32);
        port.can_mut().room = usize::MAX;
        port.poll();
        assert_eq!(port.can.sent.len(), SEND_QUEUE);
    }

    #[test]
    fn a_receive_error_does_not_spin() {
        let mut port = port();
        port.can_mut().incoming.extend([Err(()), Err(()), Err(())]);
        port.poll();
        assert_eq!((port.counters().errors, port.can.incoming.len()), (1, 2));
    }

    /// A frame that could not be sent is sent again with the next chance; the error and each displaced frame are counted.
    #[test]
    fn a_transmit_error_loses_no_frame_and_does_not_spin() {
        let mut port = port();
        port.can_mut().broken = true;
        port.tick();
        assert_eq!((port.counters().errors, port.can.sent.len()), (1, 0));
        port.can_mut().displaces = true;
        port.poll();
        assert_eq!(
            (port.counters().errors, port.can.sent.len()),
            (1, 2),
            "command and status"
        );
        assert_eq!(port.counters().dropped, 2);
    }

    #[test]
    fn what_is_reported_from_outside_reaches_the_node() {
        let mut first = port();
        first.latch(FaultCode::BusSilent);
        let outputs = first.tick();
        assert_eq!((outputs.mode, outputs.fault), (Mode::Latched, FaultCode::BusSilent));
        let mut second = port();
        second.report_solenoid_failure();
        let outputs = second.tick();
        assert_eq!((outputs.mode, outputs.fault), (Mode::Latched, FaultCode::Solenoid));
        second.can_mut().incoming.push_back(Ok(TestFrame {
            id: Id::Standard(StandardId::MAX),
            data: Vec::new(),
        }));
        second.poll();
        assert_eq!(second.node().counters().foreign, 1);
        let mut third = port();
        third.report_board(crate::can::BoardMessage::default());
        third.tick();
        let board = Id::Standard(StandardId::new(crate::can::BOARD.id).unwrap());
        assert!(third.can.sent.iter().any(|frame| frame.id == board));
    }

    #[cfg(all(feature = "serde", feature = "comparison"))]
    #[test]
    fn a_saved_port_goes_on_under_another_configuration() {
        let soft = Configuration::defender110().with_strategy(crate::Strategy::AlwaysSoft);
        let (mut port, mut plant) = (port().under(soft), PlantEnd::new());
        let inputs = Inputs::from_values(Corners::splat(0.0), Corners::splat(StrutPressures::splat(Gauge(2.0e6))));
        let mut command = crate::ValveCommand::SAFE;
        for n in 0..200 {
            for frame in plant.encode(n, &inputs) {
                let frame = TestFrame::new(StandardId::new(frame.id).unwrap(), &frame.data).unwrap();
                port.can_mut().incoming.push_back(Ok(frame));
            }
            command = port.tick().command;
            assert_eq!(port.node().plant_tick(), n as u8);
            let command_id = Id::Standard(StandardId::new(COMMAND.id).unwrap());
            if let Some(command) = port.can().sent.iter().rfind(|frame| frame.id == command_id) {
                plant.receive(COMMAND.id, &command.data);
            }
            plant.end_of_tick();
        }
        assert_eq!(command, crate::ValveCommand::SOFT);
    }
}
