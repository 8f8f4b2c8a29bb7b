//! Products of series, summed: most of what a diagnosis does beside its simulations.

use pulp::WithSimd;

/// How many sums stand side by side. They do not wait for each other, and the processor adds several at once.
const SUMS: usize = 8;

/// Sum of the products of two series of the same length, as nalgebra adds it: eight sums side by side, then what is left over. The order is fixed, so
/// the result has the same bits with vectors of any width.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    pulp::Arch::new().dispatch(Dot { a, b })
}

struct Dot<'a> {
    a: &'a [f64],
    b: &'a [f64],
}

impl WithSimd for Dot<'_> {
    type Output = f64;

    /// The compiler makes vectors of the sums; what it is told here is only which ones this processor has.
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> f64 {
        let (a, a_left) = self.a.as_chunks::<SUMS>();
        let (b, b_left) = self.b.as_chunks::<SUMS>();
        let mut sums = [0.0; SUMS];
        for (a, b) in a.iter().zip(b) {
            for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
                *sum += a * b;
            }
        }
        let (low, high) = sums.split_at(SUMS / 2);
        let sum = low.iter().zip(high).fold(0.0, |sum, (low, high)| sum + (low + high));
        a_left.iter().zip(b_left).fold(sum, |sum, (a, b)| sum + a * b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DVectorView;

    proptest::proptest! {
        #[test]
        fn the_sum_is_that_of_nalgebra_to_the_bit(pairs in proptest::collection::vec((-1e3..1e3f64, -1e-3..1e3f64), 0..70)) {
            let (a, b): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
            let expected = DVectorView::from_slice(&a, a.len()).dot(&DVectorView::from_slice(&b, b.len()));
            proptest::prop_assert_eq!(dot(&a, &b).to_bits(), expected.to_bits());
        }
    }
}
