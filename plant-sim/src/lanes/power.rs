//! Powers of several numbers at once.
//!
//! The C library's power is exact to the last bit and takes one number at a time, which is half the time of a strut whose bubbles are not isothermal.
//! Here a power is `exp(y ln x)`, with logarithm and exponential by the polynomials of Sun's fdlibm (`e_log.c`, `e_exp.c`, 1993), whose errors are below
//! one unit in the last place. The error of the power is that of its exponent `y ln x`: 1e-15 for each unit of it at most.

use super::number::Number;

const LN_2_HIGH: f64 = 6.931_471_803_691_238e-1;
const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;

/// `base` to the power of `exponent`, for a positive base and results between 1e-300 and 1e300.
#[inline(always)]
pub fn power<N: Number>(base: N, exponent: N) -> N {
    exponential(exponent * logarithm(base))
}

/// Bits of the square root of one half, about: mantissas are taken from there to the square root of two.
const LEAST_MANTISSA: u64 = 0x3fe6_a09e_0000_0000;
const ONE: u64 = 0x3ff0_0000_0000_0000;
const MANTISSA_BITS: u32 = 52;
/// A number whose last bits are those of an integer that is added to it.
const TWO_TO_52: f64 = 4_503_599_627_370_496.0;
const BIAS: f64 = 1023.0;

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

#[inline(always)]
fn exponential<N: Number>(x: N) -> N {
    // Adding this number and taking it off again rounds to the nearest integer.
    let rounding = 1.5 * TWO_TO_52;
    let k = (x * std::f64::consts::LOG2_E + rounding) - rounding;
    let high = x - k * LN_2_HIGH;
    let low = k * LN_2_LOW;
    let x = high - low;
    let xx = x * x;
    let polynomial = xx
        * (xx
            * (xx * (xx * (xx * 4.138_136_797_057_238_5e-8 - 1.653_390_220_546_525_2e-6) + 6.613_756_321_437_934e-5)
                - 2.777_777_777_701_559_3e-3)
            + 1.666_666_666_666_660_2e-1);
    let c = x - polynomial;
    let two = x.of(2.0);
    let fraction = (x * c / (two - c) - low + high) + 1.0;
    let scale = (k + (TWO_TO_52 + BIAS)).map(|biased| f64::from_bits(biased.to_bits() << MANTISSA_BITS));
    fraction * scale
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
