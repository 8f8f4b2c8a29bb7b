//! A recording on its way through a strut, step by step: by itself, or beside others whose steps are taken together.

use std::borrow::Cow;

use oleo_interface::StrutValves;

use crate::model_file::InvalidValue;

use super::hydraulics::Step;
use super::inputs::Inputs;
use super::instruments::{record_column, true_motion};
use super::integrator::{Interval, Strut};
use super::model::StrutModel;
use super::motion::{Motion, Segment, StrutMove};
use super::prediction::Prediction;
use super::rod_course::RodCourse;
use super::terms::COLUMNS;

/// What has become of a recording that went through a model.
#[derive(Debug, Clone, Default)]
pub struct Replayed {
    /// The predicted readings.
    pub prediction: Prediction,
    /// What the rod went through, where it was asked for.
    pub course: Option<RodCourse>,
}

/// A recording that is being simulated.
pub(super) struct Run<'a> {
    pub strut: Strut,
    model: &'a StrutModel,
    inputs: &'a Inputs,
    motion: Cow<'a, Motion>,
    /// Number of sampling intervals, and of those that have been begun.
    intervals: usize,
    begun: usize,
    /// The move that is being made, or was made last.
    interval: Interval,
    /// Whether one is being made.
    moves: bool,
    /// Moves that the present sampling interval still has, the next one last.
    to_come: Vec<StrutMove>,
    prediction: Prediction,
}

impl<'a> Run<'a> {
    /// A recording before its first step.
    ///
    /// # Errors
    /// Impossible values in the model.
    pub fn begin(model: &'a StrutModel, inputs: &'a Inputs) -> Result<Self, InvalidValue> {
        let truth = true_motion(&model.effects, &inputs.time_s, &inputs.motion);
        let motion = truth.map_or(Cow::Borrowed(&inputs.motion), Cow::Owned);
        let signals = inputs.signals.first().copied().unwrap_or_default();
        let strut = Strut::at_rest_at(model, signals, motion.start_m)?;
        let samples = inputs.time_s.len();
        let mut prediction = Prediction::with_capacity(samples);
        if samples > 0 {
            prediction.push(strut.output());
        }
        Ok(Self {
            strut,
            model,
            inputs,
            intervals: (motion.segments.len())
                .min(samples.saturating_sub(1))
                .min(inputs.signals.len()),
            motion,
            begun: 0,
            interval: Interval::over(),
            moves: false,
            to_come: Vec::with_capacity(2),
            prediction,
        })
    }

    /// Notes what the rod goes through.
    #[must_use]
    pub fn with_course(mut self) -> Self {
        self.strut.begin_course();
        if !self.inputs.time_s.is_empty() {
            self.strut.note_sample();
        }
        self
    }

    /// Number of samples, by which runs are ordered.
    pub fn samples(&self) -> usize {
        self.inputs.time_s.len()
    }

    /// The step that is to be taken next; none once the recording is over. It is the same one until [`Self::conclude`] is told of it.
    #[inline(always)]
    pub fn next_step(&mut self) -> Option<Step> {
        loop {
            if !self.interval.is_over() {
                return Some(self.strut.next_step(&self.interval));
            }
            if !self.begin_next() {
                return None;
            }
        }
    }

    /// Goes on after a step that the hydraulics have taken.
    #[inline(always)]
    pub fn conclude(&mut self, step: &Step, friction_n: Option<f64>) {
        self.strut.conclude(step, friction_n, &mut self.interval);
    }

    /// Ends the move that is over and begins the next one; whether there is one.
    #[inline(always)]
    fn begin_next(&mut self) -> bool {
        if self.moves {
            let output = self.strut.finish(&self.interval);
            if let Some(next) = self.to_come.pop() {
                self.interval = self.strut.begin(&next);
                return true;
            }
            self.moves = false;
            self.prediction.push(output);
            self.strut.note_sample();
        }
        let k = self.begun;
        if k == self.intervals {
            return false;
        }
        self.begun += 1;
        let duration_s = self.inputs.time_s[k + 1] - self.inputs.time_s[k];
        let first = self.first_move(self.motion.segments[k], duration_s, self.inputs.signals[k]);
        self.interval = self.strut.begin(&first);
        self.moves = true;
        true
    }

    /// The first move of a sampling interval. Where the motion begins or ends within it there are others, which are kept.
    #[inline(always)]
    fn first_move(&mut self, segment: Segment, duration_s: f64, signals: StrutValves<bool>) -> StrutMove {
        let by = |segment, duration_s| StrutMove {
            segment,
            duration_s,
            signals,
        };
        let at_m = self.strut.displacement_m();
        let (begins_s, takes_s) = segment.moves_within(at_m, duration_s);
        if begins_s + takes_s < duration_s {
            self.to_come
                .push(by(Segment::rest(segment.to_m), duration_s - (begins_s + takes_s)));
        }
        if begins_s > 0.0 {
            self.to_come.push(by(segment, takes_s));
            by(Segment::rest(at_m), begins_s)
        } else {
            by(segment, takes_s)
        }
    }

    /// Goes on to the end, by itself.
    pub fn go_on_to_the_end(&mut self) {
        while let Some(step) = self.next_step() {
            self.strut.hydraulics.step(&mut self.strut.flowing, &step);
            self.conclude(&step, None);
        }
    }

    /// What the instruments read of a recording that is over.
    pub fn into_replayed(self) -> Replayed {
        let (effects, time_s) = (&self.model.effects, &self.inputs.time_s);
        let mut prediction = self.prediction;
        let [_, force, pressures @ ..] = COLUMNS;
        record_column(effects, force, time_s, &mut prediction.force_n);
        for (column, signal) in pressures.iter().zip(&mut prediction.pressure_pa) {
            record_column(effects, column, time_s, signal);
        }
        Replayed {
            prediction,
            course: self.strut.into_course(),
        }
    }
}
