//! The controller as a node on the bus: [`oleo_controller::Node`] with a bus and a clock around it.
//!
//! It is the same code that the firmware runs. This file adds only what a simulation needs: it waits for the plant's tick, and
//! remembers what was commanded.

use std::time::Duration;

use oleo_controller::{Configuration, FaultCode, Mode, Node};

use crate::Frame;
use crate::bus::{Bus, BusCounters, BusError, Trace};
use crate::sync::{Role, Sync};

/// How the wait for the plant ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heard {
    /// The plant has sent all frames of a tick.
    Tick,
    /// The run is over.
    End,
    /// Nothing came for as long as was allowed.
    Nothing,
}

/// The controller behind one end of a bus.
pub struct ControllerNode<B> {
    bus: Trace<B>,
    node: Node,
    tick: u32,
    words: Vec<u16>,
    account: Vec<(u32, Mode, FaultCode)>,
    lost: u16,
    heard_anything: bool,
}

impl<B: Bus> ControllerNode<B> {
    /// A controller that has received nothing, with memory for `ticks` ticks.
    pub fn new(bus: B, configuration: Configuration, ticks: usize) -> Self {
        Self {
            bus: Trace::counting(bus),
            node: Node::new(configuration),
            tick: 0,
            words: Vec::with_capacity(ticks),
            account: Vec::with_capacity(64),
            lost: 0,
            heard_anything: false,
        }
    }

    /// Takes frames until the plant has sent a tick, until the run ends, or until none came for `wait`.
    pub fn listen(&mut self, wait: Duration) -> Result<Heard, BusError> {
        while let Some(frame) = self.bus.receive(wait)? {
            match Sync::decode(&frame, Role::Plant) {
                Some(Sync::TickDone { tick, sent }) => {
                    self.tick = tick;
                    self.note_lost(sent);
                    return Ok(Heard::Tick);
                }
                Some(Sync::End { sent }) => {
                    self.note_lost(sent);
                    return Ok(Heard::End);
                }
                Some(Sync::Hello { .. } | Sync::Tally { .. }) => {}
                None => self.take(&frame),
            }
        }
        Ok(Heard::Nothing)
    }

    fn note_lost(&mut self, sent: u16) {
        self.lost = sent.wrapping_sub(self.bus.messages_received() as u16);
    }

    fn take(&mut self, frame: &Frame) {
        if let Some(id) = frame.standard_id() {
            self.heard_anything = true;
            self.node.receive(id, frame.data());
        }
    }

    /// Whether any frame of a message came since the last call.
    pub fn heard_anything(&mut self) -> bool {
        std::mem::take(&mut self.heard_anything)
    }

    /// One tick: decides, and sends the command.
    pub fn decide(&mut self) -> Result<(), BusError> {
        let (outputs, frames) = self.node.tick();
        let mode = (outputs.mode, outputs.fault);
        if self
            .account
            .last()
            .is_none_or(|(_, mode_before, fault)| (*mode_before, *fault) != mode)
        {
            self.account.push((self.tick, mode.0, mode.1));
        }
        self.words.push(outputs.command.word());
        for frame in frames {
            self.bus.send(&frame.into())?;
        }
        Ok(())
    }

    /// Tells the plant that this tick is answered.
    pub fn send_done(&mut self) -> Result<(), BusError> {
        let sent = self.bus.messages_sent() as u16;
        self.bus
            .send(&Sync::TickDone { tick: self.tick, sent }.encode(Role::Controller))
    }

    /// Answers the end of the run with what was lost.
    pub fn send_tally(&mut self) -> Result<(), BusError> {
        let e2e_errors = u16::try_from(self.e2e_errors()).unwrap_or(u16::MAX);
        let sent = self.bus.messages_sent() as u16;
        self.bus.send(
            &Sync::Tally {
                sent,
                lost: self.lost,
                e2e_errors,
            }
            .encode(Role::Controller),
        )
    }

    /// Begins the next tick without the plant, for when the plant is gone.
    pub fn next_tick(&mut self) {
        self.tick = self.tick.wrapping_add(1);
    }

    /// Sets the number of the tick, which in real time follows the clock.
    pub fn set_tick(&mut self, tick: u32) {
        self.tick = tick;
    }

    /// Number of the last tick.
    pub fn tick(&self) -> u32 {
        self.tick
    }

    /// The present mode and its first cause.
    pub fn mode(&self) -> (Mode, FaultCode) {
        self.account
            .last()
            .map_or((Mode::StartUp, FaultCode::None), |(_, mode, fault)| (*mode, *fault))
    }

    /// Valve words that were commanded, one for each tick.
    pub fn words(&self) -> &[u16] {
        &self.words
    }

    /// Each change of the mode: its tick, the mode and its first cause.
    pub fn account(&self) -> &[(u32, Mode, FaultCode)] {
        &self.account
    }

    /// Number of frames that failed their end-to-end check.
    pub fn e2e_errors(&self) -> u64 {
        let seen = self.node.counters();
        u64::from(seen.wrong_crc) + u64::from(seen.wrong_sequence)
    }

    /// Number of the plant's frames that did not arrive.
    pub fn frames_lost(&self) -> u64 {
        u64::from(self.lost)
    }

    /// Counters of the controller's end of the bus.
    pub fn counters(&self) -> BusCounters {
        self.bus.counters()
    }

    /// The bus through which the node sends and receives.
    pub fn bus(&mut self) -> &mut dyn Bus {
        &mut self.bus
    }
}
