//! The inverse discrete Fourier transform of a power of two of values, with the same bits on every machine.
//!
//! `x_j = sum of X_k exp(2 pi i j k / N)`, by decimation in time with two branches (Cooley & Tukey, *Mathematics of Computation* 19
//! (1965) 297). A library would be faster, but rustfft takes its twiddle factors from the platform's sine, whose last bit differs
//! between C libraries. These come from `libm`, and everything else is sums and products, which IEEE 754 rounds alike everywhere.

use core::f64::consts::TAU;

use rustfft::num_complex::Complex;

/// Transforms `values` in place, without a factor of 1 / N. Their number is a power of two.
pub fn inverse_fft(values: &mut [Complex<f64>]) {
    let count = values.len();
    if count < 2 {
        return;
    }
    assert!(count.is_power_of_two(), "the number of values is a power of two");
    let unused_bits = count.leading_zeros() + 1;
    for k in 0..count {
        let mirrored = k.reverse_bits() >> unused_bits;
        if k < mirrored {
            values.swap(k, mirrored);
        }
    }
    let twiddles: Vec<Complex<f64>> = (0..count / 2)
        .map(|k| {
            let (sin, cos) = libm::sincos(TAU * k as f64 / count as f64);
            Complex::new(cos, sin)
        })
        .collect();
    let mut half = 1;
    while half < count {
        for part in values.chunks_exact_mut(2 * half) {
            let (even, odd) = part.split_at_mut(half);
            let factors = twiddles.iter().step_by(count / (2 * half));
            for ((even, odd), factor) in even.iter_mut().zip(odd).zip(factors) {
                let turned = *odd * factor;
                *odd = *even - turned;
                *even += turned;
            }
        }
        half *= 2;
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use rustfft::FftPlanner;

    use super::*;

    #[test]
    fn one_line_is_one_wave() {
        let mut values = vec![Complex::default(); 64];
        values[3] = Complex::new(2.0, 0.0);
        inverse_fft(&mut values);
        for (j, value) in values.iter().enumerate() {
            let (sin, cos) = libm::sincos(TAU * 3.0 * j as f64 / 64.0);
            assert!((value - Complex::new(2.0 * cos, 2.0 * sin)).norm() < 1e-14);
        }
    }

    #[test]
    fn none_and_one_are_themselves() {
        inverse_fft(&mut []);
        let mut one = [Complex::new(3.0, -1.0)];
        inverse_fft(&mut one);
        assert_eq!(one, [Complex::new(3.0, -1.0)]);
    }

    proptest! {
        #[test]
        fn it_is_that_of_rustfft(log in 1u32..11, parts in prop::collection::vec((-1.0..1.0f64, -1.0..1.0f64), 1024)) {
            let given: Vec<Complex<f64>> = parts[..1 << log].iter().map(|(re, im)| Complex::new(*re, *im)).collect();
            let (mut own, mut library) = (given.clone(), given);
            inverse_fft(&mut own);
            FftPlanner::new().plan_fft_inverse(library.len()).process(&mut library);
            prop_assert!(own.iter().zip(&library).all(|(a, b)| (a - b).norm() < 1e-11));
        }
    }
}
