//! The displacement that beats the time: the one that comes most seldom.

use super::content::SignalAccount;
use super::intervals::Intervals;
use super::readings::Frame;
use super::selection::Selection;

/// Periods of the displacement that are accepted, us. Above, the motion of a wheel (12 Hz) is not resolved.
const PERIODS_US: std::ops::RangeInclusive<f64> = 1_000.0..=20_000.0;

/// The displacement that beats the time.
#[derive(Clone, Copy, Debug)]
pub struct Beat {
    /// Position of its message in the selection.
    pub message: usize,
    /// Position of its reading in the message.
    pub reading: usize,
    /// Median of the time between two of its frames.
    pub interval_us: f64,
}

/// Looks for it, from the first frame of a log to the last.
pub struct Search(Vec<(usize, usize, Intervals)>);

impl Search {
    /// Among the displacements of a selection.
    pub fn of(selection: &Selection) -> Self {
        let displacements = selection.messages.iter().enumerate().flat_map(|(message, selected)| {
            let readings = selected.readings.iter().enumerate();
            let displacements = readings.filter(|(_, reading)| reading.target.column == 0);
            displacements.map(move |(reading, _)| (message, reading, Intervals::default()))
        });
        Self(displacements.collect())
    }

    /// The next frame.
    pub fn take(&mut self, frame: &Frame) {
        for (_, reading, intervals) in self.0.iter_mut().filter(|(message, ..)| *message == frame.message) {
            if frame.values[*reading].is_finite() {
                intervals.take(frame.time_us);
            }
        }
    }

    /// What was found.
    ///
    /// # Errors
    /// No displacement, or one that comes too seldom; a sentence without the name of the log.
    pub fn found(&self, account: &SignalAccount) -> Result<Beat, String> {
        let mut slowest: Option<Beat> = None;
        for (message, reading, intervals) in &self.0 {
            let of_message = &account.messages[*message];
            let name = &of_message.name;
            let Some(interval_us) = intervals.median_us() else {
                return Err(format!(
                    "holds no drive: {} readings of a displacement in {} frames of the message {name}; check the bus of the log, the \
                     map (valid, ignore_range) and the database",
                    intervals.frames(),
                    of_message.received
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
            if slowest.is_none_or(|slow| interval_us > slow.interval_us) {
                slowest = Some(Beat {
                    message: *message,
                    reading: *reading,
                    interval_us,
                });
            }
        }
        slowest.ok_or_else(|| "holds no drive: no message with a displacement".to_owned())
    }
}
