//! The controller as a node on the bus: [`oleo_controller::Node`] with a bus and a clock around it.
//!
//! It is the same code that the firmware runs. This file adds only what a simulation needs: it waits for the plant's tick, and
//! remembers what was commanded.

use std::time::Duration;

use oleo_controller::{Configuration, FaultCode, Mode, Node, Outputs};

use crate::Frame;
use crate::bus::{Bus, BusCounters, BusError, Trace};
use crate::companion::Companion;
use crate::deadline::Deadline;
use crate::newcomer::Newcomer;
use crate::scenario::{Fault, FaultKind};
use crate::sync::{Decoded, Role, Session, Sync};

/// How the wait for the plant ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heard {
    /// The plant has sent all frames of a tick.
    Tick,
    /// The run is over.
    End,
    /// The plant was started again, and wants another run.
    Restarted,
    /// The plant has ended no tick within the time that was allowed.
    Nothing,
}

/// The controller behind one end of a bus.
pub struct ControllerNode<B> {
    bus: Trace<B>,
    node: Node,
    companion: Option<Box<dyn Companion>>,
    configuration: Configuration,
    /// Faults in which this node restarts.
    restarts: Vec<Fault>,
    e2e_errors_before_restart: u64,
    tick: u32,
    words: Vec<u16>,
    account: Vec<(u32, Mode, FaultCode)>,
    session: Session,
    newcomer: Newcomer,
    in_step: bool,
    /// Messages that had been received when the session began.
    before: u64,
    plant_sent: u64,
    accepted: u32,
}

impl<B: Bus> ControllerNode<B> {
    /// A controller that has received nothing, with memory for `ticks` ticks. Of the faults it takes those in which it restarts.
    pub fn new(bus: B, configuration: Configuration, faults: &[Fault], ticks: usize) -> Self {
        let restarts = faults
            .iter()
            .filter(|fault| fault.kind == FaultKind::ControllerRestarted);
        Self {
            bus: Trace::counting(bus),
            node: Node::new(configuration),
            companion: None,
            configuration,
            restarts: restarts.copied().collect(),
            e2e_errors_before_restart: 0,
            tick: 0,
            words: Vec::with_capacity(ticks),
            account: Vec::with_capacity(64),
            session: Session::default(),
            newcomer: Newcomer::default(),
            in_step: false,
            before: 0,
            plant_sent: 0,
            accepted: 0,
        }
    }

    /// Serves something else on the same bus.
    pub fn serve(&mut self, companion: Box<dyn Companion>) {
        self.companion = Some(companion);
    }

    /// Takes part in a session whose plant is another process.
    pub fn join(&mut self, session: Session) {
        self.session = session;
        self.before = self.bus.messages_received();
    }

    /// Takes frames until the plant has sent a tick or the run ends, but for no longer than `wait`, whatever else comes meanwhile.
    pub fn listen(&mut self, wait: Duration) -> Result<Heard, BusError> {
        let mut deadline = Deadline::new(wait);
        while let Some(left) = deadline.left() {
            let Some(frame) = self.bus.receive(left)? else { break };
            match Sync::decode(&frame, Role::Plant, self.session) {
                Decoded::Partner(Sync::TickDone { tick, sent }) if self.follows(tick) => {
                    self.newcomer.dismiss();
                    self.plant_sent += u64::from(sent.wrapping_sub(self.plant_sent as u16));
                    return Ok(Heard::Tick);
                }
                Decoded::Partner(Sync::End { sent }) => {
                    self.plant_sent = sent;
                    return Ok(Heard::End);
                }
                Decoded::Partner(Sync::Hello { number, .. }) => {
                    if number != self.session.plant && self.newcomer.hello(number) {
                        return Ok(Heard::Restarted);
                    }
                }
                Decoded::Partner(_) | Decoded::Stranger => {}
                Decoded::Other => self.take(&frame),
            }
        }
        Ok(Heard::Nothing)
    }

    /// Whether a tick of the plant comes after the last one; it is then the present one. The first may be any: the plant may have driven on
    /// while this controller was started again.
    fn follows(&mut self, tick: u32) -> bool {
        // The number is sent modulo 2^24; half of that is far more than any gap.
        let ahead = tick.wrapping_sub(self.tick) & 0xFF_FFFF;
        let follows = !self.in_step || (1..1 << 23).contains(&ahead);
        if follows {
            self.tick = self.tick.wrapping_add(ahead);
            self.in_step = true;
        }
        follows
    }

    fn take(&mut self, frame: &Frame) {
        if self
            .companion
            .as_mut()
            .is_some_and(|companion| companion.receive(frame))
        {
            return;
        }
        if let Some(id) = frame.standard_id() {
            self.node.receive(id, frame.data());
        }
    }

    /// Whether a correct message of the plant came since the last call.
    pub fn heard_the_plant(&mut self) -> bool {
        let seen = self.node.counters();
        let accepted = seen
            .received
            .wrapping_sub(seen.wrong_crc)
            .wrapping_sub(seen.wrong_sequence);
        let heard = std::mem::replace(&mut self.accepted, accepted) != accepted;
        if heard {
            self.newcomer.dismiss();
        }
        heard
    }

    /// One tick: decides, and sends the command. A node that is in reset does neither.
    pub fn decide(&mut self) -> Result<(), BusError> {
        if let Some(fault) = self.restarts.iter().find(|fault| fault.is_active(self.tick)) {
            if self.tick + 1 == fault.until_tick {
                self.e2e_errors_before_restart = self.e2e_errors();
                self.node = Node::new(self.configuration);
                self.accepted = 0;
                if let Some(companion) = &mut self.companion {
                    companion.restart();
                }
            }
            self.words.push(0);
            return Ok(());
        }
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
        self.accompany(&outputs)
    }

    /// Lets the companion look at the tick. Nothing waits for its frames: what the bus does not take at once is left out.
    fn accompany(&mut self, outputs: &Outputs) -> Result<(), BusError> {
        let Some(companion) = &mut self.companion else {
            return Ok(());
        };
        let mut offered = Ok(true);
        companion.end_of_tick(self.tick, &mut self.node, outputs, &mut |frame| {
            if offered.is_ok() {
                offered = self.bus.offer(&frame);
            }
        });
        offered.map(drop)
    }

    /// Tells the plant that this tick is answered.
    pub fn send_done(&mut self) -> Result<(), BusError> {
        let sent = self.bus.messages_sent() as u16;
        self.say(Sync::TickDone { tick: self.tick, sent })
    }

    fn say(&mut self, sync: Sync) -> Result<(), BusError> {
        self.bus.send(&sync.encode(Role::Controller, self.session))
    }

    /// Answers the end of the run with what was lost.
    pub fn send_tally(&mut self) -> Result<(), BusError> {
        let e2e_errors = u16::try_from(self.e2e_errors()).unwrap_or(u16::MAX);
        let lost = u32::try_from(self.frames_lost()).unwrap_or(u32::MAX);
        self.say(Sync::Losses { lost, e2e_errors })?;
        let sent = self.bus.messages_sent();
        self.say(Sync::Tally { sent })
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
        self.e2e_errors_before_restart + u64::from(seen.wrong_crc) + u64::from(seen.wrong_sequence)
    }

    /// Number of the plant's frames that did not arrive.
    pub fn frames_lost(&self) -> u64 {
        self.plant_sent
            .saturating_sub(self.bus.messages_received() - self.before)
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
