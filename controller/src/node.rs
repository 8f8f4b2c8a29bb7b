//! A controller on a bus: frames in, frames out, one tick at a time.
//!
//! The node owns what the pure [`tick`] must not know: counters, check values, how old a message is. Hosts, the firmware
//! and the tests all use this one, so a rule about messages exists once.
//!
//! A message is *lost* when no usable frame came for its contract's `timeout_ticks`; until then its last values stand in. It is
//! *untrusted* when frames with wrong CRC, repeated or out of sequence outnumber right ones: a counter goes up with each
//! bad and down with each good frame, saturating at [`TRUST_LIMIT`], where trust ends until it is back at 0 (after opendbc's
//! `wrong_counters`, with hysteresis). A lost or untrusted message makes its readings invalid.

use crate::can::{
    COMMAND, CheckStatus, Checker, CommandMessage, DISPLACEMENT, DisplacementMessage, FRAME_BYTES, Frame, PRESSURE,
    PressureMessage, Protector, SENSOR_MESSAGES, STATUS, StatusMessage,
};
use crate::configuration::Configuration;
use crate::reading::{Inputs, Reading};
use crate::tick::{Outputs, State, tick};
use crate::timing::TICK_MS;
use heapless::Vec;

/// Bad frames, less good ones, at which a message is no longer trusted.
pub const TRUST_LIMIT: u8 = 5;

/// Frames a tick can send: the command, and every 100 ms the status.
pub const MAX_SENT: usize = 2;

const STATUS_TICKS: u32 = STATUS.period_ms / TICK_MS;

/// Receive side of one sensor message.
#[derive(Clone, Copy, Debug)]
struct Receiver {
    checker: Checker,
    timeout_ticks: u8,
    /// Ticks since the last usable frame, saturating.
    age: u8,
    fresh: bool,
    bad: u8,
    untrusted: bool,
}

impl Receiver {
    const fn new(contract: &crate::can::Contract) -> Self {
        Self {
            checker: Checker::new(contract),
            timeout_ticks: contract.timeout_ticks,
            age: contract.timeout_ticks,
            fresh: false,
            bad: 0,
            untrusted: false,
        }
    }

    fn receive(&mut self, data: &[u8; FRAME_BYTES]) -> CheckStatus {
        let status = self.checker.check(data);
        if status.is_usable() {
            self.fresh = true;
            self.age = 0;
            self.bad = self.bad.saturating_sub(1);
            if self.bad == 0 {
                self.untrusted = false;
            }
        } else if status.is_error() {
            self.bad = self.bad.saturating_add(1).min(TRUST_LIMIT);
            if self.bad == TRUST_LIMIT {
                self.untrusted = true;
            }
        }
        status
    }

    /// Ends the tick's reception; whether the content must not be used.
    fn end_of_tick(&mut self) -> bool {
        if !core::mem::take(&mut self.fresh) {
            self.checker.no_new_data();
            self.age = self.age.saturating_add(1);
        }
        self.untrusted || self.age >= self.timeout_ticks
    }
}

/// What has been seen on the bus, for statistics. Wrapping counters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BusCounters {
    /// Frames of the controller's messages.
    pub received: u32,
    /// Frames with other identifiers, ignored.
    pub foreign: u32,
    /// Frames with wrong length or CRC.
    pub wrong_crc: u32,
    /// Frames repeated or out of sequence.
    pub wrong_sequence: u32,
    /// Gaps seen in counters.
    pub gaps: u32,
}

/// Configuration, state, and both directions of the bus.
#[derive(Clone, Debug)]
pub struct Node {
    configuration: Configuration,
    state: State,
    receivers: [Receiver; 6],
    inputs: Inputs,
    echo_tick: u16,
    command: Protector,
    status: Protector,
    status_countdown: u32,
    counters: BusCounters,
}

impl Node {
    /// A node that has heard nothing: valves closed, mode start-up.
    pub fn new(configuration: Configuration) -> Self {
        Self {
            state: State::new(),
            configuration,
            receivers: SENSOR_MESSAGES.map(|contract| Receiver::new(&contract)),
            inputs: Inputs::default(),
            echo_tick: 0,
            command: Protector::new(&COMMAND),
            status: Protector::new(&STATUS),
            status_countdown: 0,
            counters: BusCounters::default(),
        }
    }

    /// Takes a frame from the bus, any number of times between ticks. Foreign identifiers are ignored. Returns the plant tick if the frame is a
    /// rear displacement message with the right CRC, which completes a set in lockstep.
    pub fn receive(&mut self, id: u16, data: &[u8]) -> Option<u16> {
        let index = SENSOR_MESSAGES.iter().position(|contract| contract.id == id);
        let Some((index, receiver)) = index.and_then(|i| Some((i, self.receivers.get_mut(i)?))) else {
            self.counters.foreign = self.counters.foreign.wrapping_add(1);
            return None;
        };
        self.counters.received = self.counters.received.wrapping_add(1);
        // A frame of the wrong length cannot carry the right CRC: same consequence.
        let mut whole = [0xFF; FRAME_BYTES];
        let status = if let Ok(data) = <&[u8; FRAME_BYTES]>::try_from(data) {
            whole = *data;
            receiver.receive(data)
        } else {
            receiver.receive(&whole)
        };
        match status {
            CheckStatus::WrongCrc => {
                self.counters.wrong_crc = self.counters.wrong_crc.wrapping_add(1);
                return None;
            }
            CheckStatus::Repeated | CheckStatus::WrongSequence => {
                self.counters.wrong_sequence = self.counters.wrong_sequence.wrapping_add(1);
            }
            CheckStatus::OkSomeLost => self.counters.gaps = self.counters.gaps.wrapping_add(1),
            CheckStatus::Ok | CheckStatus::Initial | CheckStatus::Sync => {}
        }
        if let Some(axle) = index.checked_sub(PRESSURE.len()) {
            let message = DisplacementMessage::decode(&whole);
            if status.is_usable() {
                let [fl, fr, rl, rr] = &mut self.inputs.displacement;
                let (left, right) = if axle == 0 { (fl, fr) } else { (rl, rr) };
                *left = message.left;
                *right = message.right;
            }
            if axle == DISPLACEMENT.len() - 1 {
                // The echo only says which frame was seen; it needs no sequence.
                self.echo_tick = message.plant_tick;
                return Some(message.plant_tick);
            }
        } else if status.is_usable()
            && let Some(pressure) = self.inputs.pressure.get_mut(index)
        {
            *pressure = PressureMessage::decode(&whole).pressure;
        }
        None
    }

    /// The output stage failed to switch a solenoid: the next tick latches.
    pub fn report_solenoid_failure(&mut self) {
        self.inputs.solenoid_failed = true;
    }

    /// One period: decides, and returns what to send. Call every [`TICK_MS`].
    pub fn tick(&mut self) -> (Outputs, Vec<Frame, MAX_SENT>) {
        let mut inputs = self.inputs;
        for (bit, receiver) in self.receivers.iter_mut().enumerate() {
            if receiver.end_of_tick() {
                inputs.lost_messages |= 1 << bit;
                if let Some(pressure) = inputs.pressure.get_mut(bit) {
                    *pressure = [Reading::INVALID; 4];
                }
            }
        }
        let lost = |axle: usize| inputs.lost_messages & (1 << (PRESSURE.len() + axle)) != 0;
        let [fl, fr, rl, rr] = &mut inputs.displacement;
        if lost(0) {
            (*fl, *fr) = (Reading::INVALID, Reading::INVALID);
        }
        if lost(1) {
            (*rl, *rr) = (Reading::INVALID, Reading::INVALID);
        }

        let outputs = tick(&self.configuration, &mut self.state, &inputs);

        let mut frames = Vec::new();
        let mut send = |id: u16, mut data: [u8; FRAME_BYTES], protector: &mut Protector| {
            protector.protect(&mut data);
            // There is room for as many frames as are ever sent in a tick.
            let _ = frames.push(Frame { id, data });
        };
        let command = CommandMessage {
            command: outputs.command,
            echo_tick: self.echo_tick,
            mode: outputs.mode,
            fault: outputs.fault,
        };
        send(COMMAND.id, command.encode(), &mut self.command);
        if self.status_countdown == 0 {
            self.status_countdown = STATUS_TICKS;
            let status: StatusMessage = outputs.status(inputs.lost_messages);
            send(STATUS.id, status.encode(), &mut self.status);
        }
        self.status_countdown = self.status_countdown.saturating_sub(1);
        (outputs, frames)
    }

    /// Bus statistics since the start.
    pub fn counters(&self) -> BusCounters {
        self.counters
    }

    /// The configuration.
    pub fn configuration(&self) -> &Configuration {
        &self.configuration
    }
}
