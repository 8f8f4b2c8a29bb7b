//! Powers of several numbers at once.
//!
//! The C library's power is exact to the last bit and takes one number at a time, which is half the time of a strut whose bubbles are not isothermal.
//! Here a power is `exp(y ln x)`, with the logarithm by the polynomial of Sun's fdlibm (`e_log.c`, 1993), whose error is below
//! one unit in the last place. The error of the power is that of its exponent `y ln x`: 1e-15 for each unit of it at most.

use super::exponential::{BIAS, LN_2_HIGH, LN_2_LOW, MANTISSA_BITS, TWO_TO_52, exponential};
use super::number::Number;

/// `base` to the power of `exponent`, for a positive base and results between 1e-300 and 1e300.
#[inline(always)]
pub fn power<N: Number>(base: N, exponent: N) -> N {
    exponential(exponent * logarithm(base))
}

/// Bits of the square root of one half, about: mantissas are taken from there to the square root of two.
const LEAST_MANTISSA: u64 = 0x3fe6_a09e_0000_0000;
const ONE: u64 = 0x3ff0_0000_0000_0000;

#[inline(always)]
fn logarithm<N: Number>(x: N) -> N {
    let shifted = |lane| x.lane(lane).to_bits().wrapping_add(ONE - LEAST_MANTISSA);
    let mantissa = x.gather(|lane| f64::from_bits((shifted(lane) & ((1 << MANTISSA_BITS) - 1)) + LEAST_MANTISSA));
    let exponent =
        x.gather(|lane| f64::from_bits(TWO_TO_52.to_bits() | (shifted(lane) >> MANTISSA_BITS))) - (TWO_TO_52 + BIAS);
    let f = mantissa - 1.0;
    let s = f / (f + 2.0);
    let z = s * s;
    let w = z * z;
    let even = w * (w * (w * 1.531_383_769_920_937_3e-1 + 2.222_219_843_214_978_4e-1) + 3.999_999_999_940_942e-1);
    let odd = z
        * (w * (w * (w * 1.479_819_860_511_658_6e-1 + 1.818_357_216_161_805e-1) + 2.857_142_874_366_239e-1)
            + 6.666_666_666_666_735e-1);
    let half_square = f * f * 0.5;
    exponent * LN_2_HIGH - ((half_square - (s * (half_square + (odd + even)) + exponent * LN_2_LOW)) - f)
}

#[cfg(test)]
mod tests {
    use super::*;

    proptest::proptest! {
        #[test]
        fn it_is_the_power_of_the_library(ln in -25.0..25.0f64, y in 0.3..2.0f64) {
            let x = libm::exp(ln);
            let error = power(x, y) / libm::pow(x, y) - 1.0;
            proptest::prop_assert!(error.abs() < 1e-15 * (1.0 + (y * ln).abs()), "{x}^{y}: {error}");
        }
    }

    #[test]
    fn one_stays_one_and_powers_of_two_are_met() {
        assert_eq!(power(1.0, 0.7), 1.0);
        assert!((power(1024.0, 0.5) / 32.0 - 1.0).abs() < 1e-15);
        assert!((power(0.25, 1.5) / 0.125 - 1.0).abs() < 1e-15);
    }
}
