//! A controller on a bus: frames in, frames out, one tick at a time.
//!
//! The node owns what the pure [`tick()`](crate::tick()) must not know: counters, check values, how old a message is. Hosts, the
//! firmware and the tests all use this one, so a rule about messages exists once.
//!
//! A message is *lost* when no usable frame came for its contract's `timeout_ticks`; until then its last values are used. It is
//! also lost while it is not trusted: `receiver` judges how many and which frames came in each tick, `can::state_machine` the
//! last sixteen ticks, and `freshness` how old the readings are. The readings of a lost message are invalid.
//!
//! A frame with one of the controller's own identifiers comes from somebody else. That is a fault
//! of its own in the tick in which it is heard (after opendbc's check of relays).
//!
//! The functions here, in `freshness` and those that make a first state are `#[inline]`: so the crate that calls them compiles them,
//! the firmware for size, while this crate is compiled for the speed of the tick.

use heapless::Vec;
use oleo_interface::tick::TICK_MS;
use oleo_interface::{Axles, Corners, Side, StrutPressures};

use crate::can::{
    BOARD, BoardMessage, COMMAND, CheckStatus, CommandMessage, Contract, Counter, DISPLACEMENT, DisplacementMessage,
    FRAME_BYTES, Frame, PRESSURE, PressureMessage, STATUS, StatusMessage, sensor_message,
};
use crate::configuration::Configuration;
use crate::failsafe::FaultCode;
use crate::freshness::{Freshness, counter};
use crate::reading::{Inputs, Reading};
use crate::receiver::Receiver;
use crate::sensor_message::{MessageSet, PerSensorMessage, SensorMessage};
use crate::tick::{Outputs, State, tick};

/// Most frames that a tick sends: the command, every 100 ms the status, and every second the state of the board.
pub const MAX_SENT: usize = 3;

const NOTHING_RECEIVED: PerSensorMessage<Receiver> = PerSensorMessage {
    pressure: Corners::splat(Receiver::INITIAL),
    displacement: Axles::splat(Receiver::INITIAL),
};
const STATUS_TICKS: u32 = STATUS.period_ms / TICK_MS;
const BOARD_TICKS: u32 = BOARD.period_ms / TICK_MS;

/// Number of ticks after which a valve that was commanded closed is closed, whatever it did before (report: at most 90 ms).
#[cfg(feature = "calibration")]
const CLOSED_TICKS: u8 = (90 / TICK_MS + 1) as u8;

/// What has been seen on the bus, for statistics. The counters wrap.
///
/// ```
/// use oleo_controller::{Configuration, Node};
/// let mut node = Node::new(Configuration::defender110());
/// node.receive(0x7DF, &[0; 8]); // a frame of somebody else
/// node.receive(0x110, &[0; 8]); // a sensor message with a wrong check value
/// let counters = node.counters();
/// assert_eq!((counters.foreign, counters.received, counters.wrong_crc), (1, 1, 1));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BusCounters {
    /// Frames of the controller's messages.
    pub received: u32,
    /// Frames with other identifiers, which are ignored.
    pub foreign: u32,
    /// Frames with the controller's own identifiers, which somebody else has sent.
    pub own: u32,
    /// Frames with a wrong length or CRC.
    pub wrong_crc: u32,
    /// Frames that were repeated or out of sequence.
    pub wrong_sequence: u32,
    /// Gaps seen in the frames' counters.
    pub gaps: u32,
}

/// A controller with its configuration and state, behind both directions of the bus.
///
/// ```
/// use oleo_controller::{Configuration, Corners, Gauge, Inputs, Mode, Node, PlantEnd, StrutPressures};
/// let mut node = Node::new(Configuration::defender110());
/// let mut plant = PlantEnd::new(); // stands for the sensors and the output stage
/// let at_rest = Inputs::from_values(Corners::splat(0.0), Corners::splat(StrutPressures::splat(Gauge(2.0e6))));
/// let mut mode = Mode::StartUp;
/// for tick in 0..40 {
///     for frame in plant.encode(tick, &at_rest) {
///         node.receive(frame.id, &frame.data);
///     }
///     let (outputs, frames) = node.tick();
///     for frame in frames {
///         plant.receive(frame.id, &frame.data);
///     }
///     plant.end_of_tick();
///     mode = outputs.mode;
/// }
/// assert_eq!(mode, Mode::Normal);
/// ```
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Node {
    // Not a part of what is saved: see `under`.
    #[cfg_attr(feature = "serde", serde(skip, default = "Configuration::defender110"))]
    configuration: Configuration,
    state: State,
    receivers: PerSensorMessage<Receiver>,
    freshness: Freshness,
    inputs: Inputs,
    echo_tick: u8,
    command: Counter,
    status: Counter,
    status_countdown: u32,
    board: Counter,
    board_state: Option<BoardMessage>,
    board_countdown: u32,
    counters: BusCounters,
    /// Ticks since a valve was commanded open, or a bend was handled; it saturates.
    #[cfg(feature = "calibration")]
    calm_ticks: u8,
}

impl Node {
    /// A node that has received nothing: all valves are closed, and the mode is [`Mode::StartUp`](crate::Mode::StartUp).
    #[inline]
    pub fn new(configuration: Configuration) -> Self {
        Self {
            state: State::new(),
            configuration,
            receivers: NOTHING_RECEIVED,
            freshness: Freshness::INITIAL,
            inputs: Inputs::default(),
            echo_tick: 0,
            command: Counter::INITIAL,
            status: Counter::INITIAL,
            status_countdown: 0,
            board: Counter::INITIAL,
            board_state: None,
            board_countdown: 0,
            counters: BusCounters::default(),
            #[cfg(feature = "calibration")]
            calm_ticks: 0,
        }
    }

    /// Latches the safe state, see [`State::latch`].
    ///
    /// ```
    /// use oleo_controller::{Configuration, FaultCode, Mode, Node};
    /// let mut node = Node::new(Configuration::defender110());
    /// node.latch(FaultCode::Solenoid);
    /// assert_eq!(node.tick().0.mode, Mode::Latched);
    /// ```
    #[inline]
    pub fn latch(&mut self, cause: FaultCode) {
        self.state.latch(cause);
    }

    /// Takes a frame from the bus: its standard identifier, 0 to 0x7FF, and its data. Call it any number of times between
    /// ticks; frames with other identifiers are counted and ignored.
    #[inline]
    pub fn receive(&mut self, id: u16, data: &[u8]) {
        let Some(message) = sensor_message(id) else {
            if [COMMAND.id, STATUS.id, BOARD.id].contains(&id) {
                self.counters.own = self.counters.own.wrapping_add(1);
                self.inputs.foreign_sender = true;
            } else {
                self.counters.foreign = self.counters.foreign.wrapping_add(1);
            }
            return;
        };
        self.counters.received = self.counters.received.wrapping_add(1);
        // A frame of the wrong length cannot carry the right CRC: it has the same consequence.
        let data = <&[u8; FRAME_BYTES]>::try_from(data).unwrap_or(&[0xFF; FRAME_BYTES]);
        let status = self.receivers.get_mut(message).receive(message.contract(), data);
        match status {
            CheckStatus::WrongCrc => {
                self.counters.wrong_crc = self.counters.wrong_crc.wrapping_add(1);
                return;
            }
            CheckStatus::Repeated | CheckStatus::WrongSequence => {
                self.counters.wrong_sequence = self.counters.wrong_sequence.wrapping_add(1);
            }
            CheckStatus::OkSomeLost => self.counters.gaps = self.counters.gaps.wrapping_add(1),
            CheckStatus::Ok | CheckStatus::Initial | CheckStatus::Sync => {}
        }
        if matches!(message, SensorMessage::Displacement(_)) {
            // The echo only says which frame was seen; it needs no sequence.
            self.echo_tick = DisplacementMessage::decode(data).plant_tick;
        }
    }

    /// Reports that the output stage could not switch a solenoid. The next tick latches.
    #[inline]
    pub fn report_solenoid_failure(&mut self) {
        self.inputs.solenoid_failed = true;
    }

    /// Says what the board knows of itself. Once this was called, the node sends the latest of it every second.
    #[inline]
    pub fn report_board(&mut self, state: BoardMessage) {
        self.board_state = Some(state);
    }

    /// One period: decides, and returns the frames to send. Call it every [`TICK_MS`].
    #[inline]
    pub fn tick(&mut self) -> (Outputs, Vec<Frame, MAX_SENT>) {
        let mut frames = Vec::new();
        let outputs = self.tick_and_send(|frame| {
            // There is room for as many frames as are ever sent in a tick.
            let _ = frames.push(frame);
        });
        (outputs, frames)
    }

    /// The same; hands over each frame as it is made.
    #[inline]
    pub(crate) fn tick_and_send(&mut self, mut take: impl FnMut(Frame)) -> Outputs {
        self.end_of_reception();
        let outputs = tick(&self.configuration, &mut self.state, &self.inputs);
        self.inputs.foreign_sender = false;
        #[cfg(feature = "calibration")]
        {
            let calm = outputs.command == crate::ValveCommand::SAFE && !outputs.handling && !outputs.rollover_guard;
            self.calm_ticks = if calm { self.calm_ticks.saturating_add(1) } else { 0 };
        }

        let mut send = |contract: &Contract, mut data: [u8; FRAME_BYTES], counter: &mut Counter| {
            counter.protect(contract, &mut data);
            take(Frame { id: contract.id, data });
        };
        let command = CommandMessage {
            command: outputs.command,
            echo_tick: self.echo_tick,
            challenge: self.freshness.challenge(),
            mode: outputs.mode,
            fault: outputs.fault,
        };
        send(&COMMAND, command.encode(), &mut self.command);
        if self.status_countdown == 0 {
            self.status_countdown = STATUS_TICKS;
            let status = status(&outputs, self.inputs.lost_messages);
            send(&STATUS, status.encode(), &mut self.status);
        }
        self.status_countdown = self.status_countdown.saturating_sub(1);
        if let Some(state) = self.board_state {
            if self.board_countdown == 0 {
                self.board_countdown = BOARD_TICKS;
                send(&BOARD, state.encode(), &mut self.board);
            }
            self.board_countdown = self.board_countdown.saturating_sub(1);
        }
        outputs
    }

    /// Takes over what the messages of this tick say, and makes the readings of lost messages invalid.
    #[inline]
    fn end_of_reception(&mut self) {
        let inputs = &mut self.inputs;
        let displacement = &mut self.receivers.displacement;
        let fresh = self.freshness.displacements(Axles::from_fn(|axle| {
            let data = displacement[axle].candidate()?;
            Some((DisplacementMessage::decode(data), counter(data)))
        }));
        inputs.lost_messages = MessageSet::EMPTY;
        for (axle, receiver) in displacement.iter_mut() {
            if receiver.candidate().is_some() && !fresh[axle] {
                receiver.distrust();
            }
            let contract = &DISPLACEMENT[axle];
            let left_and_right = match receiver.end_of_tick(contract) {
                Some(data) => {
                    let DisplacementMessage { left, right, .. } = DisplacementMessage::decode(&data);
                    (left, right)
                }
                None if receiver.is_lost(contract) => {
                    inputs.lost_messages.insert(SensorMessage::Displacement(axle));
                    (Reading::INVALID, Reading::INVALID)
                }
                None => continue,
            };
            (
                inputs.displacement[axle.corner(Side::Left)],
                inputs.displacement[axle.corner(Side::Right)],
            ) = left_and_right;
        }
        for (corner, receiver) in self.receivers.pressure.iter_mut() {
            let late = |data| !self.freshness.is_in_step(counter(data));
            if receiver.candidate().is_some_and(late) {
                receiver.distrust();
            }
            let contract = &PRESSURE[corner];
            match receiver.end_of_tick(contract) {
                Some(data) => inputs.pressure[corner] = PressureMessage::decode(&data).pressure,
                None if receiver.is_lost(contract) => {
                    inputs.lost_messages.insert(SensorMessage::Pressure(corner));
                    inputs.pressure[corner] = StrutPressures::splat(Reading::INVALID);
                }
                None => {}
            }
        }
    }

    /// What the last tick was told: for a tool that looks on.
    #[inline]
    pub fn inputs(&self) -> &Inputs {
        &self.inputs
    }

    /// Tick of the plant, modulo 256, of which the last displacements are.
    #[inline]
    pub fn plant_tick(&self) -> u8 {
        self.echo_tick
    }

    /// Whether another tuning may take effect now: all valves are closed, as long as the slowest needs, and no bend is handled.
    #[cfg(feature = "calibration")]
    pub fn may_reconfigure(&self) -> bool {
        self.calm_ticks >= CLOSED_TICKS
    }

    /// Takes another configuration from the next tick on, if [`Self::may_reconfigure`]. The state goes on. Returns whether it was taken.
    #[cfg(feature = "calibration")]
    pub fn reconfigure(&mut self, configuration: Configuration) -> bool {
        let may = self.may_reconfigure();
        if may {
            self.configuration = configuration;
        }
        may
    }

    /// The node under a configuration. One that was read from its saved form has another's: a configuration holds what follows from a vehicle and
    /// a tuning, which whoever saves the node knows.
    #[cfg(feature = "serde")]
    #[must_use]
    pub fn under(self, configuration: Configuration) -> Self {
        Self { configuration, ..self }
    }

    /// Bus statistics since the start.
    #[inline]
    pub fn counters(&self) -> BusCounters {
        self.counters
    }
}

/// Content of the status message after a tick.
#[inline]
fn status(outputs: &Outputs, lost_messages: MessageSet) -> StatusMessage {
    StatusMessage {
        mode: outputs.mode,
        fault: outputs.fault,
        handling: outputs.handling,
        rollover_guard: outputs.rollover_guard,
        lateral_rms_m_s2: root(outputs.estimate.lateral_mean_square),
        vertical_rms_m_s2: root(outputs.estimate.vertical_mean_square),
        invalid_readings: outputs.invalid_readings,
        lost_messages,
    }
}

/// Square root to six digits, 0 of what is not positive. The library's is exact to the last bit with a table that fills a fiftieth of
/// the board's image; a message that rounds to 0.02 m/s2 needs neither.
///
/// Half the exponent is a first value within 4 %; Heron's rule squares the error, and halves it, in each of its two steps.
fn root(square: f32) -> f32 {
    if square > 0.0 {
        let first = f32::from_bits((square.to_bits() >> 1) + 0x1FBD_1DF5);
        let second = 0.5 * (first + square / first);
        0.5 * (second + square / second)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::failsafe::Mode;
    use crate::plant_end::PlantEnd;
    use oleo_interface::{Corner, Gauge};

    #[test]
    fn a_root_has_six_digits() {
        let worst = (1..2_000_000)
            .map(|n| n as f32 * 0.000_1)
            .map(|x| (root(x) / libm::sqrtf(x) - 1.0).abs());
        assert!(worst.fold(0.0, f32::max) < 1e-6);
        assert_eq!([root(0.0), root(-1.0), root(f32::NAN)], [0.0; 3]);
        assert!((root(1e30) / 1e15 - 1.0).abs() < 1e-6 && (root(1e-30) / 1e-15 - 1.0).abs() < 1e-6);
    }

    /// A node with the other end of its bus, at rest.
    struct Pair {
        node: Node,
        plant: PlantEnd,
        tick: u16,
    }

    impl Pair {
        fn settled() -> Self {
            let mut pair = Self {
                node: Node::new(Configuration::defender110()),
                plant: PlantEnd::default(),
                tick: 0,
            };
            for _ in 0..60 {
                pair.step(|_| {}, |_| true);
            }
            pair
        }

        /// One tick with changed readings, in which only some frames arrive. Returns the status if one was sent.
        fn step(
            &mut self,
            change: impl FnOnce(&mut Inputs),
            arrives: impl Fn(SensorMessage) -> bool,
        ) -> (Outputs, Option<StatusMessage>) {
            let pressure = Corners::splat(StrutPressures::splat(Gauge(2.0e6)));
            let mut inputs = Inputs::from_values(Corners::splat(0.01), pressure);
            change(&mut inputs);
            for frame in self.plant.encode(self.tick, &inputs) {
                if sensor_message(frame.id).is_some_and(&arrives) {
                    self.node.receive(frame.id, &frame.data);
                }
            }
            self.tick += 1;
            let (outputs, frames) = self.node.tick();
            let mut status = None;
            for frame in &frames {
                self.plant.receive(frame.id, &frame.data);
                if frame.id == STATUS.id {
                    status = StatusMessage::decode(&frame.data);
                }
            }
            assert_eq!(self.plant.end_of_tick(), self.plant.output().command());
            (outputs, status)
        }
    }

    #[cfg(all(feature = "calibration", feature = "comparison"))]
    #[test]
    fn another_tuning_waits_until_every_valve_is_closed() {
        let soft = Configuration::defender110().with_strategy(crate::Strategy::AlwaysSoft);
        let stiff = Configuration::defender110().with_strategy(crate::Strategy::AlwaysStiff);
        let mut pair = Pair::settled();
        assert!(pair.node.reconfigure(soft), "a smooth road: all valves are closed");
        let open = (0..400).any(|_| pair.step(|_| {}, |_| true).0.command == crate::ValveCommand::SOFT);
        assert!(open && !pair.node.may_reconfigure());
        assert!(!pair.node.reconfigure(stiff), "every valve is open");
        // Silence closes them; a valve needs up to 90 ms for it.
        let mut closed = 0;
        while !pair.node.may_reconfigure() {
            closed += u32::from(pair.step(|_| {}, |_| false).0.command == crate::ValveCommand::SAFE);
            assert!(closed < 100);
        }
        assert_eq!(closed, 19);
        assert!(pair.node.reconfigure(stiff));
    }

    #[test]
    fn the_state_of_a_board_is_sent_each_second_once_there_is_one() {
        let mut node = Node::new(Configuration::defender110());
        let sent = |node: &mut Node| {
            let (_, frames) = node.tick();
            let board = frames.into_iter().find(|frame| frame.id == BOARD.id)?;
            BoardMessage::decode(&board.data)
        };
        assert!(
            (0..500).all(|_| sent(&mut node).is_none()),
            "a simulated controller has no board"
        );
        for tick in 0..1000_u32 {
            let state = BoardMessage {
                overruns: (tick / 10) as u8,
                ..BoardMessage::default()
            };
            node.report_board(state);
            assert_eq!(
                sent(&mut node),
                tick.is_multiple_of(200).then_some(state),
                "tick {tick}"
            );
        }
    }

    /// A tool that looks on sees the readings as the bus carried them, the tick of which they are, and what has not come.
    #[test]
    fn a_tool_sees_what_the_node_was_told() {
        let mut pair = Pair::settled();
        let late = SensorMessage::Pressure(Corner::FrontRight);
        for _ in 0..8 {
            let moved = |inputs: &mut Inputs| inputs.displacement[Corner::RearLeft] = Reading::new(-0.023_4);
            pair.step(moved, |message| message != late);
        }
        let inputs = pair.node.inputs();
        let read = |corner| inputs.displacement[corner].value().expect("a reading");
        assert!((read(Corner::RearLeft) + 0.023_4).abs() < 1e-5 && (read(Corner::FrontLeft) - 0.01).abs() < 1e-5);
        let mut lost = MessageSet::EMPTY;
        lost.insert(late);
        assert_eq!(inputs.lost_messages, lost);
        assert!(!inputs.pressure[Corner::FrontRight].p1.is_valid());
        assert_eq!(u16::from(pair.node.plant_tick()), pair.tick - 1);
    }

    /// Each 100 ms; what it says is what the tick decided.
    #[test]
    fn the_status_says_what_was_decided() {
        let mut pair = Pair::settled();
        let mut sent = 0;
        for _ in 0..400 {
            let missing = |inputs: &mut Inputs| inputs.displacement[Corner::RearLeft] = Reading::INVALID;
            let (outputs, status) = pair.step(missing, |message| message != SensorMessage::Pressure(Corner::RearRight));
            let Some(status) = status else { continue };
            sent += 1;
            assert_eq!(
                (
                    status.mode,
                    status.fault,
                    status.invalid_readings,
                    status.handling,
                    status.rollover_guard
                ),
                (
                    outputs.mode,
                    outputs.fault,
                    outputs.invalid_readings,
                    outputs.handling,
                    outputs.rollover_guard
                )
            );
            if sent > 2 {
                let mut lost = MessageSet::EMPTY;
                lost.insert(SensorMessage::Pressure(Corner::RearRight));
                assert_eq!((status.mode, status.lost_messages), (Mode::Degraded, lost));
                assert_eq!(status.invalid_readings, 5, "a displacement and four pressures");
            }
            let vertical = libm::sqrtf(outputs.estimate.vertical_mean_square);
            let lateral = libm::sqrtf(outputs.estimate.lateral_mean_square);
            assert!((status.vertical_rms_m_s2 - vertical).abs() <= 0.011);
            assert!((status.lateral_rms_m_s2 - lateral).abs() <= 0.011);
        }
        assert_eq!(sent, 20);
    }

    #[test]
    fn a_lost_message_is_the_one_that_does_not_come_and_only_from_the_fourth_tick_on() {
        for lost in SensorMessage::ALL {
            let mut pair = Pair::settled();
            for n in 1..=6 {
                let (outputs, _) = pair.step(|_| {}, |message| message != lost);
                let expected = if n < 4 { Mode::Normal } else { Mode::Degraded };
                assert_eq!(outputs.mode, expected, "{lost:?} tick {n}");
                assert_eq!(pair.node.inputs.lost_messages.contains(lost), n >= 4);
                let readings = match lost {
                    SensorMessage::Pressure(_) => 4,
                    SensorMessage::Displacement(_) => 2,
                };
                assert_eq!(outputs.invalid_readings, if n < 4 { 0 } else { readings });
            }
        }
    }

    #[test]
    fn what_is_reported_from_outside_latches() {
        let mut pair = Pair::settled();
        pair.node.report_solenoid_failure();
        let (outputs, _) = pair.step(|_| {}, |_| true);
        assert_eq!((outputs.mode, outputs.fault), (Mode::Latched, FaultCode::Solenoid));
        let mut pair = Pair::settled();
        pair.node.latch(FaultCode::Internal);
        let (outputs, _) = pair.step(|_| {}, |_| true);
        assert_eq!((outputs.mode, outputs.fault), (Mode::Latched, FaultCode::Internal));
    }

    #[test]
    fn frames_are_counted_by_what_they_are() {
        let mut pair = Pair::settled();
        let before = pair.node.counters();
        assert_eq!((before.received, before.own, before.foreign), (6 * 60, 0, 0));
        for id in [COMMAND.id, STATUS.id] {
            pair.node.receive(id, &[0; FRAME_BYTES]);
            let (outputs, _) = pair.step(|_| {}, |_| true);
            assert_eq!(outputs.fault, FaultCode::ForeignSender);
        }
        pair.node.receive(0x7FF, &[]);
        let after = pair.node.counters();
        assert_eq!((after.own, after.foreign, after.received), (2, 1, 6 * 62));
    }
}
