//! Exponentials of several numbers at once, by the polynomial of Sun's fdlibm (`e_exp.c`, 1993), whose error is below one unit in the last place.

use super::number::Number;

/// The logarithm of two in two parts, of which an integer times the first one is exact.
pub(super) const LN_2_HIGH: f64 = 6.931_471_803_691_238e-1;
pub(super) const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;
/// A number whose last bits are those of an integer that is added to it.
pub(super) const TWO_TO_52: f64 = 4_503_599_627_370_496.0;
pub(super) const MANTISSA_BITS: u32 = 52;
/// What is added to the exponent of two in a number's bits.
pub(super) const BIAS: f64 = 1023.0;
/// Adding this number and taking it off again rounds to the nearest integer.
const ROUNDING: f64 = 1.5 * TWO_TO_52;

/// Below this an exponential is less than any number is accurate to, and is taken as what it is here: 1e-304.
const LEAST_EXPONENT: f64 = -700.0;
/// Up to here the library reduces no argument: the half of `ln 2`, to the high word.
const NOT_REDUCED: f64 = f64::from_bits(0x3fd6_2e42_ffff_ffff);
/// Up to here the library's exponential is `1 + x`: 2^-28, to the high word.
const LINEAR: f64 = f64::from_bits(0x3e30_0000_ffff_ffff);

/// `e` to the power of a number, for results between 1e-300 and 1e300.
#[inline(always)]
pub(super) fn exponential<N: Number>(x: N) -> N {
    by_polynomial(x, nearest(x * std::f64::consts::LOG2_E))
}

/// `e` to the power of a number that is not greater than zero. A result above 1e-300 has the bits of `libm::exp`, and one below is next to nothing.
#[inline(always)]
pub fn decay<N: Number>(x: N) -> N {
    let x = x.at_least(x.of(LEAST_EXPONENT));
    // The library adds the half and drops the fraction.
    let beyond = x * std::f64::consts::LOG2_E - 0.5;
    let k = nearest(beyond);
    let k = N::choose(beyond.above(k), k + 1.0, k);
    let size = x.abs();
    let k = N::choose(size.above(x.of(NOT_REDUCED)), k, x.of(0.0));
    N::choose(size.above(x.of(LINEAR)), by_polynomial(x, k), x + 1.0)
}

#[inline(always)]
fn nearest<N: Number>(x: N) -> N {
    (x + ROUNDING) - ROUNDING
}

/// `2^k` times the exponential of what is left of `x`.
#[inline(always)]
fn by_polynomial<N: Number>(x: N, k: N) -> N {
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

    fn is_that_of_the_library(x: f64) -> bool {
        decay(x).to_bits() == libm::exp(x).to_bits()
    }

    proptest::proptest! {
        #[test]
        fn a_decay_has_the_bits_of_the_library(log10 in -18.0..2.84f64, near in -4i64..5) {
            let x = -libm::pow(10.0, log10);
            proptest::prop_assert!(is_that_of_the_library(x), "{x}");
            // Beside each place where the library changes its way, and beside a half of ln 2 where it rounds.
            for place in [LINEAR, NOT_REDUCED, 1.5 * std::f64::consts::LN_2, (x.floor() + 0.5) * std::f64::consts::LN_2] {
                let x = -f64::from_bits(place.abs().to_bits().wrapping_add_signed(near));
                proptest::prop_assert!(is_that_of_the_library(x), "{x}");
            }
        }
    }

    #[test]
    fn nothing_is_one_and_what_is_far_below_is_next_to_nothing() {
        assert_eq!((decay(0.0), decay(-0.0)), (1.0, 1.0));
        assert!(is_that_of_the_library(-690.0));
        for x in [-701.0, -1e9, f64::NEG_INFINITY] {
            assert!((0.0..1e-300).contains(&decay(x)), "{x}");
        }
    }
}
