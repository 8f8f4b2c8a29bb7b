//! The controller as a node on the bus: [`oleo_controller::Node`] with a bus and a clock around it.
//!
//! It is the same code that the firmware runs. What is added here is only what a simulation needs: waiting for the
//! plant's tick, and remembering what was commanded.

use std::time::Duration;

use oleo_controller::{Configuration, FaultCode, Mode, Node};

use crate::Frame;
use crate::bus::{Bus, BusCounters, BusError, Trace};
use crate::sync::{Role, Sync};

/// What a wait for the plant ended with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heard {
    /// The plant has sent all of a tick.
    Tick,
    /// The run is over.
    End,
    /// Nothing for as long as was allowed.
    Nothing,
}

/// Controller behind one end of a bus.
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
    /// A controller that has heard nothing. `ticks`: room for that many without allocation.
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

    /// Takes frames until the plant has done its tick, the run ends, or none came for `wait`.
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

    /// Whether any frame came since this was last asked.
    pub fn heard_anything(&mut self) -> bool {
        std::mem::take(&mut self.heard_anything)
    }

    /// One tick: decides and sends.
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

    /// Answers the end of the run.
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

    /// Moves on without the plant, as a controller in a vehicle would: used when the plant is gone.
    pub fn next_tick(&mut self) {
        self.tick = self.tick.wrapping_add(1);
    }

    /// Counts ticks by its own clock, in real time.
    pub fn set_tick(&mut self, tick: u32) {
        self.tick = tick;
    }

    /// The plant's tick that was last answered.
    pub fn tick(&self) -> u32 {
        self.tick
    }

    /// Mode and cause now.
    pub fn mode(&self) -> (Mode, FaultCode) {
        self.account
            .last()
            .map_or((Mode::StartUp, FaultCode::None), |(_, mode, fault)| (*mode, *fault))
    }

    /// Words commanded, one a tick.
    pub fn words(&self) -> &[u16] {
        &self.words
    }

    /// Modes entered, with the tick.
    pub fn account(&self) -> &[(u32, Mode, FaultCode)] {
        &self.account
    }

    /// Frames that failed their end-to-end check.
    pub fn e2e_errors(&self) -> u64 {
        let seen = self.node.counters();
        u64::from(seen.wrong_crc) + u64::from(seen.wrong_sequence)
    }

    /// Frames of the plant that did not arrive.
    pub fn frames_lost(&self) -> u64 {
        u64::from(self.lost)
    }

    /// What the bus counted.
    pub fn counters(&self) -> BusCounters {
        self.bus.counters()
    }

    /// The bus, for the handshake.
    pub fn bus(&mut self) -> &mut dyn Bus {
        &mut self.bus
    }
}
