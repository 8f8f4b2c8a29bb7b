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
//!
//! Frames come in the order of time, so that a sample is complete a few samples later, and is given on then.

use std::collections::VecDeque;
use std::ops::ControlFlow;

use libm::{floor, round};
use oleo_interface::{Corners, StrutPressures, StrutValves};

use super::content::{SignalAccount, SignalPart, SignalSink, StrutSample};
use super::map::{COLUMNS, VALVES};
use super::readings::Frame;
use super::selection::{Selection, Target};
use super::stretches::Step;
use super::survey::{Drive, Survey};

/// A switching signal this part of a period before the beat is taken for one that comes with it.
const EARLY_SIGNAL: f64 = 0.1;
/// Samples that are not complete yet. From one beat to the next the time base moves by half a sample at most, and a delay is no longer.
const INCOMPLETE: f64 = 8.0;

/// What came for one sample.
#[derive(Clone)]
struct Row {
    /// Values of the columns; NaN where there is none yet.
    values: Corners<[f64; COLUMNS.len()]>,
    /// How far the frame of each was from the sample; infinite without one.
    away: Corners<[f64; COLUMNS.len()]>,
}

impl Row {
    const EMPTY: Self = Self {
        values: Corners::splat([f64::NAN; COLUMNS.len()]),
        away: Corners::splat([f64::INFINITY; COLUMNS.len()]),
    };
}

/// What became of the frames of a reading in a drive.
#[derive(Clone, Copy, Default)]
struct Used {
    repeated: u64,
    outside: u64,
}

/// Puts the frames of a log into samples, drive after drive.
pub struct Samples<'s> {
    selection: &'s Selection,
    /// Drives that have not begun.
    ahead: std::slice::Iter<'s, Drive>,
    next: Option<&'s Drive>,
    stretches: u64,
    filling: Option<Filling<'s>>,
    /// Frames that are used twice or not at all, message by message.
    used: Vec<Used>,
}

impl<'s> Samples<'s> {
    /// Of the drives that a survey has found.
    pub fn new(selection: &'s Selection, survey: &'s Survey) -> Self {
        let mut ahead = survey.drives.iter();
        Self {
            selection,
            next: ahead.next(),
            ahead,
            stretches: 0,
            filling: None,
            used: vec![Used::default(); selection.messages.len()],
        }
    }

    /// The next step of the log. Samples that are complete go to `sink`.
    pub fn take(&mut self, step: &Step, sink: &mut SignalSink) -> ControlFlow<()> {
        match (step, &mut self.filling) {
            (Step::Begins(first_us), _) => {
                self.stretches += 1;
                if let Some(drive) = self.next.filter(|drive| drive.stretch == self.stretches) {
                    self.next = self.ahead.next();
                    self.filling = Some(Filling::new(self.selection, drive));
                    sink(SignalPart::Begins(*first_us as f64 * 1e-6))?;
                }
            }
            (Step::Frame { time, frame }, Some(filling)) => filling.take(*time, frame, sink)?,
            (Step::Frame { frame, .. }, None) => self.used[frame.message].outside += 1,
            (Step::Outside(message), _) => self.used[*message].outside += 1,
            (Step::Ends(_), filling) => {
                if let Some(filling) = filling.take() {
                    filling.end(&mut self.used, sink)?;
                }
            }
        }
        ControlFlow::Continue(())
    }

    /// Number of samples that are held.
    #[cfg(test)]
    pub fn held(&self) -> usize {
        self.filling.as_ref().map_or(0, |filling| filling.rows.len())
    }

    /// Enters what became of the frames into an account of them.
    pub fn account(&self, account: &mut SignalAccount) {
        for (message, used) in account.messages.iter_mut().zip(&self.used) {
            message.repeated += used.repeated;
            message.outside += used.outside;
        }
    }
}

/// A drive that is under way.
struct Filling<'s> {
    selection: &'s Selection,
    drive: &'s Drive,
    /// Number of the first row.
    first: usize,
    rows: VecDeque<Row>,
    used: Vec<Vec<Used>>,
    /// For each column, for how many samples a value holds, and the last value with its sample.
    held: Corners<[usize; COLUMNS.len()]>,
    last: Corners<[Option<(f64, usize)>; COLUMNS.len()]>,
}

impl<'s> Filling<'s> {
    fn new(selection: &'s Selection, drive: &'s Drive) -> Self {
        let mut held = Corners::splat([1; COLUMNS.len()]);
        let mut last = Corners::splat([None; COLUMNS.len()]);
        for (message, follows) in selection.messages.iter().zip(&drive.follows) {
            for (reading, follows) in message.readings.iter().zip(follows) {
                held[reading.target.corner][reading.target.column] = follows.held;
            }
        }
        for (Target { corner, column }, value) in &selection.fixed {
            held[*corner][*column] = usize::MAX;
            last[*corner][*column] = Some((*value, 0));
        }
        let of_message = |message: &super::selection::Selected| vec![Used::default(); message.readings.len()];
        Self {
            selection,
            drive,
            first: 0,
            rows: VecDeque::new(),
            used: selection.messages.iter().map(of_message).collect(),
            held,
            last,
        }
    }

    fn take(&mut self, time: f64, frame: &Frame, sink: &mut SignalSink) -> ControlFlow<()> {
        while self.first < self.drive.samples && (self.first as f64) < floor(time) - INCOMPLETE {
            self.give_on(sink)?;
        }
        let readings = &self.selection.messages[frame.message].readings;
        for (at, (reading, value)) in readings.iter().zip(frame.values).enumerate() {
            if value.is_finite() {
                let delay = self.drive.follows[frame.message][at].delay;
                let used = self.enter(reading.target, time, delay, *value);
                let of_reading = &mut self.used[frame.message][at];
                of_reading.repeated += used.repeated;
                of_reading.outside += used.outside;
            }
        }
        ControlFlow::Continue(())
    }

    /// Enters a reading into its sample. Whichever frame is nearest to a sample is the sample's.
    fn enter(&mut self, target: Target, time: f64, delay: f64, value: f64) -> Used {
        let (sample, distance) = if VALVES.contains(&target.column) {
            let sample = floor(time + EARLY_SIGNAL);
            // The last of several holds.
            (sample, sample - time)
        } else {
            let sample = round(time - delay);
            (sample, (time - delay - sample).abs())
        };
        let is_inside = sample >= self.first as f64 && sample < self.drive.samples as f64;
        let place = is_inside.then(|| sample as usize - self.first);
        let Some(place) = place else {
            return Used {
                repeated: 0,
                outside: 1,
            };
        };
        while self.rows.len() <= place {
            self.rows.push_back(Row::EMPTY);
        }
        let row = &mut self.rows[place];
        let nearest = &mut row.away[target.corner][target.column];
        let repeated = u64::from(nearest.is_finite());
        if distance < *nearest {
            *nearest = distance;
            row.values[target.corner][target.column] = value;
        }
        Used { repeated, outside: 0 }
    }

    /// The end of the drive: all samples go to `sink`.
    fn end(mut self, used: &mut [Used], sink: &mut SignalSink) -> ControlFlow<()> {
        while self.first < self.drive.samples {
            self.give_on(sink)?;
        }
        for (of_message, readings) in used.iter_mut().zip(&self.used) {
            of_message.repeated += readings.iter().map(|used| used.repeated).max().unwrap_or(0);
            of_message.outside += readings.iter().map(|used| used.outside).max().unwrap_or(0);
        }
        ControlFlow::Continue(())
    }

    /// Gives the first sample on.
    fn give_on(&mut self, sink: &mut SignalSink) -> ControlFlow<()> {
        let row = self.rows.pop_front().unwrap_or(Row::EMPTY);
        let sample = self.first;
        self.first += 1;
        let (held, last) = (&self.held, &mut self.last);
        let struts = Corners::from_fn(|corner| {
            let values: [f64; COLUMNS.len()] = std::array::from_fn(|column| {
                let value = row.values[corner][column];
                let last = &mut last[corner][column];
                if value.is_finite() {
                    *last = Some((value, sample));
                }
                // A value holds for some samples where no other comes.
                last.filter(|(_, since)| sample - since < held[corner][column])
                    .map_or(f64::NAN, |(value, _)| value)
            });
            strut_sample(values)
        });
        sink(SignalPart::Sample(&struts))
    }
}

/// A sample of a strut from the values of its columns.
fn strut_sample([displacement_m, p1, p2, p3, p4, valves @ ..]: [f64; COLUMNS.len()]) -> StrutSample {
    let is_known = valves.iter().all(|value| value.is_finite());
    StrutSample {
        displacement_m,
        pressure_pa: StrutPressures::from_array([p1, p2, p3, p4]),
        valves: is_known.then(|| StrutValves::from_array(valves.map(|value| value > 0.5))),
    }
}
