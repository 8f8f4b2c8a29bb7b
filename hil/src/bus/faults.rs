//! A bus decorator that disturbs frames deliberately and reproducibly.
//!
//! Each [`Injection`] disturbs some messages during some ticks with some probability. Every injection has a random stream of its
//! own (ChaCha8, seeded by the scenario), so that adding one does not change what the others do. Only messages of the vehicle's
//! database are disturbed; all other frames pass.

use std::collections::VecDeque;
use std::time::Duration;

use oleo_controller::can::{BOARD, COMMAND, MESSAGES, STATUS};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use super::recorder::Recorder;
use super::{Bus, BusCounters, BusError};
use crate::Frame;

/// What happens to a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Disturbance {
    /// The frame is dropped.
    Drop,
    /// Some bits of its data, at random places, are inverted.
    Corrupt {
        /// How many bits, 1 or more. A bit that is drawn twice is inverted twice.
        bits: u8,
    },
    /// The frame arrives later, after the other frames of that tick.
    Delay {
        /// Number of ticks by which the frame is late.
        ticks: u16,
    },
    /// The frame arrives twice.
    Duplicate,
    /// Instead of the frame arrives the one that was sent under its identifier so many ticks before, where one was.
    Replay {
        /// Age of what arrives, ticks.
        ticks: u16,
    },
    /// A second sender follows each frame with one of its own: the content of the first frame that it heard, with a counter that is one
    /// ahead and a right CRC.
    Masquerade,
}

/// Frames that a fault disturbs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// Every message of the database.
    All,
    /// The six sensor messages.
    Sensors,
    /// What the controller sends: command, status and the state of its board.
    Controller,
    /// The message with this identifier.
    Id(u16),
}

impl Target {
    fn includes(self, id: u16) -> bool {
        let from_controller = [COMMAND.id, STATUS.id, BOARD.id].contains(&id);
        match self {
            Self::All => true,
            Self::Sensors => !from_controller,
            Self::Controller => from_controller,
            Self::Id(only) => only == id,
        }
    }
}

/// One kind of disturbance during one interval of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Injection {
    /// Messages that are disturbed.
    pub target: Target,
    /// First tick of the interval.
    pub from_tick: u32,
    /// First tick after the interval.
    pub until_tick: u32,
    /// Fraction of those frames that is disturbed, 0 to 1.
    pub probability: f64,
    /// What happens to them.
    pub disturbance: Disturbance,
}

/// What was done to frames so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InjectionCounts {
    /// Number of dropped frames.
    pub dropped: u64,
    /// Number of altered frames.
    pub corrupted: u64,
    /// Number of frames that were delivered late.
    pub delayed: u64,
    /// Number of frames that were delivered twice.
    pub duplicated: u64,
    /// Number of frames that were replaced by old ones.
    pub replayed: u64,
    /// Number of forged frames.
    pub forged: u64,
}

/// A decorator that disturbs frames in both directions.
#[derive(Debug)]
pub struct FaultInjector<B> {
    inner: B,
    tick: u32,
    injections: Vec<(Injection, ChaCha8Rng, Recorder)>,
    late_sent: VecDeque<(u32, Frame)>,
    late_received: VecDeque<(u32, Frame)>,
    ready: VecDeque<Frame>,
    counts: InjectionCounts,
}

/// What becomes of a frame: how often it goes on, or how many ticks later, its content, and a forged one that follows.
enum Fate {
    Copies(u8, Frame, Option<Frame>),
    Late(u16, Frame),
}

impl<B: Bus> FaultInjector<B> {
    /// Wraps `inner`; `seed` fixes all randomness.
    pub fn new(inner: B, injections: &[Injection], seed: u64) -> Self {
        let stream = |(index, injection): (usize, &Injection)| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            rng.set_stream(index as u64);
            (*injection, rng, Recorder::default())
        };
        Self {
            inner,
            tick: 0,
            injections: injections.iter().enumerate().map(stream).collect(),
            late_sent: VecDeque::with_capacity(64),
            late_received: VecDeque::with_capacity(64),
            ready: VecDeque::with_capacity(64),
            counts: InjectionCounts::default(),
        }
    }

    /// What was done to frames so far.
    pub fn counts(&self) -> InjectionCounts {
        self.counts
    }

    /// The bus that this decorator wraps.
    pub fn inner(&self) -> &B {
        &self.inner
    }

    /// The wrapped bus, to change it.
    pub fn inner_mut(&mut self) -> &mut B {
        &mut self.inner
    }

    fn fate(&mut self, frame: &Frame) -> Fate {
        let (mut frame, mut copies, mut forged) = (*frame, 1, None);
        let ours = frame
            .standard_id()
            .filter(|id| MESSAGES.iter().any(|message| message.id == *id));
        let Some(id) = ours else {
            return Fate::Copies(1, frame, None);
        };
        let tick = self.tick;
        for (injection, rng, recorder) in &mut self.injections {
            if !injection.target.includes(id) {
                continue;
            }
            // Listened to from the start, so that there is something to replay when the fault begins.
            let old = match injection.disturbance {
                Disturbance::Replay { ticks } => recorder.replay(tick, ticks, &frame),
                _ => None,
            };
            let concerned = (injection.from_tick..injection.until_tick).contains(&tick);
            if !concerned || !happens(rng, injection.probability) {
                continue;
            }
            match injection.disturbance {
                Disturbance::Drop => {
                    self.counts.dropped += 1;
                    return Fate::Copies(0, frame, forged);
                }
                Disturbance::Corrupt { bits } => {
                    self.counts.corrupted += 1;
                    for _ in 0..bits {
                        // 64 divides 2^32, so no bit is preferred.
                        frame = frame.with_flipped_bit((rng.next_u32() % 64) as usize);
                    }
                }
                Disturbance::Delay { ticks } => {
                    self.counts.delayed += 1;
                    return Fate::Late(ticks, frame);
                }
                Disturbance::Duplicate => {
                    self.counts.duplicated += 1;
                    copies = 2;
                }
                Disturbance::Replay { .. } => {
                    if let Some(old) = old {
                        self.counts.replayed += 1;
                        frame = old;
                    }
                }
                Disturbance::Masquerade => {
                    forged = recorder.forge(tick, &frame);
                    self.counts.forged += u64::from(forged.is_some());
                }
            }
        }
        Fate::Copies(copies, frame, forged)
    }
}

/// True with a probability; certain and impossible events use no randomness.
fn happens(rng: &mut ChaCha8Rng, probability: f64) -> bool {
    probability >= 1.0 || (probability > 0.0 && f64::from(rng.next_u32()) < probability * 4_294_967_296.0)
}

/// Takes a frame that is due out of a queue of delayed frames, which need not be in the order of their times.
fn due(queue: &mut VecDeque<(u32, Frame)>, tick: u32) -> Option<Frame> {
    let position = queue.iter().position(|(due, _)| *due <= tick)?;
    queue.remove(position).map(|(_, frame)| frame)
}

impl<B: Bus> Bus for FaultInjector<B> {
    fn begin_tick(&mut self, tick: u32) {
        self.tick = tick;
        self.inner.begin_tick(tick);
        while let Some(frame) = due(&mut self.late_received, tick) {
            self.ready.push_back(frame);
        }
    }

    fn send(&mut self, frame: &Frame) -> Result<(), BusError> {
        // The frame that ends a tick must come last, so delayed frames are sent before it.
        if crate::sync::is_sync(frame) {
            while let Some(late) = due(&mut self.late_sent, self.tick) {
                self.inner.send(&late)?;
            }
        }
        match self.fate(frame) {
            Fate::Copies(copies, frame, forged) => {
                let mut frames = (0..copies).map(|_| frame).chain(forged);
                frames.try_for_each(|frame| self.inner.send(&frame))
            }
            Fate::Late(ticks, frame) => {
                self.late_sent
                    .push_back((self.tick.saturating_add(u32::from(ticks)), frame));
                Ok(())
            }
        }
    }

    fn receive(&mut self, wait: Duration) -> Result<Option<Frame>, BusError> {
        loop {
            if let Some(frame) = self.ready.pop_front() {
                return Ok(Some(frame));
            }
            let Some(frame) = self.inner.receive(wait)? else {
                return Ok(None);
            };
            match self.fate(&frame) {
                Fate::Copies(copies, frame, forged) => {
                    self.ready.extend((0..copies).map(|_| frame).chain(forged));
                }
                Fate::Late(ticks, frame) => {
                    self.late_received
                        .push_back((self.tick.saturating_add(u32::from(ticks)), frame));
                }
            }
        }
    }

    fn counters(&self) -> BusCounters {
        self.inner.counters()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bus::{InProcess, in_process_pair};
    use crate::frame::standard;
    use crate::sync::{Role, Session, Sync};

    fn with(disturbance: Disturbance, target: Target, probability: f64) -> (FaultInjector<InProcess>, InProcess) {
        let (a, b) = in_process_pair();
        let injection = Injection {
            target,
            from_tick: 2,
            until_tick: 4,
            probability,
            disturbance,
        };
        (FaultInjector::new(a, &[injection], 7), b)
    }

    fn sensor(tick: u32) -> Frame {
        Frame::whole(standard(0x110), [tick as u8; 8])
    }

    /// What arrives at the far end, by tick of arrival.
    fn run(bus: &mut FaultInjector<InProcess>, far: &mut InProcess) -> Vec<Vec<Frame>> {
        let tick = |tick| {
            bus.begin_tick(tick);
            bus.send(&sensor(tick)).unwrap();
            let done = Sync::TickDone { tick, sent: 0 };
            bus.send(&done.encode(Role::Plant, Session::default())).unwrap();
            let arrivals = std::iter::from_fn(|| far.receive(Duration::ZERO).unwrap());
            arrivals.filter(|frame| !crate::sync::is_sync(frame)).collect()
        };
        (0..6).map(tick).collect()
    }

    #[test]
    fn each_disturbance_within_its_interval() {
        let (mut bus, mut far) = with(Disturbance::Drop, Target::Sensors, 1.0);
        let lengths: Vec<_> = run(&mut bus, &mut far).iter().map(Vec::len).collect();
        assert_eq!(lengths, [1, 1, 0, 0, 1, 1]);

        let (mut bus, mut far) = with(Disturbance::Duplicate, Target::All, 1.0);
        let lengths: Vec<_> = run(&mut bus, &mut far).iter().map(Vec::len).collect();
        assert_eq!(lengths, [1, 1, 2, 2, 1, 1]);

        let (mut bus, mut far) = with(Disturbance::Delay { ticks: 2 }, Target::Id(0x110), 1.0);
        let arrived = run(&mut bus, &mut far);
        assert_eq!(arrived[4], [sensor(4), sensor(2)]);
        assert_eq!(arrived[5], [sensor(5), sensor(3)]);

        let (mut bus, mut far) = with(Disturbance::Corrupt { bits: 1 }, Target::All, 1.0);
        let arrived = run(&mut bus, &mut far);
        let flipped: u32 = arrived[2][0].data().iter().map(|byte| (byte ^ 2).count_ones()).sum();
        assert_eq!((flipped, arrived[1][0]), (1, sensor(1)));
        assert_eq!(bus.counts().corrupted, 2);
    }

    #[test]
    fn a_replay_is_as_old_as_it_says() {
        let (mut bus, mut far) = with(Disturbance::Replay { ticks: 2 }, Target::Sensors, 1.0);
        let arrived = run(&mut bus, &mut far);
        let of: Vec<_> = arrived.iter().map(|frames| frames[0]).collect();
        assert_eq!(of, [0, 1, 0, 1, 4, 5].map(sensor));
        assert_eq!(bus.counts().replayed, 2);
    }

    /// The receiver's own check takes a forged frame for the next one, and refuses the real one that follows.
    #[test]
    fn a_masquerade_is_one_ahead_with_a_right_crc() {
        use oleo_controller::can::{CheckStatus, Checker, PRESSURE, Protector};
        let contract = PRESSURE[oleo_interface::Corner::FrontLeft];
        let (mut bus, mut far) = with(Disturbance::Masquerade, Target::Id(contract.id), 1.0);
        let (mut sender, mut receiver) = (Protector::new(&contract), Checker::new(&contract));
        let mut seen = Vec::new();
        for tick in 0..4u32 {
            bus.begin_tick(tick);
            let mut data = [tick as u8 * 0x10; 8];
            sender.protect(&mut data);
            bus.send(&Frame::whole(standard(contract.id), data)).unwrap();
            while let Some(frame) = far.receive(Duration::ZERO).unwrap() {
                let data = <[u8; 8]>::try_from(frame.data()).unwrap();
                seen.push((data[7], receiver.check(&data)));
            }
        }
        use CheckStatus::{Initial, Ok};
        // Tick 2 is the first of the fault: the attacker listens. In tick 3 its frame follows the real one.
        assert_eq!(seen, [(0x00, Initial), (0x10, Ok), (0x20, Ok), (0x30, Ok), (0x20, Ok)]);
        assert_eq!(bus.counts().forged, 1);
    }

    #[test]
    fn only_the_target_and_both_directions() {
        let (mut bus, mut far) = with(Disturbance::Drop, Target::Controller, 1.0);
        assert!(run(&mut bus, &mut far).iter().all(|tick| tick.len() == 1));
        bus.begin_tick(2);
        far.send(&Frame::whole(standard(0x0A0), [0; 8])).unwrap();
        far.send(&Frame::whole(standard(0x7DF), [0; 8])).unwrap();
        assert_eq!(
            bus.receive(Duration::ZERO).unwrap().unwrap().raw_id(),
            0x7DF,
            "a frame with another identifier passes"
        );
        assert_eq!(bus.receive(Duration::ZERO).unwrap(), None);
        assert_eq!(bus.counts().dropped, 1);
    }

    #[test]
    fn the_same_seed_does_the_same() {
        let lengths = || {
            let (mut bus, mut far) = with(Disturbance::Drop, Target::All, 0.5);
            (0..50)
                .map(|_| run(&mut bus, &mut far).iter().map(Vec::len).sum())
                .collect::<Vec<usize>>()
        };
        assert_eq!(lengths(), lengths());
        let total: usize = lengths().iter().sum();
        assert!(
            (230..270).contains(&total),
            "{total} of 300, half of the 100 concerned expected to be gone"
        );
    }
}
