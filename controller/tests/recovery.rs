//! Faults that come and go: the mode does not follow them, valves do not chatter, and what recovers may be used again.

mod common;

use common::{Loop, rough_road};
use oleo_controller::can::Frame;
use oleo_controller::failsafe::MODE_CHANGES_A_MINUTE;
use oleo_controller::{
    Configuration, Corner, FaultCode, Inputs, Mode, Outputs, PressurePoint, Reading, SensorMessage, Strategy,
};
use proptest::prelude::*;
use proptest::strategy::Strategy as Draw;

const SECOND: u32 = 200;
const MINUTE: u32 = 60 * SECOND;

fn soft_loop() -> Loop {
    let mut it = Loop::new(Configuration::defender110().with_strategy(Strategy::AlwaysSoft));
    it.run(600);
    it
}

/// Runs with a fault, and counts how often the mode changes.
fn mode_changes(it: &mut Loop, ticks: u32, mut fault: impl FnMut(u32, &mut Inputs)) -> (u32, Mode) {
    let (mut changes, mut before) = (0, Mode::Normal);
    for n in 0..ticks {
        let mode = it.step(rough_road(it.tick), |inputs| fault(n, inputs), |_| {}).mode;
        changes += u32::from(std::mem::replace(&mut before, mode) != mode);
    }
    (changes, before)
}

#[test]
fn a_reading_that_is_missing_3_of_216_ticks_for_ten_minutes() {
    let mut it = soft_loop();
    let (changes, mode) = mode_changes(&mut it, 10 * MINUTE, |n, inputs| {
        if n % 216 < 3 {
            inputs.pressure[Corner::RearLeft].p1 = Reading::new(f32::NAN);
        }
    });
    // Once restricted, back after a second, and then for good.
    assert_eq!((changes, mode), (3, Mode::Degraded));
    // It ends when the fault does.
    assert_eq!(it.run(64 * SECOND + 40).mode, Mode::Normal);
}

#[test]
fn a_constant_offset_changes_the_mode_once() {
    for point in PressurePoint::ALL {
        for offset_pa in [1.2e6, 1.7e6, 3.0e6] {
            let mut it = soft_loop();
            let (changes, mode) = mode_changes(&mut it, MINUTE, |_, inputs| {
                let reading = &mut inputs.pressure[Corner::RearLeft][point];
                *reading = Reading::new(reading.value().unwrap() + offset_pa);
            });
            // Near the threshold the first verdict may come and go once.
            let most = if offset_pa < 1.5e6 { 3 } else { 1 };
            assert!(changes <= most, "{point:?} off by {offset_pa}: {changes}");
            assert_eq!(mode, Mode::Degraded, "{point:?} off by {offset_pa}");
        }
    }
    for offset_m in [0.05, 0.07] {
        let mut it = soft_loop();
        let (changes, mode) = mode_changes(&mut it, MINUTE, |_, inputs| {
            let reading = &mut inputs.displacement[Corner::FrontRight];
            *reading = Reading::new(reading.value().unwrap() + offset_m);
        });
        assert_eq!((changes, mode), (1, Mode::Degraded), "off by {offset_m}");
    }
}

#[test]
fn three_short_dropouts_500_s_apart_do_not_latch() {
    let mut it = soft_loop();
    for _ in 0..3 {
        for _ in 0..10 {
            it.step(rough_road(it.tick), |_| {}, Vec::clear);
        }
        assert_eq!(it.run(500 * SECOND).mode, Mode::Normal);
    }
}

/// Runs with the front left displacement dead, and no message at all for some ticks.
fn dead_sensor(it: &mut Loop, ticks: u32, silent: bool) -> Outputs {
    let mut outputs = Outputs::default();
    for _ in 0..ticks {
        outputs = it.step(
            rough_road(it.tick),
            |inputs| inputs.displacement[Corner::FrontLeft] = Reading::INVALID,
            |frames: &mut Vec<Frame>| {
                if silent {
                    frames.clear();
                }
            },
        );
    }
    outputs
}

#[test]
fn one_dead_sensor_with_one_dropout_ends_in_limp_mode() {
    let mut it = soft_loop();
    assert_eq!(dead_sensor(&mut it, 20, false).mode, Mode::Degraded);
    assert_eq!(dead_sensor(&mut it, 10, true).mode, Mode::Safe);
    let outputs = dead_sensor(&mut it, 30 * SECOND, false);
    assert_eq!((outputs.mode, outputs.fault), (Mode::Degraded, FaultCode::SensorRange));
    assert_ne!(outputs.command.word(), 0, "the rear dampers follow the strategy again");
    assert_eq!(it.run(6 * SECOND).mode, Mode::Normal);
}

#[test]
fn a_reading_missing_3_of_20_ticks_does_not_make_valves_chatter() {
    let mut it = Loop::new(Configuration::defender110());
    it.run(600);
    let mut words = Vec::new();
    for n in 0..4000 {
        it.step(
            rough_road(it.tick),
            |inputs| {
                if n % 20 < 3 {
                    inputs.displacement[Corner::FrontLeft] = Reading::INVALID;
                }
            },
            |_| {},
        );
        words.push(it.command.word());
    }
    assert!(most_switches_a_second(&words) <= 10);
    // The front axle is closed for good: 3 of 20 ticks are a fault all the time.
    assert!(words[100..].iter().all(|word| word & 0b111_111 == 0));
}

/// Most switchings of any valve within any second.
fn most_switches_a_second(words: &[u16]) -> usize {
    (0..12)
        .map(|bit| {
            let edge = |tick: &usize| words[*tick] >> bit & 1 != words[*tick - 1] >> bit & 1;
            let edges: Vec<usize> = (1..words.len()).filter(edge).collect();
            most_within(&edges, SECOND as usize)
        })
        .max()
        .unwrap_or(0)
}

/// Most of the ascending times within a span.
fn most_within(times: &[usize], span: usize) -> usize {
    let within = |first: usize| {
        times[first..]
            .iter()
            .take_while(|&&time| time < times[first] + span)
            .count()
    };
    (0..times.len()).map(within).max().unwrap_or(0)
}

/// Something that goes wrong for some ticks, again and again.
#[derive(Clone, Debug)]
struct Flapping {
    what: u8,
    corner: u8,
    point: u8,
    on: u32,
    off: u32,
    from: u32,
}

impl Flapping {
    fn is_on(&self, n: u32) -> bool {
        n >= self.from && (n - self.from) % (self.on + self.off) < self.on
    }

    fn corner(&self) -> Corner {
        Corner::ALL[usize::from(self.corner)]
    }

    fn readings(&self, n: u32, inputs: &mut Inputs) {
        if !self.is_on(n) {
            return;
        }
        let pressure = &mut inputs.pressure[self.corner()][PressurePoint::ALL[usize::from(self.point)]];
        let displacement = &mut inputs.displacement[self.corner()];
        match self.what {
            0 => *pressure = Reading::INVALID,
            1 => *displacement = Reading::INVALID,
            2 => *pressure = Reading::new(pressure.value().unwrap_or(0.0) + 2.0e6),
            3 => *displacement = Reading::new(displacement.value().unwrap_or(0.0) + 0.08),
            4 => *pressure = Reading::new(2.0e6 + 6.0e6 * (n % 2) as f32),
            _ => {}
        }
    }

    fn frames(&self, n: u32, frames: &mut Vec<Frame>) {
        if !self.is_on(n) {
            return;
        }
        let id = SensorMessage::Pressure(self.corner()).contract().id;
        match self.what {
            5 => frames.clear(),
            6 => frames.retain(|frame| frame.id != id),
            7 => frames
                .iter_mut()
                .filter(|frame| frame.id == id)
                .for_each(|frame| frame.data[4] ^= 1),
            8 => frames.extend(frames.clone().iter().filter(|frame| frame.id == id)),
            9 => frames.push(Frame {
                id: 0x0A0,
                data: [0; 8],
            }),
            _ => {}
        }
    }
}

fn flapping() -> impl Draw<Value = Flapping> {
    (
        0u8..10,
        0u8..4,
        0u8..4,
        1u32..40,
        prop_oneof![1u32..60, 190u32..260, 700u32..1200, 3000u32..4000],
        0u32..3000,
    )
        .prop_map(|(what, corner, point, on, off, from)| Flapping {
            what,
            corner,
            point,
            on,
            off,
            from,
        })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Whatever flaps: no valve switches more than ten times in any second, the mode changes at most sixteen times in any minute,
    /// a closed mode means closed valves, and latched stays latched.
    #[test]
    fn nothing_chatters(faults in prop::collection::vec(flapping(), 1..6), policy in 0usize..2) {
        let strategy = [Strategy::AlwaysSoft, Strategy::RideHandling][policy];
        let mut it = Loop::new(Configuration::defender110().with_strategy(strategy));
        it.run(200);
        let (mut words, mut driven, mut changes, mut before) = (vec![0], vec![0], Vec::new(), Mode::Normal);
        for n in 0..2 * MINUTE {
            let outputs = it.step(
                rough_road(it.tick),
                |inputs| faults.iter().for_each(|fault| fault.readings(n, inputs)),
                |frames| faults.iter().for_each(|fault| fault.frames(n, frames)),
            );
            if outputs.mode != before {
                prop_assert!(before != Mode::Latched);
                changes.push(n as usize);
                before = outputs.mode;
            }
            if matches!(outputs.mode, Mode::StartUp | Mode::Safe | Mode::Latched) {
                prop_assert_eq!(outputs.command.word(), 0);
                prop_assert_eq!(it.command.word(), 0);
            }
            words.push(outputs.command.word());
            driven.push(it.command.word());
        }
        prop_assert!(most_switches_a_second(&words) <= 10);
        prop_assert!(most_switches_a_second(&driven) <= 10, "at the output stage");
        prop_assert!(most_within(&changes, MINUTE as usize) <= MODE_CHANGES_A_MINUTE, "{:?}", changes);
    }
}
