//! The state machine of the protocol: one command a tick in, one answer out, and the lists that run.
//!
//! ```text
//!                 CONNECT
//!   disconnected ---------> connected: every command is answered in the tick after which it came
//!        ^                     |
//!        +---------------------+  DISCONNECT
//! ```
//!
//! A master sends a command only after the answer to the one before (standard communication model, without block transfer and
//! interleaving). A frame that comes while another waits is therefore left out and counted.

use heapless::Vec;
use oleo_controller::Builder;
#[cfg(feature = "calibration")]
use oleo_controller::Configuration;
use oleo_controller::interface::tick::TICK_MS;

use crate::bus::{Budget, MOST_DATA_FRAMES};
use crate::daq::{Daq, MOST_ENTRY_BYTES, MOST_LISTS};
use crate::measurement::Sample;
use crate::memory::{IDENTITY_ADDRESS, MOST_CHECKED, Memory};
use crate::packet::{MOST_BYTES, NEGATIVE, POSITIVE, Packet, Refusal, Request, command, packet, refused};

/// Most frames that the slave sends in a tick: an answer, and measured data.
pub const MOST_SENT: usize = MOST_DATA_FRAMES + 1;

/// Version of protocol layer and transport layer, each: 1.x.
const VERSION: u8 = 0x01;
/// Unit of the time stamps: a millisecond, of which a tick has [`TICK_MS`].
const UNIT_MS: u8 = 6;
/// Time stamps have two bytes.
const STAMP_WORD: u8 = 0x02;
const CHECKSUM_CRC_32: u8 = 0x09;
/// The one event: the end of a tick.
const EVENTS: u16 = 1;
const EVENT_NAME: &[u8] = b"tick";

const RESOURCE_CALIBRATION: u8 = 0x01;
const RESOURCE_DAQ: u8 = 0x04;
const OPTIONAL_COMMANDS: u8 = 0x80;
const STATUS_DAQ_RUNNING: u8 = 0x40;
/// Dynamic configuration, prescaler, time stamps; no overload indication.
const DAQ_PROPERTIES: u8 = 0x01 | 0x02 | 0x10;
/// A list of measured data; consistent within the event.
const EVENT_PROPERTIES: u8 = 0x04 | 0x80;

/// What the slave did not do, for statistics. The counters wrap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Commands that came before the one before was answered.
    pub commands_left_out: u32,
    /// Samples of a list that found no room in the queue.
    pub samples_left_out: u32,
    /// Values that were written.
    pub written: u32,
}

/// Where UPLOAD reads and DOWNLOAD writes next.
#[derive(Clone, Copy, Debug)]
enum Transfer {
    Memory(u32),
    /// The name of the event, which has no address.
    EventName(u32),
}

/// An XCP slave for one controller.
///
/// ```
/// use oleo_controller::{Builder, Inputs, Outputs};
/// use oleo_xcp::{Budget, Sample, Slave};
/// let mut slave = Slave::new(Builder::default(), Budget::at(500_000));
/// let (inputs, outputs) = (Inputs::default(), Outputs::default());
/// let sample = Sample { tick: 0, plant_tick: 0, inputs: &inputs, outputs: &outputs, writable: false };
///
/// slave.receive(&[0xFF, 0x00]); // CONNECT
/// let sent = slave.end_of_tick(&sample);
/// assert_eq!(sent[0].as_slice(), [0xFF, 0x04, 0x80, 8, 8, 0, 1, 1]); // only measurement; eight bytes a packet
///
/// slave.receive(&[0xF4, 1, 0, 0, 0x04, 0x10, 0, 0]); // SHORT_UPLOAD of one byte at 0x1004
/// assert_eq!(slave.end_of_tick(&sample)[0].as_slice(), [0xFF, 0]);
/// ```
#[derive(Clone, Debug)]
pub struct Slave {
    budget: Budget,
    builder: Builder,
    memory: Memory,
    daq: Daq,
    connected: bool,
    transfer: Transfer,
    tick: u32,
    request: Option<Packet>,
    counters: Counters,
    #[cfg(feature = "calibration")]
    may_write: bool,
    #[cfg(feature = "calibration")]
    changed: Option<Configuration>,
}

impl Slave {
    /// A slave that nothing is connected to, for a controller that was built from this, and a bus with this much room. It does not
    /// write.
    pub fn new(builder: Builder, budget: Budget) -> Self {
        Self {
            budget,
            builder,
            memory: Memory::new(builder),
            daq: Daq::new(budget.data_frames()),
            connected: false,
            transfer: Transfer::Memory(0),
            tick: 0,
            request: None,
            counters: Counters::default(),
            #[cfg(feature = "calibration")]
            may_write: false,
            #[cfg(feature = "calibration")]
            changed: None,
        }
    }

    /// The same, and a tool may write the parameters as the module `calibration` says.
    #[cfg(feature = "calibration")]
    #[must_use]
    pub fn writable(mut self) -> Self {
        self.may_write = true;
        self
    }

    /// The controller was restarted: nothing is connected any more, and the tuning is that of the start.
    pub fn restart(&mut self) {
        let fresh = Self::new(self.builder, self.budget);
        *self = Self {
            counters: self.counters,
            #[cfg(feature = "calibration")]
            may_write: self.may_write,
            ..fresh
        };
    }

    /// Takes a frame with [`REQUEST_ID`](crate::REQUEST_ID). It is answered at the end of the tick.
    pub fn receive(&mut self, data: &[u8]) {
        if self.request.is_some() {
            self.counters.commands_left_out = self.counters.commands_left_out.wrapping_add(1);
        } else if !data.is_empty() && data.len() <= MOST_BYTES {
            self.request = Some(packet(data));
        }
    }

    /// Ends a tick: takes copies of what the controller was told and decided, answers the command that came, and returns what is to be
    /// sent, with [`RESPONSE_ID`](crate::RESPONSE_ID).
    pub fn end_of_tick(&mut self, sample: &Sample) -> Vec<Packet, MOST_SENT> {
        self.tick = sample.tick;
        self.memory.measured.update(sample);
        let mut sent = Vec::new();
        // There is room for an answer and for as much data as a budget ever permits.
        if let Some(answer) = self.request.take().and_then(|request| self.answered(&request, sample)) {
            let _ = sent.push(answer);
        }
        self.daq.sample(&self.memory, sample.tick);
        self.daq.send(|packet| {
            let _ = sent.push(packet);
        });
        sent
    }

    /// The configuration that a tool has asked for in this tick. It is the caller's to give it to the controller before the next tick.
    #[cfg(feature = "calibration")]
    pub fn take_changed(&mut self) -> Option<Configuration> {
        self.changed.take()
    }

    /// Whether a tool is connected.
    pub fn is_connected(&self) -> bool {
        self.connected
    }

    /// What was not done, since the start.
    pub fn counters(&self) -> Counters {
        Counters {
            samples_left_out: self.daq.left_out(),
            ..self.counters
        }
    }

    fn answered(&mut self, request: &[u8], sample: &Sample) -> Option<Packet> {
        let request = Request(request);
        let code = request.byte(0);
        if code == command::CONNECT {
            // The other mode is for a special purpose that this slave does not have; it does not answer it.
            return (request.byte(1) == 0).then(|| self.connect());
        }
        if !self.connected {
            return None;
        }
        Some(match self.execute(code, request, sample) {
            Ok(answer) => answer,
            // Of a block that is too large, the largest is told.
            Err(Refusal::OutOfRange) if code == command::BUILD_CHECKSUM => {
                let [a, b, c, d] = MOST_CHECKED.to_le_bytes();
                packet(&[NEGATIVE, Refusal::OutOfRange as u8, 0, 0, a, b, c, d])
            }
            Err(why) => refused(why),
        })
    }

    fn connect(&mut self) -> Packet {
        // A tool that connects again begins anew.
        self.disconnect();
        self.connected = true;
        let resources = RESOURCE_DAQ | if self.writes() { RESOURCE_CALIBRATION } else { 0 };
        let most = MOST_BYTES as u8;
        packet(&[POSITIVE, resources, OPTIONAL_COMMANDS, most, most, 0, VERSION, VERSION])
    }

    fn disconnect(&mut self) {
        self.connected = false;
        self.transfer = Transfer::Memory(0);
        self.daq.free();
    }

    fn writes(&self) -> bool {
        #[cfg(feature = "calibration")]
        return self.may_write;
        #[cfg(not(feature = "calibration"))]
        false
    }

    fn execute(&mut self, code: u8, request: Request, sample: &Sample) -> Result<Packet, Refusal> {
        let done = packet(&[POSITIVE]);
        match code {
            command::DISCONNECT => {
                self.disconnect();
                Ok(done)
            }
            command::GET_STATUS => {
                let status = if self.daq.is_running() { STATUS_DAQ_RUNNING } else { 0 };
                Ok(packet(&[POSITIVE, status, 0, 0, 0, 0]))
            }
            command::SYNCH => Err(Refusal::Synchronised),
            command::GET_COMM_MODE_INFO => Ok(packet(&[POSITIVE, 0, 0, 0, 0, 0, 0, VERSION << 4])),
            command::GET_ID => self.identification(request.needs(2)?.byte(1)),
            command::SET_MTA => {
                let request = request.needs(8)?;
                self.transfer = Transfer::Memory(address(request.byte(3), request.double_word(4))?);
                Ok(done)
            }
            command::UPLOAD => self.upload(request.needs(2)?.byte(1)),
            command::SHORT_UPLOAD => {
                let request = request.needs(8)?;
                self.transfer = Transfer::Memory(address(request.byte(3), request.double_word(4))?);
                self.upload(request.byte(1))
            }
            command::BUILD_CHECKSUM => {
                let bytes = request.needs(8)?.double_word(4);
                let Transfer::Memory(from) = self.transfer else {
                    return Err(Refusal::AccessDenied);
                };
                let [a, b, c, d] = self.memory.checksum(from, bytes)?.to_le_bytes();
                self.transfer = Transfer::Memory(from.saturating_add(bytes));
                Ok(packet(&[POSITIVE, CHECKSUM_CRC_32, 0, 0, a, b, c, d]))
            }
            command::DOWNLOAD => self.download(request.needs(3)?, sample).map(|()| done),
            _ => self.execute_daq(code, request),
        }
    }

    /// Commands of the optional part for measured data.
    fn execute_daq(&mut self, code: u8, request: Request) -> Result<Packet, Refusal> {
        let done = packet(&[POSITIVE]);
        match code {
            command::GET_DAQ_PROCESSOR_INFO => {
                let [low, high] = (MOST_LISTS as u16).to_le_bytes();
                let [events, more_events] = EVENTS.to_le_bytes();
                Ok(packet(&[
                    POSITIVE,
                    DAQ_PROPERTIES,
                    low,
                    high,
                    events,
                    more_events,
                    0,
                    0,
                ]))
            }
            command::GET_DAQ_RESOLUTION_INFO => {
                let [ticks, more_ticks] = (TICK_MS as u16).to_le_bytes();
                let largest = MOST_ENTRY_BYTES as u8;
                let stamp = UNIT_MS << 4 | STAMP_WORD;
                Ok(packet(&[POSITIVE, 1, largest, 1, 0, stamp, ticks, more_ticks]))
            }
            command::GET_DAQ_EVENT_INFO => {
                event(request.needs(4)?.word(2))?;
                self.transfer = Transfer::EventName(0);
                let (lists, name) = (MOST_LISTS as u8, EVENT_NAME.len() as u8);
                Ok(packet(&[
                    POSITIVE,
                    EVENT_PROPERTIES,
                    lists,
                    name,
                    TICK_MS as u8,
                    UNIT_MS,
                    0,
                ]))
            }
            command::GET_DAQ_CLOCK => {
                let [a, b, c, d] = self.tick.to_le_bytes();
                Ok(packet(&[POSITIVE, 0, 0, 0, a, b, c, d]))
            }
            command::FREE_DAQ => {
                self.daq.free();
                Ok(done)
            }
            command::ALLOC_DAQ => self.daq.allocate_lists(request.needs(4)?.word(2)).map(|()| done),
            command::ALLOC_ODT => {
                let request = request.needs(5)?;
                self.daq.allocate_odts(request.word(2), request.byte(4)).map(|()| done)
            }
            command::ALLOC_ODT_ENTRY => {
                let request = request.needs(6)?;
                self.daq
                    .allocate_entries(request.word(2), request.byte(4), request.byte(5))
                    .map(|()| done)
            }
            command::SET_DAQ_PTR => {
                let request = request.needs(6)?;
                self.daq
                    .point(request.word(2), request.byte(4), request.byte(5))
                    .map(|()| done)
            }
            command::WRITE_DAQ => {
                let request = request.needs(8)?;
                let address = address(request.byte(3), request.double_word(4))?;
                self.daq
                    .write(&self.memory, request.byte(1), request.byte(2), address)
                    .map(|()| done)
            }
            command::SET_DAQ_LIST_MODE => {
                let request = request.needs(8)?;
                event(request.word(4))?;
                self.daq
                    .set_mode(request.word(2), request.byte(1), request.byte(6))
                    .map(|()| done)
            }
            command::GET_DAQ_LIST_MODE => {
                let (mode, prescaler) = self.daq.mode(request.needs(4)?.word(2))?;
                Ok(packet(&[POSITIVE, mode, 0, 0, 0, 0, prescaler, 0]))
            }
            command::START_STOP_DAQ_LIST => {
                let request = request.needs(4)?;
                let list = request.word(2);
                match request.byte(1) {
                    0 => self.daq.stop(list)?,
                    1 => self.daq.start(list)?,
                    2 => self.daq.select(list)?,
                    _ => return Err(Refusal::ModeNotValid),
                }
                Ok(packet(&[POSITIVE, self.daq.first_identifier(list)?]))
            }
            command::START_STOP_SYNCH => {
                match request.needs(2)?.byte(1) {
                    0 => self.daq.stop_all(),
                    1 => self.daq.start_selected()?,
                    2 => self.daq.stop_selected(),
                    _ => return Err(Refusal::ModeNotValid),
                }
                Ok(done)
            }
            _ => Err(Refusal::UnknownCommand),
        }
    }

    /// The texts by which this slave is known: type 0 its own, type 1 the name of the description file.
    fn identification(&mut self, kind: u8) -> Result<Packet, Refusal> {
        let bytes = match kind {
            0 => self.memory.identity_bytes(),
            // The text begins with the name of the file, `oleo`.
            1 => 4,
            _ => 0,
        };
        if bytes > 0 {
            self.transfer = Transfer::Memory(IDENTITY_ADDRESS);
        }
        let [a, b, c, d] = bytes.to_le_bytes();
        Ok(packet(&[POSITIVE, 0, 0, 0, a, b, c, d]))
    }

    fn upload(&mut self, bytes: u8) -> Result<Packet, Refusal> {
        if bytes == 0 || usize::from(bytes) >= MOST_BYTES {
            return Err(Refusal::OutOfRange);
        }
        let count = u32::from(bytes);
        let (data, next) = match self.transfer {
            Transfer::Memory(from) => (
                self.memory.read(from, count)?,
                Transfer::Memory(from.saturating_add(count)),
            ),
            Transfer::EventName(from) => {
                let piece = EVENT_NAME.get(from as usize..(from + count) as usize);
                (piece.ok_or(Refusal::AccessDenied)?, Transfer::EventName(from + count))
            }
        };
        let mut answer = packet(&[POSITIVE]);
        let _ = answer.extend_from_slice(data);
        self.transfer = next;
        Ok(answer)
    }

    #[cfg(not(feature = "calibration"))]
    #[expect(clippy::unused_self, reason = "the other build writes")]
    fn download(&mut self, _: Request, _: &Sample) -> Result<(), Refusal> {
        Err(Refusal::WriteProtected)
    }

    #[cfg(feature = "calibration")]
    fn download(&mut self, request: Request, sample: &Sample) -> Result<(), Refusal> {
        if !self.may_write {
            return Err(Refusal::WriteProtected);
        }
        let Transfer::Memory(to) = self.transfer else {
            return Err(Refusal::AccessDenied);
        };
        let count = usize::from(request.byte(1));
        let bytes = request.0.get(2..2 + count).ok_or(Refusal::Syntax)?;
        if !sample.writable {
            return Err(Refusal::TemporarilyNotAccessible);
        }
        self.changed = Some(self.memory.tuning.write(to, bytes)?);
        self.counters.written = self.counters.written.wrapping_add(1);
        self.transfer = Transfer::Memory(to.saturating_add(count as u32));
        Ok(())
    }
}

/// An address with its extension, of which there is only the first.
fn address(extension: u8, address: u32) -> Result<u32, Refusal> {
    if extension == 0 {
        Ok(address)
    } else {
        Err(Refusal::OutOfRange)
    }
}

/// There is only one event.
fn event(number: u16) -> Result<(), Refusal> {
    if number < EVENTS {
        Ok(())
    } else {
        Err(Refusal::OutOfRange)
    }
}
