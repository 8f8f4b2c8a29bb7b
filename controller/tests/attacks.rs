//! Somebody else on the bus: forged frames, frames played back, held up or sent under the wrong name.
//!
//! The attackers here know the database, so their frames have the right check values. What they achieve at most is that valves
//! close. One that silences the right sender and answers in time is not found: that takes a secret, see `docs/safety.md`.

mod common;

use std::collections::VecDeque;

use common::{Loop, rough_road};
use oleo_controller::can::{
    BOARD, BoardMessage, COMMAND, CommandMessage, FRAME_BYTES, Frame, Protector, STATUS, StatusMessage,
};
use oleo_controller::{
    Configuration, Corner, Corners, FaultCode, Gauge, Inputs, Mode, Outputs, PlantEnd, SensorMessage, Strategy,
    StrutPressures, ValveCommand,
};

/// All valves open in normal mode, so that every reaction shows.
fn soft_loop() -> Loop {
    let mut it = Loop::new(Configuration::defender110().with_strategy(Strategy::AlwaysSoft));
    it.run(600);
    assert_eq!(it.command, ValveCommand::SOFT);
    it
}

/// Ticks until the mode is not normal, with the outputs of that tick.
fn until_reaction(it: &mut Loop, most: u32, mut frames: impl FnMut(u32, &mut Vec<Frame>)) -> (u32, Outputs) {
    for n in 1..=most {
        let tick = it.tick;
        let outputs = it.step(rough_road(tick), |_| {}, |sent| frames(tick, sent));
        if outputs.mode != Mode::Normal {
            return (n, outputs);
        }
    }
    panic!("no reaction within {most} ticks");
}

/// Readings of a vehicle that does not exist: nothing in it is out of range.
fn lies() -> Inputs {
    Inputs::from_values(
        Corners::splat(0.03),
        Corners::splat(StrutPressures::splat(Gauge(3.0e6))),
    )
}

/// A forger whose frames are so many counters ahead of the right ones, with the right ticks.
fn forger(it: &Loop, ahead: u32) -> PlantEnd {
    let mut forger = it.plant;
    for n in 0..ahead {
        forger.encode((it.tick + n) as u16, &lies());
    }
    forger
}

#[test]
fn one_forged_frame_for_each_right_one() {
    for message in SensorMessage::ALL {
        for ahead in [0, 1, 2, 5, 15] {
            for forged_first in [true, false] {
                let mut it = soft_loop();
                let mut forger = forger(&it, ahead);
                let (n, outputs) = until_reaction(&mut it, 10, |tick, frames| {
                    let forged = forger.encode(tick as u16, &lies());
                    let forged = forged
                        .into_iter()
                        .find(|frame| frame.id == message.contract().id)
                        .unwrap();
                    frames.insert(if forged_first { 0 } else { frames.len() }, forged);
                });
                assert_eq!(
                    (n, outputs.mode, outputs.fault),
                    (3, Mode::Degraded, FaultCode::MessageLost),
                    "{message:?}, {ahead} ahead"
                );
            }
        }
    }
}

#[test]
fn a_forged_set_of_all_messages_is_safe_and_stays_so() {
    let mut it = soft_loop();
    let mut forger = forger(&it, 1);
    let (n, outputs) = until_reaction(&mut it, 10, |tick, frames| {
        frames.extend(forger.encode(tick as u16, &lies()));
    });
    assert_eq!((n, outputs.mode, outputs.command), (3, Mode::Safe, ValveCommand::SAFE));
    for _ in 0..1500 {
        let tick = it.tick;
        let outputs = it.step(
            rough_road(tick),
            |_| {},
            |frames| frames.extend(forger.encode(tick as u16, &lies())),
        );
        assert_eq!(
            (outputs.mode, it.command),
            (Mode::Safe, ValveCommand::SAFE),
            "tick {tick}"
        );
    }
}

#[test]
fn frames_of_noise_beside_the_right_ones() {
    for contract in SensorMessage::ALL.map(SensorMessage::contract) {
        for each_tick in 1..3 {
            let mut it = soft_loop();
            let noise = Frame {
                id: contract.id,
                data: [0x55; FRAME_BYTES],
            };
            let (n, outputs) = until_reaction(&mut it, 10, |_, frames| {
                for _ in 0..each_tick {
                    frames.insert(0, noise);
                }
            });
            assert_eq!(
                (n, outputs.mode, outputs.fault),
                (3, Mode::Degraded, FaultCode::MessageLost),
                "{:#x}",
                contract.id
            );
        }
    }
}

/// N of M: three doubled ticks of sixteen end trust; two do not, and their content is not used.
#[test]
fn seldom_forged_frames() {
    for (every, ends) in [(5, true), (7, true), (8, false), (16, false)] {
        let mut it = soft_loop();
        let mut forger = forger(&it, 1);
        let mut worst = Mode::Normal;
        for n in 0..400 {
            let tick = it.tick;
            let forged = forger.encode(tick as u16, &lies());
            let outputs = it.step(
                rough_road(tick),
                |_| {},
                |frames| {
                    if n % every == 0 {
                        frames.push(forged[0]);
                    }
                },
            );
            worst = worst.max(outputs.mode);
        }
        assert_eq!(worst != Mode::Normal, ends, "every {every} ticks");
    }
}

/// Frames under the controller's own identifiers close the valves in the tick in which they are heard, right or not.
#[test]
fn own_identifiers_heard_from_elsewhere() {
    let forged = CommandMessage {
        command: ValveCommand::SOFT,
        mode: Mode::Normal,
        ..CommandMessage::default()
    };
    let mut sealed = forged.encode();
    Protector::new(&COMMAND).protect(&mut sealed);
    for (id, data) in [
        (COMMAND.id, sealed),
        (COMMAND.id, [0; FRAME_BYTES]),
        (STATUS.id, StatusMessage::default().encode()),
        (BOARD.id, BoardMessage::default().encode()),
    ] {
        let mut it = soft_loop();
        let (n, outputs) = until_reaction(&mut it, 1, |_, frames| frames.push(Frame { id, data }));
        assert_eq!(
            (n, outputs.mode, outputs.fault, it.command),
            (1, Mode::Safe, FaultCode::ForeignSender, ValveCommand::SAFE)
        );
        assert_eq!(it.node.counters().own, 1);
        // It ends as every other severe fault does.
        let mut back = 0;
        while it.run(1).mode != Mode::Normal {
            back += 1;
            assert!(back < 400);
        }
        assert_eq!(back, 199, "healthy for a second");
    }
}

/// A command that opens valves while the controller is latched, one counter ahead, as the output stage hears it.
#[test]
fn forged_commands_open_nothing() {
    for mode in [Mode::Normal, Mode::Latched] {
        for ahead in [0, 1, 2, 7] {
            let mut it = soft_loop();
            it.node.report_solenoid_failure();
            it.run(40);
            assert_eq!(it.command, ValveCommand::SAFE);
            // The attacker's counter, so many ahead of the controller's.
            let mut attacker = Protector::new(&COMMAND);
            for _ in 0..it.tick + ahead {
                attacker.protect(&mut [0; FRAME_BYTES]);
            }
            for _ in 0..400 {
                let inputs = it.sensors(rough_road(it.tick));
                for frame in it.plant.encode(it.tick as u16, &inputs) {
                    it.node.receive(frame.id, &frame.data);
                }
                let (_, sent) = it.node.tick();
                let forged = CommandMessage {
                    command: ValveCommand::SOFT,
                    mode,
                    echo_tick: it.tick as u8,
                    ..CommandMessage::default()
                };
                let mut data = forged.encode();
                attacker.protect(&mut data);
                for frame in sent {
                    it.plant.receive(frame.id, &frame.data);
                }
                it.plant.receive(COMMAND.id, &data);
                assert_eq!(
                    it.plant.end_of_tick(),
                    ValveCommand::SAFE,
                    "{mode:?}, {ahead} ahead, tick {}",
                    it.tick
                );
                it.tick += 1;
            }
        }
    }
}

/// The sensors' node hears its own identifiers from elsewhere: it closes the valves too.
#[test]
fn sensor_messages_from_elsewhere_close_the_output_stage() {
    let mut it = soft_loop();
    let mut forger = forger(&it, 1);
    for n in 1..=10_u32 {
        for frame in forger.encode(it.tick as u16, &lies()) {
            it.plant.receive(frame.id, &frame.data);
        }
        it.run(1);
        assert_eq!(it.command == ValveCommand::SAFE, n >= 3, "tick {n}");
    }
}

/// Delivers the frames of every tick so many ticks later, from some tick on.
struct Delay {
    ticks: usize,
    waiting: VecDeque<Vec<Frame>>,
}

impl Delay {
    fn new(ticks: usize) -> Self {
        Self {
            ticks,
            waiting: VecDeque::new(),
        }
    }

    fn pass(&mut self, frames: &mut Vec<Frame>) {
        self.waiting.push_back(std::mem::take(frames));
        if self.waiting.len() > self.ticks {
            *frames = self.waiting.pop_front().unwrap_or_default();
        }
    }
}

#[test]
fn a_delay_from_the_first_frame_on_never_becomes_normal() {
    for ticks in [3, 4, 7, 16, 32, 100, 200, 256, 300, 512, 800, 1000] {
        let mut it = Loop::new(Configuration::defender110().with_strategy(Strategy::AlwaysSoft));
        let mut delay = Delay::new(ticks);
        for _ in 0..2500 {
            let outputs = it.step(rough_road(it.tick), |_| {}, |frames| delay.pass(frames));
            assert_eq!(
                (outputs.mode, outputs.command, it.command),
                (Mode::StartUp, ValveCommand::SAFE, ValveCommand::SAFE),
                "{ticks} late in tick {}",
                it.tick
            );
        }
    }
}

#[test]
fn a_delay_that_begins_is_safe_and_its_end_is_normal() {
    for ticks in [3, 4, 10, 16, 48, 200, 256, 800] {
        let mut it = soft_loop();
        let mut delay = Delay::new(ticks);
        let (n, outputs) = until_reaction(&mut it, 6, |_, frames| delay.pass(frames));
        assert!(n <= 6, "{ticks} late: {n}");
        assert_eq!(outputs.mode, Mode::Safe);
        for _ in 0..1200 {
            let outputs = it.step(rough_road(it.tick), |_| {}, |frames| delay.pass(frames));
            assert_eq!(
                (outputs.mode, it.command),
                (Mode::Safe, ValveCommand::SAFE),
                "{ticks} late"
            );
        }
        let mut back = 0;
        while it.run(1).mode != Mode::Normal {
            back += 1;
            assert!(back < 400, "{ticks} late: does not recover");
        }
    }
}

/// Up to two ticks are borne: the age limit.
#[test]
fn two_ticks_of_delay_are_borne() {
    for ticks in [1, 2] {
        let mut it = Loop::new(Configuration::defender110().with_strategy(Strategy::AlwaysSoft));
        let mut delay = Delay::new(ticks);
        for _ in 0..600 {
            it.step(rough_road(it.tick), |_| {}, |frames| delay.pass(frames));
        }
        let outputs = it.step(rough_road(it.tick), |_| {}, |frames| delay.pass(frames));
        assert_eq!(
            (outputs.mode, it.command),
            (Mode::Normal, ValveCommand::SOFT),
            "{ticks} late"
        );
    }
}

/// The commands are late instead of the readings: the sensors' echo tells.
#[test]
fn commands_that_are_late_are_found_by_both_ends() {
    let mut it = soft_loop();
    let mut late: VecDeque<Frame> = VecDeque::new();
    let (mut mode, mut closed_at) = (Mode::Normal, None);
    for n in 1..=300 {
        let inputs = it.sensors(rough_road(it.tick));
        for frame in it.plant.encode(it.tick as u16, &inputs) {
            it.node.receive(frame.id, &frame.data);
        }
        let (outputs, sent) = it.node.tick();
        late.extend(sent);
        while late.len() > 20 {
            let frame = late.pop_front().unwrap();
            it.plant.receive(frame.id, &frame.data);
        }
        it.command = it.plant.end_of_tick();
        it.tick += 1;
        mode = outputs.mode;
        if it.command == ValveCommand::SAFE {
            closed_at = closed_at.or(Some(n));
        }
        assert!(n < 8 || it.command == ValveCommand::SAFE, "tick {n}");
    }
    assert_eq!(mode, Mode::Safe);
    assert!(closed_at.is_some_and(|n| n <= 4), "{closed_at:?}");
}

/// A loop of recorded frames replaces the right ones, of every length that a counter takes for its continuation.
#[test]
fn a_recording_is_not_believed() {
    for length in [16, 32, 160, 256, 320, 800] {
        let mut it = soft_loop();
        let mut recording: Vec<Vec<Frame>> = Vec::new();
        for _ in 0..length {
            it.step(rough_road(it.tick), |_| {}, |frames| recording.push(frames.clone()));
        }
        let (n, outputs) = until_reaction(&mut it, 6, |tick, frames| {
            frames.clone_from(&recording[(tick as usize - 600) % length]);
        });
        assert!(n <= 4, "{length}: {n}");
        assert_eq!(outputs.mode, Mode::Safe);
        let mut worst_word = 0;
        for _ in 0..8000 {
            let at = (it.tick as usize - 600) % length;
            let outputs = it.step(rough_road(it.tick), |_| {}, |frames| frames.clone_from(&recording[at]));
            assert_ne!(outputs.mode, Mode::Normal);
            worst_word |= it.command.word();
        }
        assert_eq!(worst_word, 0, "{length}");
    }
}

/// A loop of recorded commands in place of the controller's, which has fallen silent. Only loops of a multiple of 256 ticks would
/// answer a fresh tick from the beginning.
#[test]
fn recorded_commands_open_nothing() {
    for length in [16, 48, 200, 320, 800] {
        let mut it = soft_loop();
        let mut recording: Vec<Frame> = Vec::new();
        let mut opened = 0;
        for n in 0..20_000 {
            let inputs = it.sensors(rough_road(it.tick));
            let frames = it.plant.encode(it.tick as u16, &inputs);
            if n < length {
                for frame in frames {
                    it.node.receive(frame.id, &frame.data);
                }
                let (_, sent) = it.node.tick();
                recording.extend(sent.iter().filter(|frame| frame.id == COMMAND.id));
            }
            it.plant.receive(COMMAND.id, &recording[n % length].data);
            it.command = it.plant.end_of_tick();
            it.tick += 1;
            if n >= length + 4 {
                opened |= it.command.word();
            }
        }
        assert_eq!(opened, 0, "{length}");
    }
}

/// The sender's sampling has stopped while its counters run and it still echoes.
#[test]
fn a_plant_tick_that_stands_still() {
    let mut it = soft_loop();
    let frozen = it.tick as u16;
    let held = it.sensors(rough_road(it.tick));
    for n in 1..=300 {
        for frame in it.plant.encode(frozen, &held) {
            it.node.receive(frame.id, &frame.data);
        }
        let (outputs, sent) = it.node.tick();
        for frame in sent {
            it.plant.receive(frame.id, &frame.data);
        }
        it.plant.end_of_tick();
        assert_eq!(outputs.mode == Mode::Normal, n < 4, "tick {n}: {:?}", outputs.mode);
    }
}

/// One message alone is late, so that the six do not belong together.
#[test]
fn one_message_out_of_step() {
    for message in SensorMessage::ALL {
        let id = message.contract().id;
        for ticks in [3, 5, 8, 12] {
            let mut it = Loop::new(Configuration::defender110().with_strategy(Strategy::AlwaysSoft));
            let mut late: VecDeque<Frame> = VecDeque::new();
            for _ in 0..600 {
                let outputs = it.step(
                    rough_road(it.tick),
                    |_| {},
                    |frames| {
                        let at = frames.iter().position(|frame| frame.id == id).unwrap();
                        late.push_back(frames.remove(at));
                        if late.len() > ticks {
                            frames.extend(late.pop_front());
                        }
                    },
                );
                assert_eq!(
                    outputs.mode,
                    Mode::StartUp,
                    "{message:?} {ticks} late in tick {}",
                    it.tick
                );
            }
        }
    }
}

/// Two messages of the same kind under each other's identifiers: the data identifiers tell.
#[test]
fn messages_under_each_others_names() {
    let mut it = soft_loop();
    let ids = [Corner::FrontLeft, Corner::FrontRight].map(|corner| SensorMessage::Pressure(corner).contract().id);
    let (n, outputs) = until_reaction(&mut it, 6, |_, frames| {
        for frame in frames {
            frame.id = match frame.id {
                id if id == ids[0] => ids[1],
                id if id == ids[1] => ids[0],
                other => other,
            };
        }
    });
    assert_eq!(
        (n, outputs.mode, outputs.fault),
        (3, Mode::Degraded, FaultCode::MessageLost)
    );
}
