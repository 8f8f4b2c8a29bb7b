//! A single number.

use std::fmt::Debug;

use super::number::{Mask, Number};

impl Mask for bool {
    #[inline(always)]
    fn any(self) -> bool {
        self
    }

    #[inline(always)]
    fn all(self) -> bool {
        self
    }

    #[inline(always)]
    fn lane(self, _: usize) -> bool {
        self
    }
}

impl Number for f64 {
    const IS_SINGLE: bool = true;
    type Mask = bool;
    type Each<T: Clone + Debug> = [T; 1];

    #[inline(always)]
    fn of(self, value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn gather(self, mut value: impl FnMut(usize) -> f64) -> Self {
        value(0)
    }

    #[inline(always)]
    fn each<T: Clone + Debug>(mut thing: impl FnMut(usize) -> T) -> [T; 1] {
        [thing(0)]
    }

    #[inline(always)]
    fn each_of<T: Clone + Debug>(mut thing: impl FnMut(usize) -> Option<T>) -> Option<[T; 1]> {
        Some([thing(0)?])
    }

    #[inline(always)]
    fn lane(self, _: usize) -> f64 {
        self
    }

    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn recip(self) -> Self {
        1.0 / self
    }

    #[inline(always)]
    fn above(self, other: Self) -> bool {
        self > other
    }

    #[inline(always)]
    fn up_to(self, other: Self) -> bool {
        self <= other
    }

    #[inline(always)]
    fn choose(condition: bool, one: Self, other: Self) -> Self {
        if condition { one } else { other }
    }
}
