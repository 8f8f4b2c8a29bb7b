//! Fits polynomials over the neighbourhood of a sample, and decides how wide the neighbourhood may be.

use super::chi_square::largest_chi_square;
use super::noise::Noise;
use super::projection::{Basis, HIGHEST_DEGREE};

/// Window lengths that are tried to one side, samples.
const LENGTHS: [usize; 13] = [4, 5, 6, 8, 11, 15, 20, 27, 36, 48, 64, 86, 114];
/// Fewest samples of which a neighbourhood can be made.
pub(super) const FEWEST_SAMPLES: usize = LENGTHS[0];
/// Degree of the polynomials next to corners.
pub(super) const CUBIC: usize = 3;
/// Degree of the polynomials where the motion is smooth.
pub(super) const QUINTIC: usize = HIGHEST_DEGREE;
/// Samples of the longest neighbourhood.
const LONGEST: usize = 2 * LENGTHS[LENGTHS.len() - 1];

/// Value and slope (per sample) of a fit, and the variance of the slope for unit noise.
#[derive(Clone, Copy)]
pub(super) struct Fit {
    pub value: f64,
    pub slope: f64,
    pub slope_variance: f64,
}

/// The fit of `x` around point `at`, if noise of this variance explains the residual.
fn fit(basis: &Basis, x: &[f64], at: usize, variance: f64) -> Option<Fit> {
    let origin = x[at];
    let (total, coefficients) = basis.project(x, origin);
    // The residual's square is that of the data less that of its projections (Bessel).
    let mut residual = total;
    let mut out = Fit {
        value: origin,
        slope: 0.0,
        slope_variance: 0.0,
    };
    for (c, (value, slope)) in coefficients.into_iter().zip(basis.at(at)) {
        residual -= c * c;
        out.value += c * value;
        out.slope += c * slope;
        out.slope_variance += slope * slope;
    }
    let freedom = (x.len() - 1 - basis.degree) as f64;
    let rounding = 1e-13 * total;
    let limit = variance * largest_chi_square(freedom.max(1.0)) + rounding;
    (freedom == 0.0 || residual <= limit).then_some(out)
}

/// The polynomials of one degree over neighbourhoods of every length that a recording may need.
pub(super) struct Bases {
    pub degree: usize,
    by_length: Vec<Option<Basis>>,
}

impl Bases {
    pub fn new(degree: usize) -> Self {
        let by_length = (0..=LONGEST)
            .map(|l| (l > degree).then(|| Basis::new(l, degree)))
            .collect();
        Self { degree, by_length }
    }

    /// The fit over samples `from..to` around `at`, if the noise explains what it leaves.
    pub fn fit(&self, x: &[f64], from: usize, to: usize, at: usize, noise: &Noise) -> Option<Fit> {
        let basis = self.by_length.get(to - from)?.as_ref()?;
        fit(basis, x.get(from..to)?, at - from, noise.variance(from, to))
    }

    /// Number of samples to one side of `at` that one polynomial explains, at most. The search starts at `hint`, the
    /// neighbour's answer.
    pub fn reach(&self, x: &[f64], at: usize, ahead: bool, noise: &Noise, hint: &mut usize) -> usize {
        let passes = |k: usize| {
            let l = LENGTHS[k];
            let range = if ahead {
                Some((at, at + l))
            } else {
                (at + 1).checked_sub(l).map(|from| (from, at + 1))
            };
            l > self.degree && range.is_some_and(|(from, to)| self.fit(x, from, to, at, noise).is_some())
        };
        // A degree needs more points than it has coefficients.
        let least = LENGTHS.iter().position(|l| *l > self.degree).unwrap_or(0);
        let mut k = (*hint).max(least);
        let mut passed = passes(k);
        if passed {
            while k + 1 < LENGTHS.len() && passes(k + 1) {
                k += 1;
            }
        }
        while !passed && k > least {
            k -= 1;
            passed = passes(k);
        }
        *hint = k;
        if passed { LENGTHS[k] - 1 } else { 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polynomial_of_the_degree_is_found_again_with_its_slope() {
        let x: Vec<f64> = (0..40)
            .map(|i| f64::from(i) * 0.1)
            .map(|t| 1.0 - 2.0 * t + 0.3 * t * t * t)
            .collect();
        for degree in [CUBIC, QUINTIC] {
            let bases = Bases::new(degree);
            let fit = bases.fit(&x, 3, 30, 12, &Noise::even(1e-9)).expect("exact");
            let (t, per_sample) = (1.2, 0.1);
            assert!((fit.value - x[12]).abs() < 1e-12);
            assert!((fit.slope - per_sample * (-2.0 + 0.9 * t * t)).abs() < 1e-10);
        }
    }

    #[test]
    fn a_neighbourhood_ends_at_a_corner() {
        let x: Vec<f64> = (0..200)
            .map(|i| if i < 100 { 0.0 } else { 1e-3 * f64::from(i - 100) })
            .collect();
        let bases = Bases::new(CUBIC);
        let (mut behind, mut ahead) = (0, 0);
        assert!(bases.reach(&x, 90, true, &Noise::even(5e-6), &mut ahead) <= 12);
        assert!(bases.reach(&x, 90, false, &Noise::even(5e-6), &mut behind) >= 60);
    }
}
