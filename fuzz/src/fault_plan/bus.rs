//! What happens to frames between sender and receiver.
//!
//! Forgers know the database, so their frames have the right check values. One of them is less able than an attacker can be: commands are
//! forged only in ticks in which the right one arrives too. Who silences the controller and takes its place cannot be found without a
//! secret (`docs/safety.md`).

use std::collections::VecDeque;

use oleo_controller::can::{
    COMMAND, CommandMessage, DISPLACEMENT, DisplacementMessage, FRAME_BYTES, Frame, PRESSURE, Protector, STATUS,
};
use oleo_controller::{Corners, Gauge, Inputs, Mode, PlantEnd, SensorMessage, StrutPressures, ValveCommand};

use super::plan::{Event, What};

/// A frame on its way. Some have a wrong length.
#[derive(Clone, Copy, Debug)]
pub struct OnBus {
    /// Standard identifier.
    pub id: u16,
    data: [u8; FRAME_BYTES],
    length: usize,
}

impl OnBus {
    /// The bytes that arrive.
    pub fn data(&self) -> &[u8] {
        &self.data[..self.length]
    }
}

impl From<&Frame> for OnBus {
    fn from(&Frame { id, data }: &Frame) -> Self {
        let length = data.len();
        Self { id, data, length }
    }
}

/// What a fault of the bus remembers of the ticks before.
#[derive(Clone, Debug, Default)]
pub struct Memory {
    waiting: VecDeque<Vec<OnBus>>,
    forger: Option<PlantEnd>,
    commander: Option<Protector>,
}

/// The frames that are in the bus' hands in a tick.
pub struct Crossing<'a> {
    /// Number of the tick, as the sensors' node has it.
    pub tick: u32,
    /// The frames; what remains is delivered.
    pub frames: &'a mut Vec<OnBus>,
    /// The sensors' node, as it is before this tick.
    pub sender: &'a PlantEnd,
}

/// Readings of a vehicle that does not exist: nothing in it is out of range.
fn lies(event: &Event) -> Inputs {
    let size = f32::from(event.size) / 255.0;
    let pressure = StrutPressures::splat(Gauge(1.0e6 + 4.0e6 * size));
    Inputs::from_values(Corners::splat(0.06 * size - 0.03), Corners::splat(pressure))
}

fn is_of(event: &Event, frame: &OnBus) -> bool {
    event.message.is_none_or(|message| message.contract().id == frame.id)
}

/// Changes the sensors' frames of a tick as an event does that has been present for `since` ticks.
pub fn spoil_sensors(event: &Event, since: u32, memory: &mut Memory, crossing: &mut Crossing) {
    if since == 0 {
        *memory = Memory::default();
    }
    let Crossing { tick, frames, sender } = crossing;
    match event.what {
        What::Dropped => frames.retain(|frame| !is_of(event, frame)),
        What::Late => hold(usize::from(event.size % 32), memory, frames, |frame| {
            is_of(event, frame)
        }),
        What::Repeated => frames.extend(frames.clone().iter().filter(|frame| is_of(event, frame))),
        What::Corrupted => corrupt(event, since, frames, |frame| is_of(event, frame)),
        What::WrongLength => (frames.iter_mut().filter(|frame| is_of(event, frame)))
            .for_each(|frame| frame.length = usize::from(event.size) % FRAME_BYTES),
        What::ForgedBeside | What::ForgedInstead => {
            let forger = memory.forger.get_or_insert_with(|| {
                let mut forger = **sender;
                for ahead in 0..u32::from(event.size % 4) {
                    forger.encode((*tick + ahead) as u16, &lies(event));
                }
                forger
            });
            let forged = forger.encode(*tick as u16, &lies(event));
            if event.what == What::ForgedInstead {
                frames.retain(|frame| !is_of(event, frame));
            }
            frames.extend(forged.iter().map(OnBus::from).filter(|frame| is_of(event, frame)));
        }
        What::Replayed => {
            let length = 1 + usize::from(event.size % 128);
            if memory.waiting.len() < length {
                memory.waiting.push_back(frames.clone());
            } else if let Some(recorded) = memory.waiting.pop_front() {
                frames.clone_from(&recorded);
                memory.waiting.push_back(recorded);
            }
        }
        What::Misnamed => {
            let mine = SensorMessage::Pressure(event.corner).contract().id;
            let other = PRESSURE.as_array()[usize::from(event.size % 4)].id;
            for frame in frames.iter_mut() {
                if frame.id == mine {
                    frame.id = other;
                } else if frame.id == other {
                    frame.id = mine;
                }
            }
        }
        What::FrozenTick => rewrite(event, frames, |message| message.plant_tick = (*tick - since) as u8),
        What::WrongAnswer => rewrite(event, frames, |message| message.answer ^= event.size | 1),
        What::Strangers => frames.extend((0..event.size % 8).map(|n| OnBus {
            id: 0x400 + u16::from(event.size) + u16::from(n),
            data: [n; FRAME_BYTES],
            length: usize::from(event.size) % (FRAME_BYTES + 1),
        })),
        What::OwnIdentifier => frames.push(OnBus {
            id: [COMMAND.id, STATUS.id][usize::from(event.size & 1)],
            data: [event.size; FRAME_BYTES],
            length: FRAME_BYTES,
        }),
        What::Silence => frames.clear(),
        _ => {}
    }
}

/// Changes the controller's frames of a tick in the same way.
pub fn spoil_commands(event: &Event, since: u32, memory: &mut Memory, crossing: &mut Crossing) {
    if since == 0 {
        *memory = Memory::default();
    }
    let Crossing { tick, frames, sender } = crossing;
    let is_command = |frame: &OnBus| frame.id == COMMAND.id;
    match event.what {
        What::CommandDropped => frames.retain(|frame| !is_command(frame)),
        What::CommandLate => hold(usize::from(event.size % 32), memory, frames, is_command),
        What::CommandCorrupted => corrupt(event, since, frames, is_command),
        What::CommandRepeated => frames.extend(frames.clone().iter().filter(|frame| is_command(frame))),
        What::CommandForged => {
            // As many counters ahead of the right command as the attacker likes.
            let right = frames.iter().find(|frame| is_command(frame)).map(|frame| frame.data);
            if let Some(right) = right {
                let ahead = event.size % 4;
                let commander = memory.commander.get_or_insert_with(|| {
                    let mut commander = Protector::new(&COMMAND);
                    for _ in 0..(right[1] & 0x0F) + 15 + ahead {
                        commander.protect(&mut [0; FRAME_BYTES]);
                    }
                    commander
                });
                let forged = CommandMessage {
                    command: ValveCommand::SOFT,
                    mode: Mode::Normal,
                    echo_tick: *tick as u8,
                    ..CommandMessage::default()
                };
                let mut data = forged.encode();
                commander.protect(&mut data);
                let forged = OnBus {
                    id: COMMAND.id,
                    data,
                    length: FRAME_BYTES,
                };
                let place = if event.size & 4 == 0 { 0 } else { frames.len() };
                frames.insert(place, forged);
            }
        }
        What::SensorIdentifier => {
            let mut forger = **sender;
            let forged = forger.encode(*tick as u16, &lies(event));
            frames.extend(forged.iter().map(OnBus::from).filter(|frame| is_of(event, frame)));
        }
        What::Silence => frames.clear(),
        _ => {}
    }
}

/// Holds frames back for some ticks.
fn hold(ticks: usize, memory: &mut Memory, frames: &mut Vec<OnBus>, concerned: impl Fn(&OnBus) -> bool) {
    let (held, rest) = frames.iter().partition(|frame| concerned(frame));
    *frames = rest;
    memory.waiting.push_back(held);
    if memory.waiting.len() > ticks {
        frames.extend(memory.waiting.pop_front().unwrap_or_default());
    }
}

/// Turns bits over, in each tick another one.
fn corrupt(event: &Event, since: u32, frames: &mut [OnBus], concerned: impl Fn(&OnBus) -> bool) {
    let bit = (since as usize * 37 + usize::from(event.size)) % (8 * FRAME_BYTES);
    for frame in frames.iter_mut().filter(|frame| concerned(frame)) {
        frame.data[bit / 8] ^= 1 << (bit % 8);
    }
}

/// Changes the content of displacement messages, and gives them the check value that fits.
fn rewrite(event: &Event, frames: &mut [OnBus], mut change: impl FnMut(&mut DisplacementMessage)) {
    for (_, contract) in DISPLACEMENT.iter() {
        for frame in frames
            .iter_mut()
            .filter(|frame| frame.id == contract.id && is_of(event, frame))
        {
            let mut message = DisplacementMessage::decode(&frame.data);
            change(&mut message);
            let counter = frame.data[1] & 0x0F;
            let mut data = message.encode();
            let mut sealer = Protector::new(contract);
            for _ in 0..counter + 15 {
                sealer.protect(&mut [0; FRAME_BYTES]);
            }
            sealer.protect(&mut data);
            frame.data = data;
        }
    }
}
