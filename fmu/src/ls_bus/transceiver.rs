//! The CAN peripheral of a node whose bus is a tool: what `bxCAN` is to the board, bus operations are here.
//!
//! The node behind it is the firmware's [`Port`](oleo_controller::Port), with its short queue of frames that wait. What the peripheral adds is as in the
//! board's hardware: three mailboxes that a frame occupies until the bus has confirmed it, a frame that was destroyed or has lost its arbitration is sent again, and
//! a node with too many errors is silent until it has heard enough of others.
//!
//! All that needs a bus that tells of confirmations and errors. Where the parameter `Can_BusNotifications` is off, every frame counts as sent at once
//! (chapter 4.5.1, "Transmission and Acknowledge").

use std::collections::VecDeque;

use embedded_can::nb::Can;
use embedded_can::{ErrorKind, ExtendedId, Id, StandardId};
use serde::{Deserialize, Serialize};

use super::codec::operations;
use super::confinement::Confinement;
use super::operation::{ArbitrationLost, Identifier, NodeStatus, Operation, Setting};

/// Mailboxes of the board's peripheral.
const MAILBOXES: usize = 3;
/// Received frames that wait for the node; more than a bus delivers between two ticks.
const MOST_WAITING: usize = 1024;
/// Bytes of operations that wait for the tool: what a node sends in the longest step, 10 s.
pub const MOST_SENT: usize = 56 << 10;
/// Most bytes that are given back as unreadable; no operation of CAN is longer.
const MOST_GIVEN_BACK: usize = 4096;

/// A CAN frame.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Frame {
    id: Identifier,
    is_remote: bool,
    length: usize,
    data: Vec<u8>,
}

impl Frame {
    fn operation(&self) -> Operation<'_> {
        Operation::CanTransmit {
            id: self.id,
            remote: self.is_remote,
            data: &self.data,
        }
    }
}

impl embedded_can::Frame for Frame {
    fn new(id: impl Into<Id>, data: &[u8]) -> Option<Self> {
        (data.len() <= 8).then(|| Self {
            id: identifier(id.into()),
            is_remote: false,
            length: data.len(),
            data: data.to_vec(),
        })
    }

    fn new_remote(id: impl Into<Id>, length: usize) -> Option<Self> {
        (length <= 8).then(|| Self {
            id: identifier(id.into()),
            is_remote: true,
            length,
            data: Vec::new(),
        })
    }

    fn is_extended(&self) -> bool {
        matches!(self.id, Identifier::Extended(_))
    }

    fn is_remote_frame(&self) -> bool {
        self.is_remote
    }

    fn id(&self) -> Id {
        match self.id {
            Identifier::Standard(id) => StandardId::new(id).unwrap_or(StandardId::MAX).into(),
            Identifier::Extended(id) => ExtendedId::new(id).unwrap_or(ExtendedId::MAX).into(),
        }
    }

    fn dlc(&self) -> usize {
        self.length
    }

    fn data(&self) -> &[u8] {
        &self.data
    }
}

fn identifier(id: Id) -> Identifier {
    match id {
        Id::Standard(id) => Identifier::Standard(id.as_raw()),
        Id::Extended(id) => Identifier::Extended(id.as_raw()),
    }
}

/// The peripheral.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Transceiver {
    /// The bus tells of confirmations and errors.
    is_notified: bool,
    /// Frames that the bus has not confirmed.
    mailboxes: Vec<Frame>,
    received: VecDeque<Frame>,
    /// More frames came than can wait.
    is_overrun: bool,
    /// Operations that the tool has not taken yet.
    sent: Vec<u8>,
    confinement: Confinement,
    format_errors: u32,
}

impl Transceiver {
    /// A peripheral that asks the bus for a bit rate (bit/s) and a behaviour, and tells that it has had no errors.
    pub fn new(bit_rate: u32, arbitration_lost: ArbitrationLost, is_notified: bool) -> Self {
        let mut transceiver = Self {
            is_notified,
            mailboxes: Vec::new(),
            received: VecDeque::new(),
            is_overrun: false,
            sent: Vec::new(),
            confinement: Confinement::default(),
            format_errors: 0,
        };
        for setting in [
            Setting::CanBitRate(bit_rate),
            Setting::ArbitrationLost(arbitration_lost),
        ] {
            Operation::Configuration(setting).write(&mut transceiver.sent);
        }
        Operation::Status(NodeStatus::ErrorActive).write(&mut transceiver.sent);
        transceiver
    }

    /// Takes operations from the bus.
    pub fn take(&mut self, bytes: &[u8]) {
        for read in operations(bytes) {
            let before = self.confinement.status();
            match read {
                Ok(operation) => self.follow(operation),
                Err(malformed) => {
                    self.format_errors = self.format_errors.saturating_add(1);
                    if !malformed.is_answer() {
                        let data = malformed.bytes.get(..MOST_GIVEN_BACK).unwrap_or(malformed.bytes);
                        self.send(Operation::FormatError { data });
                    }
                }
            }
            self.tell(before);
        }
    }

    /// Operations for the bus, which are then gone from here.
    pub fn take_sent(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.sent)
    }

    /// State on the bus.
    pub fn status(&self) -> NodeStatus {
        self.confinement.status()
    }

    /// Errors of own frames, and of others'.
    pub fn errors(&self) -> (u16, u16) {
        self.confinement.errors()
    }

    /// Operations that one side or the other could not read.
    pub fn format_errors(&self) -> u32 {
        self.format_errors
    }

    fn follow(&mut self, operation: Operation) {
        match operation {
            Operation::CanTransmit { id, remote, data } => {
                let hears = self.status() != NodeStatus::BusOff;
                if self.is_notified {
                    self.confinement.received();
                }
                if hears {
                    self.keep(Frame {
                        id,
                        is_remote: remote,
                        length: data.len(),
                        data: data.to_vec(),
                    });
                }
            }
            Operation::FormatError { .. } => self.format_errors = self.format_errors.saturating_add(1),
            Operation::Confirm { id } if self.is_notified => {
                if let Some(place) = self.mailbox(id) {
                    self.mailboxes.remove(place);
                    self.confinement.confirmed();
                }
            }
            Operation::ArbitrationLost { id } if self.is_notified => self.send_again(id),
            Operation::BusError {
                id,
                code,
                flag,
                is_sender,
            } if self.is_notified => {
                self.confinement.disturbed(code, flag, is_sender);
                if is_sender {
                    self.send_again(id);
                }
            }
            // A node has no use for frames of other kinds, for what other nodes ask of the bus, nor for being woken: it never sleeps.
            _ => {}
        }
    }

    /// Tells the bus when the state has changed. A node that takes part again sends what it could not.
    fn tell(&mut self, before: NodeStatus) {
        let now = self.confinement.status();
        if now == before {
            return;
        }
        self.send(Operation::Status(now));
        if before == NodeStatus::BusOff {
            for frame in self.mailboxes.clone() {
                self.send(frame.operation());
            }
        }
    }

    /// Sends an operation, if there is room. A bus that wants more than fits is no bus.
    fn send(&mut self, operation: Operation) -> bool {
        let before = self.sent.len();
        operation.write(&mut self.sent);
        let fits = self.sent.len() <= MOST_SENT;
        if !fits {
            self.sent.truncate(before);
        }
        fits
    }

    fn keep(&mut self, frame: Frame) {
        if self.received.len() < MOST_WAITING {
            self.received.push_back(frame);
        } else {
            self.is_overrun = true;
        }
    }

    fn mailbox(&self, id: u32) -> Option<usize> {
        self.mailboxes.iter().position(|frame| frame.id.number() == id)
    }

    fn send_again(&mut self, id: u32) {
        if self.status() != NodeStatus::BusOff
            && let Some(frame) = self.mailbox(id).and_then(|place| self.mailboxes.get(place)).cloned()
        {
            self.send(frame.operation());
        }
    }
}

impl Can for Transceiver {
    type Frame = Frame;
    type Error = ErrorKind;

    fn transmit(&mut self, frame: &Frame) -> nb::Result<Option<Frame>, ErrorKind> {
        let is_full = self.mailboxes.len() >= MAILBOXES || self.status() == NodeStatus::BusOff;
        if is_full || !self.send(frame.operation()) {
            return Err(nb::Error::WouldBlock);
        }
        if self.is_notified {
            self.mailboxes.push(frame.clone());
        }
        Ok(None)
    }

    fn receive(&mut self) -> nb::Result<Frame, ErrorKind> {
        if std::mem::take(&mut self.is_overrun) {
            return Err(nb::Error::Other(ErrorKind::Overrun));
        }
        self.received.pop_front().ok_or(nb::Error::WouldBlock)
    }
}

#[cfg(test)]
mod tests {
    use embedded_can::Frame as _;

    use super::super::operation::{ErrorCode, ErrorFlag};
    use super::*;

    fn frame(id: u16) -> Frame {
        Frame::new(StandardId::new(id).unwrap(), &[1, 2, 3]).unwrap()
    }

    fn notified() -> Transceiver {
        let mut transceiver = Transceiver::new(500_000, ArbitrationLost::DiscardAndNotify, true);
        transceiver.take_sent();
        transceiver
    }

    fn bytes(all: &[Operation]) -> Vec<u8> {
        let mut bytes = Vec::new();
        all.iter().for_each(|operation| operation.write(&mut bytes));
        bytes
    }

    fn own_error(id: u32) -> Operation<'static> {
        Operation::BusError {
            id,
            code: ErrorCode::Bit,
            flag: ErrorFlag::Primary,
            is_sender: true,
        }
    }

    #[test]
    fn it_asks_for_its_bus_first() {
        let mut transceiver = Transceiver::new(500_000, ArbitrationLost::BufferAndRetransmit, false);
        let sent = transceiver.take_sent();
        assert_eq!(
            operations(&sent).collect::<Vec<_>>(),
            [
                Ok(Operation::Configuration(Setting::CanBitRate(500_000))),
                Ok(Operation::Configuration(Setting::ArbitrationLost(
                    ArbitrationLost::BufferAndRetransmit
                ))),
                Ok(Operation::Status(NodeStatus::ErrorActive)),
            ]
        );
        assert_eq!(transceiver.take_sent(), []);
    }

    #[test]
    fn a_frame_keeps_its_mailbox_until_it_is_confirmed() {
        let mut transceiver = notified();
        for id in [0x300, 0x0A0, 0x301] {
            assert_eq!(transceiver.transmit(&frame(id)), Ok(None));
        }
        assert_eq!(transceiver.transmit(&frame(0x0A0)), Err(nb::Error::WouldBlock));
        transceiver.take_sent();
        transceiver.take(&bytes(&[
            Operation::Confirm { id: 0x123 },
            Operation::ArbitrationLost { id: 0x0A0 },
        ]));
        assert_eq!(
            transceiver.take_sent(),
            bytes(&[frame(0x0A0).operation()]),
            "it is sent again"
        );
        transceiver.take(&bytes(&[Operation::Confirm { id: 0x0A0 }]));
        assert_eq!(transceiver.transmit(&frame(0x0A0)), Ok(None));
    }

    /// Without a bus that tells of them, confirmations are not waited for and errors are not believed.
    #[test]
    fn without_notifications_a_frame_is_sent_at_once() {
        let mut transceiver = Transceiver::new(500_000, ArbitrationLost::BufferAndRetransmit, false);
        assert!((0..100).all(|_| transceiver.transmit(&frame(0x0A0)) == Ok(None)));
        (0..100).for_each(|_| transceiver.take(&bytes(&[own_error(0x0A0)])));
        assert_eq!(
            (transceiver.errors(), transceiver.status()),
            ((0, 0), NodeStatus::ErrorActive)
        );
    }

    #[test]
    fn a_node_that_is_bus_off_is_silent_and_comes_back() {
        let mut transceiver = notified();
        transceiver.transmit(&frame(0x0A0)).unwrap();
        transceiver.take_sent();
        for errors in 1..=32 {
            transceiver.take(&bytes(&[own_error(0x0A0)]));
            let expected = match errors {
                16 => bytes(&[frame(0x0A0).operation(), Operation::Status(NodeStatus::ErrorPassive)]),
                32 => bytes(&[Operation::Status(NodeStatus::BusOff)]),
                _ => bytes(&[frame(0x0A0).operation()]),
            };
            assert_eq!(transceiver.take_sent(), expected, "error {errors}");
        }
        assert_eq!(transceiver.transmit(&frame(0x300)), Err(nb::Error::WouldBlock));
        let heard = bytes(&[frame(0x110).operation()]);
        (0..127).for_each(|_| transceiver.take(&heard));
        assert_eq!(transceiver.receive(), Err(nb::Error::WouldBlock), "it hears nothing");
        assert_eq!(transceiver.take_sent(), []);
        transceiver.take(&heard);
        let back = bytes(&[Operation::Status(NodeStatus::ErrorActive), frame(0x0A0).operation()]);
        assert_eq!(transceiver.take_sent(), back);
        transceiver.take(&heard);
        assert_eq!(transceiver.receive(), Ok(frame(0x110)));
    }

    #[test]
    fn what_cannot_be_read_is_answered_once() {
        let mut transceiver = notified();
        let unknown = [0x99, 0, 0, 0, 9, 0, 0, 0, 7];
        let cut = &bytes(&[frame(0x110).operation()])[..12];
        transceiver.take(&[&unknown[..], cut].concat());
        let answer = bytes(&[
            Operation::FormatError { data: &unknown },
            Operation::FormatError { data: cut },
        ]);
        assert_eq!(transceiver.take_sent(), answer);
        assert_eq!(transceiver.format_errors(), 2);
        // An answer is counted and not answered, whether it is right or not.
        transceiver.take(&answer);
        transceiver.take(&answer[..answer.len() - 1]);
        assert_eq!((transceiver.take_sent(), transceiver.format_errors()), (vec![], 6));
    }

    /// Whatever a bus asks for, what waits for it has an end.
    #[test]
    fn a_flood_of_what_is_to_be_answered_does_not_fill_the_memory() {
        let mut transceiver = notified();
        transceiver.transmit(&frame(0x0A0)).unwrap();
        let flood = bytes(&[Operation::ArbitrationLost { id: 0x0A0 }; 5000]);
        transceiver.take(&flood);
        transceiver.take(&[0; 1 << 16]);
        assert!((MOST_SENT - 100..=MOST_SENT).contains(&transceiver.take_sent().len()));
        transceiver.take(&[0; 1 << 16]);
        assert_eq!(transceiver.take_sent().len(), 10 + MOST_GIVEN_BACK);
    }

    #[test]
    fn more_than_can_wait_is_an_overrun() {
        let mut transceiver = notified();
        (0..=MOST_WAITING).for_each(|_| transceiver.take(&bytes(&[frame(0x110).operation()])));
        assert_eq!(transceiver.receive(), Err(nb::Error::Other(ErrorKind::Overrun)));
        assert!((0..MOST_WAITING).all(|_| transceiver.receive() == Ok(frame(0x110))));
        assert_eq!(transceiver.receive(), Err(nb::Error::WouldBlock));
    }
}
