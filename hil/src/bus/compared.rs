//! A controller at the other end of a bus, held against the same controller in this process.
//!
//! The decorator gives everything that it carries to a node of its own, and compares each frame that comes back with the one that this
//! node would have sent: valves, mode, fault, challenge, echo, counter, check value and status. The first difference ends the run.
//! What a board says of itself has no counterpart here: it must be intact and in sequence.

use std::collections::VecDeque;
use std::time::Duration;

use oleo_controller::can::{BOARD, BoardMessage, CheckStatus, Checker};
use oleo_controller::{Configuration, Node};

use super::{Bus, BusCounters, BusError};
use crate::Frame;
use crate::sync::{Decoded, Role, Session, Sync};

/// One end of a bus whose other end is a controller.
pub struct Compared<B> {
    inner: B,
    node: Node,
    expected: VecDeque<Frame>,
    board: Checker,
    tick: u32,
}

impl<B: Bus> Compared<B> {
    /// Compares the controller at the other end with one of this configuration. Both must be new.
    pub fn new(inner: B, configuration: Configuration) -> Self {
        Self {
            inner,
            node: Node::new(configuration),
            expected: VecDeque::new(),
            board: Checker::new(&BOARD),
            tick: 0,
        }
    }
}

impl<B> Compared<B> {
    /// Whether a frame is the intact state of a board. Any other frame is compared.
    fn is_board_state(&mut self, frame: &Frame) -> bool {
        if frame.standard_id() != Some(BOARD.id) {
            return false;
        }
        let Ok(data) = <[u8; 8]>::try_from(frame.data()) else {
            return false;
        };
        let status = self.board.check(&data);
        matches!(status, CheckStatus::Ok | CheckStatus::Initial) && BoardMessage::decode(&data).is_some()
    }
}

impl<B: Bus> Bus for Compared<B> {
    fn begin_tick(&mut self, tick: u32) {
        self.inner.begin_tick(tick);
    }

    fn send(&mut self, frame: &Frame) -> Result<(), BusError> {
        if let Some(id) = frame.standard_id() {
            self.node.receive(id, frame.data());
        } else if let Decoded::Partner(Sync::TickDone { tick, .. }) =
            Sync::decode(frame, Role::Plant, Session::default())
        {
            self.tick = tick;
            let (_, frames) = self.node.tick();
            self.expected.extend(frames.into_iter().map(Frame::from));
        }
        self.inner.send(frame)
    }

    fn receive(&mut self, wait: Duration) -> Result<Option<Frame>, BusError> {
        let received = self.inner.receive(wait)?;
        let Some(frame) = received else { return Ok(None) };
        if self.is_board_state(&frame) {
            return Ok(received);
        }
        let expected = if frame.standard_id().is_some() {
            self.expected.pop_front()
        } else if let Decoded::Partner(Sync::TickDone { .. }) =
            Sync::decode(&frame, Role::Controller, Session::default())
        {
            // All frames of the tick have come.
            match self.expected.pop_front() {
                None => return Ok(received),
                missing => missing,
            }
        } else {
            return Ok(received);
        };
        if expected == received {
            return Ok(received);
        }
        let name = |frame: Option<Frame>| frame.map_or("nothing".to_owned(), |frame| super::slcan_encode(&frame));
        Err(BusError::Differs {
            tick: self.tick,
            sent: name(received).trim_end().to_owned(),
            expected: name(expected).trim_end().to_owned(),
        })
    }

    fn counters(&self) -> BusCounters {
        self.inner.counters()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bus::in_process_pair;
    use crate::frame::standard;

    #[test]
    fn the_same_controller_passes_and_another_word_does_not() {
        let configuration = Configuration::defender110();
        let (near, mut far) = in_process_pair();
        let mut near = Compared::new(near, configuration);
        let mut node = Node::new(configuration);
        for tick in 0..50 {
            near.send(&Frame::whole(standard(0x110), [tick as u8; 8])).unwrap();
            near.send(&Sync::TickDone { tick, sent: 0 }.encode(Role::Plant, Session::default()))
                .unwrap();
            while let Some(frame) = far.receive(Duration::ZERO).unwrap() {
                if let Some(id) = frame.standard_id() {
                    node.receive(id, frame.data());
                }
            }
            for frame in node.tick().1 {
                let frame = Frame::from(frame);
                // In the last tick a valve bit is another one.
                far.send(&if tick == 49 { frame.with_flipped_bit(17) } else { frame })
                    .unwrap();
            }
            far.send(&Sync::TickDone { tick, sent: 0 }.encode(Role::Controller, Session::default()))
                .unwrap();
            let mut received = Ok(None);
            while let Ok(Some(_)) | Ok(None) = received {
                received = near.receive(Duration::ZERO);
                if matches!(received, Ok(None)) {
                    break;
                }
            }
            match received {
                Ok(_) => assert!(tick < 49),
                Err(error) => assert!(tick == 49 && error.to_string().contains("tick 49"), "{error}"),
            }
        }
    }
}
