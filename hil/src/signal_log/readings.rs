//! The frames of a log that the map names, in the order of time, each with its readings.
//!
//! Frames are logged late by less than a second, so that a frame can be given on when the log has come a second further.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::Path;

use super::content::{SignalAccount, SignalMessage};
use super::selection::{Reading, Selection};
use crate::logs::{FrameKind, FrameSource, LogError, Payload};

/// A time that runs back by more than this is that of another log behind the first, us. Frames are logged late by less.
const RUNS_BACK_US: u64 = 1_000_000;
/// Time between two logs of one file, us: long enough to end a drive.
const BETWEEN_LOGS_US: u64 = 10_000_000;
/// Most frames that are held. Ten buses do not carry as many in a second.
const MOST_HELD: usize = 1 << 17;

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

/// A frame of a message of the map.
pub struct Frame<'a> {
    /// Time, us; it does not run back from one frame to the next.
    pub time_us: u64,
    /// Position of its message in the selection.
    pub message: usize,
    /// Values in the order of the message's readings; NaN where the frame has none.
    pub values: &'a [f64],
}

/// Takes the frames of a log, and may end the reading.
pub type FrameSink<'a> = dyn FnMut(&Frame) -> ControlFlow<()> + 'a;

/// Frames that wait for others that were logged late.
struct Ordered<'s> {
    selection: &'s Selection,
    /// By time; those of the same time in the order of the log.
    held: BTreeMap<(u64, u64), (usize, Payload)>,
    taken: u64,
    /// Time of the last frame that was given on.
    given_us: u64,
    messages: Vec<SignalMessage>,
    values: Vec<f64>,
}

impl Ordered<'_> {
    fn take(&mut self, time_us: u64, message: usize, payload: Payload) {
        self.messages[message].received += 1;
        if time_us < self.given_us {
            self.messages[message].outside += 1;
            return;
        }
        self.taken += 1;
        self.held.insert((time_us, self.taken), (message, payload));
    }

    /// Gives the frames on that nothing can come before any more.
    fn give(&mut self, latest_us: u64, sink: &mut FrameSink) -> ControlFlow<()> {
        while let Some(first) = self.held.first_entry() {
            let is_due = first.key().0.saturating_add(RUNS_BACK_US) <= latest_us;
            if !is_due && self.held.len() <= MOST_HELD {
                break;
            }
            self.give_first(sink)?;
        }
        ControlFlow::Continue(())
    }

    fn give_first(&mut self, sink: &mut FrameSink) -> ControlFlow<()> {
        let Some(((time_us, _), (message, payload))) = self.held.pop_first() else {
            return ControlFlow::Continue(());
        };
        self.given_us = time_us;
        let readings = self.selection.messages[message].readings.iter();
        self.values.clear();
        self.values
            .extend(readings.map(|reading: &Reading| reading.value(payload.data()).unwrap_or(f64::NAN)));
        if self.values.iter().all(|value| value.is_nan()) {
            self.messages[message].without_reading += 1;
        }
        sink(&Frame {
            time_us,
            message,
            values: &self.values,
        })
    }
}

/// Reads a log from front to back.
///
/// # Errors
/// The log cannot be read on, or a message comes on two buses.
pub fn read(
    log: &mut dyn FrameSource,
    selection: &Selection,
    path: &Path,
    sink: &mut FrameSink,
) -> Result<SignalAccount, LogError> {
    let of_message = |message: &super::selection::Selected| SignalMessage::new(&message.name);
    let mut ordered = Ordered {
        selection,
        held: BTreeMap::new(),
        taken: 0,
        given_us: 0,
        messages: selection.messages.iter().map(of_message).collect(),
        values: Vec::new(),
    };
    let mut buses: Vec<Option<String>> = vec![None; selection.messages.len()];
    let (mut foreign_frames, mut conflict, mut clock) = (0, None, Clock::default());
    let mut flow = ControlFlow::Continue(());
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
        ordered.take(time_us, at, frame.payload);
        flow = ordered.give(clock.latest_us, sink);
        flow
    })?;
    if let Some((at, one, other)) = conflict {
        let name = &selection.messages[at].name;
        let what = format!(
            "the message {name} comes on the buses {one} and {other}; choose one in the map, such as bus = {one:?}"
        );
        return Err(LogError::new(path, what));
    }
    while flow.is_continue() && !ordered.held.is_empty() {
        flow = ordered.give_first(sink);
    }
    Ok(SignalAccount {
        log,
        foreign_frames,
        messages: ordered.messages,
    })
}
