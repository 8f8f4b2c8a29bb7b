//! What the arithmetic of the strut asks of a number.

use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Sub};

/// Which lanes a comparison holds for.
pub trait Mask: Copy + BitAnd<Output = Self> + BitOr<Output = Self> {
    /// Whether it holds in one lane at least.
    fn any(self) -> bool;
    /// Whether it holds in all lanes.
    fn all(self) -> bool;
    /// Whether it holds in a lane.
    fn lane(self, lane: usize) -> bool;
}

/// One number, or several side by side. Every operation rounds as that of `f64` does.
///
/// A vector can only be made where the processor is known to have vectors, so constants and tables are made "like" a number at hand:
/// [`Number::of`], [`Number::gather`].
pub trait Number:
    Copy
    + Debug
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    /// Whether it is a single number.
    const IS_SINGLE: bool;
    /// Which lanes a comparison holds for.
    type Mask: Mask;
    /// One thing for each lane.
    type Each<T: Clone + Debug>: Clone + Debug + AsRef<[T]> + AsMut<[T]>;

    /// Value in all lanes.
    fn of(self, value: f64) -> Self;
    /// Values by lane.
    fn gather(self, value: impl FnMut(usize) -> f64) -> Self;
    /// One thing for each lane.
    fn each<T: Clone + Debug>(thing: impl FnMut(usize) -> T) -> Self::Each<T>;
    /// One thing for each lane, where all of them are there.
    fn each_of<T: Clone + Debug>(thing: impl FnMut(usize) -> Option<T>) -> Option<Self::Each<T>>;
    /// The number of a lane.
    fn lane(self, lane: usize) -> f64;
    /// Absolute value.
    fn abs(self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// One over the number.
    fn recip(self) -> Self;
    /// Where it is greater than another one.
    fn above(self, other: Self) -> Self::Mask;
    /// Where it is not greater than another one, nor one of the two not a number.
    fn up_to(self, other: Self) -> Self::Mask;
    /// The one where a condition holds, and the other one elsewhere.
    fn choose(condition: Self::Mask, one: Self, other: Self) -> Self;

    /// A quantity of each of several things, one in each lane.
    #[inline(always)]
    fn gather_from<T>(self, things: &[&T], quantity: impl Fn(&T) -> f64) -> Self {
        self.gather(|lane| quantity(things[lane]))
    }

    /// Each lane on its own.
    #[inline(always)]
    fn map(self, mut function: impl FnMut(f64) -> f64) -> Self {
        self.gather(|lane| function(self.lane(lane)))
    }

    /// The greater of the number and a bound. Where it is not a number, the bound.
    #[inline(always)]
    fn at_least(self, bound: Self) -> Self {
        Self::choose(self.above(bound), self, bound)
    }
}
