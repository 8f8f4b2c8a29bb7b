//! The readings of a log, message by message, each with the time of its frame.

use std::ops::ControlFlow;
use std::path::Path;

use super::content::{SignalAccount, SignalMessage};
use super::selection::{Reading, Selected, Selection};
use crate::logs::{FrameKind, FrameSource, LogError};

/// A time that runs back by more than this is that of another log behind the first, us. Frames are logged late by less.
const RUNS_BACK_US: u64 = 1_000_000;
/// Time between two logs of one file, us: long enough to end a drive.
const BETWEEN_LOGS_US: u64 = 10_000_000;

/// The time of a log of which several may be in one file.
#[derive(Default)]
struct Clock {
    latest_us: u64,
    /// What the times of the current log lack.
    offset_us: u64,
}

impl Clock {
    /// The time of an entry, which does not run back by more than frames are late.
    fn read(&mut self, time_us: u64) -> u64 {
        let mut now = time_us.saturating_add(self.offset_us);
        if now.saturating_add(RUNS_BACK_US) < self.latest_us {
            self.offset_us = self.latest_us.saturating_add(BETWEEN_LOGS_US).saturating_sub(time_us);
            now = time_us.saturating_add(self.offset_us);
        }
        self.latest_us = self.latest_us.max(now);
        now
    }
}

/// The readings of one message.
pub struct Series<'s> {
    /// The message and its readings.
    pub message: &'s Selected,
    /// Time of every frame, us, ascending.
    pub time_us: Vec<u64>,
    /// Values in the order of the readings, frame after frame; NaN where a frame has none.
    values: Vec<f64>,
}

impl Series<'_> {
    /// Every frame that has a reading, as its time and the value.
    pub fn of_reading(&self, reading: usize) -> impl Iterator<Item = (u64, f64)> + '_ {
        let values = self
            .values
            .iter()
            .skip(reading)
            .step_by(self.message.readings.len().max(1));
        (self.time_us.iter().copied())
            .zip(values.copied())
            .filter(|(_, value)| value.is_finite())
    }

    /// Sorts by time, where frames were logged late. Those of the same time keep their order.
    fn sort(&mut self) {
        if self.time_us.is_sorted() {
            return;
        }
        let mut order: Vec<usize> = (0..self.time_us.len()).collect();
        order.sort_by_key(|k| self.time_us[*k]);
        let width = self.message.readings.len();
        self.values = order
            .iter()
            .flat_map(|k| self.values[k * width..(k + 1) * width].to_vec())
            .collect();
        self.time_us = order.iter().map(|k| self.time_us[*k]).collect();
    }
}

/// Reads a whole log.
///
/// # Errors
/// The log cannot be read on, or a message comes on two buses.
pub fn read<'s>(
    log: &mut dyn FrameSource,
    selection: &'s Selection,
    path: &Path,
) -> Result<(Vec<Series<'s>>, SignalAccount), LogError> {
    let mut all: Vec<Series> = (selection.messages.iter())
        .map(|message| Series {
            message,
            time_us: Vec::new(),
            values: Vec::new(),
        })
        .collect();
    let mut messages: Vec<SignalMessage> = (selection.messages.iter())
        .map(|message| SignalMessage::new(&message.name))
        .collect();
    let mut buses: Vec<Option<String>> = vec![None; all.len()];
    let (mut foreign_frames, mut conflict, mut clock) = (0, None, Clock::default());
    let log = log.read(&mut |entry| {
        let (frame, time_us) = (&entry.frame, clock.read(entry.time_us));
        let is_wanted =
            selection.bus.as_deref().is_none_or(|bus| bus == entry.bus) && !matches!(frame.kind, FrameKind::Remote(_));
        let at = selection.messages.iter().position(|message| message.id == frame.id);
        let Some(at) = at.filter(|_| is_wanted) else {
            foreign_frames += 1;
            return ControlFlow::Continue(());
        };
        match &buses[at] {
            None => buses[at] = Some(entry.bus.to_owned()),
            Some(bus) if bus != entry.bus => {
                conflict = Some((at, bus.clone(), entry.bus.to_owned()));
                return ControlFlow::Break(());
            }
            Some(_) => {}
        }
        let series = &mut all[at];
        messages[at].received += 1;
        let values = series
            .message
            .readings
            .iter()
            .map(|reading: &Reading| reading.value(frame.data()).unwrap_or(f64::NAN));
        let before = series.values.len();
        series.values.extend(values);
        if series.values[before..].iter().all(|value| value.is_nan()) {
            messages[at].without_reading += 1;
        }
        series.time_us.push(time_us);
        ControlFlow::Continue(())
    })?;
    if let Some((at, one, other)) = conflict {
        let name = &selection.messages[at].name;
        let what = format!(
            "the message {name} comes on the buses {one} and {other}; choose one in the map, such as bus = {one:?}"
        );
        return Err(LogError::new(path, what));
    }
    all.iter_mut().for_each(Series::sort);
    let account = SignalAccount {
        log,
        foreign_frames,
        messages,
    };
    Ok((all, account))
}
