//! Stretches of a log in which the beat does not pause, and the time of every frame in samples of its stretch.
//!
//! ```text
//!   beat       |         |         |         |        interval: median time between two frames
//!   sample     0         1         2         3
//!   frame         0.3          1.6                    time in samples since the first, by the beat before it
//! ```

use std::collections::VecDeque;
use std::ops::ControlFlow;

use libm::round;

use super::beat::Beat;
use super::readings::Frame;
use super::selection::Selection;

/// Silence that ends a stretch, us.
const LONGEST_SILENCE_US: u64 = 1_000_000;
/// Half a silence around a stretch is its own, so that no frame belongs to two.
const MARGIN_US: u64 = LONGEST_SILENCE_US / 2;
/// How fast the beat follows the times of the log: a sixteenth of the difference with each frame. Half of the frames may be late by
/// up to a third of a period then, and a clock that is wrong by a percent is followed.
const FOLLOWING: f64 = 1.0 / 16.0;
/// Most frames that wait for a beat. More than these do not come between two times.
const MOST_WAITING: usize = 1 << 17;

/// What comes next in a log.
pub enum Step<'a> {
    /// A stretch begins, at this time, us.
    Begins(u64),
    /// A frame of the stretch.
    Frame {
        /// Its time in samples since the first; less than 0 just before it.
        time: f64,
        /// The frame.
        frame: Frame<'a>,
    },
    /// The stretch has ended.
    Ends(Stretch),
    /// A frame of this message is in no stretch.
    Outside(usize),
}

/// Takes the steps of a log, and may end the reading.
pub type StepSink<'a> = dyn FnMut(Step) -> ControlFlow<()> + 'a;

/// A stretch that has ended.
#[derive(Clone, Copy, Debug)]
pub struct Stretch {
    /// Number of frames of the beat.
    pub beats: usize,
    /// Sample of the last of them, counted from 0.
    pub last: i64,
    /// Time of that sample on the smoothed time base, us after the beginning of the stretch.
    pub base_us: f64,
}

/// The stretch that is under way, as of the last frame of the beat.
struct Current {
    first_us: u64,
    time_us: u64,
    so_far: Stretch,
}

/// Finds the stretches of a log.
pub struct Stretches {
    beat: Beat,
    current: Option<Current>,
    /// Frames whose stretch or beat is not known yet: time and message.
    waiting: VecDeque<(u64, usize)>,
    /// The values of these frames, one after the other.
    values: VecDeque<f64>,
    /// Number of values of a frame, message by message.
    widths: Vec<usize>,
}

impl Stretches {
    /// None yet.
    pub fn new(selection: &Selection, beat: Beat) -> Self {
        Self {
            beat,
            current: None,
            waiting: VecDeque::new(),
            values: VecDeque::new(),
            widths: selection
                .messages
                .iter()
                .map(|message| message.readings.len())
                .collect(),
        }
    }

    /// The next frame of the log.
    pub fn take(&mut self, frame: &Frame, sink: &mut StepSink) -> ControlFlow<()> {
        let now = frame.time_us;
        if let Some(current) = &self.current
            && now - current.time_us > LONGEST_SILENCE_US
        {
            self.end_stretch(sink)?;
        }
        if self.current.is_none() {
            self.give_until(now.saturating_sub(MARGIN_US), sink)?;
        }
        if frame.message == self.beat.message && frame.values[self.beat.reading].is_finite() {
            match self.current.is_some() {
                true => self.give_until(now, sink)?,
                false => sink(Step::Begins(now))?,
            }
            self.current = Some(self.beaten(now));
            self.give_until(now, sink)?;
        }
        self.waiting.push_back((now, frame.message));
        self.values.extend(frame.values);
        if self.waiting.len() > MOST_WAITING {
            self.give_first(sink)?;
        }
        ControlFlow::Continue(())
    }

    /// The end of the log.
    pub fn end(mut self, sink: &mut StepSink) -> ControlFlow<()> {
        if self.current.is_some() {
            self.end_stretch(sink)?;
        }
        self.give_until(u64::MAX, sink)
    }

    /// Number of frames that are held.
    #[cfg(test)]
    pub fn held(&self) -> usize {
        self.waiting.len()
    }

    /// The stretch after another frame of the beat.
    fn beaten(&self, time_us: u64) -> Current {
        let Some(current) = &self.current else {
            let (beats, last, base_us) = (1, 0, 0.0);
            return Current {
                first_us: time_us,
                time_us,
                so_far: Stretch { beats, last, base_us },
            };
        };
        let (interval_us, so_far) = (self.beat.interval_us, &current.so_far);
        let since_us = (time_us - current.first_us) as f64;
        let ticks = round((since_us - so_far.base_us) / interval_us).max(0.0);
        let expected_us = so_far.base_us + ticks * interval_us;
        Current {
            first_us: current.first_us,
            time_us,
            so_far: Stretch {
                beats: so_far.beats + 1,
                last: so_far.last + ticks as i64,
                base_us: expected_us + FOLLOWING * (since_us - expected_us),
            },
        }
    }

    fn end_stretch(&mut self, sink: &mut StepSink) -> ControlFlow<()> {
        let last_us = self.current.as_ref().map_or(0, |current| current.time_us);
        self.give_until(last_us.saturating_add(MARGIN_US), sink)?;
        match self.current.take() {
            Some(current) => sink(Step::Ends(current.so_far)),
            None => ControlFlow::Continue(()),
        }
    }

    /// Gives the frames before a time on.
    fn give_until(&mut self, until_us: u64, sink: &mut StepSink) -> ControlFlow<()> {
        while self.waiting.front().is_some_and(|(time_us, _)| *time_us < until_us) {
            self.give_first(sink)?;
        }
        ControlFlow::Continue(())
    }

    fn give_first(&mut self, sink: &mut StepSink) -> ControlFlow<()> {
        let Some((time_us, message)) = self.waiting.pop_front() else {
            return ControlFlow::Continue(());
        };
        let values: Vec<f64> = self.values.drain(..self.widths[message]).collect();
        let Some(current) = &self.current else {
            return sink(Step::Outside(message));
        };
        let since_us = time_us as f64 - current.first_us as f64;
        sink(Step::Frame {
            time: current.so_far.last as f64 + (since_us - current.so_far.base_us) / self.beat.interval_us,
            frame: Frame {
                time_us,
                message,
                values: &values,
            },
        })
    }
}
