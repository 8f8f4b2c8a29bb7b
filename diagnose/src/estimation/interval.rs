//! How sure a fitted number is where the model is not the whole truth.
//!
//! Residuals that stay after a good fit are coloured and differ from move to move, so that one part of the recordings
//! asks for another value than the next, by more than the scatter within either admits. Leaving out each part in turn and
//! fitting again (jackknife: Quenouille, Biometrika 43, 1956; Efron & Stein, Ann. Statist. 9(3), 1981) counts that in. Two
//! recordings are no sample: made to differ in one condition, neither may determine alone what both do. Their blocks are left
//! out instead.

use std::sync::Arc;

use nalgebra::DVector;
use rayon::prelude::*;

use super::blocks::Block;
use super::covariance;
use super::fit::Fit;
use super::gauss_newton::{Start, fit_from};
use super::least_squares::LeastSquares;
use super::normal_equations::assemble;
use crate::error::DiagnoseError;

/// Half of a 95 % interval in standard deviations of a normal distribution.
pub const HALF_INTERVAL: f64 = 1.96;

/// Where leaving out parts costs too much: neighbouring blocks share the state of the gas and what smoothing left of the
/// displacement's noise, and are not as independent as the sandwich takes them. `oleo diagnose --self-test --seed 1
/// --campaigns 158` found 88 of 107 true values in intervals without this factor, as if they were 1.46 times too narrow.
const WIDER: f64 = 1.46;

/// A fit with derivatives from both sides of where it ended, from which to say how sure its numbers are; the fit itself where one side cannot be simulated.
///
/// The zero of a displacement, the clearances of stops and the charges of the gas can move together without a trace. A gross effect has columns of ten
/// thousand times the noise there, and what the error of a derivative leaves of their difference would pass for knowledge: of stops of 100 x noise and more
/// the intervals of the clearances were up to thirty times too narrow (`oleo diagnose --self-test --terms bump_stop --campaigns 40 --seed 5`).
///
/// # Errors
/// [`DiagnoseError::Interrupted`] once the caller asked to stop.
pub fn derived_from_both_sides(problem: &LeastSquares<'_>, best: &Fit) -> Result<Fit, DiagnoseError> {
    let all: Vec<usize> = (0..best.point.z.len()).collect();
    let derived = (problem.evaluation.from_both_sides()).sensitivities(&best.point, &all, None);
    let sensitivities = match derived {
        Err(DiagnoseError::Simulation { .. }) => return Ok(best.clone()),
        other => other?,
    };
    Ok(Fit {
        normals: assemble(&problem.blocks, &sensitivities),
        sensitivities: Some(Arc::new(sensitivities)),
        ..best.clone()
    })
}

/// Standard deviation of every coordinate of a fit, [derived from both sides](derived_from_both_sides): the larger of the sandwich's from blocks and, where
/// fits cost milliseconds, the jackknife's over three recordings or more, over blocks of two, over the halves of a single one.
///
/// # Errors
/// As [`crate::estimation::fit()`] without one of the parts.
pub fn deviations(problem: &LeastSquares<'_>, best: &Fit) -> Result<DVector<f64>, DiagnoseError> {
    let within = covariance::deviations(best);
    if !problem.specimen().simulates_in_milliseconds() {
        return Ok(within * WIDER);
    }
    let recordings = problem.specimen().recordings().len();
    let (groups, part): (usize, fn(&Block) -> usize) = if recordings > 2 {
        (recordings, |b| b.recording)
    } else {
        (problem.blocks.folds(), |b| b.fold)
    };
    let start = Start::of(problem, best.clone())?;
    let left_out: Vec<DVector<f64>> = (0..groups)
        .into_par_iter()
        .map(|g| {
            let rest = problem.keeping(|b| part(b) != g);
            let point = fit_from(&rest, start.clone(), problem.criteria.fitting.converged)?.point;
            Ok(DVector::from_vec(point.z))
        })
        .collect::<Result<_, DiagnoseError>>()?;
    let mean = left_out.iter().sum::<DVector<f64>>() / groups as f64;
    let weight = (groups as f64 - 1.0) / groups as f64;
    let squares = (left_out.iter()).fold(DVector::zeros(mean.len()), |sum: DVector<f64>, z| {
        sum + (z - &mean).map(|d| weight * d * d)
    });
    Ok(within.zip_map(&squares, |a, b| a.max(b.sqrt())))
}
