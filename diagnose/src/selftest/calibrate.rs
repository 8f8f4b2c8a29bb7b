//! How much each kind of evidence should count, so that of the effects reported at 0.9 nine in ten are there: logistic
//! regression of "is there, at its place" on the evidence, with a weak prior that keeps weights finite where the evidence
//! separates.

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use super::trial::Trial;
use crate::confidence::{EVIDENCE, Evidence};

/// Weights for [`crate::confidence`] and what they were fitted on.
#[derive(Debug, Clone, Serialize)]
pub struct Calibration {
    /// Name of each kind of evidence.
    pub names: Vec<&'static str>,
    /// Weight of each piece of evidence.
    pub weights: Vec<f64>,
    /// Number of reports that the weights were fitted to.
    pub reports: usize,
    /// Those of them that are there.
    pub there: usize,
    /// Mean logarithmic score of confidence as reported; -0.69 is a coin.
    pub score_reported: f64,
    /// The same with these weights, each report judged by weights fitted on all others.
    pub score_fitted: f64,
}

/// Fewest reports from which weights are fitted.
const FEWEST: usize = 30;
/// Precision of the prior on weights (evidence is of order one).
const PRIOR: f64 = 0.1;
/// Newton steps; the problem is convex.
const STEPS: usize = 40;

type Sample = ([f64; EVIDENCE.len()], bool, f64);

/// Fits the weights; `None` where there are too few reports, or only right or only wrong ones.
#[must_use]
pub fn calibrate(trials: &[&Trial]) -> Option<Calibration> {
    let mut samples: Vec<Sample> = Vec::new();
    for t in trials {
        for r in &t.reported {
            let Some(gain) = r.gain else { continue };
            let evidence = Evidence { gain, lead: r.lead };
            samples.push((evidence.measures(), t.there(r), r.confidence));
        }
    }
    let there = samples.iter().filter(|s| s.1).count();
    if samples.len() < FEWEST || there == 0 || there == samples.len() {
        return None;
    }
    let score = |p: f64, there: bool| libm::log(if there { p } else { 1.0 - p }.max(1e-6));
    let left_out = |k: usize| {
        let others: Vec<Sample> = samples
            .iter()
            .enumerate()
            .filter(|(i, _)| *i != k)
            .map(|(_, s)| *s)
            .collect();
        let w = fit(&others)?;
        Some(score(
            crate::confidence::weighed(&samples[k].0, w.as_slice()),
            samples[k].1,
        ))
    };
    let n = samples.len() as f64;
    let score_fitted = (0..samples.len()).map(left_out).sum::<Option<f64>>()? / n;
    Some(Calibration {
        names: EVIDENCE.to_vec(),
        weights: fit(&samples)?.iter().copied().collect(),
        reports: samples.len(),
        there,
        score_reported: samples.iter().map(|s| score(s.2, s.1)).sum::<f64>() / n,
        score_fitted,
    })
}

/// Iteratively reweighted least squares (McCullagh & Nelder, Generalized Linear Models, 1989, 4.4).
fn fit(samples: &[Sample]) -> Option<DVector<f64>> {
    let p = EVIDENCE.len();
    let mut w = DVector::zeros(p);
    for _ in 0..STEPS {
        let mut h = DMatrix::identity(p, p) * PRIOR;
        let mut g = -PRIOR * &w;
        for (x, there, _) in samples {
            let x = DVector::from_column_slice(x);
            let q = 1.0 / (1.0 + libm::exp(-x.dot(&w)));
            g += &x * (f64::from(u8::from(*there)) - q);
            h += &x * x.transpose() * (q * (1.0 - q)).max(1e-9);
        }
        let step = h.cholesky()?.solve(&g);
        w += &step;
        if step.norm() < 1e-10 {
            break;
        }
    }
    w.iter().all(|v| v.is_finite()).then_some(w)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frequencies_become_probabilities() {
        // Only the constant differs from zero: the fitted probability is the frequency.
        let mut x = [0.0; EVIDENCE.len()];
        x[0] = 1.0;
        let samples: Vec<Sample> = (0..1000).map(|k| (x, k % 10 != 0, 0.5)).collect();
        let w = fit(&samples).unwrap();
        let p = 1.0 / (1.0 + libm::exp(-w[0]));
        assert!((p - 0.9).abs() < 1e-3, "{p}");
    }
}
