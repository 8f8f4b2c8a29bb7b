//! Logs made of drives whose every sample is known, and damaged in every way that logs are.

use oleo_controller::can::{COMMAND, CommandMessage, MESSAGES, Protector};
use oleo_controller::{Inputs, PlantEnd, Reading, ValveCommand};
use oleo_interface::{Corner, Corners, Gauge, StrutPressures};
use proptest::prelude::*;

use std::ops::ControlFlow;

use super::{DriveLog, DrivePart, Drives, LoggedDrive, parse};
use crate::Frame;
use crate::frame::standard;
use crate::logs::candump::write_line;
use crate::logs::{Entry, LoggedFrame};

mod unit;

/// A line of a log before it is written.
#[derive(Clone, Debug)]
struct Line {
    time_us: u64,
    frame: Frame,
}

/// Every sample of this drive differs from every other one in all values.
fn displacement_m(tick: u32, corner: Corner) -> f64 {
    1e-5 * f64::from(tick % 5000) + 0.06 * corner.index() as f64 - 0.1
}

fn pressure_pa(tick: u32, corner: Corner, point: usize) -> f32 {
    5000.0 * (tick % 1500 + 1600 * corner.index() as u32 + point as u32) as f32
}

fn word(tick: u32) -> u16 {
    (tick.wrapping_mul(2654435761) >> 20) as u16 & 0xFFF
}

/// The frames of ticks `from..to`, as the plant and the controller send them.
fn drive(from: u32, to: u32, begins_us: u64) -> Vec<Line> {
    let (mut plant, mut controller) = (PlantEnd::new(), Protector::new(&COMMAND));
    let mut lines = Vec::new();
    for tick in from..to {
        let start = begins_us + u64::from(tick - from) * 5000;
        let pressure = Corners::from_fn(|corner| {
            StrutPressures::from_array([0, 1, 2, 3].map(|point| Gauge(pressure_pa(tick, corner, point))))
        });
        let inputs = Inputs::from_values(Corners::from_fn(|c| displacement_m(tick, c) as f32), pressure);
        for (k, frame) in (0..).zip(plant.encode(tick as u16, &inputs)) {
            lines.push(Line {
                time_us: start + 270 * (k + 1),
                frame: frame.into(),
            });
        }
        let mut data = CommandMessage {
            command: ValveCommand::from_word(word(tick)),
            echo_tick: tick as u8,
            ..CommandMessage::default()
        }
        .encode();
        controller.protect(&mut data);
        lines.push(Line {
            time_us: start + 2200,
            frame: Frame::whole(standard(COMMAND.id), data),
        });
    }
    lines
}

fn written(lines: &[Line]) -> Vec<u8> {
    let mut log = Vec::new();
    for line in lines {
        write_line(&mut log, line.time_us, "can0", &line.frame).expect("memory takes it");
    }
    log
}

fn read(lines: &[Line]) -> DriveLog {
    parse(&written(lines)).expect("a drive")
}

/// Whatever is there must be what was sent in its tick. Returns how many readings and commands are there.
fn all_true(drive: &LoggedDrive, first_tick: u32) -> usize {
    let mut there = 0;
    for (tick, sample) in (first_tick..).zip(&drive.samples) {
        for corner in Corner::ALL {
            if let Some(x) = sample.displacement_m[corner].value() {
                assert!(
                    (f64::from(x) - displacement_m(tick, corner)).abs() < 1e-7,
                    "tick {tick}"
                );
                there += 1;
            }
            for (point, reading) in sample.pressure_pa[corner].into_array().into_iter().enumerate() {
                if let Some(p) = reading.value() {
                    assert_eq!(
                        p,
                        pressure_pa(tick, corner, point),
                        "tick {tick} {corner:?} p{}",
                        point + 1
                    );
                    there += 1;
                }
            }
        }
        if let Some(command) = sample.command {
            assert_eq!(command.word(), word(tick), "tick {tick}");
            there += 1;
        }
    }
    there
}

const READINGS_OF_A_TICK: usize = 4 * 5 + 1;

#[test]
fn an_undisturbed_log_is_read_whole_over_every_wrap() {
    // Over the wrap of the counter, of eight bits and of sixteen.
    let log = read(&drive(65_000, 66_200, 7_000_000));
    assert_eq!((log.drives.len(), log.drives[0].samples.len()), (1, 1200));
    assert_eq!(all_true(&log.drives[0], 65_000), 1200 * READINGS_OF_A_TICK);
    for message in &log.account.messages {
        let quiet = (
            message.lost,
            message.late,
            message.repeated,
            message.corrupted,
            message.out_of_sequence,
        );
        assert_eq!((message.received, quiet), (1200, (0, 0, 0, 0, 0)), "{message:?}");
    }
}

/// The first edition of the database had sixteen bits of `PlantTick` and `EchoTick`, where there now are eight and a challenge.
#[test]
fn a_log_of_the_first_edition_is_read_too() {
    let mut lines = drive(65_200, 65_900, 0);
    let mut protectors = MESSAGES.map(|contract| Protector::new(&contract));
    for (k, line) in lines.iter_mut().enumerate() {
        let message = MESSAGES
            .iter()
            .position(|m| Some(m.id) == line.frame.standard_id())
            .expect("known");
        let mut bits = u64::from_le_bytes(line.frame.data().try_into().expect("eight bytes"));
        let high = (65_200 + k as u64 / 7) >> 8 & 0xFF;
        match message {
            4 | 5 => bits = bits & !(0xFF << 20) | high << 20,
            6 => bits = bits & !(0xFF << 44) | high << 44,
            _ => {}
        }
        let mut data = bits.to_le_bytes();
        protectors[message].protect(&mut data);
        line.frame = Frame::whole(standard(MESSAGES[message].id), data);
    }
    let log = read(&lines);
    assert_eq!((log.drives.len(), log.drives[0].samples.len()), (1, 700));
    assert_eq!(all_true(&log.drives[0], 65_200), 700 * READINGS_OF_A_TICK);
}

#[test]
fn a_restart_of_the_tick_and_a_silence_begin_another_drive() {
    let mut lines = drive(0, 300, 0);
    // The sender starts again at once, then falls silent for two minutes.
    lines.extend(drive(0, 400, 300 * 5000));
    lines.extend(drive(1000, 1200, 120_000_000));
    let log = read(&lines);
    let lengths: Vec<usize> = log.drives.iter().map(|d| d.samples.len()).collect();
    assert_eq!(lengths, [300, 400, 200]);
    for (drive, first) in log.drives.iter().zip([0, 0, 1000]) {
        assert_eq!(all_true(drive, first), drive.samples.len() * READINGS_OF_A_TICK);
    }
    assert!((log.drives[2].begins_s - 120.0).abs() < 0.002);
    assert_eq!(log.account.total(|m| m.out_of_sequence), 0);
}

#[test]
fn strangers_and_a_line_cut_off_are_counted() {
    let mut lines = drive(0, 100, 0);
    for k in (0..lines.len()).step_by(7).rev() {
        let frame = Frame::new(standard(0x0A1), &[1, 2, 3]).expect("short");
        let time_us = lines[k].time_us;
        lines.insert(k, Line { time_us, frame });
    }
    let mut log = written(&lines);
    log.truncate(log.len() - 9);
    let mut log = parse(&log).expect("a drive");
    assert_eq!(log.account.foreign_frames, 100);
    // The last command is cut off: too short to be one.
    assert_eq!(log.account.messages[6].corrupted, 1);
    assert_eq!(all_true(&log.drives.remove(0), 0), 100 * READINGS_OF_A_TICK - 1);
}

#[test]
fn what_a_sensor_calls_invalid_is_missing() {
    let mut plant = PlantEnd::new();
    let mut inputs = Inputs {
        displacement: Corners::splat(Reading::new(0.01)),
        ..Inputs::default()
    };
    inputs.displacement[Corner::RearLeft] = Reading::INVALID;
    let lines: Vec<Line> = (0..20)
        .flat_map(|tick| plant.encode(tick, &inputs).map(|frame| (u64::from(tick) * 5000, frame)))
        .map(|(time_us, frame)| Line {
            time_us,
            frame: frame.into(),
        })
        .collect();
    let log = read(&lines);
    let sample = &log.drives[0].samples[10];
    assert!(sample.displacement_m[Corner::RearRight].is_valid());
    assert!(!sample.displacement_m[Corner::RearLeft].is_valid());
    assert_eq!(sample.command, None);
}

#[test]
fn a_log_without_a_drive_is_refused_in_one_line() {
    let other = Frame::new(standard(0x123), &[0; 8]).expect("eight");
    let mut lines = vec![
        Line {
            time_us: 0,
            frame: other
        };
        50
    ];
    lines.push(Line {
        frame: drive(0, 1, 0)[0].frame.with_flipped_bit(40),
        time_us: 0,
    });
    let error = parse(&written(&lines)).expect_err("no drive");
    assert!(
        error.contains("50 frames with other identifiers") && error.contains("1 of the suspension's"),
        "{error}"
    );
    assert!(!error.contains('\n'));
    assert!(parse(b"").expect_err("empty").contains("0 entries"));
    let mut backwards = drive(0, 200, 0);
    backwards.reverse();
    let error = parse(&written(&backwards)).expect_err("no drive");
    assert!(error.contains("keep the frames in the order"), "{error}");
}

/// Reads the lines one by one. Returns the number of samples, and the most frames and samples that were held at once.
fn held(lines: impl IntoIterator<Item = Line>) -> (usize, usize) {
    let (mut drives, mut samples, mut most) = (Drives::new(), 0, 0);
    let mut count = |part: DrivePart| {
        samples += usize::from(matches!(part, DrivePart::Sample(_)));
        ControlFlow::Continue(())
    };
    for line in lines {
        let frame = LoggedFrame::from(&line.frame);
        let entry = Entry {
            time_us: line.time_us,
            bus: "can0",
            frame,
        };
        assert!(drives.take(&entry, &mut count).is_continue());
        most = most.max(drives.held());
    }
    let _ = drives.end(&mut count);
    (samples, most)
}

/// Lines of a drive, one second after the other.
fn long_drive(seconds: u32, keep: fn(u32, &Line) -> bool) -> impl Iterator<Item = Line> {
    // All counters have run round after 1024 ticks.
    (0..seconds).flat_map(move |k| {
        let mut lines = drive(0, 1024, 1_000_000 + u64::from(k) * 1024 * 5000);
        lines.retain(|line| keep(k, line));
        lines
    })
}

#[test]
fn a_long_drive_needs_no_more_memory_than_a_short_one() {
    fn is(line: &Line, message: usize) -> bool {
        line.frame.standard_id() == Some(MESSAGES[message].id)
    }
    let (samples, usual) = held(long_drive(12, |_, _| true));
    assert_eq!(samples, 12 * 1024);
    assert!(usual < 30_000, "{usual}");
    assert_eq!(held(long_drive(60, |_, _| true)), (60 * 1024, usual));
    // A message that falls silent for good holds nothing back.
    let (samples, most) = held(long_drive(40, |k, line| k < 5 || !(is(line, 6) || is(line, 2))));
    assert_eq!(samples, 40 * 1024);
    assert!(most < usual + 100, "{most}");
    // What goes on after the displacements waits, but not without end; and so after a displacement message that begins no drive.
    let (samples, most) = held(long_drive(80, |k, line| k < 10 || !(is(line, 4) || is(line, 5))));
    assert_eq!(samples, 10 * 1024);
    assert!(most < usual + (1 << 16) + 5 * (1 << 14), "{most}");
    let (samples, most) = held(long_drive(80, |k, line| {
        let is_first = line.time_us == 1_000_000 + u64::from(k) * 5_120_000 + 270 * 5;
        k < 10 || !(is(line, 4) || is(line, 5)) || k == 20 && is_first
    }));
    assert_eq!(samples, 10 * 1024);
    assert!(most < usual + 2 * (1 << 16) + 5 * (1 << 14), "{most}");
}

/// What a logger does to a frame.
#[derive(Clone, Copy, Debug)]
enum Mishap {
    Lost,
    Repeated,
    Corrupted,
    /// Logged this many frames later.
    Late(usize),
}

fn mishap() -> impl Strategy<Value = Mishap> {
    prop_oneof![
        Just(Mishap::Lost),
        Just(Mishap::Repeated),
        Just(Mishap::Corrupted),
        (1_usize..25).prop_map(Mishap::Late),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn whatever_is_read_was_measured_in_its_tick(
        first in 0_u32..70_000,
        mishaps in prop::collection::vec((0_usize..3500, mishap()), 0..200),
    ) {
        let mut lines = drive(first, first + 500, 1_000_000);
        let count = lines.len();
        let (mut lost, mut repeated, mut damaged) = (0, 0, std::collections::BTreeSet::new());
        for (at, mishap) in mishaps {
            if at >= lines.len() {
                continue;
            }
            match mishap {
                Mishap::Lost => {
                    lines.remove(at);
                    lost += 1;
                }
                Mishap::Repeated => {
                    let again = lines[at].clone();
                    lines.insert(at + 1, again);
                    repeated += 1;
                }
                Mishap::Corrupted => {
                    if damaged.insert(lines[at].time_us) {
                        lines[at].frame = lines[at].frame.with_flipped_bit(17);
                    }
                }
                Mishap::Late(by) => {
                    let mut line = lines.remove(at);
                    let to = (at + by).min(lines.len());
                    line.time_us = lines.get(to.saturating_sub(1)).map_or(line.time_us, |l| l.time_us);
                    lines.insert(to, line);
                }
            }
        }
        let log = read(&lines);
        prop_assert_eq!(log.drives.len(), 1);
        // The drive begins with the first displacement that was read, a few ticks late at most.
        let begins = (first..first + 12).find(|tick| {
            let at_left = log.drives[0].samples.iter().find_map(|s| s.displacement_m[Corner::FrontLeft].value());
            let k = log.drives[0].samples.iter().position(|s| s.displacement_m[Corner::FrontLeft].is_valid()).unwrap_or(0);
            at_left.is_some_and(|x| (f64::from(x) - displacement_m(tick + k as u32, Corner::FrontLeft)).abs() < 1e-7)
        });
        let there = all_true(&log.drives[0], begins.expect("the begin"));
        // Nearly every frame that is not lost or corrupted is used; one moved beyond both ends is not.
        let messages = log.account.total(|m| m.received);
        prop_assert_eq!(messages + log.account.total(|m| m.corrupted), (count - lost + repeated) as u64);
        let unused = log.account.total(|m| m.repeated + m.corrupted + m.out_of_sequence);
        prop_assert!(unused as usize <= repeated + damaged.len() + 30, "{unused}");
        prop_assert!(there > 0);
    }

    #[test]
    fn no_bytes_make_it_panic(bytes in prop::collection::vec(any::<u8>(), 0..600)) {
        let _ = parse(&bytes);
    }

    /// Frames that pass their check but say anything, at any time.
    #[test]
    fn no_content_makes_it_panic(frames in prop::collection::vec((0_usize..7, any::<[u8; 8]>(), any::<u64>()), 0..60)) {
        let mut protectors = MESSAGES.map(|contract| Protector::new(&contract));
        let lines: Vec<Line> = frames.into_iter().map(|(message, mut data, time_us)| {
            protectors[message].protect(&mut data);
            Line { time_us: time_us % 1_000_000_000, frame: Frame::whole(standard(MESSAGES[message].id), data) }
        }).collect();
        if let Ok(log) = parse(&written(&lines)) {
            prop_assert!(log.drives.iter().all(|d| d.samples.len() < 100_000));
        }
    }
}
