//! A specimen simulated at a point and compared with its recordings: residuals, and how they answer each coordinate.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use rayon::prelude::*;

use super::point::Point;
use crate::error::DiagnoseError;
use crate::specimen::{Hypothesis, Series, Specimen};

/// Step of the numerical derivative, in `z`: small beside one, the scale of every coordinate, so that the model is nearly
/// linear over it, and large enough that its effect stands out of the error of the simulation.
const DERIVATIVE_STEP: f64 = 0.02;
/// The same from both sides. Where a stop is touched or friction turns, the error is of first order from both sides too, and a smaller step makes it small;
/// far below this one the error of the simulation shows.
const STEP_FROM_BOTH_SIDES: f64 = 0.002;

/// Simulations of one specimen, until the caller asks to stop.
#[derive(Clone)]
pub struct Evaluation<'a> {
    specimen: &'a dyn Specimen,
    stop: &'a AtomicBool,
    simulated: Arc<AtomicUsize>,
    /// Indices of the recordings that are simulated.
    recordings: Arc<[usize]>,
    /// True if it is one of many that work at the same time: each keeps one thread as busy as it can, instead of all.
    one_of_many: bool,
    /// True if derivatives are taken from both sides of a point.
    both_sides: bool,
}

/// Residuals and derivatives of one recording, in units of noise. Both are zero where nothing was measured.
#[derive(Debug, Clone)]
pub struct Sensitivity {
    /// `(measured - predicted) / noise`, one series a channel.
    pub residual: Series,
    /// `d predicted / d z / noise`, one set of series a coordinate.
    pub columns: Vec<Series>,
}

impl<'a> Evaluation<'a> {
    /// `stop`, set from another thread, ends the work at the next simulation.
    #[must_use]
    pub fn new(specimen: &'a dyn Specimen, stop: &'a AtomicBool) -> Self {
        Self {
            specimen,
            stop,
            simulated: Arc::default(),
            recordings: (0..specimen.recordings().len()).collect(),
            one_of_many: false,
            both_sides: false,
        }
    }

    /// Another specimen, stopped by the same flag and counted with this one.
    #[must_use]
    pub fn on<'b>(&self, specimen: &'b dyn Specimen) -> Evaluation<'b>
    where
        'a: 'b,
    {
        Evaluation {
            simulated: Arc::clone(&self.simulated),
            ..Evaluation::new(specimen, self.stop)
        }
    }

    /// Some of the recordings, by their indices, for many who ask at the same time. What is said of every recording is then said of these, in this order.
    #[must_use]
    pub fn of_recordings(&self, recordings: &[usize]) -> Self {
        Self {
            recordings: recordings.into(),
            ..self.of_many()
        }
    }

    /// The same for one of many who ask at the same time.
    #[must_use]
    pub fn of_many(&self) -> Self {
        Self {
            one_of_many: true,
            ..self.clone()
        }
    }

    /// The same with derivatives from both sides of a point, for twice the simulations. Their error is of second order in the step: where two gross columns
    /// nearly cancel, the error of one side alone stands for a difference that the recordings do not show.
    #[must_use]
    pub fn from_both_sides(&self) -> Self {
        Self {
            both_sides: true,
            ..self.clone()
        }
    }

    /// Indices of the recordings that are simulated.
    #[must_use]
    pub fn recordings(&self) -> &[usize] {
        &self.recordings
    }

    /// The specimen.
    #[must_use]
    pub const fn specimen(&self) -> &'a dyn Specimen {
        self.specimen
    }

    /// Number of recordings simulated so far.
    #[must_use]
    pub fn simulated(&self) -> usize {
        self.simulated.load(Ordering::Relaxed)
    }

    /// The true quantities at a point, before any instrument, every recording.
    ///
    /// # Errors
    /// A model that cannot be simulated; [`DiagnoseError::Interrupted`] once the caller asked to stop.
    pub fn truths(&self, point: &Point) -> Result<Vec<Series>, DiagnoseError> {
        let hypothesis = point.hypothesis(self.specimen);
        let wanted: Vec<(&Hypothesis, usize)> = self.recordings.iter().map(|&r| (&hypothesis, r)).collect();
        self.simulate_all(&wanted)
    }

    /// The same at several points, each on its own; an error where a point cannot be simulated.
    #[must_use]
    pub fn truths_at_each(&self, points: &[Point]) -> Vec<Result<Vec<Series>, DiagnoseError>> {
        let hypotheses: Vec<Hypothesis> = points.iter().map(|point| point.hypothesis(self.specimen)).collect();
        let wanted: Vec<(&Hypothesis, usize)> = (hypotheses.iter())
            .flat_map(|hypothesis| self.recordings.iter().map(move |&r| (hypothesis, r)))
            .collect();
        let mut simulated = (wanted.par_chunks(self.at_once(wanted.len())))
            .flat_map_iter(|wanted| self.simulate_each(wanted))
            .collect::<Vec<_>>()
            .into_iter();
        (points.iter())
            .map(|_| {
                // All of a point, also behind an error: what follows belongs to the next one.
                let of_point: Vec<_> = simulated.by_ref().take(self.recordings.len()).collect();
                of_point.into_iter().collect()
            })
            .collect()
    }

    /// What the instruments show of given true quantities at a point.
    #[must_use]
    pub fn observed(&self, point: &Point, truths: &[Series]) -> Vec<Series> {
        let hypothesis = point.hypothesis(self.specimen);
        (truths.par_iter().zip(&*self.recordings))
            .map(|(t, &r)| self.specimen.observe(&hypothesis, r, t))
            .collect()
    }

    /// What the instruments would have shown at a point, every recording.
    ///
    /// # Errors
    /// As [`Self::truths`].
    pub fn predict(&self, point: &Point) -> Result<Vec<Series>, DiagnoseError> {
        Ok(self.observed(point, &self.truths(point)?))
    }

    /// `(measured - predicted) / noise`, every recording; zero where nothing was measured (NaN).
    #[must_use]
    pub fn residuals(&self, predicted: &[Series]) -> Vec<Series> {
        (predicted.iter().zip(&*self.recordings))
            .map(|(p, &r)| self.residual(r, p))
            .collect()
    }

    /// Residuals at a point, every recording.
    ///
    /// # Errors
    /// As [`Self::truths`].
    pub fn residuals_at(&self, point: &Point) -> Result<Vec<Series>, DiagnoseError> {
        Ok(self.residuals(&self.predict(point)?))
    }

    /// Residuals and their derivatives with respect to the chosen coordinates, every recording. The true quantities at the
    /// point may be given where they are known already.
    ///
    /// # Errors
    /// As [`Self::truths`].
    pub fn sensitivities(
        &self,
        point: &Point,
        coordinates: &[usize],
        truths: Option<&[Series]>,
    ) -> Result<Vec<Sensitivity>, DiagnoseError> {
        let simulated;
        let truths = if let Some(known) = truths {
            known
        } else {
            simulated = self.truths(point)?;
            &simulated
        };
        let at = Wanted {
            point,
            coordinates,
            truths,
        };
        self.sensitivities_at_each(&[at])
            .pop()
            .unwrap_or_else(|| Ok(Vec::new()))
    }

    /// The same at several points, each on its own; an error where a derivative cannot be simulated.
    #[must_use]
    pub fn sensitivities_at_each(&self, wanted: &[Wanted<'_>]) -> Vec<Result<Vec<Sensitivity>, DiagnoseError>> {
        let asked: Vec<Asked<'_>> = (wanted.iter())
            .map(|at| Asked {
                truths: at.truths,
                shown: self.observed(at.point, at.truths),
                moved: at.coordinates.iter().map(|&k| self.moved(at.point, k)).collect(),
            })
            .collect();
        // All (recording, coordinate) pairs at once keep every core busy; collect restores their order. Of a recording, its place among those that
        // are simulated.
        let matters = |place: usize, moved: &Moved| moved.matters_in(self.recordings[place]);
        let pairs: Vec<(usize, &Asked<'_>, &Moved)> = (asked.iter())
            .flat_map(|asked| (0..asked.truths.len()).map(move |r| (r, asked)))
            .flat_map(|(r, asked)| asked.moved.iter().map(move |moved| (r, asked, moved)))
            .filter(|&(r, _, moved)| matters(r, moved))
            .collect();
        let derivatives: Vec<Vec<Result<Series, DiagnoseError>>> = (pairs.par_chunks(self.at_once(pairs.len())))
            .map(|pairs| self.derivatives(pairs))
            .collect();
        let mut derivatives = derivatives.into_iter().flatten();
        let mut sensitivity = |asked: &Asked<'_>, r: usize, residual: Series| {
            let unchanged = || residual.iter().map(|series| vec![0.0; series.len()]).collect();
            // All of a point, also behind an error: what follows belongs to the next one.
            let columns: Vec<Result<Series, DiagnoseError>> = (asked.moved.iter())
                .map(|moved| if matters(r, moved) { derivatives.next() } else { None })
                .map(|column| column.unwrap_or_else(|| Ok(unchanged())))
                .collect();
            Ok(Sensitivity {
                columns: columns.into_iter().collect::<Result<_, _>>()?,
                residual,
            })
        };
        (asked.iter())
            .map(|asked| {
                let recordings: Vec<Result<Sensitivity, DiagnoseError>> = (self.residuals(&asked.shown).into_iter())
                    .enumerate()
                    .map(|(r, residual)| sensitivity(asked, r, residual))
                    .collect();
                recordings.into_iter().collect()
            })
            .collect()
    }

    /// A point moved along one coordinate, backwards where its range ends.
    fn moved(&self, point: &Point, coordinate: usize) -> Moved {
        let parameter = point.parameters(self.specimen)[coordinate];
        let (z, range) = (point.z[coordinate], parameter.z_range());
        let size = if self.both_sides {
            STEP_FROM_BOTH_SIDES
        } else {
            DERIVATIVE_STEP
        };
        let inside = z + size <= range.1;
        let step = if inside { size } else { -size };
        let at = |z: f64| {
            let mut there = point.clone();
            there.z[coordinate] = z;
            there.hypothesis(self.specimen)
        };
        let back = (self.both_sides && inside && z - size >= range.0).then(|| at(z - size));
        Moved {
            hypothesis: at(z + step),
            step: if back.is_some() { 2.0 * step } else { step },
            back,
            instrument_only: parameter.instrument_only,
            matters: point.matters(self.specimen, coordinate),
            only_in: parameter.only_in,
        }
    }

    /// Derivatives of recordings along coordinates, those that need a simulation by simulations together.
    fn derivatives(&self, pairs: &[(usize, &Asked<'_>, &Moved)]) -> Vec<Result<Series, DiagnoseError>> {
        let wanted: Vec<(&Hypothesis, usize)> = (pairs.iter())
            .filter(|(_, _, moved)| !moved.instrument_only)
            .flat_map(|&(place, _, moved)| moved.hypotheses().map(move |h| (h, self.recordings[place])))
            .collect();
        let mut simulated = self.simulate_each(&wanted).into_iter();
        (pairs.iter())
            .map(|&(place, asked, moved)| {
                let recording = self.recordings[place];
                // All of a pair, also behind an error: what follows belongs to the next one.
                let shown: Vec<Result<Series, DiagnoseError>> = (moved.hypotheses())
                    .map(|hypothesis| {
                        let simulated = if moved.instrument_only { None } else { simulated.next() };
                        let simulated = simulated.transpose()?;
                        let truth = simulated.as_ref().unwrap_or(&asked.truths[place]);
                        Ok(self.specimen.observe(hypothesis, recording, truth))
                    })
                    .collect();
                let shown = shown.into_iter().collect::<Result<Vec<_>, _>>()?;
                Ok(self.derivative(moved, recording, &shown[0], shown.get(1).unwrap_or(&asked.shown[place])))
            })
            .collect()
    }

    /// What the readings change by along a coordinate, from what is shown where it is moved to and where from.
    fn derivative(&self, moved: &Moved, recording: usize, there: &Series, from: &Series) -> Series {
        let weight = |c: usize| 1.0 / (self.specimen.channels()[c].noise * moved.step);
        (there.iter().zip(from).enumerate())
            .map(|(c, (a, b))| {
                let changes = (a.iter().zip(b).zip(self.specimen.measured(recording, c)))
                    .map(|((a, b), measured)| if measured.is_nan() { 0.0 } else { (a - b) * weight(c) });
                self.weighed(recording, c, changes.collect())
            })
            .collect()
    }

    /// How many of so many simulations one thread is given at once: all threads have some, and none so many that a wish to stop waits for long.
    fn at_once(&self, simulations: usize) -> usize {
        let most = self.specimen.simulations_at_once();
        if self.one_of_many {
            return most;
        }
        let share = simulations.div_ceil(rayon::current_num_threads());
        share.clamp(1, most)
    }

    fn simulate_all(&self, wanted: &[(&Hypothesis, usize)]) -> Result<Vec<Series>, DiagnoseError> {
        let simulated: Vec<Vec<Series>> = (wanted.par_chunks(self.at_once(wanted.len())))
            .map(|wanted| self.simulate_these(wanted))
            .collect::<Result<_, _>>()?;
        Ok(simulated.into_iter().flatten().collect())
    }

    /// Simulations on this thread.
    fn simulate_these(&self, wanted: &[(&Hypothesis, usize)]) -> Result<Vec<Series>, DiagnoseError> {
        self.simulate_each(wanted).into_iter().collect()
    }

    fn simulate_each(&self, wanted: &[(&Hypothesis, usize)]) -> Vec<Result<Series, DiagnoseError>> {
        if self.stop.load(Ordering::Relaxed) {
            return wanted.iter().map(|_| Err(DiagnoseError::Interrupted)).collect();
        }
        self.simulated.fetch_add(wanted.len(), Ordering::Relaxed);
        (self.specimen.simulate_all(wanted).into_iter().zip(wanted))
            .map(|(simulated, &(_, recording))| {
                simulated.map_err(|what| DiagnoseError::Simulation {
                    recording: self.specimen.recording_name(recording).to_owned(),
                    what,
                })
            })
            .collect()
    }

    fn residual(&self, recording: usize, predicted: &Series) -> Series {
        (self.specimen.channels().iter().enumerate())
            .map(|(c, channel)| {
                let weight = 1.0 / channel.noise;
                let residual = (self.specimen.measured(recording, c).iter().zip(&predicted[c]))
                    .map(|(m, p)| if m.is_nan() { 0.0 } else { (m - p) * weight });
                self.weighed(recording, c, residual.collect())
            })
            .collect()
    }

    /// A series in units of its channel's noise in units of its samples' noise.
    fn weighed(&self, recording: usize, channel: usize, mut series: Vec<f64>) -> Vec<f64> {
        if let Some(relative) = self.specimen.relative_noise(recording, channel) {
            series.iter_mut().zip(relative).for_each(|(v, relative)| *v /= relative);
        }
        series
    }
}

/// A point of which residuals and derivatives are wanted.
#[derive(Debug, Clone, Copy)]
pub struct Wanted<'w> {
    /// The point.
    pub point: &'w Point,
    /// Coordinates along which derivatives are wanted.
    pub coordinates: &'w [usize],
    /// The true quantities at the point, one set of series a recording.
    pub truths: &'w [Series],
}

/// A point of which derivatives are asked for.
struct Asked<'w> {
    truths: &'w [Series],
    /// What the instruments show there.
    shown: Vec<Series>,
    /// The point moved along each coordinate.
    moved: Vec<Moved>,
}

/// A model moved along one coordinate.
struct Moved {
    hypothesis: Hypothesis,
    /// The point moved the other way, where the derivative is taken from both sides.
    back: Option<Hypothesis>,
    /// Distance from where it is moved from.
    step: f64,
    instrument_only: bool,
    matters: bool,
    only_in: Option<usize>,
}

impl Moved {
    /// Where it is moved to and, where that is not the point itself, where from.
    fn hypotheses(&self) -> impl Iterator<Item = &Hypothesis> {
        std::iter::once(&self.hypothesis).chain(&self.back)
    }

    /// Whether a recording changes along the coordinate.
    fn matters_in(&self, recording: usize) -> bool {
        self.matters && self.only_in.is_none_or(|only| only == recording)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytic::{CUBIC, FRAGILE, GAIN, RUN, Recipe, VIBRATION};

    /// The derivative of a sine by its frequency is known: `a t cos(w t)`.
    #[test]
    fn derivatives_from_both_sides_are_exact_but_at_the_end_of_a_range_where_there_is_one_side() {
        let specimen = Recipe::default().make();
        let evaluation = Evaluation::new(&specimen, &RUN);
        let [least, middle, most] = [0.5, 2.3, 4.0];
        // The error at a frequency, and how many recordings were simulated for it.
        let error = |evaluation: &Evaluation<'_>, frequency: f64| {
            let point = Point::nominal(&specimen).with_effect(&specimen, VIBRATION, &[0.1, frequency]);
            let truths = evaluation.truths(&point).expect("simulated");
            let before = evaluation.simulated();
            let answers = evaluation
                .sensitivities(&point, &[3], Some(&truths))
                .expect("derivatives");
            let recording = &specimen.recordings()[0];
            let per_z = 0.05 / specimen.channels()[1].noise;
            let exact = (recording.time_s.iter()).map(|t| 0.1 * t * libm::cos(frequency * t) * per_z);
            let worst = (exact.zip(&answers[0].columns[0][1])).fold(0.0, |w: f64, (a, b)| w.max((a - b).abs()));
            (worst, evaluation.simulated() - before)
        };
        let both = evaluation.from_both_sides();
        let one_side = error(&evaluation, middle);
        assert!(one_side.0 > 0.05 && one_side.1 == 3, "{one_side:?}");
        let both_sides = error(&both, middle);
        assert!(both_sides.0 < 1e-4 && both_sides.1 == 6, "{both_sides:?}");
        for end in [least, most] {
            let at_end = error(&both, end);
            assert!(at_end.0 > 1e-4 && at_end.0 < 0.02 && at_end.1 == 3, "{at_end:?}");
        }
    }

    #[test]
    fn several_points_give_what_each_gives_alone_also_behind_one_that_cannot_be_simulated() {
        let specimen = Recipe::default().make();
        let evaluation = Evaluation::new(&specimen, &RUN);
        let with = |effect, value| Point::nominal(&specimen).with_effect(&specimen, effect, &[value]);
        let points = [with(CUBIC, 0.1), with(FRAGILE, 2.0), with(CUBIC, 0.3)];
        let together = evaluation.truths_at_each(&points);
        assert_eq!(together.len(), points.len());
        for (point, together) in points.iter().zip(together) {
            assert_eq!(together.ok(), evaluation.truths(point).ok());
        }
    }

    #[test]
    fn derivatives_at_a_point_that_cannot_be_simulated_are_an_error_of_that_point_only() {
        let specimen = Recipe::default().make();
        let evaluation = Evaluation::new(&specimen, &RUN);
        let nominal = Point::nominal(&specimen);
        let truths = evaluation.truths(&nominal).expect("simulated");
        let with = |effect, value| nominal.with_effect(&specimen, effect, &[value]);
        let points = [with(CUBIC, 0.0), with(FRAGILE, 2.0), with(CUBIC, 0.1)];
        let coordinates = [2];
        let answers = evaluation.sensitivities_at_each(&points.each_ref().map(|point| Wanted {
            point,
            coordinates: &coordinates,
            truths: &truths,
        }));
        let [first, broken, last] = answers.try_into().expect("one each");
        assert!(matches!(broken, Err(DiagnoseError::Simulation { .. })));
        let columns = |answer: Result<Vec<Sensitivity>, _>| answer.expect("derivatives")[0].columns.clone();
        assert_eq!(columns(first).len(), 1);
        let alone = evaluation.sensitivities(&points[2], &coordinates, Some(&truths));
        assert_eq!(columns(last), columns(alone));
    }

    #[test]
    fn several_points_answer_as_each_does_alone() {
        let specimen = Recipe::default().make();
        let evaluation = Evaluation::new(&specimen, &RUN);
        let truths = evaluation.truths(&Point::nominal(&specimen)).expect("simulated");
        let with = |effect| Point::nominal(&specimen).with_effect(&specimen, effect, &[0.0]);
        let points = [with(CUBIC), with(GAIN)];
        let coordinates: [&[usize]; 2] = [&[2, 0], &[2]];
        let wanted: Vec<Wanted<'_>> = (points.iter().zip(coordinates))
            .map(|(point, coordinates)| Wanted {
                point,
                coordinates,
                truths: &truths,
            })
            .collect();
        let together = evaluation.sensitivities_at_each(&wanted);
        for (at, together) in wanted.into_iter().zip(together) {
            let together = together.expect("derivatives");
            let alone = evaluation
                .sensitivities(at.point, at.coordinates, Some(&truths))
                .expect("derivatives");
            assert_eq!(together.len(), alone.len());
            for (a, b) in together.iter().zip(&alone) {
                assert_eq!((&a.residual, &a.columns), (&b.residual, &b.columns));
            }
        }
    }
}
