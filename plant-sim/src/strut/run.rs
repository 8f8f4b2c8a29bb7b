//! A recording on its way through a strut, step by step: by itself, or beside others whose steps are taken together.

use std::borrow::Cow;

use oleo_interface::StrutValves;

use crate::model_file::InvalidValue;

use super::beginning::Beginning;
use super::hydraulics::Step;
use super::inputs::Inputs;
use super::instruments::{record_column, true_motion};
use super::integrator::{Interval, Strut};
use super::model::StrutModel;
use super::motion::{Motion, Segment, StrutMove};
use super::prediction::Prediction;
use super::rod_course::RodCourse;
use super::terms::{COLUMNS, LawArgument};

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
    /// Accelerations at the samples, m/s2, where a law or a course asks for them.
    accelerations_m_s2: Vec<f64>,
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
    pub fn begin(model: &'a StrutModel, inputs: &'a Inputs, begins: &Beginning) -> Result<Self, InvalidValue> {
        let truth = true_motion(&model.effects, &inputs.time_s, &inputs.motion);
        let motion = truth.map_or(Cow::Borrowed(&inputs.motion), Cow::Owned);
        let signals = inputs.signals.first().copied().unwrap_or_default();
        let strut = Strut::beginning(model, signals, motion.start_m, begins)?;
        let samples = inputs.time_s.len();
        let mut prediction = Prediction::with_capacity(samples);
        if samples > 0 {
            prediction.push(strut.output());
        }
        let mut run = Self {
            strut,
            model,
            inputs,
            intervals: (motion.segments.len())
                .min(samples.saturating_sub(1))
                .min(inputs.signals.len()),
            accelerations_m_s2: vec![],
            motion,
            begun: 0,
            interval: Interval::over(),
            moves: false,
            to_come: Vec::with_capacity(2),
            prediction,
        };
        if (model.effects.unlisted.iter()).any(|law| law.depends_on == LawArgument::Acceleration) {
            run.know_accelerations();
        }
        Ok(run)
    }

    /// Works out the accelerations of the recorded motion.
    fn know_accelerations(&mut self) {
        self.accelerations_m_s2 = self.motion.accelerations_m_s2(&self.inputs.time_s);
    }

    /// Notes what the rod goes through.
    #[must_use]
    pub fn with_course(mut self) -> Self {
        self.strut.begin_course();
        self.know_accelerations();
        if !self.inputs.time_s.is_empty() {
            self.strut.note_sample();
        }
        self
    }

    /// Whether another run's model has laws without a name of the same quantities at the same places.
    pub fn has_laws_of(&self, other: &Self) -> bool {
        let laws = |run: &Self| run.model.effects.unlisted.iter().map(|law| (law.place, law.depends_on));
        laws(self).eq(laws(other))
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
            // Known at samples, where the last move of an interval ends.
            let known = (self.accelerations_m_s2.get(self.begun).copied()).filter(|_| self.to_come.is_empty());
            let output = self.strut.finish(&self.interval, known);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strut::beginning::InMotion;
    use crate::strut::gas::GasState;
    use crate::strut::replay::replay;
    use crate::strut::terms::{
        AccumulatorPistonFriction, DampingFade, Effects, LawPlace, OilCompressibility, OilCount, UnlistedLaw,
    };

    /// Samples of a motion with all valves open, from one on.
    fn inputs(from: usize, to: usize) -> Inputs {
        let at = |k: usize| {
            (
                0.005 * k as f64,
                0.05 * libm::sin(0.03 * k as f64) + 0.02 * libm::sin(0.2 * k as f64),
            )
        };
        let speed = |k: usize| 0.3 * libm::cos(0.03 * k as f64) + 0.8 * libm::cos(0.2 * k as f64);
        Inputs {
            time_s: (from..=to).map(|k| at(k).0).collect(),
            motion: Motion::through((from..=to).map(|k| (at(k).1, speed(k)))),
            signals: vec![StrutValves::new(true, true, true); to - from + 1],
        }
    }

    /// A run over the first samples, and the beginning of what follows without knowledge of the second gas.
    fn middle_of<'a>(model: &'a StrutModel, first: &'a Inputs) -> (Run<'a>, InMotion) {
        let mut run = Run::begin(model, first, &Beginning::AtRest).unwrap();
        run.go_on_to_the_end();
        let output = run.strut.output();
        let mut begins = InMotion {
            chamber_pa: output.pressure_pa[0],
            accumulator_pa: [output.pressure_pa[1], output.pressure_pa[3]],
            seal_shear: run.strut.flowing.state.shear,
            ..InMotion::default()
        };
        let equally_warm = begun_gas(model, first, begins)[0].temperature_k;
        begins.first_beyond_k = run.strut.flowing.state.gas[0].temperature_k - equally_warm;
        (run, begins)
    }

    /// The gas with which a recording begins that goes on where another one ends.
    fn begun_gas(model: &StrutModel, first: &Inputs, begins: InMotion) -> [GasState; 2] {
        let samples = first.time_s.len() - 1;
        let next = inputs(samples, samples + 1);
        let run = Run::begin(model, &next, &Beginning::InMotion(begins)).unwrap();
        run.strut.flowing.state.gas
    }

    #[test]
    fn a_moving_mass_feels_the_acceleration_of_its_side_where_that_jumps() {
        // From 1 to -3 m/s2 between samples 5 and 6.
        let speed = |t: f64| t.min(0.0525) - 3.0 * (t - 0.0525).max(0.0);
        let time_s: Vec<f64> = (0..12).map(|k| 0.01 * f64::from(k)).collect();
        let mut at_m = 0.0;
        let segments = (time_s.windows(2))
            .map(|t| {
                let (from_m_s, to_m_s) = (speed(t[0]), speed(t[1]));
                at_m += 0.5 * 0.01 * (from_m_s + to_m_s);
                Segment {
                    to_m: at_m,
                    from_m_s,
                    to_m_s,
                }
            })
            .collect();
        let inputs = Inputs {
            motion: Motion { start_m: 0.0, segments },
            signals: vec![StrutValves::new(true, true, true); 12],
            time_s,
        };
        let bare = StrutModel::defender110(6000.0);
        let mut with_mass = bare.clone();
        with_mass.effects.unlisted = vec![UnlistedLaw {
            place: LawPlace::MainSeal,
            depends_on: LawArgument::Acceleration,
            argument: vec![-10.0, 10.0],
            value: vec![-200.0, 200.0],
            time_constant_s: None,
            frequency_hz: None,
            presliding_volume_m3: None,
            attraction: None,
        }];
        let [with, without] = [&with_mass, &bare].map(|model| replay(model, &inputs).unwrap().force_n);
        for (k, (a, b)) in with.iter().zip(&without).enumerate().skip(1) {
            let exact = if k <= 5 { 20.0 } else { -60.0 };
            assert!((a - b - exact).abs() < 1e-6, "{k}: {} {exact}", a - b);
        }
    }

    #[test]
    fn a_drive_goes_on_from_its_middle_as_from_its_start() {
        // Real gas, heat, undissolved air, and oil that is counted at its static density and not lost.
        let model = StrutModel::defender110(6000.0);
        goes_on_from_its_middle(&model);
        // The seals of the floating pistons hold back two bar and one.
        let mut rubs = model;
        rubs.effects.accumulator_piston_friction = Some(AccumulatorPistonFriction {
            pressure_1_pa: 2e5,
            pressure_2_pa: 1e5,
            presliding_volume_m3: 4e-7,
        });
        goes_on_from_its_middle(&rubs);
    }

    fn goes_on_from_its_middle(model: &StrutModel) {
        const MIDDLE: usize = 400;
        let (first, rest, whole) = (inputs(0, MIDDLE), inputs(MIDDLE, 1200), inputs(0, 1200));
        let (to_the_middle, begins) = middle_of(model, &first);
        let truth = to_the_middle.strut.flowing.state.gas;
        let mut from_the_middle = Run::begin(model, &rest, &Beginning::InMotion(begins)).unwrap();
        let begun = from_the_middle.strut.flowing.state.gas;
        for (begun, truth) in begun.iter().zip(&truth) {
            assert!(
                (begun.temperature_k - truth.temperature_k).abs() < 0.1,
                "{begun:?} {truth:?}"
            );
            assert!(
                (begun.volume_m3 / truth.volume_m3 - 1.0).abs() < 3e-4,
                "{begun:?} {truth:?}"
            );
        }
        from_the_middle.go_on_to_the_end();
        let from_rest = replay(model, &whole).unwrap();
        let from_the_middle = from_the_middle.into_replayed().prediction;
        for point in 0..4 {
            let (a, b) = (
                &from_rest.pressure_pa[point][MIDDLE + 10..],
                &from_the_middle.pressure_pa[point][10..],
            );
            let range = a.iter().fold(0.0_f64, |m, v| m.max((v - a[0]).abs()));
            let off = a.iter().zip(b).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
            assert!(off < 1e-3 * range, "p{}: {off} of {range}", point + 1);
        }
    }

    #[test]
    fn the_recordings_equation_loses_the_volume_of_the_work_that_became_heat() {
        let mut model = StrutModel::defender110(6000.0);
        model.effects = Effects {
            oil_compressibility: Some(OilCompressibility {
                bulk_modulus_pa: 1.5e9,
                counted_at: OilCount::Chamber,
            }),
            gas_heat_transfer: model.effects.gas_heat_transfer,
            ..Effects::default()
        };
        let first = inputs(0, 4000);
        let (run, begins) = middle_of(&model, &first);
        let both_m3 = |gas: [GasState; 2]| gas[0].volume_m3 + gas[1].volume_m3;
        let off_m3 = both_m3(begun_gas(&model, &first, begins)) - both_m3(run.strut.flowing.state.gas);
        // (V - A x) dp / beta over the drive, less what the same rise takes up where it ends.
        let (area_m2, p1) = (model.piston_area_m2(), &run.prediction.pressure_pa[0]);
        let x = |k: usize| 0.05 * libm::sin(0.03 * k as f64) + 0.02 * libm::sin(0.2 * k as f64);
        let to = p1.len() - 1;
        let path: f64 = (1..=to).map(|k| 0.5 * (x(k) + x(k - 1)) * (p1[k] - p1[k - 1])).sum();
        let lost_m3 = area_m2 * (path - x(to) * (p1[to] - p1[0])) / 1.5e9;
        assert!(lost_m3.abs() > 1e-6, "{lost_m3}");
        assert!((off_m3.abs() / lost_m3.abs() - 1.0).abs() < 0.05, "{off_m3} {lost_m3}");
    }

    #[test]
    fn dampers_that_fade_begin_as_warm_as_they_have_been_made() {
        let mut model = StrutModel::defender110(6000.0);
        let begins = InMotion {
            chamber_pa: 5e6,
            accumulator_pa: [4e6, 3e6],
            heating_w: [200.0, 50.0],
            heated_s: 40.0,
            ..InMotion::default()
        };
        let some = inputs(7, 8);
        let heat_j = |model: &StrutModel, begins| Run::begin(model, &some, &begins).unwrap().strut.flowing.state.heat_j;
        assert_eq!(heat_j(&model, Beginning::InMotion(begins)), [0.0; 2]);
        model.effects.damping_fade = Some(DampingFade {
            fade_1_per_j: 1e-5,
            fade_2_per_j: 0.0,
            cooling_time_s: 1e6,
        });
        // As good as nothing has cooled away.
        let [first, second] = heat_j(&model, Beginning::InMotion(begins));
        assert!(
            (first - 8000.0).abs() < 1.0 && (second - 2000.0).abs() < 1.0,
            "{first} {second}"
        );
        assert_eq!(heat_j(&model, Beginning::AtRest), [0.0; 2]);
    }

    #[test]
    fn a_beginning_that_is_not_a_number_or_far_from_any_is_no_panic() {
        let model = StrutModel::defender110(6000.0);
        let some = inputs(7, 8);
        for pa in [f64::NAN, f64::NEG_INFINITY, f64::INFINITY] {
            let begins = InMotion {
                chamber_pa: pa,
                accumulator_pa: [pa; 2],
                volume_beyond: pa,
                first_beyond_k: pa,
                heating_w: [pa; 2],
                heated_s: pa,
                seal_shear: [pa; 2],
            };
            // Whatever it gives, it returns.
            assert!(Run::begin(&model, &some, &Beginning::InMotion(begins)).is_ok());
        }
    }

    #[test]
    fn gas_that_stays_at_ambient_temperature_begins_at_the_pressure_that_was_read() {
        let mut model = StrutModel::defender110(6000.0);
        model.effects.gas_heat_transfer = None;
        let begins = InMotion {
            chamber_pa: 5e6,
            accumulator_pa: [4e6, 3e6],
            first_beyond_k: 40.0,
            volume_beyond: -0.2,
            ..InMotion::default()
        };
        let some = inputs(7, 8);
        let run = Run::begin(&model, &some, &Beginning::InMotion(begins)).unwrap();
        let state = &run.strut.flowing.state;
        assert_eq!(state.gas.map(|gas| gas.temperature_k), [model.gas.temperature_k; 2]);
        assert_eq!((state.p1_pa, run.strut.output().pressure_pa[3]), (5e6, 3e6));
    }
}
