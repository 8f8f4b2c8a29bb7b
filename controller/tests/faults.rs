//! Every fault on every message and reading: detected within N ticks, reacted to within M, and the valve pattern then.
//!
//! N is the tick in which the mode first leaves normal, M the tick of the first command that shows it; the tables here are the
//! ones of `docs/safety.md`.

mod common;

use common::{Loop, rough_road};
use oleo_controller::can::Frame;
use oleo_controller::{
    Axle, Configuration, Corner, Corners, FaultCode, Gauge, Inputs, MessageSet, Mode, Outputs, PressurePoint, Reading,
    SensorMessage, Strategy, StrutPressures, Valve, ValveCommand,
};
use proptest::prelude::*;

/// All valves open in normal mode, so that every reaction shows.
fn soft_loop() -> Loop {
    let mut it = Loop::new(Configuration::defender110().with_strategy(Strategy::AlwaysSoft));
    let outputs = it.run(600);
    assert_eq!(
        (outputs.mode, outputs.command.word()),
        (Mode::Normal, 0xFFF),
        "{outputs:?}"
    );
    it
}

/// Ticks until the mode is not normal, with the outputs of that tick.
fn until_reaction(
    it: &mut Loop,
    most: u32,
    mut inputs: impl FnMut(&mut Inputs),
    mut frames: impl FnMut(&mut Vec<Frame>),
) -> (u32, Outputs) {
    for n in 1..=most {
        let outputs = it.step(rough_road(it.tick), &mut inputs, &mut frames);
        if outputs.mode != Mode::Normal {
            let answer = it.answer.expect("a command frame every tick");
            assert_eq!(
                (answer.mode, answer.command),
                (outputs.mode, outputs.command),
                "reacted in the same tick"
            );
            return (n, outputs);
        }
    }
    panic!("no reaction within {most} ticks");
}

/// The command when one axle's sensors are incomplete: springs closed, and only the other axle keeps its dampers.
/// Valve 2 rests behind a closed valve 3.
fn limp_pattern(affected: Axle) -> ValveCommand {
    ValveCommand::from_fn(|corner, valve| corner.axle() != affected && valve == Valve::Bypass1)
}

fn axle_of(message: SensorMessage) -> Axle {
    match message {
        SensorMessage::Pressure(corner) => corner.axle(),
        SensorMessage::Displacement(axle) => axle,
    }
}

/// One of the twenty readings.
#[derive(Clone, Copy, Debug)]
enum Place {
    Displacement(Corner),
    Pressure(Corner, PressurePoint),
}

impl Place {
    fn all() -> impl Iterator<Item = Self> {
        let pressures = Corner::ALL
            .into_iter()
            .flat_map(|corner| PressurePoint::ALL.map(|point| Self::Pressure(corner, point)));
        Corner::ALL.into_iter().map(Self::Displacement).chain(pressures)
    }

    fn axle(self) -> Axle {
        let (Self::Displacement(corner) | Self::Pressure(corner, _)) = self;
        corner.axle()
    }

    fn of(self, inputs: &mut Inputs) -> &mut Reading {
        match self {
            Self::Displacement(corner) => &mut inputs.displacement[corner],
            Self::Pressure(corner, point) => &mut inputs.pressure[corner][point],
        }
    }
}

#[test]
fn every_message_silent() {
    for message in SensorMessage::ALL {
        let contract = message.contract();
        let mut it = soft_loop();
        let (n, outputs) = until_reaction(&mut it, 20, |_| {}, |frames| frames.retain(|f| f.id != contract.id));
        assert_eq!(
            (n, outputs.mode, outputs.fault),
            (4, Mode::Degraded, FaultCode::MessageLost),
            "{message:?}"
        );
        assert_eq!(outputs.command, limp_pattern(axle_of(message)), "{message:?}");
    }
}

#[test]
fn every_message_corrupted() {
    for message in SensorMessage::ALL {
        let contract = message.contract();
        let mut it = soft_loop();
        let corrupt = |frames: &mut Vec<Frame>| {
            for frame in frames.iter_mut().filter(|f| f.id == contract.id) {
                frame.data[3] ^= 0x40;
            }
        };
        let (n, outputs) = until_reaction(&mut it, 20, |_| {}, corrupt);
        assert_eq!(
            (n, outputs.mode, outputs.fault),
            (3, Mode::Degraded, FaultCode::MessageLost),
            "{message:?}"
        );
        assert_eq!(outputs.command, limp_pattern(axle_of(message)), "{message:?}");
    }
}

#[test]
fn every_message_frozen_in_a_gateway() {
    for message in SensorMessage::ALL {
        let contract = message.contract();
        let mut it = soft_loop();
        let mut stored = None;
        let (n, outputs) = until_reaction(
            &mut it,
            20,
            |_| {},
            |frames| {
                for frame in frames.iter_mut().filter(|f| f.id == contract.id) {
                    frame.data = *stored.get_or_insert(frame.data);
                }
            },
        );
        // The first of them is still right.
        assert_eq!(
            (n, outputs.mode, outputs.fault),
            (5, Mode::Degraded, FaultCode::MessageLost),
            "{message:?}"
        );
        assert_eq!(outputs.command, limp_pattern(axle_of(message)), "{message:?}");
    }
}

#[test]
fn bus_silence_and_its_end() {
    let mut it = soft_loop();
    let (n, outputs) = until_reaction(&mut it, 20, |_| {}, Vec::clear);
    assert_eq!(
        (n, outputs.mode, outputs.fault, outputs.command.word()),
        (4, Mode::Safe, FaultCode::BusSilent, 0)
    );
    // Back: trusted and healthy for 1 s, then normal.
    let mut back = 0;
    while it.run(1).mode != Mode::Normal {
        assert_eq!(it.command.word(), 0);
        back += 1;
        assert!(back < 300, "does not recover");
    }
    assert!((210..230).contains(&back), "{back}");
}

#[test]
fn long_silence_and_repeated_silence_latch() {
    let mut it = soft_loop();
    let mut last = Mode::Normal;
    for n in 0..2100 {
        let outputs = it.step(rough_road(it.tick), |_| {}, Vec::clear);
        if outputs.mode == Mode::Latched && last != Mode::Latched {
            assert_eq!(n, 3 + 2000);
        }
        last = outputs.mode;
    }
    assert_eq!(last, Mode::Latched);
    assert_eq!(it.run(2000).mode, Mode::Latched, "health does not help");

    // The recovery takes longer each time; the fifth silence within a minute of the one before latches.
    let mut it = soft_loop();
    for (entry, recovery) in [(1, 1.0), (2, 4.0), (3, 16.0), (4, 64.0), (5, 64.0)] {
        for _ in 0..10 {
            it.step(rough_road(it.tick), |_| {}, Vec::clear);
        }
        let just_before = it.run((recovery * 200.0) as u32);
        assert_eq!(
            just_before.mode,
            if entry < 5 { Mode::Safe } else { Mode::Latched },
            "entry {entry}"
        );
        let outputs = it.run(40);
        assert_eq!(
            outputs.mode,
            if entry < 5 { Mode::Normal } else { Mode::Latched },
            "entry {entry}"
        );
    }
    assert_eq!(it.command.word(), 0);
}

/// What goes wrong with one reading.
fn every_reading(fault: impl Fn(&mut Reading, f32), most: u32, expected: FaultCode) -> u32 {
    let mut slowest = 0;
    for place in Place::all() {
        let mut it = soft_loop();
        let (n, outputs) = until_reaction(
            &mut it,
            most,
            |inputs| {
                let scale = match place {
                    Place::Displacement(_) => 1.0,
                    Place::Pressure(..) => 1.2e8,
                };
                fault(place.of(inputs), scale);
            },
            |_| {},
        );
        assert_eq!((outputs.mode, outputs.fault), (Mode::Degraded, expected), "{place:?}");
        assert_eq!(outputs.command, limp_pattern(place.axle()), "{place:?}");
        slowest = slowest.max(n);
    }
    slowest
}

#[test]
fn every_reading_nan_flagged_or_out_of_range() {
    assert_eq!(
        every_reading(|r, _| *r = Reading::new(f32::NAN), 10, FaultCode::SensorRange),
        3
    );
    assert_eq!(
        every_reading(|r, _| *r = Reading::INVALID, 10, FaultCode::SensorRange),
        3
    );
    assert_eq!(
        every_reading(|r, scale| *r = Reading::new(0.3 * scale), 10, FaultCode::SensorRange),
        3
    );
    assert_eq!(
        every_reading(|r, scale| *r = Reading::new(-0.3 * scale), 10, FaultCode::SensorRange),
        3
    );
}

#[test]
fn every_reading_jumping() {
    let flip = std::cell::Cell::new(false);
    let n = every_reading(
        |r, scale| {
            flip.set(!flip.get());
            *r = Reading::new((if flip.get() { 0.20 } else { 0.01 }) * scale);
        },
        20,
        FaultCode::SensorRate,
    );
    assert!(n <= 10, "{n}");
}

#[test]
fn every_reading_stuck() {
    let mut slowest = 0;
    for place in Place::all().filter(|place| !matches!(place, Place::Pressure(_, PressurePoint::P4))) {
        let mut it = soft_loop();
        let held = std::cell::Cell::new(None);
        let (n, outputs) = until_reaction(
            &mut it,
            220,
            |inputs| {
                let reading = place.of(inputs);
                held.set(held.get().or(Some(*reading)));
                *reading = held.get().unwrap();
            },
            |_| {},
        );
        assert_eq!(
            (outputs.mode, outputs.fault),
            (Mode::Degraded, FaultCode::SensorStuck),
            "{place:?}"
        );
        slowest = slowest.max(n);
    }
    assert!(slowest <= 200, "{slowest}");
}

#[test]
fn pressure_offset_is_outvoted_and_displacement_offset_breaks_the_oil_balance() {
    for point in PressurePoint::ALL {
        let mut it = soft_loop();
        let shift = |inputs: &mut Inputs| {
            let reading = &mut inputs.pressure[Corner::RearLeft][point];
            *reading = Reading::new(reading.value().unwrap() + 1.7e6);
        };
        let (n, outputs) = until_reaction(&mut it, 600, shift, |_| {});
        assert_eq!(outputs.mode, Mode::Degraded);
        assert!(n <= 400, "{}: {n}", point.key());
        let balanced = matches!(point, PressurePoint::P2 | PressurePoint::P4);
        assert!(outputs.fault == FaultCode::SensorVote || (balanced && outputs.fault == FaultCode::OilBalance));
    }
    let mut it = soft_loop();
    let (n, outputs) = until_reaction(
        &mut it,
        600,
        |inputs| {
            let reading = &mut inputs.displacement[Corner::FrontRight];
            *reading = Reading::new(reading.value().unwrap() + 0.07);
        },
        |_| {},
    );
    assert_eq!((outputs.mode, outputs.fault), (Mode::Degraded, FaultCode::OilBalance));
    assert!(n <= 400, "{n}");
}

#[test]
fn both_axles_affected_is_safe_and_one_axle_is_not() {
    use Corner::{FrontLeft, FrontRight, RearLeft, RearRight};
    for (a, b, mode) in [
        (FrontLeft, FrontRight, Mode::Degraded),
        (RearLeft, RearRight, Mode::Degraded),
        (FrontLeft, RearLeft, Mode::Safe),
        (FrontRight, RearRight, Mode::Safe),
    ] {
        let mut it = soft_loop();
        let (n, outputs) = until_reaction(
            &mut it,
            10,
            |inputs| {
                inputs.displacement[a] = Reading::INVALID;
                inputs.pressure[b].p1 = Reading::INVALID;
            },
            |_| {},
        );
        assert_eq!((n, outputs.mode), (3, mode));
    }
}

#[test]
fn limp_mode_ends_after_a_second_of_health() {
    let mut it = soft_loop();
    until_reaction(
        &mut it,
        10,
        |inputs| inputs.displacement[Corner::FrontLeft] = Reading::INVALID,
        |_| {},
    );
    let mut n = 0;
    while it.run(1).mode != Mode::Normal {
        n += 1;
    }
    assert_eq!(
        n, 210,
        "12 to be believed, of which the last is the first of 200 healthy ones"
    );
}

#[test]
fn a_failed_solenoid_latches_in_the_next_tick() {
    let mut it = soft_loop();
    it.node.report_solenoid_failure();
    let outputs = it.run(1);
    assert_eq!(
        (outputs.mode, outputs.fault, outputs.command.word()),
        (Mode::Latched, FaultCode::Solenoid, 0)
    );
    assert_eq!(it.run(500).mode, Mode::Latched);
}

#[test]
fn start_up_waits_with_closed_valves() {
    let mut it = Loop::new(Configuration::defender110());
    for _ in 0..1000 {
        let outputs = it.step(rough_road(it.tick), |_| {}, Vec::clear);
        assert_eq!((outputs.mode, outputs.command.word()), (Mode::StartUp, 0));
    }
    let mut n = 0;
    while it.run(1).mode == Mode::StartUp {
        n += 1;
    }
    assert!((30..40).contains(&n), "{n}");
}

#[test]
fn single_lost_frames_do_not_disturb() {
    let mut it = soft_loop();
    for n in 0..2000u32 {
        let outputs = it.step(
            rough_road(it.tick),
            |_| {},
            |frames| {
                if n % 7 < 2 {
                    frames.remove((n / 7) as usize % frames.len());
                }
            },
        );
        assert_eq!(
            (outputs.mode, outputs.command.word()),
            (Mode::Normal, 0xFFF),
            "tick {n}"
        );
    }
}

fn any_frame() -> impl Strategy2<Value = Frame> {
    (
        prop_oneof![
            Just(0x110u16),
            Just(0x111),
            Just(0x112),
            Just(0x113),
            Just(0x114),
            Just(0x115),
            any::<u16>()
        ],
        any::<[u8; 8]>(),
    )
        .prop_map(|(id, data)| Frame { id, data })
}

use proptest::strategy::Strategy as Strategy2;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Any frames whatever: no panic, and without a single right frame the valves stay closed.
    #[test]
    fn noise_opens_nothing(ticks in prop::collection::vec(prop::collection::vec(any_frame(), 0..8), 1..60)) {
        let mut node = oleo_controller::Node::new(Configuration::defender110());
        for frames in ticks {
            for frame in frames {
                node.receive(frame.id, &frame.data);
            }
            prop_assert_eq!(node.tick().0.command.word(), 0);
        }
    }

    /// Any readings whatever: the command is what the mode permits, latched stays latched, nothing panics.
    #[test]
    fn any_readings(ticks in prop::collection::vec(
        (prop::array::uniform4(prop::num::f32::ANY), prop::array::uniform4(prop::array::uniform4(prop::num::f32::ANY)),
         any::<u8>(), prop::bool::weighted(0.01)), 1..80),
        quiet in 0u32..100)
    {
        let mut it = Loop::new(Configuration::defender110());
        it.run(quiet);
        let (configuration, mut state) = (Configuration::defender110(), oleo_controller::State::new());
        let mut latched = false;
        for (x, p, lost_messages, solenoid_failed) in ticks {
            let pressure = Corners::from_array(p.map(|p| StrutPressures::from_array(p.map(Gauge))));
            let mut inputs = Inputs::from_values(Corners::from_array(x), pressure);
            inputs.lost_messages = MessageSet::from_bits(lost_messages);
            inputs.solenoid_failed = solenoid_failed;
            let outputs = oleo_controller::tick(&configuration, &mut state, &inputs);
            prop_assert!(outputs.estimate.is_finite());
            if matches!(outputs.mode, Mode::StartUp | Mode::Safe | Mode::Latched) {
                prop_assert_eq!(outputs.command.word(), 0);
            }
            if outputs.mode == Mode::Degraded {
                prop_assert!(Corner::ALL.iter().all(|&corner| !outputs.command.is_open(corner, Valve::Spring)));
            }
            latched |= solenoid_failed;
            prop_assert_eq!(outputs.mode == Mode::Latched, latched || outputs.mode == Mode::Latched);
            prop_assert!(!latched || outputs.mode == Mode::Latched);
        }
    }

    /// Bursts of missing, doubled, corrupted and swapped frames on a running system: the valve pattern always fits the mode, and when
    /// all is quiet again the mode is normal or latched.
    #[test]
    fn bursts(events in prop::collection::vec((0u8..5, 0usize..6, 1u8..12), 1..12)) {
        let mut it = Loop::new(Configuration::defender110());
        it.run(100);
        let mut latched = false;
        for (kind, index, length) in events {
            for _ in 0..length {
                let outputs = it.step(rough_road(it.tick), |_| {}, |frames| match kind {
                    0 => { frames.remove(index); }
                    1 => { let double = frames[index]; frames.push(double); }
                    2 => frames[index].data[5] ^= 0x11,
                    3 => frames.swap(index, 5 - index),
                    _ => frames.clear(),
                });
                prop_assert!(!latched || outputs.mode == Mode::Latched);
                latched = outputs.mode == Mode::Latched;
                if !matches!(outputs.mode, Mode::Normal | Mode::Degraded) {
                    prop_assert_eq!(outputs.command.word(), 0);
                }
            }
        }
        let mode = it.run(700).mode;
        prop_assert!(mode == Mode::Normal || mode == Mode::Latched, "{:?}", mode);
    }
}
