//! Fits polynomials over the neighbourhood of a sample, and decides how wide the neighbourhood may be.

use core::array::from_fn;

use pulp::{NullaryFnOnce, Simd};

use super::chi_square::largest_chi_square;
use super::noise::Noise;
use crate::lanes::{Four, LANES, Number, vectors};

/// Window lengths that are tried to one side, samples.
const LENGTHS: [usize; 13] = [4, 5, 6, 8, 11, 15, 20, 27, 36, 48, 64, 86, 114];
/// Fewest samples of which a neighbourhood can be made.
pub(super) const FEWEST_SAMPLES: usize = LENGTHS[0];
/// Degree of the polynomials next to corners.
pub(super) const CUBIC: usize = 3;
/// Degree of the polynomials where the motion is smooth.
pub(super) const QUINTIC: usize = 5;

/// Samples of the longest neighbourhood.
const LONGEST: usize = 2 * LENGTHS[LENGTHS.len() - 1];
/// Coefficients of the polynomials of the highest degree.
const MOST_COEFFICIENTS: usize = QUINTIC + 1;

/// Orthonormal polynomials on an even grid, by Gram-Schmidt. Those above the degree are zero.
struct Basis {
    degree: usize,
    /// Each polynomial at four samples side by side, and zeros behind the last sample.
    values: Vec<[[f64; LANES]; MOST_COEFFICIENTS]>,
    /// Derivative of the polynomials at each sample, per sample spacing.
    slopes: Vec<[f64; MOST_COEFFICIENTS]>,
}

/// Value and slope (per sample) of a fit, and the variance of the slope for unit noise.
#[derive(Clone, Copy)]
pub(super) struct Fit {
    pub value: f64,
    pub slope: f64,
    pub slope_variance: f64,
}

impl Basis {
    fn new(length: usize, degree: usize) -> Self {
        let t: Vec<f64> = (0..length)
            .map(|i| (2 * i) as f64 / (length - 1) as f64 - 1.0)
            .collect();
        let scale = 2.0 / (length - 1) as f64;
        let (mut columns, mut slopes): (Vec<Vec<f64>>, Vec<Vec<f64>>) = (Vec::new(), Vec::new());
        for k in 0..=degree {
            // t * previous column, made orthogonal to all before; the derivative follows the same recurrence.
            let (mut v, mut d): (Vec<f64>, Vec<f64>) = if k == 0 {
                (vec![1.0; length], vec![0.0; length])
            } else {
                let (c, s) = (&columns[k - 1], &slopes[k - 1]);
                (
                    t.iter().zip(c).map(|(t, c)| t * c).collect(),
                    t.iter()
                        .zip(c.iter().zip(s))
                        .map(|(t, (c, s))| scale * c + t * s)
                        .collect(),
                )
            };
            for _ in 0..2 {
                for j in 0..k {
                    let dot: f64 = v.iter().zip(&columns[j]).map(|(a, b)| a * b).sum();
                    v.iter_mut().zip(&columns[j]).for_each(|(a, b)| *a -= dot * b);
                    d.iter_mut().zip(&slopes[j]).for_each(|(a, b)| *a -= dot * b);
                }
            }
            let norm = v.iter().map(|a| a * a).sum::<f64>().sqrt();
            columns.push(v.iter().map(|a| a / norm).collect());
            slopes.push(d.iter().map(|a| a / norm).collect());
        }
        let at = |columns: &[Vec<f64>], k: usize, i: usize| columns.get(k).and_then(|c| c.get(i)).map_or(0.0, |v| *v);
        Self {
            degree,
            values: (0..length.div_ceil(LANES))
                .map(|row| from_fn(|k| from_fn(|lane| at(&columns, k, row * LANES + lane))))
                .collect(),
            slopes: (0..length).map(|i| from_fn(|k| at(&slopes, k, i))).collect(),
        }
    }

    /// Fit `x` around point `at`, if noise of this variance explains the residual.
    fn fit(&self, x: &[f64], at: usize, variance: f64) -> Option<Fit> {
        let projection = Projection {
            x,
            origin: x[at],
            values: &self.values,
        };
        let (total, coefficients) = match vectors() {
            Some(simd) => simd.vectorize(InVectors(simd, projection)),
            None => InVectors(pulp::Scalar256b, projection).call(),
        };
        // The residual's square is that of the data less that of its projections (Bessel).
        let mut residual = total;
        let mut out = Fit {
            value: x[at],
            slope: 0.0,
            slope_variance: 0.0,
        };
        let values = &self.values[at / LANES];
        for ((c, value), slope) in coefficients.into_iter().zip(values).zip(self.slopes[at]) {
            residual -= c * c;
            out.value += c * value[at % LANES];
            out.slope += c * slope;
            out.slope_variance += slope * slope;
        }
        let freedom = (x.len() - 1 - self.degree) as f64;
        let rounding = 1e-13 * total;
        let limit = variance * largest_chi_square(freedom.max(1.0)) + rounding;
        (freedom == 0.0 || residual <= limit).then_some(out)
    }
}

/// Samples less that at the origin, and the polynomials that they are projected on.
struct Projection<'a> {
    x: &'a [f64],
    origin: f64,
    values: &'a [[[f64; LANES]; MOST_COEFFICIENTS]],
}

/// The same with the proof that the processor has the vectors.
struct InVectors<'a, S>(S, Projection<'a>);

impl<S: Simd> NullaryFnOnce for InVectors<'_, S> {
    /// The sum of squares, and the coefficient of each polynomial.
    type Output = (f64, [f64; MOST_COEFFICIENTS]);

    /// Every sum is one of four that go side by side, added at the end: the same bits on every processor.
    #[inline(always)]
    fn call(self) -> Self::Output {
        let Self(simd, Projection { x, origin, values }) = self;
        let zero = Four::zero(simd);
        let (mut squares, mut products) = (zero, [zero; MOST_COEFFICIENTS]);
        let mut add = |x: [f64; LANES], values: &[[f64; LANES]; MOST_COEFFICIENTS]| {
            let x = zero.gather(|lane| x[lane]) - origin;
            squares = squares + x * x;
            for (product, value) in products.iter_mut().zip(values) {
                *product = *product + x * zero.gather(|lane| value[lane]);
            }
        };
        let (whole, rest) = x.as_chunks::<LANES>();
        whole.iter().zip(values).for_each(|(x, values)| add(*x, values));
        if let Some(values) = values.get(whole.len()) {
            add(from_fn(|lane| rest.get(lane).map_or(origin, |x| *x)), values);
        }
        let sum = |parts: Four<S>| {
            let [a, b, c, d] = parts.into_array();
            (a + b) + (c + d)
        };
        (sum(squares), products.map(sum))
    }
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
        self.by_length
            .get(to - from)?
            .as_ref()?
            .fit(x.get(from..to)?, at - from, noise.variance(from, to))
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

    /// Four sums side by side are those one after the other but for rounding, and have the same bits with and without the vectors.
    #[test]
    fn a_projection_is_the_same_on_every_processor() {
        for (degree, length) in [CUBIC, QUINTIC].into_iter().flat_map(|d| (d + 1..=LONGEST).map(move |l| (d, l))) {
            let basis = Basis::new(length, degree);
            let x: Vec<f64> = (0..length).map(|i| 0.02 + 0.01 * libm::sin(0.7 * i as f64)).collect();
            let projection = || Projection {
                x: &x,
                origin: x[length / 2],
                values: &basis.values,
            };
            let (total, coefficients) = InVectors(pulp::Scalar256b, projection()).call();
            if let Some(simd) = vectors() {
                assert_eq!(
                    simd.vectorize(InVectors(simd, projection())),
                    (total, coefficients),
                    "{length}"
                );
            }
            let about: Vec<f64> = x.iter().map(|value| value - x[length / 2]).collect();
            let squares: f64 = about.iter().map(|a| a * a).sum();
            assert!((total - squares).abs() <= 1e-14 * squares, "{length}: {total} {squares}");
            for (k, coefficient) in coefficients.into_iter().enumerate() {
                let of = |(i, a): (usize, &f64)| a * basis.values[i / LANES][k][i % LANES];
                let sum: f64 = about.iter().enumerate().map(of).sum();
                assert!(
                    (coefficient - sum).abs() <= 1e-14 * squares.sqrt(),
                    "{length}: {coefficient} {sum}"
                );
                assert!(k <= degree || coefficient == 0.0, "{length}: above the degree");
            }
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
