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

/// Simulations of one specimen, until the caller asks to stop.
#[derive(Clone)]
pub struct Evaluation<'a> {
    specimen: &'a dyn Specimen,
    stop: &'a AtomicBool,
    simulated: Arc<AtomicUsize>,
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
        }
    }

    /// Another specimen, stopped by the same flag and counted with this one.
    #[must_use]
    pub fn on<'b>(&self, specimen: &'b dyn Specimen) -> Evaluation<'b>
    where
        'a: 'b,
    {
        Evaluation {
            specimen,
            stop: self.stop,
            simulated: Arc::clone(&self.simulated),
        }
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
        (0..self.specimen.recordings().len())
            .into_par_iter()
            .map(|r| self.simulate(&hypothesis, r))
            .collect()
    }

    /// What the instruments show of given true quantities at a point.
    #[must_use]
    pub fn observed(&self, point: &Point, truths: &[Series]) -> Vec<Series> {
        let hypothesis = point.hypothesis(self.specimen);
        (truths.par_iter().enumerate())
            .map(|(r, t)| self.specimen.observe(&hypothesis, r, t))
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
        predicted.iter().enumerate().map(|(r, p)| self.residual(r, p)).collect()
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
        let shown = self.observed(point, truths);
        let moved: Vec<Moved> = coordinates.iter().map(|&k| self.moved(point, k)).collect();
        // All (recording, coordinate) pairs at once keep every core busy; collect restores their order.
        let pairs: Vec<(usize, usize)> = (0..truths.len())
            .flat_map(|r| (0..moved.len()).map(move |k| (r, k)))
            .collect();
        let derivatives: Vec<Series> = pairs
            .par_iter()
            .map(|&(r, k)| self.derivative(&moved[k], r, &truths[r], &shown[r]))
            .collect::<Result<_, _>>()?;
        let mut derivatives = derivatives.into_iter();
        Ok((shown.iter().enumerate())
            .map(|(r, shown)| Sensitivity {
                residual: self.residual(r, shown),
                columns: derivatives.by_ref().take(coordinates.len()).collect(),
            })
            .collect())
    }

    /// A point moved along one coordinate, backwards where its range ends.
    fn moved(&self, point: &Point, coordinate: usize) -> Moved {
        let parameter = point.parameters(self.specimen)[coordinate];
        let inside = point.z[coordinate] + DERIVATIVE_STEP <= parameter.z_range().1;
        let step = if inside { DERIVATIVE_STEP } else { -DERIVATIVE_STEP };
        let mut there = point.clone();
        there.z[coordinate] += step;
        Moved {
            hypothesis: there.hypothesis(self.specimen),
            step,
            instrument_only: parameter.instrument_only,
        }
    }

    fn derivative(
        &self,
        moved: &Moved,
        recording: usize,
        truth: &Series,
        shown: &Series,
    ) -> Result<Series, DiagnoseError> {
        let there = if moved.instrument_only {
            self.specimen.observe(&moved.hypothesis, recording, truth)
        } else {
            let truth = self.simulate(&moved.hypothesis, recording)?;
            self.specimen.observe(&moved.hypothesis, recording, &truth)
        };
        let weight = |c: usize| 1.0 / (self.specimen.channels()[c].noise * moved.step);
        Ok((there.iter().zip(shown).enumerate())
            .map(|(c, (a, b))| {
                let changes = (a.iter().zip(b).zip(self.specimen.measured(recording, c)))
                    .map(|((a, b), measured)| if measured.is_nan() { 0.0 } else { (a - b) * weight(c) });
                self.weighed(recording, c, changes.collect())
            })
            .collect())
    }

    fn simulate(&self, hypothesis: &Hypothesis, recording: usize) -> Result<Series, DiagnoseError> {
        if self.stop.load(Ordering::Relaxed) {
            return Err(DiagnoseError::Interrupted);
        }
        self.simulated.fetch_add(1, Ordering::Relaxed);
        (self.specimen.simulate(hypothesis, recording)).map_err(|what| DiagnoseError::Simulation {
            recording: self.specimen.recording_name(recording).to_owned(),
            what,
        })
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

/// A model moved along one coordinate.
struct Moved {
    hypothesis: Hypothesis,
    step: f64,
    instrument_only: bool,
}
