//! Gauge and absolute pressure as separate types, so that they cannot be confused.
//!
//! Sensors, dampers and forces speak of gauge pressure; gas laws, bubbles and vacuum speak of absolute pressure. The two
//! differ by 101,325 Pa, which is 2.5 % of a strut's static pressure: small enough to be overlooked in a plot, large
//! enough to be wrong. A function that takes [`Absolute`] cannot be handed a reading by mistake.
//!
//! ```
//! use oleo_interface::{Absolute, Gauge};
//! let reading = Gauge(4.0e6_f64);
//! assert_eq!(reading.absolute(), Absolute(4_101_325.0));
//! assert_eq!(reading.absolute().gauge(), reading);
//! ```

use core::ops::{Add, Sub};

/// Standard atmosphere, Pa (ISO 2533). `f32` holds it exactly.
pub const ATMOSPHERE_PA: f32 = 101_325.0;

/// Pressure above the atmosphere, Pa; negative below it. See the [module](self) for an example.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Gauge<T>(pub T);

/// Pressure above vacuum, Pa. See the [module](self) for an example.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Absolute<T>(pub T);

impl<T> Gauge<T> {
    /// The pressure as a number, Pa.
    pub fn pa(self) -> T {
        self.0
    }
}

impl<T> Absolute<T> {
    /// The pressure as a number, Pa.
    pub fn pa(self) -> T {
        self.0
    }
}

impl<T: From<f32> + Add<Output = T>> Gauge<T> {
    /// The same pressure counted from vacuum.
    pub fn absolute(self) -> Absolute<T> {
        Absolute(self.0 + T::from(ATMOSPHERE_PA))
    }
}

impl<T: From<f32> + Sub<Output = T>> Absolute<T> {
    /// The same pressure counted from the atmosphere.
    pub fn gauge(self) -> Gauge<T> {
        Gauge(self.0 - T::from(ATMOSPHERE_PA))
    }
}

impl<T: Add<Output = T>> Add<T> for Gauge<T> {
    type Output = Self;
    /// The pressure that is higher by a difference, Pa.
    fn add(self, difference: T) -> Self {
        Self(self.0 + difference)
    }
}

impl<T: Add<Output = T>> Add<T> for Absolute<T> {
    type Output = Self;
    /// The pressure that is higher by a difference, Pa.
    fn add(self, difference: T) -> Self {
        Self(self.0 + difference)
    }
}

impl<T: Sub<Output = T>> Sub for Gauge<T> {
    /// A difference, Pa, which is neither gauge nor absolute.
    type Output = T;
    fn sub(self, other: Self) -> T {
        self.0 - other.0
    }
}

impl<T: Sub<Output = T>> Sub for Absolute<T> {
    /// A difference, Pa, which is neither gauge nor absolute.
    type Output = T;
    fn sub(self, other: Self) -> T {
        self.0 - other.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_widths_hold_the_atmosphere_exactly() {
        assert_eq!(Gauge(0.0_f64).absolute().pa(), 101_325.0);
        assert_eq!(Gauge(0.0_f32).absolute().pa(), 101_325.0);
        assert_eq!(Absolute(0.0_f32).gauge(), Gauge(-101_325.0));
        assert_eq!(Gauge(3.0e6_f64).absolute() - Gauge(1.0e6_f64).absolute(), 2.0e6);
    }

    #[test]
    fn a_difference_shifts_either() {
        assert_eq!(Gauge(3.0e6_f32) + -1.0e6, Gauge(2.0e6));
        assert_eq!(Absolute(3.0e6_f32) + 1.0e6, Absolute(4.0e6));
    }
}
