//! Logs with an inertial unit on the same bus.

use oleo_plant_sim::vehicle::InertialReading;

use super::{Line, READINGS_OF_A_TICK, all_true, drive, read};
use crate::drive_log::LoggedSample;
use crate::imu::{self, ImuSettings, Unit};

/// Every reading differs from every other one of its axis.
fn truth(tick: u32) -> InertialReading {
    let step = f64::from(tick % 20_000);
    InertialReading {
        specific_force_m_s2: [0.002 * step, -0.002 * step, 0.002 * step - 20.0],
        rate_rad_s: [0.0001 * step, -0.0001 * step, 0.0001 * step - 1.0],
    }
}

/// A drive whose unit has no noise; its frames come behind the displacements of their tick.
fn with_unit(from: u32, to: u32) -> Vec<Line> {
    let settings = ImuSettings {
        specific_force_noise_m_s2: 0.0,
        rate_noise_rad_s: 0.0,
        ..ImuSettings::default()
    };
    let mut unit = Unit::new(&settings, 1);
    let mut lines = Vec::new();
    for (tick, of_tick) in (from..to).zip(drive(from, to, 1_000_000).chunks(7)) {
        lines.extend_from_slice(&of_tick[..6]);
        let last_us = of_tick[5].time_us;
        for (k, frame) in (1..).zip(unit.frames(&truth(tick))) {
            let time_us = last_us + 270 * k;
            lines.push(Line { time_us, frame });
        }
        lines.extend_from_slice(&of_tick[6..]);
    }
    lines
}

/// Whatever is there must be what was read in its tick. Returns how many readings are there.
fn all_of_unit_true(samples: &[LoggedSample], first_tick: u32) -> usize {
    let mut there = 0;
    for (tick, sample) in (first_tick..).zip(samples) {
        let expected = truth(tick);
        let pairs = (sample
            .inertial
            .specific_force_m_s2
            .into_iter()
            .zip(expected.specific_force_m_s2))
        .chain(sample.inertial.rate_rad_s.into_iter().zip(expected.rate_rad_s));
        for (found, expected) in pairs {
            if let Some(found) = found.value() {
                assert!(
                    (f64::from(found) - expected).abs() < 1e-5,
                    "tick {tick}: {found} {expected}"
                );
                there += 1;
            }
        }
    }
    there
}

#[test]
fn what_the_unit_says_is_in_the_sample_of_its_tick() {
    let log = read(&with_unit(100, 1100));
    assert_eq!((log.drives.len(), log.drives[0].samples.len()), (1, 1000));
    assert_eq!(all_true(&log.drives[0], 100), 1000 * READINGS_OF_A_TICK);
    assert_eq!(all_of_unit_true(&log.drives[0].samples, 100), 1000 * 6);
    assert_eq!(log.account.messages.len(), 9);
    assert!(
        log.account
            .messages
            .iter()
            .all(|message| (message.received, message.lost) == (1000, 0))
    );
    assert_eq!(log.account.foreign_frames, 0);
}

/// Two of three frames of the unit are lost, and one in ten comes after later frames.
#[test]
fn its_counter_finds_the_tick_where_frames_are_missing_or_late() {
    let mut lines = with_unit(0, 3000);
    let is_unit = |line: &Line| imu::of_unit(line.frame.standard_id()).is_some();
    let mut seen = 0;
    lines.retain(|line| {
        seen += usize::from(is_unit(line));
        !is_unit(line) || seen % 3 == 0
    });
    for k in (0..lines.len() - 10).rev() {
        if is_unit(&lines[k]) && k % 10 == 0 {
            let late = lines.remove(k);
            lines.insert(k + 7, late);
        }
    }
    let log = read(&lines);
    let samples = &log.drives[0].samples;
    assert_eq!(samples.len(), 3000);
    assert_eq!(all_of_unit_true(samples, 0), 2000 * 3);
    assert_eq!(log.account.messages[7].lost + log.account.messages[8].lost, 4000);
}

#[test]
fn a_log_without_a_unit_has_no_account_of_one() {
    let log = read(&drive(0, 200, 0));
    assert_eq!(log.account.messages.len(), 7);
    assert_eq!(all_of_unit_true(&log.drives[0].samples, 0), 0);
}
