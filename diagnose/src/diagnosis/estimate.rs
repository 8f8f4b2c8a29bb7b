//! Fitted parameters with their confidence intervals.

use crate::error::DiagnoseError;
use crate::estimation::covariance::covariance;
use crate::estimation::interval::HALF_INTERVAL;
use crate::estimation::{Fit, LeastSquares, interval};

/// Estimates are called strongly correlated above this size of their correlation.
const STRONG_CORRELATION: f64 = 0.9;

/// A fitted number with its interval.
#[derive(Debug, Clone)]
pub struct Estimate {
    /// Key with unit, such as `bulk_modulus_Pa`.
    pub key: String,
    /// Estimated value, in the unit of the key.
    pub value: f64,
    /// 95 % interval from blocks; an end is not finite where the recordings do not determine it.
    pub ci95: [f64; 2],
}

/// A value of the calibration.
#[derive(Debug, Clone)]
pub struct CalibratedValue {
    /// Estimated deviation from the nominal value; the value itself where it is known to an order of magnitude only.
    pub estimate: Estimate,
    /// Fraction of its tolerance that was used; a little more than 1 is possible.
    pub tolerance_used: f64,
}

/// Two estimates of which only a combination is well determined.
#[derive(Debug, Clone)]
pub struct Correlation {
    /// Keys of the two estimates.
    pub keys: [String; 2],
    /// Correlation coefficient, -1 to 1.
    pub coefficient: f64,
}

/// All parameters of a fitted model, in the order of its coordinates.
pub(super) fn estimates(problem: &LeastSquares<'_>, fit: &Fit) -> Result<Vec<Estimate>, DiagnoseError> {
    let parameters = fit.point.parameters(problem.specimen());
    let deviations = interval::deviations(problem, fit)?;
    Ok((parameters.iter().zip(&fit.point.z).zip(deviations.iter()))
        .map(|((p, &z), &sd)| {
            let (low, high) = (p.value(z - HALF_INTERVAL * sd), p.value(z + HALF_INTERVAL * sd));
            let (from, to) = (p.reported(low), p.reported(high));
            Estimate {
                key: p.reported_key().into(),
                value: p.reported(p.value(z)),
                ci95: [from.min(to), from.max(to)],
            }
        })
        .collect())
}

/// The values of the calibration that matter, which come first among the estimates.
pub(super) fn calibration(problem: &LeastSquares<'_>, fit: &Fit, estimates: &[Estimate]) -> Vec<CalibratedValue> {
    let specimen = problem.specimen();
    (estimates.iter().zip(&fit.point.z).enumerate())
        .take(specimen.calibration().len())
        .filter(|(k, _)| fit.point.matters(specimen, *k))
        .map(|(_, (estimate, z))| CalibratedValue {
            estimate: estimate.clone(),
            // A coordinate of 1 is half of the tolerance.
            tolerance_used: 0.5 * z.abs(),
        })
        .collect()
}

/// Pairs of estimates whose correlation exceeds [`STRONG_CORRELATION`].
pub(super) fn correlations(problem: &LeastSquares<'_>, fit: &Fit) -> Vec<Correlation> {
    let parameters = fit.point.parameters(problem.specimen());
    let Some(c) = covariance(fit) else { return Vec::new() };
    let mut strong = Vec::new();
    for i in 0..parameters.len() {
        for j in 0..i {
            let coefficient = c[(i, j)] / (c[(i, i)] * c[(j, j)]).sqrt();
            if coefficient.abs() > STRONG_CORRELATION {
                strong.push(Correlation {
                    keys: [j, i].map(|k| parameters[k].key.clone()),
                    coefficient,
                });
            }
        }
    }
    strong
}
