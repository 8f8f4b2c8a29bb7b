//! A specimen's recordings cut into blocks, and residuals and sensitivities on them.
//!
//! All judgement in this crate is about *free-run* simulation: the model gets the recording's inputs and nothing else,
//! and what it predicts is compared with what was measured, in units of each channel's noise. Normal equations are
//! kept per block, so that leaving blocks out (for held-out figures and for intervals) costs no simulation.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::error::DiagnoseError;
use crate::parameter::Parameter;
use crate::specimen::{Hypothesis, Series, Specimen};

/// Blocks a recording is cut into; also the number of folds. Each fold holds one block of every recording.
const BLOCKS_PER_RECORDING: usize = 8;
/// Step of the numerical derivative, in `z`.
const DERIVATIVE_STEP: f64 = 0.02;

/// A stretch of one recording.
#[derive(Debug, Clone)]
pub struct Block {
    /// Recording.
    pub recording: usize,
    /// First sample.
    pub start: usize,
    /// One past the last sample.
    pub end: usize,
    /// Held out together with the other blocks of this fold.
    pub fold: usize,
}

/// Normal equations of one block at a point: `cost(z + d) = cost - 2 g d + d H d` in the linear approximation.
#[derive(Debug, Clone)]
pub struct Normal {
    /// `J^T J`.
    pub h: DMatrix<f64>,
    /// `J^T r`, where `r = (measured - predicted) / noise` and `J = d predicted / d z / noise`.
    pub g: DVector<f64>,
    /// `r^T r`.
    pub cost: f64,
    /// Number of residuals.
    pub count: usize,
}

/// Structure (which candidates are present) and the coordinates of all its parameters.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Point {
    /// Candidates present, in the order their parameters have in `z`.
    pub effects: Vec<usize>,
    /// Calibration first, then the effects' parameters.
    pub z: Vec<f64>,
}

/// The specimen with everything that stays the same while hypotheses change.
pub struct Problem<'a> {
    /// The specimen.
    pub specimen: &'a dyn Specimen,
    /// Blocks of all recordings.
    pub blocks: Vec<Block>,
    /// Number of folds.
    pub folds: usize,
    stop: &'a AtomicBool,
    simulated: AtomicUsize,
}

impl<'a> Problem<'a> {
    /// Cuts the recordings into blocks. `stop` set from elsewhere ends the work at the next simulation.
    #[must_use]
    pub fn new(specimen: &'a dyn Specimen, stop: &'a AtomicBool) -> Self {
        let recordings = specimen.recordings();
        let mut blocks = Vec::new();
        let mut folds = 0;
        for recording in 0..recordings {
            let n = specimen.time_s(recording).len();
            for k in 0..BLOCKS_PER_RECORDING {
                let (start, end) = (n * k / BLOCKS_PER_RECORDING, n * (k + 1) / BLOCKS_PER_RECORDING);
                let fold = match recordings {
                    // The first half predicts the second and the other way round: nothing in between leaks.
                    1 => 2 * k / BLOCKS_PER_RECORDING,
                    // Each recording excites what no other does, so all folds hold a part of each; shifted from
                    // recording to recording, so that no fold holds all beginnings.
                    _ => (k + 3 * recording) % BLOCKS_PER_RECORDING,
                };
                folds = folds.max(fold + 1);
                blocks.push(Block {
                    recording,
                    start,
                    end,
                    fold,
                });
            }
        }
        Self {
            specimen,
            blocks,
            folds,
            stop,
            simulated: AtomicUsize::new(0),
        }
    }

    /// Another specimen, under the same wish to stop.
    #[must_use]
    pub fn on<'b>(&self, specimen: &'b dyn Specimen) -> Problem<'b>
    where
        'a: 'b,
    {
        Problem::new(specimen, self.stop)
    }

    /// The same problem without the blocks of a fold.
    #[must_use]
    pub fn without_fold(&self, fold: usize) -> Self {
        self.keeping(|b| b.fold != fold)
    }

    /// The same problem with some of its blocks.
    #[must_use]
    pub fn keeping(&self, wanted: impl Fn(&Block) -> bool) -> Self {
        let blocks = self.blocks.iter().filter(|b| wanted(b)).cloned().collect();
        Self {
            specimen: self.specimen,
            blocks,
            folds: self.folds,
            stop: self.stop,
            simulated: AtomicUsize::new(0),
        }
    }

    /// True where fitting once a fold is cheap enough to be done instead of approximated.
    #[must_use]
    pub fn refits_folds(&self) -> bool {
        self.specimen.is_cheap() && self.specimen.recordings() == 1
    }

    /// Sum of squares of given residuals over the blocks.
    #[must_use]
    pub fn squares(&self, residuals: &[Series]) -> f64 {
        (self.blocks.iter())
            .map(|b| {
                residuals[b.recording]
                    .iter()
                    .map(|c| c[b.start..b.end].iter().map(|r| r * r).sum::<f64>())
                    .sum::<f64>()
            })
            .sum()
    }

    /// Recordings simulated so far.
    #[must_use]
    pub fn simulated(&self) -> usize {
        self.simulated.load(Ordering::Relaxed)
    }

    /// Fails once the caller asked to stop.
    ///
    /// # Errors
    /// [`DiagnoseError::Interrupted`].
    pub fn check(&self) -> Result<(), DiagnoseError> {
        if self.stop.load(Ordering::Relaxed) {
            Err(DiagnoseError::Interrupted)
        } else {
            Ok(())
        }
    }

    /// The parameters of a structure, in the order of `z`.
    pub fn parameters(&self, effects: &[usize]) -> Vec<&Parameter> {
        let candidates = self.specimen.candidates();
        self.specimen
            .calibration()
            .iter()
            .chain(effects.iter().flat_map(|&e| candidates[e].parameters.iter()))
            .collect()
    }

    /// Nominal calibration, no effects.
    #[must_use]
    pub fn nominal(&self) -> Point {
        Point {
            effects: Vec::new(),
            z: vec![0.0; self.specimen.calibration().len()],
        }
    }

    /// A point with one more effect at given values.
    #[must_use]
    pub fn with_effect(&self, point: &Point, effect: usize, values: &[f64]) -> Point {
        let mut more = point.clone();
        more.effects.push(effect);
        more.z.extend(
            self.specimen.candidates()[effect]
                .parameters
                .iter()
                .zip(values)
                .map(|(p, &v)| p.z(v)),
        );
        more
    }

    /// A point without the effect at a position of [`Point::effects`].
    #[must_use]
    pub fn without(&self, point: &Point, position: usize) -> Point {
        let candidates = self.specimen.candidates();
        let from = self.specimen.calibration().len()
            + point.effects[..position]
                .iter()
                .map(|&e| candidates[e].parameters.len())
                .sum::<usize>();
        let mut less = point.clone();
        let effect = less.effects.remove(position);
        less.z.drain(from..from + candidates[effect].parameters.len());
        less
    }

    /// The hypothesis at a point.
    #[must_use]
    pub fn hypothesis(&self, point: &Point) -> Hypothesis {
        let candidates = self.specimen.candidates();
        let (calibration, mut rest) = point.z.split_at(self.specimen.calibration().len());
        let value = |p: &Parameter, z: &f64| p.value(*z);
        let mut effects = Vec::with_capacity(point.effects.len());
        for &effect in &point.effects {
            let parameters = &candidates[effect].parameters;
            let (own, after) = rest.split_at(parameters.len());
            effects.push((effect, parameters.iter().zip(own).map(|(p, z)| value(p, z)).collect()));
            rest = after;
        }
        let calibration = self
            .specimen
            .calibration()
            .iter()
            .zip(calibration)
            .map(|(p, z)| value(p, z))
            .collect();
        Hypothesis { calibration, effects }
    }

    /// The true quantities at a point, every recording.
    ///
    /// # Errors
    /// A hypothesis that cannot be simulated, or the wish to stop.
    pub fn truths(&self, point: &Point) -> Result<Vec<Series>, DiagnoseError> {
        let hypothesis = self.hypothesis(point);
        (0..self.specimen.recordings())
            .into_par_iter()
            .map(|r| self.simulate(&hypothesis, r))
            .collect()
    }

    /// What the instruments show of given truths at a point.
    #[must_use]
    pub fn observed(&self, point: &Point, truths: &[Series]) -> Vec<Series> {
        let hypothesis = self.hypothesis(point);
        truths
            .par_iter()
            .enumerate()
            .map(|(r, t)| self.specimen.observe(&hypothesis, r, t))
            .collect()
    }

    /// What the instruments would have shown, every recording.
    ///
    /// # Errors
    /// As [`Self::truths`].
    pub fn predict(&self, point: &Point) -> Result<Vec<Series>, DiagnoseError> {
        Ok(self.observed(point, &self.truths(point)?))
    }

    /// Residuals of given observations, every recording.
    #[must_use]
    pub fn residuals(&self, observed: &[Series]) -> Vec<Series> {
        observed.iter().enumerate().map(|(r, p)| self.residual(r, p)).collect()
    }

    fn simulate(&self, hypothesis: &Hypothesis, recording: usize) -> Result<Series, DiagnoseError> {
        self.check()?;
        self.simulated.fetch_add(1, Ordering::Relaxed);
        self.specimen
            .simulate(hypothesis, recording)
            .map_err(|what| DiagnoseError::Simulation {
                recording: self.specimen.recording_name(recording).to_owned(),
                what,
            })
    }

    /// `(measured - predicted) / noise` of one recording.
    #[must_use]
    pub fn residual(&self, recording: usize, predicted: &Series) -> Series {
        self.specimen
            .channels()
            .iter()
            .enumerate()
            .map(|(c, channel)| {
                let weight = 1.0 / channel.noise;
                self.specimen
                    .measured(recording, c)
                    .iter()
                    .zip(&predicted[c])
                    .map(|(m, p)| (m - p) * weight)
                    .collect()
            })
            .collect()
    }

    /// Sum of squared residuals of every block, then of the prior.
    ///
    /// # Errors
    /// As [`Self::predict`].
    pub fn cost(&self, point: &Point) -> Result<f64, DiagnoseError> {
        Ok(self.block_costs(point)?.iter().sum::<f64>() + self.prior_cost(point))
    }

    /// Sum of squared residuals of every block.
    ///
    /// # Errors
    /// As [`Self::predict`].
    pub fn block_costs(&self, point: &Point) -> Result<Vec<f64>, DiagnoseError> {
        let predicted = self.predict(point)?;
        let residuals = self.residuals(&predicted);
        Ok(self
            .blocks
            .iter()
            .map(|b| {
                residuals[b.recording]
                    .iter()
                    .map(|c| c[b.start..b.end].iter().map(|r| r * r).sum::<f64>())
                    .sum()
            })
            .collect())
    }

    /// Cost of departing from nominal.
    #[must_use]
    pub fn prior_cost(&self, point: &Point) -> f64 {
        self.parameters(&point.effects)
            .iter()
            .zip(&point.z)
            .filter(|(p, _)| p.prior)
            .map(|(_, z)| z * z)
            .sum()
    }

    /// Number of residuals.
    #[must_use]
    pub fn count(&self) -> usize {
        self.blocks
            .iter()
            .map(|b| (b.end - b.start) * self.specimen.channels().len())
            .sum()
    }

    /// Residual and the derivatives of the prediction with respect to the chosen coordinates, every recording. The true
    /// quantities at the point may be given where they are known already.
    ///
    /// # Errors
    /// As [`Self::truths`].
    pub fn sensitivities(
        &self,
        point: &Point,
        columns: &[usize],
        truths: Option<&[Series]>,
    ) -> Result<Vec<Sensitivity>, DiagnoseError> {
        let recordings = self.specimen.recordings();
        let simulated;
        let truths = if let Some(known) = truths {
            known
        } else {
            simulated = self.truths(point)?;
            &simulated
        };
        let base: Vec<(&Series, Series)> = truths.iter().zip(self.observed(point, truths)).collect();
        let parameters = self.parameters(&point.effects);
        let moved: Vec<(Hypothesis, f64, bool)> = columns
            .iter()
            .map(|&k| {
                let mut there = point.clone();
                let inside = point.z[k] + DERIVATIVE_STEP <= parameters[k].z_range().1;
                let step = if inside { DERIVATIVE_STEP } else { -DERIVATIVE_STEP };
                there.z[k] += step;
                (self.hypothesis(&there), step, parameters[k].instrument_only)
            })
            .collect();
        // All (recording, column) pairs at once keeps every core busy; order is restored by collect.
        let pairs: Vec<(usize, usize)> = (0..recordings)
            .flat_map(|r| (0..columns.len()).map(move |k| (r, k)))
            .collect();
        let derivatives: Vec<Series> = pairs
            .par_iter()
            .map(|&(r, k)| {
                let (there, step, instrument_only) = &moved[k];
                let shown = if *instrument_only {
                    self.specimen.observe(there, r, base[r].0)
                } else {
                    let truth = self.simulate(there, r)?;
                    self.specimen.observe(there, r, &truth)
                };
                let weight = |c: usize| 1.0 / (self.specimen.channels()[c].noise * step);
                Ok(shown
                    .iter()
                    .zip(&base[r].1)
                    .enumerate()
                    .map(|(c, (a, b))| a.iter().zip(b).map(|(a, b)| (a - b) * weight(c)).collect())
                    .collect())
            })
            .collect::<Result<_, DiagnoseError>>()?;
        let mut derivatives = derivatives.into_iter();
        Ok(base
            .iter()
            .enumerate()
            .map(|(r, (_, shown))| Sensitivity {
                residual: self.residual(r, shown),
                columns: derivatives.by_ref().take(columns.len()).collect(),
            })
            .collect())
    }

    /// Normal equations with new residuals and the same derivatives.
    #[must_use]
    pub fn with_residuals(&self, normals: &[Normal], sensitivity: &[Sensitivity]) -> Vec<Normal> {
        (self.blocks.par_iter().zip(normals))
            .map(|(b, old)| {
                let s = &sensitivity[b.recording];
                let (mut g, mut cost) = (DVector::zeros(s.columns.len()), 0.0);
                let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
                for (c, residual) in s.residual.iter().enumerate() {
                    let r = &residual[b.start..b.end];
                    cost += dot(r, r);
                    for (i, column) in s.columns.iter().enumerate() {
                        g[i] += dot(&column[c][b.start..b.end], r);
                    }
                }
                Normal {
                    h: old.h.clone(),
                    g,
                    cost,
                    count: old.count,
                }
            })
            .collect()
    }

    /// Sums residuals and derivatives into normal equations, block by block.
    #[must_use]
    pub fn assemble(&self, sensitivity: &[Sensitivity]) -> Vec<Normal> {
        self.blocks
            .par_iter()
            .map(|b| {
                let s = &sensitivity[b.recording];
                let p = s.columns.len();
                let (mut h, mut g, mut cost, mut count) = (DMatrix::zeros(p, p), DVector::zeros(p), 0.0, 0);
                let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
                for (c, residual) in s.residual.iter().enumerate() {
                    let r = &residual[b.start..b.end];
                    cost += dot(r, r);
                    count += r.len();
                    for i in 0..p {
                        let column = &s.columns[i][c][b.start..b.end];
                        g[i] += dot(column, r);
                        for j in 0..=i {
                            h[(i, j)] += dot(column, &s.columns[j][c][b.start..b.end]);
                        }
                    }
                }
                h.fill_upper_triangle_with_lower_triangle();
                Normal { h, g, cost, count }
            })
            .collect()
    }
}

/// Residual and derivatives of one recording, in noise units.
#[derive(Debug, Clone)]
pub struct Sensitivity {
    /// One series a channel.
    pub residual: Series,
    /// `d predicted / d z`, one set of series a coordinate.
    pub columns: Vec<Series>,
}
