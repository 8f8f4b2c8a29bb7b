//! Noise ratios of each channel for the given and the improved model.

use rayon::prelude::*;

use crate::error::DiagnoseError;
use crate::estimation::{Fit, LeastSquares, held_out};
use crate::specimen::Series;
use crate::vocabulary::Column;

/// Noise ratios of one channel.
#[derive(Debug, Clone)]
pub struct ChannelFigures {
    /// Column of the recordings that the channel is.
    pub column: Column,
    /// Noise ratio of the model as given.
    pub before: f64,
    /// The improved model, all recordings in the fit.
    pub after: f64,
    /// The given model, recalibrated within tolerance without the block it is judged on.
    pub held_out_before: f64,
    /// The improved model, fitted without the block it is judged on.
    pub held_out_after: f64,
    /// Correlation of neighbouring residuals of the improved model: 0 is white.
    pub lag_one: f64,
}

/// Residuals in units of noise of two models, every recording.
#[derive(Debug, Clone)]
pub struct Residuals {
    /// The model recalibrated within tolerance, no effect added.
    pub calibrated: Vec<Series>,
    /// Residuals of the improved model, for each recording.
    pub improved: Vec<Series>,
}

impl ChannelFigures {
    /// The figures of every channel. `given` are the residuals of the model as given.
    pub(super) fn of(
        problem: &LeastSquares<'_>,
        given: &[Series],
        fitted: &Residuals,
        held_out: &Residuals,
    ) -> Vec<Self> {
        let specimen = problem.specimen();
        (specimen.channels().iter().enumerate())
            .map(|(c, channel)| {
                let measured: usize = (0..specimen.recordings().len())
                    .map(|r| specimen.measured(r, c).iter().filter(|v| !v.is_nan()).count())
                    .sum();
                let ratio = |residuals: &[Series]| ratio(residuals, c, measured);
                Self {
                    column: channel.column.clone(),
                    before: ratio(given),
                    after: ratio(&fitted.improved),
                    held_out_before: ratio(&held_out.calibrated),
                    held_out_after: ratio(&held_out.improved),
                    lag_one: lag_one(&fitted.improved, c),
                }
            })
            .collect()
    }
}

/// Residuals of every block from a simulation with parameters that were fitted without the fold of that block.
pub(super) fn held_out_residuals(problem: &LeastSquares<'_>, fit: &Fit) -> Result<Vec<Series>, DiagnoseError> {
    let folds: Vec<Vec<Series>> = (held_out(fit, problem).points.par_iter())
        .map(|point| problem.evaluation.residuals_at(point))
        .collect::<Result<_, DiagnoseError>>()?;
    let mut out = folds[0].clone();
    for b in problem.blocks.as_slice() {
        for (to, from) in out[b.recording].iter_mut().zip(&folds[b.fold][b.recording]) {
            to[b.start..b.end].copy_from_slice(b.of(from));
        }
    }
    Ok(out)
}

fn ratio(residuals: &[Series], channel: usize, measured: usize) -> f64 {
    let sum: f64 = (residuals.iter())
        .map(|r| r[channel].iter().map(|v| v * v).sum::<f64>())
        .sum();
    (sum / measured as f64).sqrt()
}

fn lag_one(residuals: &[Series], channel: usize) -> f64 {
    let (mut product, mut square) = (0.0, 0.0);
    for r in residuals {
        product += r[channel].windows(2).map(|w| w[0] * w[1]).sum::<f64>();
        square += r[channel].iter().map(|v| v * v).sum::<f64>();
    }
    product / square.max(1e-300)
}
