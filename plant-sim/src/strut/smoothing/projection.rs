//! Orthonormal polynomials on an even grid, and what samples are made of them.

use core::array::from_fn;

use pulp::{NullaryFnOnce, Simd};

use crate::lanes::{Four, LANES, Number, vectors};

/// Highest degree of which there are polynomials.
pub(super) const HIGHEST_DEGREE: usize = 5;
/// Coefficients of the polynomials of the highest degree.
const MOST_COEFFICIENTS: usize = HIGHEST_DEGREE + 1;

/// Orthonormal polynomials on an even grid, by Gram-Schmidt. Those above the degree are zero.
pub(super) struct Basis {
    pub degree: usize,
    /// Each polynomial at four samples side by side, and zeros behind the last sample.
    values: Vec<[[f64; LANES]; MOST_COEFFICIENTS]>,
    /// Derivative of the polynomials at each sample, per sample spacing.
    slopes: Vec<[f64; MOST_COEFFICIENTS]>,
}

impl Basis {
    /// Those up to a degree, [`HIGHEST_DEGREE`] at most, over so many samples, of which there are more than the degree.
    pub fn new(length: usize, degree: usize) -> Self {
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

    /// The sum of squares of samples less an origin, and how much of each polynomial they are made of.
    pub fn project(&self, x: &[f64], origin: f64) -> (f64, [f64; MOST_COEFFICIENTS]) {
        let projection = Projection {
            x,
            origin,
            values: &self.values,
        };
        match vectors() {
            Some(simd) => simd.vectorize(InVectors(simd, projection)),
            None => InVectors(pulp::Scalar256b, projection).call(),
        }
    }

    /// Value and slope of each polynomial at a sample.
    pub fn at(&self, i: usize) -> impl Iterator<Item = (f64, f64)> {
        (self.values[i / LANES].iter().zip(self.slopes[i])).map(move |(values, slope)| (values[i % LANES], slope))
    }
}

/// Samples, the value that is taken off them, and the polynomials that they are projected on.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Four sums side by side are those one after the other but for rounding, and have the same bits with and without the vectors.
    #[test]
    fn a_projection_is_the_same_on_every_processor() {
        if vectors().is_none() {
            eprintln!("SKIPPED vectors of four numbers: this processor has none");
        }
        for (degree, length) in [3, HIGHEST_DEGREE]
            .into_iter()
            .flat_map(|d| (d + 1..=228).map(move |l| (d, l)))
        {
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
            assert!(
                (total - squares).abs() <= 1e-14 * squares,
                "{length}: {total} {squares}"
            );
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
}
