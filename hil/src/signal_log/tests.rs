//! Logs of an invented car whose every reading is known, in its own database and units.

use std::cell::Cell;
use std::ops::ControlFlow;
use std::path::Path;

use oleo_interface::{Corner, PressurePoint};
use proptest::prelude::*;

use super::samples::Samples;
use super::stretches::Stretches;
use super::{Database, Selection, SignalLog, SignalMap, SignalPart, parse, readings, survey_of};
use crate::logs::candump::write_line;
use crate::logs::{Account, Entry, FrameKind, FrameSource, LogError, LoggedFrame, Payload, Sink, identifier};

/// Heights in 0.1 mm above 250 mm, falling in compression, big-endian; pressures in bar absolute, a multiplexed frame for each corner;
/// valves in one frame, and a sensor of each axle that says whether it works.
const DBC: &str = include_str!("invented_car.dbc");
const MAP: &str = include_str!("invented_car.toml");

fn selection() -> Selection {
    let map = SignalMap::from_toml(MAP, "map.toml").expect("a map");
    let database = Database::from_bytes(DBC.as_bytes(), "car.dbc").expect("a database");
    Selection::of(&map, &database, "map.toml").expect("a selection")
}

/// Compression in steps of 0.1 mm; every sample and corner differs.
fn height_steps(sample: u64, corner: usize) -> u16 {
    (sample % 700) as u16 + 700 * corner as u16
}

/// Pressure in steps of 0.25 bar above vacuum.
fn pressure_steps(sample: u64, corner: usize, point: usize) -> u16 {
    (20 + sample % 900) as u16 + 4 * corner as u16 + point as u16
}

fn valve_is_open(sample: u64, corner: usize, valve: usize) -> bool {
    (sample / 7 + corner as u64 + valve as u64).is_multiple_of(3)
}

/// A line of a log: time, identifier, data.
type Line = (u64, u32, Vec<u8>);

/// The frames of samples `from..to`, the first at `begins_us`, one sample every 10 ms.
fn drive(from: u64, to: u64, begins_us: u64) -> Vec<Line> {
    let mut lines = Vec::new();
    for sample in from..to {
        let start = begins_us + (sample - from) * 10_000;
        for axle in 0..2 {
            let [left, right] = [2 * axle, 2 * axle + 1].map(|corner| height_steps(sample, corner).to_be_bytes());
            lines.push((
                start,
                0x18FF_0100 + axle as u32,
                vec![0xA5, left[0], left[1], right[0], right[1], 1],
            ));
        }
        for corner in 0..4 {
            let mut data = vec![corner as u8];
            for point in 0..4 {
                data.extend(pressure_steps(sample, corner, point).to_le_bytes());
            }
            // Nine bytes: only CAN FD carries them.
            lines.push((start + 1_500 + 200 * corner as u64, 0x210, data));
        }
        let bits = (0..12).fold(0_u16, |bits, k| {
            bits | u16::from(valve_is_open(sample, k / 3, k % 3)) << k
        });
        lines.push((start + 6_000, 0x220, bits.to_le_bytes().to_vec()));
    }
    lines
}

fn written(lines: &[Line]) -> Vec<u8> {
    let mut log = Vec::new();
    for line in lines {
        write_line(&mut log, line.0, "can2", frame(line)).expect("memory takes it");
    }
    log
}

fn frame((_, number, data): &Line) -> LoggedFrame {
    let kind = if data.len() > 8 {
        FrameKind::Fd(1)
    } else {
        FrameKind::Classic
    };
    let id = identifier(*number, *number > 0x7FF).expect("an identifier");
    LoggedFrame::new(id, kind, Payload::new(data).expect("short")).expect("a frame")
}

/// A drive of 5 s that is logged again and again.
struct Repeated {
    lines: Vec<Line>,
    times: u64,
    /// Number of frames that were read.
    read: std::rc::Rc<Cell<usize>>,
}

impl FrameSource for Repeated {
    fn read(&mut self, sink: &mut Sink) -> Result<Account, LogError> {
        for k in 0..self.times {
            for line in &self.lines {
                self.read.set(self.read.get() + 1);
                let entry = Entry {
                    time_us: line.0 + k * 5_000_000,
                    bus: "can2",
                    frame: frame(line),
                };
                if sink(entry).is_break() {
                    break;
                }
            }
        }
        Ok(Account::default())
    }
}

/// The number of samples in so many times 5 s, and the most frames and samples that were held at once.
fn held(times: u64, keep: fn(&Line) -> bool) -> (usize, usize) {
    let (selection, path, read) = (selection(), Path::new("log"), std::rc::Rc::new(Cell::new(0)));
    let mut lines = drive(0, 500, 0);
    lines.retain(keep);
    let source = || Repeated {
        lines: lines.clone(),
        times,
        read: read.clone(),
    };
    let survey = survey_of(&|| Ok(Box::new(source())), &selection, path).expect("a drive");
    let (mut samples, mut stretches) = (
        Samples::new(&selection, &survey),
        Stretches::new(&selection, survey.beat),
    );
    let (mut count, mut most, mut given) = (0, 0, 0);
    let mut sink = |part: SignalPart| {
        count += usize::from(matches!(part, SignalPart::Sample(_)));
        ControlFlow::Continue(())
    };
    read.set(0);
    let account = readings::read(&mut source(), &selection, path, &mut |frame| {
        given += 1;
        let flow = stretches.take(frame, &mut |step| samples.take(&step, &mut sink));
        most = most.max(read.get() - given + stretches.held() + samples.held());
        flow
    });
    account.expect("one bus");
    let _ = stretches.end(&mut |step| samples.take(&step, &mut sink));
    (count, most)
}

#[test]
fn a_long_log_needs_no_more_memory_than_a_short_one() {
    let (samples, usual) = held(4, |_| true);
    assert_eq!(samples, 4 * 500);
    // Seven frames come in a sample, and a second is held.
    assert!(usual < 1000, "{usual}");
    assert_eq!(held(40, |_| true), (40 * 500, usual));
    // Messages that are missing hold nothing back.
    let (samples, most) = held(40, |line| line.1 != 0x220 && line.1 != 0x210);
    assert_eq!(samples, 40 * 500);
    assert!(most < usual, "{most}");
}

fn read(lines: &[Line]) -> SignalLog {
    parse(&written(lines), &selection()).expect("a drive")
}

/// Whatever is there must be what was sent in its sample. Returns how many readings there are.
fn all_true(log: &SignalLog, drive: usize, first: u64) -> usize {
    let mut there = 0;
    let drive = &log.drives[drive];
    for corner in Corner::ALL {
        let k = corner.index();
        for (struts, sample) in drive.samples.iter().zip(first..) {
            let strut = &struts[corner];
            let x = strut.displacement_m;
            if x.is_finite() {
                // Our zero is 62 mm above the sensor's.
                let expected = -(1e-4 * f64::from(height_steps(sample, k)) + 0.25 - 0.312);
                assert!(
                    (x - expected).abs() < 1e-9,
                    "sample {sample} {corner:?}: {x} for {expected}"
                );
                there += 1;
            }
            for point in PressurePoint::ALL {
                let p = strut.pressure_pa[point];
                if p.is_finite() {
                    let expected = 25_000.0 * f64::from(pressure_steps(sample, k, point.index())) - 101_325.0;
                    assert!(
                        (p - expected).abs() < 1e-3,
                        "sample {sample} {corner:?} {point:?}: {p} for {expected}"
                    );
                    there += 1;
                }
            }
            if let Some(valves) = strut.valves {
                let expected = [0, 1, 2].map(|valve| valve_is_open(sample, k, valve));
                // The third valve of the rear left strut has no signal.
                let third = expected[2] && corner != Corner::RearLeft;
                assert_eq!(
                    valves,
                    oleo_interface::StrutValves::new(expected[0], expected[1], third),
                    "sample {sample}"
                );
                there += 1;
            }
        }
    }
    there
}

const READINGS_OF_A_SAMPLE: usize = 4 * (5 + 1);

#[test]
fn every_reading_arrives_in_its_sample_and_unit() {
    let mut lines = drive(0, 500, 7_000_000);
    // The vehicle stands, the bus sleeps for a minute, and another drive begins.
    lines.extend(drive(500, 700, 90_000_000));
    let log = read(&lines);
    let found: Vec<(usize, f64)> = log.drives.iter().map(|d| (d.samples.len(), d.period_s)).collect();
    assert_eq!(found, [(500, 0.01), (200, 0.01)]);
    assert_eq!(all_true(&log, 0, 0), 500 * READINGS_OF_A_SAMPLE);
    assert_eq!(all_true(&log, 1, 500), 200 * READINGS_OF_A_SAMPLE);
    assert!((log.drives[1].begins_s - 90.0).abs() < 1e-9);
    let steps = log.steps[Corner::RearRight];
    assert!((steps.displacement_m - 1e-4).abs() < 1e-12 && (steps.pressure_pa.p4 - 25_000.0).abs() < 1e-6);
    let account = &log.account;
    assert_eq!(
        (
            account.foreign_frames,
            account.total(|m| m.without_reading),
            account.total(|m| m.outside)
        ),
        (0, 0, 0)
    );
}

#[test]
fn logs_that_were_joined_are_several_drives() {
    // The second log begins before the end of the first, as a log whose times count from its own beginning.
    let mut lines = drive(0, 500, 7_000_000);
    lines.extend(drive(500, 700, 8_000_000));
    let log = read(&lines);
    assert_eq!(log.drives.len(), 2);
    assert_eq!(all_true(&log, 0, 0), 500 * READINGS_OF_A_SAMPLE);
    assert_eq!(all_true(&log, 1, 500), 200 * READINGS_OF_A_SAMPLE);
}

#[test]
fn a_range_that_its_signal_leaves_can_be_ignored() {
    let database = DBC.replace("(0.1,250) [0|1000]", "(0.1,250) [0|1]");
    let database = Database::from_bytes(database.as_bytes(), "car.dbc").expect("a database");
    let read = |map: &str| {
        let map = SignalMap::from_toml(map, "map.toml").expect("a map");
        let selection = Selection::of(&map, &database, "map.toml").expect("a selection");
        parse(&written(&drive(0, 50, 0)), &selection)
    };
    let said = read(MAP).expect_err("no displacement").to_string();
    assert!(said.contains("0 readings of a displacement in 50 frames"), "{said}");
    let map = MAP.replace("sign = -1", "sign = -1, ignore_range = true");
    assert_eq!(all_true(&read(&map).expect("a drive"), 0, 0), 50 * READINGS_OF_A_SAMPLE);
}

#[test]
fn what_a_sensor_calls_invalid_is_missing() {
    let mut lines = drive(0, 50, 0);
    for line in lines.iter_mut().filter(|line| line.1 == 0x18FF_0101).skip(10).take(3) {
        line.2[5] = 0;
    }
    let log = read(&lines);
    let missing = (log.drives[0].samples.iter())
        .filter(|struts| struts[Corner::RearRight].displacement_m.is_nan())
        .count();
    assert_eq!((missing, all_true(&log, 0, 0)), (3, 50 * READINGS_OF_A_SAMPLE - 6));
}

#[test]
fn two_buses_with_the_same_identifiers_are_refused() {
    let mut log = written(&drive(0, 50, 0));
    log.extend(b"(0000000001.000000) can7 220#0000\n");
    let said = parse(&log, &selection()).expect_err("two buses").to_string();
    assert!(
        said.contains("VALVES comes on the buses can2 and can7") && said.contains("bus = \"can2\""),
        "{said}"
    );
    let map = format!("bus = \"can2\"\n{MAP}");
    let map = SignalMap::from_toml(&map, "map.toml").expect("a map");
    let database = Database::from_bytes(DBC.as_bytes(), "car.dbc").expect("a database");
    let read = parse(&log, &Selection::of(&map, &database, "map.toml").expect("a selection")).expect("a drive");
    assert_eq!(read.account.foreign_frames, 1);
}

#[test]
fn a_wrong_map_is_refused_with_what_was_meant() {
    let refused = |old: &str, new: &str| {
        let text = MAP.replacen(old, new, 1);
        assert_ne!(text, MAP, "{old}");
        let database = Database::from_bytes(DBC.as_bytes(), "car.dbc").expect("a database");
        let map = SignalMap::from_toml(&text, "map.toml");
        let said = match map.and_then(|map| Selection::of(&map, &database, "map.toml").map(|_| ())) {
            Ok(()) => panic!("{new} was accepted"),
            Err(said) => said,
        };
        assert!(!said.contains('\n') && said.starts_with("map.toml"), "{said}");
        said
    };
    let said = refused("HEIGHT_F.Left", "HEIGHT_F.Leftt");
    assert!(
        said.contains("[front_left] displacement_m") && said.contains("did you mean Left?"),
        "{said}"
    );
    assert!(refused("HEIGHT_F.Left", "HIGHT_F.Left").contains("did you mean HEIGHT_F?"));
    assert!(refused("HEIGHT_F.Left", "Left").contains("write one of HEIGHT_F.Left, HEIGHT_R.Left"));
    assert!(refused("unit = \"mm\"", "unit = \"bar\"").contains("the units are m, mm, cm, in"));
    assert!(refused("unit = \"mm\", ", "").contains("states the unit \"0.1mm\"; add unit"));
    assert!(refused("sign = -1", "sign = 2").contains("1 or -1"));
    assert!(refused("p1_Pa", "p5_Pa").contains("did you mean p1_Pa?"));
    assert!(refused("p1_Pa =", "#").contains("has no p1_Pa; add p1_Pa"));
    assert!(refused("open = \"Auf\"", "open = \"Offen\"").contains("its names are Zu, Auf"));
    assert!(refused("always = \"closed\"", "always = \"shut\"").contains("\"open\" or \"closed\""));
    assert!(refused("[rear_left]", "[rear_lefft]").starts_with("map.toml:"));
    assert!(refused("HEIGHT_F.LeftWorks", "HEIGHT_R.LeftWorks").contains("a signal of the same message, HEIGHT_F"));
    let no_database = Database::from_bytes(b"VERSION \"\"\nBO_ x\n", "car.dbc")
        .err()
        .expect("no database");
    assert!(
        no_database.starts_with("car.dbc:2") && !no_database.contains('\n'),
        "{no_database}"
    );
}

#[test]
fn displacements_that_come_too_seldom_are_refused() {
    let lines: Vec<Line> = drive(0, 500, 0)
        .into_iter()
        .map(|(t, id, data)| (t * 5, id, data))
        .collect();
    let said = parse(&written(&lines), &selection()).expect_err("50 ms").to_string();
    assert!(
        said.contains("HEIGHT_F comes every 50 ms") && !said.contains('\n'),
        "{said}"
    );
    // 300 samples a second: the period is no multiple of anything.
    let lines: Vec<Line> = drive(0, 500, 0)
        .into_iter()
        .map(|(t, id, data)| (t / 3, id, data))
        .collect();
    assert!((read(&lines).drives[0].period_s - 0.01 / 3.0).abs() < 1e-7);
    let said = parse(b"(1.000000) can0 123#00\n", &selection())
        .expect_err("nothing")
        .to_string();
    assert!(said.contains("in 0 frames of the message HEIGHT_F"), "{said}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Frames lost, repeated and jittering by a fifth of a period, and a clock that is wrong by up to 0.3 %.
    #[test]
    fn whatever_is_read_was_measured_in_its_sample(
        seed in any::<u64>(),
        clock in -0.003_f64..0.003,
        mishaps in prop::collection::vec((50_usize..3400, 0_u8..2), 0..150),
    ) {
        let mut random = seed | 1;
        let mut lines = drive(0, 500, 1_000_000);
        let count = lines.len();
        for (k, line) in lines.iter_mut().enumerate() {
            random ^= random << 13;
            random ^= random >> 7;
            random ^= random << 17;
            let jitter = if k < 50 { 0.0 } else { (random % 2000) as f64 - 1000.0 };
            line.0 = (line.0 as f64 * (1.0 + clock) + jitter) as u64;
        }
        let (mut lost, mut repeated) = (0, 0);
        for (at, mishap) in mishaps {
            if mishap == 0 {
                lines.remove(at);
                lost += 1;
            } else {
                let again = lines[at].clone();
                lines.insert(at + 1, again);
                repeated += 1;
            }
        }
        lines.sort_by_key(|line| line.0);
        let log = read(&lines);
        prop_assert_eq!(log.drives.len(), 1);
        // A pressure frame is of one corner, a frame of the valves of four: at most four readings are lost with a frame.
        let there = all_true(&log, 0, 0);
        prop_assert!(there + 4 * lost + 4 >= 500 * READINGS_OF_A_SAMPLE, "{} of {} with {} lost of {}", there, 500 * READINGS_OF_A_SAMPLE, lost, count);
        prop_assert!(log.account.total(|m| m.repeated) <= repeated as u64 + 2, "{:?}", log.account);
    }
}
