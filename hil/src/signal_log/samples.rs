//! From readings with times to samples of all struts at the same instants.
//!
//! The messages of a bus are sent in a cycle, and what is sent in one cycle was measured together. The slowest of the messages that
//! carry a displacement beats the time: each of its frames is a sample. A reading of another message belongs to the sample
//! that is nearest, after the delay with which this message usually follows the beat has been taken off. A switching signal holds from
//! the sample before it, and as long as its message is not missed.
//!
//! ```text
//!   beat       |         |         |         |        period: median time between two frames
//!   pressure      |         |      .    |       |     delay: mean direction of (time since the beat) on the circle of one period
//!   sample     0  0      1  1      2 -  3  3    4     '-': missing
//! ```

use libm::{atan2, cos, floor, round, sin};
use oleo_interface::{Corners, StrutPressures, StrutValves};

use super::content::{SignalAccount, SignalDrive, StrutSeries};
use super::map::{COLUMNS, VALVES};
use super::selection::{Reading, Target};
use super::series::Series;

/// Periods of the displacement that are accepted, us. Above, the motion of a wheel (12 Hz) is not resolved.
const PERIODS_US: std::ops::RangeInclusive<f64> = 1_000.0..=20_000.0;
/// A period is rounded to this, us, if that changes it by no more than clocks differ.
const PERIOD_STEP_US: f64 = 100.0;
/// Difference of two clocks.
const CLOCKS_DIFFER: f64 = 0.004;
/// Silence that ends a drive, us.
const LONGEST_SILENCE_US: u64 = 1_000_000;
/// Fewest samples of a drive.
const FEWEST_SAMPLES: usize = 6;
/// Most samples of a drive for each beat. Of a drive with more gaps nothing could be used, and it would need a lot of memory.
const MOST_SAMPLES_A_BEAT: usize = 20;
/// How fast the beat follows the times of the log: a sixteenth of the difference with each frame. Half of the frames may be late by
/// up to a third of a period then, and a clock that is wrong by a percent is followed.
const FOLLOWING: f64 = 1.0 / 16.0;
/// Frames by which the delay of a message is measured.
const FRAMES_OF_DELAY: usize = 4096;
/// A switching signal this part of a period before the beat is taken for one that comes with it.
const EARLY_SIGNAL: f64 = 0.1;

/// The frames of the beat in one drive.
struct Drive {
    beats: Vec<Beat>,
    samples: usize,
}

/// A frame of the beat.
struct Beat {
    time_us: u64,
    /// The sample.
    tick: i64,
    /// Time of the sample on the smoothed time base, us after the beginning of the drive.
    base_us: f64,
}

/// The drives of a log.
///
/// # Errors
/// No displacement, or one that comes too seldom; a sentence without the name of the log.
pub fn drives(
    all: &[Series],
    fixed: &[(Target, f64)],
    account: &mut SignalAccount,
) -> Result<Vec<SignalDrive>, String> {
    let beat = beat(all)?;
    let drives = drives_of_beat(&beat);
    if drives.is_empty() {
        return Err(
            "holds no drive: displacements come for an instant only; log the bus for at least a second".to_owned(),
        );
    }
    let period_us = period_us(&drives);
    let mut out: Vec<SignalDrive> = Vec::new();
    for (k, drive) in drives.iter().enumerate() {
        // Half a silence around a drive is its own, so that no frame belongs to two.
        let margin = LONGEST_SILENCE_US / 2;
        let from = drive.first_us().saturating_sub(margin);
        let is_last = k + 1 == drives.len();
        let to = if is_last {
            u64::MAX
        } else {
            drive.last_us().saturating_add(margin)
        };
        let mut struts = Corners::from_fn(|_| StrutColumns::new(drive.samples));
        for (target, value) in fixed {
            struts[target.corner].columns[target.column].fill(*value);
        }
        for (series, message) in all.iter().zip(&mut account.messages) {
            let mut of_message = Used::default();
            for (at, reading) in series.message.readings.iter().enumerate() {
                let frames: Vec<(u64, f64)> = series
                    .of_reading(at)
                    .filter(|(time, _)| (from..to).contains(time))
                    .collect();
                let column = &mut struts[reading.target.corner].columns[reading.target.column];
                let used = enter(&frames, reading, drive, beat.interval_us, column);
                of_message.repeated = of_message.repeated.max(used.repeated);
                of_message.outside = of_message.outside.max(used.outside);
            }
            message.repeated += of_message.repeated;
            message.outside += of_message.outside;
        }
        out.push(SignalDrive {
            begins_s: drive.first_us() as f64 * 1e-6,
            period_s: period_us * 1e-6,
            struts: struts.map(StrutColumns::into_series),
        });
    }
    Ok(out)
}

/// Mean time between two samples, us.
fn period_us(drives: &[Drive]) -> f64 {
    let last = || drives.iter().filter_map(|drive| drive.beats.last());
    let ticks: i64 = last().map(|beat| beat.tick).sum();
    let mean = last().map(|beat| beat.base_us).sum::<f64>() / ticks.max(1) as f64;
    let rounded = round(mean / PERIOD_STEP_US) * PERIOD_STEP_US;
    if (rounded - mean).abs() <= CLOCKS_DIFFER * mean {
        rounded
    } else {
        mean
    }
}

/// The displacement that beats the time.
struct Beats {
    time_us: Vec<u64>,
    interval_us: f64,
}

/// The displacement that comes most seldom.
fn beat(all: &[Series]) -> Result<Beats, String> {
    let mut slowest: Option<Beats> = None;
    for series in all {
        for (at, _) in series
            .message
            .readings
            .iter()
            .enumerate()
            .filter(|(_, reading)| reading.target.column == 0)
        {
            let name = &series.message.name;
            let time_us: Vec<u64> = series.of_reading(at).map(|(time_us, _)| time_us).collect();
            let Some(interval_us) = median_interval_us(time_us.iter().copied()) else {
                return Err(format!(
                    "holds no drive: {} readings of a displacement in {} frames of the message {name}; check the bus of the log, the \
                     map (valid, ignore_range) and the database",
                    time_us.len(),
                    series.time_us.len()
                ));
            };
            if !PERIODS_US.contains(&interval_us) {
                return Err(format!(
                    "the message {name} comes every {} ms; displacements must come every {} to {} ms",
                    interval_us * 1e-3,
                    PERIODS_US.start() * 1e-3,
                    PERIODS_US.end() * 1e-3
                ));
            }
            if slowest.as_ref().is_none_or(|slow| interval_us > slow.interval_us) {
                slowest = Some(Beats { time_us, interval_us });
            }
        }
    }
    slowest.ok_or_else(|| "holds no drive: no message with a displacement".to_owned())
}

/// Median of the time between two frames; `None` of fewer than three.
fn median_interval_us(times: impl Iterator<Item = u64> + Clone) -> Option<f64> {
    let mut between: Vec<u64> = times
        .clone()
        .skip(1)
        .zip(times)
        .map(|(next, time)| next - time)
        .collect();
    let middle = between.len() / 2;
    (between.len() >= 2).then(|| *between.select_nth_unstable(middle).1 as f64)
}

/// Counts the samples along the frames of the beat.
fn drives_of_beat(beats: &Beats) -> Vec<Drive> {
    let interval_us = beats.interval_us;
    let mut drives: Vec<Drive> = Vec::new();
    let mut current: Vec<Beat> = Vec::new();
    for &time_us in &beats.time_us {
        let next = match (current.first(), current.last()) {
            (Some(first), Some(last)) if time_us - last.time_us <= LONGEST_SILENCE_US => {
                let since_us = (time_us - first.time_us) as f64;
                let ticks = round((since_us - last.base_us) / interval_us).max(0.0);
                let expected_us = last.base_us + ticks * interval_us;
                Beat {
                    time_us,
                    tick: last.tick + ticks as i64,
                    base_us: expected_us + FOLLOWING * (since_us - expected_us),
                }
            }
            _ => {
                finish(&mut drives, std::mem::take(&mut current));
                Beat {
                    time_us,
                    tick: 0,
                    base_us: 0.0,
                }
            }
        };
        current.push(next);
    }
    finish(&mut drives, current);
    drives
}

fn finish(drives: &mut Vec<Drive>, beats: Vec<Beat>) {
    let samples = beats.last().map_or(0, |beat| beat.tick as usize + 1);
    if (FEWEST_SAMPLES..=MOST_SAMPLES_A_BEAT * beats.len()).contains(&samples) {
        drives.push(Drive { beats, samples });
    }
}

impl Drive {
    fn first_us(&self) -> u64 {
        self.beats.first().map_or(0, |beat| beat.time_us)
    }

    fn last_us(&self) -> u64 {
        self.beats.last().map_or(0, |beat| beat.time_us)
    }

    /// The time in samples since the first one, for times that ascend: `at` is where the last search ended.
    fn in_samples(&self, time_us: u64, at: &mut usize, interval_us: f64) -> f64 {
        while self.beats.get(*at + 1).is_some_and(|next| next.time_us <= time_us) {
            *at += 1;
        }
        let beat = &self.beats[*at];
        let since_us = time_us as f64 - self.first_us() as f64;
        beat.tick as f64 + (since_us - beat.base_us) / interval_us
    }
}

/// What became of the frames of a reading in a drive.
#[derive(Default)]
struct Used {
    repeated: u64,
    outside: u64,
}

/// Enters a reading into the samples of a drive. `frames` are those that have it, with their times.
fn enter(frames: &[(u64, f64)], reading: &Reading, drive: &Drive, interval_us: f64, column: &mut [f64]) -> Used {
    let mut at = 0;
    let times: Vec<f64> = frames
        .iter()
        .map(|(time_us, _)| drive.in_samples(*time_us, &mut at, interval_us))
        .collect();
    let is_signal = VALVES.contains(&reading.target.column);
    let delay = if is_signal { 0.0 } else { delay(&times) };
    // Whichever frame is nearest to a sample is the sample's.
    let mut away = vec![f64::INFINITY; column.len()];
    let mut used = Used::default();
    for (time, (_, value)) in times.iter().zip(frames) {
        let (sample, distance) = if is_signal {
            let sample = floor(time + EARLY_SIGNAL);
            // The last of several holds.
            (sample, sample - time)
        } else {
            let sample = round(time - delay);
            (sample, (time - delay - sample).abs())
        };
        let place = (sample >= 0.0).then_some(sample as usize);
        match place.and_then(|k| Some((away.get_mut(k)?, column.get_mut(k)?))) {
            None => used.outside += 1,
            Some((nearest, entry)) => {
                used.repeated += u64::from(nearest.is_finite());
                if distance < *nearest {
                    (*nearest, *entry) = (distance, *value);
                }
            }
        }
    }
    if is_signal {
        let usual = median_interval_us(frames.iter().map(|(time_us, _)| *time_us));
        let held = usual.map_or(1, |usual| round(usual / interval_us).max(1.0) as usize);
        hold(column, if reading.on_change { usize::MAX } else { held });
    }
    used
}

/// The time in samples by which a message usually follows the beat, from -0.5 to 0.5.
fn delay(times: &[f64]) -> f64 {
    const TURN: f64 = 2.0 * std::f64::consts::PI;
    let (s, c) = (times.iter().take(FRAMES_OF_DELAY)).fold((0.0, 0.0), |(s, c), time| {
        let angle = TURN * (time - floor(*time));
        (s + sin(angle), c + cos(angle))
    });
    atan2(s, c) / TURN
}

/// Lets each value hold for `held` samples, its own included, where no other comes.
fn hold(column: &mut [f64], held: usize) {
    let mut last: Option<(f64, usize)> = None;
    for (k, value) in column.iter_mut().enumerate() {
        if value.is_finite() {
            last = Some((*value, k));
        } else if let Some((old, since)) = last
            && k - since < held
        {
            *value = old;
        }
    }
}

/// The columns of a strut while they are filled.
struct StrutColumns {
    columns: [Vec<f64>; COLUMNS.len()],
}

impl StrutColumns {
    fn new(samples: usize) -> Self {
        Self {
            columns: std::array::from_fn(|_| vec![f64::NAN; samples]),
        }
    }

    fn into_series(self) -> StrutSeries {
        let [displacement_m, p1, p2, p3, p4, valves @ ..] = self.columns;
        let at = |k: usize| {
            let [first, second, third] = valves
                .each_ref()
                .map(|valve| valve.get(k).copied().filter(|v| v.is_finite()));
            Some(StrutValves::new(first? > 0.5, second? > 0.5, third? > 0.5))
        };
        StrutSeries {
            valves: (0..displacement_m.len()).map(at).collect(),
            displacement_m,
            pressure_pa: StrutPressures::from_array([p1, p2, p3, p4]),
        }
    }
}
