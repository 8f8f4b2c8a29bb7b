//! Four numbers side by side in the vectors of the processor.

use std::fmt::{self, Debug};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Sub};

use pulp::Simd;

use super::number::{Mask, Number};

/// The vectors of the processors that this is compiled for.
#[cfg(target_arch = "x86_64")]
pub type Vectors = pulp::x86::V3;
/// The vectors of the processors that this is compiled for.
#[cfg(not(target_arch = "x86_64"))]
pub type Vectors = pulp::Scalar256b;

/// The proof that this processor has vectors of four numbers, where it has.
pub fn vectors() -> Option<Vectors> {
    #[cfg(target_arch = "x86_64")]
    return Vectors::try_new();
    #[cfg(not(target_arch = "x86_64"))]
    None
}

/// How many numbers stand side by side.
pub const LANES: usize = 4;

/// Something for each lane. (`array::from_fn` and `map` are not always compiled in line, and outside of it vectors go through memory.)
#[inline(always)]
pub fn each_lane<T>(mut thing: impl FnMut(usize) -> T) -> [T; LANES] {
    [thing(0), thing(1), thing(2), thing(3)]
}

/// Four numbers. `S` is the proof that the processor has the vectors, whose width must be four.
#[derive(Clone, Copy)]
pub struct Four<S: Simd> {
    simd: S,
    lanes: S::f64s,
}

/// Where a comparison of four numbers holds.
#[derive(Clone, Copy)]
pub struct FourMask<S: Simd> {
    simd: S,
    lanes: S::m64s,
}

impl<S: Simd> Four<S> {
    /// Zero in all lanes, on a processor that is known to have the vectors.
    #[inline(always)]
    pub fn zero(simd: S) -> Self {
        const { assert!(S::F64_LANES == LANES) };
        Self {
            simd,
            lanes: simd.splat_f64s(0.0),
        }
    }

    #[inline(always)]
    fn with(self, lanes: S::f64s) -> Self {
        Self { lanes, ..self }
    }

    #[inline(always)]
    fn mask(self, lanes: S::m64s) -> FourMask<S> {
        FourMask { simd: self.simd, lanes }
    }

    /// The numbers of the lanes.
    #[inline(always)]
    pub fn into_array(self) -> [f64; LANES] {
        pulp::cast(self.lanes)
    }
}

impl<S: Simd> Debug for Four<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.into_array().fmt(f)
    }
}

impl<S: Simd> Neg for Four<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.with(self.simd.neg_f64s(self.lanes))
    }
}

macro_rules! operator {
    ($operator:ident, $method:ident, $lanes:ident) => {
        impl<S: Simd> $operator for Four<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.with(self.simd.$lanes(self.lanes, other.lanes))
            }
        }
    };
}

macro_rules! operator_with_one {
    ($operator:ident, $method:ident) => {
        impl<S: Simd> $operator<f64> for Four<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: f64) -> Self {
                self.$method(self.of(other))
            }
        }
    };
}

operator!(Add, add, add_f64s);
operator!(Sub, sub, sub_f64s);
operator!(Mul, mul, mul_f64s);
operator!(Div, div, div_f64s);
operator_with_one!(Add, add);
operator_with_one!(Sub, sub);
operator_with_one!(Mul, mul);

impl<S: Simd> BitAnd for FourMask<S> {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self {
            lanes: self.simd.and_m64s(self.lanes, other.lanes),
            ..self
        }
    }
}

impl<S: Simd> BitOr for FourMask<S> {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self {
            lanes: self.simd.or_m64s(self.lanes, other.lanes),
            ..self
        }
    }
}

impl<S: Simd> Mask for FourMask<S> {
    #[inline(always)]
    fn any(self) -> bool {
        self.simd.first_true_m64s(self.lanes) < LANES
    }

    #[inline(always)]
    fn all(self) -> bool {
        self.simd.first_true_m64s(self.simd.not_m64s(self.lanes)) == LANES
    }

    #[inline(always)]
    fn lane(self, lane: usize) -> bool {
        let (one, zero) = (self.simd.splat_f64s(1.0), self.simd.splat_f64s(0.0));
        let lanes: [f64; LANES] = pulp::cast(self.simd.select_f64s(self.lanes, one, zero));
        lanes[lane] != 0.0
    }
}

impl<S: Simd> Number for Four<S> {
    const IS_SINGLE: bool = false;
    type Mask = FourMask<S>;
    type Each<T: Clone + Debug> = [T; LANES];

    #[inline(always)]
    fn of(self, value: f64) -> Self {
        self.with(self.simd.splat_f64s(value))
    }

    #[inline(always)]
    fn gather(self, mut value: impl FnMut(usize) -> f64) -> Self {
        self.with(pulp::cast(each_lane(&mut value)))
    }

    #[inline(always)]
    fn each<T: Clone + Debug>(thing: impl FnMut(usize) -> T) -> [T; LANES] {
        each_lane(thing)
    }

    #[inline(always)]
    fn each_of<T: Clone + Debug>(mut thing: impl FnMut(usize) -> Option<T>) -> Option<[T; LANES]> {
        Some([thing(0)?, thing(1)?, thing(2)?, thing(3)?])
    }

    #[inline(always)]
    fn lane(self, lane: usize) -> f64 {
        self.into_array()[lane]
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.with(self.simd.abs_f64s(self.lanes))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.with(self.simd.sqrt_f64s(self.lanes))
    }

    #[inline(always)]
    fn recip(self) -> Self {
        self.of(1.0) / self
    }

    #[inline(always)]
    fn above(self, other: Self) -> FourMask<S> {
        self.mask(self.simd.less_than_f64s(other.lanes, self.lanes))
    }

    #[inline(always)]
    fn up_to(self, other: Self) -> FourMask<S> {
        self.mask(self.simd.less_than_or_equal_f64s(self.lanes, other.lanes))
    }

    #[inline(always)]
    fn choose(condition: FourMask<S>, one: Self, other: Self) -> Self {
        one.with(one.simd.select_f64s(condition.lanes, one.lanes, other.lanes))
    }
}
