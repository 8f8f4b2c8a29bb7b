//! What must be known of a whole log before its first sample can be given on: which stretches are drives, the period of the samples, and how
//! each reading follows the beat.

use std::ops::ControlFlow;

use libm::{atan2, cos, floor, round, sin};

use super::beat::Beat;
use super::intervals::Intervals;
use super::map::VALVES;
use super::readings::Frame;
use super::selection::{Reading, Selection};
use super::stretches::{Step, Stretch};

/// A period is rounded to this, us, if that changes it by no more than clocks differ.
const PERIOD_STEP_US: f64 = 100.0;
/// Difference of two clocks.
const CLOCKS_DIFFER: f64 = 0.004;
/// Fewest samples of a drive.
const FEWEST_SAMPLES: usize = 6;
/// Most samples of a drive for each beat. Of a drive with more gaps nothing could be used.
const MOST_SAMPLES_A_BEAT: usize = 20;
/// Frames by which the delay of a message is measured.
const FRAMES_OF_DELAY: u32 = 4096;

/// What was found out of a log.
pub struct Survey {
    pub(super) beat: Beat,
    pub(super) drives: Vec<Drive>,
    period_us: f64,
}

/// A stretch that is a drive.
pub struct Drive {
    /// Its number among the stretches.
    pub stretch: u64,
    /// Number of samples.
    pub samples: usize,
    /// How its readings follow the beat, message by message.
    pub follows: Vec<Vec<Follows>>,
}

/// How a reading follows the beat.
#[derive(Clone, Copy, Debug)]
pub struct Follows {
    /// Time by which it usually comes behind the beat, samples from -0.5 to 0.5; 0 of a switching signal.
    pub delay: f64,
    /// Number of samples for which a value holds, its own included.
    pub held: usize,
}

impl Survey {
    /// Time between two samples, s.
    #[must_use]
    pub fn period_s(&self) -> f64 {
        self.period_us * 1e-6
    }

    /// Number of drives, at least one.
    #[must_use]
    pub fn number_of_drives(&self) -> usize {
        self.drives.len()
    }
}

/// A survey that is under way.
pub struct Surveyor<'s> {
    selection: &'s Selection,
    beat: Beat,
    /// Of the stretch that is under way, message by message.
    measured: Vec<Vec<Measured>>,
    stretches: u64,
    drives: Vec<Drive>,
    /// Last samples of all drives, and the times of these on the smoothed time base, added up.
    last: i64,
    base_us: f64,
}

impl<'s> Surveyor<'s> {
    /// Of nothing yet.
    pub fn new(selection: &'s Selection, beat: Beat) -> Self {
        Self {
            selection,
            beat,
            measured: Vec::new(),
            stretches: 0,
            drives: Vec::new(),
            last: 0,
            base_us: 0.0,
        }
    }

    /// The next step of the log.
    pub fn take(&mut self, step: &Step) -> ControlFlow<()> {
        match step {
            Step::Begins(_) => {
                self.stretches += 1;
                let of_message =
                    |message: &super::selection::Selected| message.readings.iter().map(Measured::of).collect();
                self.measured = self.selection.messages.iter().map(of_message).collect();
            }
            Step::Frame { time, frame } => {
                for (measured, value) in self.measured[frame.message].iter_mut().zip(frame.values) {
                    if value.is_finite() {
                        measured.take(*time, frame);
                    }
                }
            }
            Step::Ends(stretch) => self.end(stretch),
            Step::Outside(_) => {}
        }
        ControlFlow::Continue(())
    }

    fn end(&mut self, stretch: &Stretch) {
        let samples = stretch.last as usize + 1;
        if !(FEWEST_SAMPLES..=MOST_SAMPLES_A_BEAT * stretch.beats).contains(&samples) {
            return;
        }
        self.last += stretch.last;
        self.base_us += stretch.base_us;
        let interval_us = self.beat.interval_us;
        let follows = |measured: &Vec<Measured>| measured.iter().map(|one| one.follows(interval_us)).collect();
        self.drives.push(Drive {
            stretch: self.stretches,
            samples,
            follows: self.measured.iter().map(follows).collect(),
        });
    }

    /// What was found.
    ///
    /// # Errors
    /// No drive; a sentence without the name of the log.
    pub fn found(self) -> Result<Survey, String> {
        if self.drives.is_empty() {
            return Err(
                "holds no drive: displacements come for an instant only; log the bus for at least a second".to_owned(),
            );
        }
        let mean = self.base_us / self.last.max(1) as f64;
        let rounded = round(mean / PERIOD_STEP_US) * PERIOD_STEP_US;
        let is_near = (rounded - mean).abs() <= CLOCKS_DIFFER * mean;
        Ok(Survey {
            beat: self.beat,
            drives: self.drives,
            period_us: if is_near { rounded } else { mean },
        })
    }
}

/// What is measured of a reading in a stretch.
enum Measured {
    /// A displacement or a pressure: the direction of the time since the beat on the circle of one period, added up.
    Reading { sine: f64, cosine: f64, frames: u32 },
    /// A switching signal.
    Signal(Intervals),
    /// A switching signal that is sent when it changes.
    OnChange,
}

impl Measured {
    fn of(reading: &Reading) -> Self {
        match (VALVES.contains(&reading.target.column), reading.on_change) {
            (true, true) => Self::OnChange,
            (true, false) => Self::Signal(Intervals::default()),
            (false, _) => Self::Reading {
                sine: 0.0,
                cosine: 0.0,
                frames: 0,
            },
        }
    }

    fn take(&mut self, time: f64, frame: &Frame) {
        match self {
            Self::Reading { sine, cosine, frames } if *frames < FRAMES_OF_DELAY => {
                let angle = TURN * (time - floor(time));
                *sine += sin(angle);
                *cosine += cos(angle);
                *frames += 1;
            }
            Self::Signal(intervals) => intervals.take(frame.time_us),
            Self::Reading { .. } | Self::OnChange => {}
        }
    }

    fn follows(&self, interval_us: f64) -> Follows {
        match self {
            Self::Reading { sine, cosine, .. } => Follows {
                delay: atan2(*sine, *cosine) / TURN,
                held: 1,
            },
            Self::Signal(intervals) => Follows {
                delay: 0.0,
                held: (intervals.median_us()).map_or(1, |usual| round(usual / interval_us).max(1.0) as usize),
            },
            Self::OnChange => Follows {
                delay: 0.0,
                held: usize::MAX,
            },
        }
    }
}

/// A turn of the circle, rad.
const TURN: f64 = 2.0 * std::f64::consts::PI;
