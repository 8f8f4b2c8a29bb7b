//! The three solenoid valves of one strut.

use core::ops::{Index, IndexMut};

use strum::{EnumString, IntoStaticStr, VariantArray};

/// A solenoid valve of a strut. Open means energised. See [`StrutValves`] for an example.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, IntoStaticStr, EnumString, VariantArray)]
pub enum Valve {
    /// Valve 1 bypasses damper 1. Open: low damping in the path to the 0.1 l accumulator.
    #[strum(serialize = "valve1")]
    Bypass1,
    /// Valve 2 bypasses damper 2. Open: low damping in the path to the 0.4 l accumulator. It has no effect while valve 3
    /// is closed.
    #[strum(serialize = "valve2")]
    Bypass2,
    /// Valve 3 connects the 0.4 l accumulator. Open: soft spring.
    #[strum(serialize = "valve3")]
    Spring,
}

impl Valve {
    /// All valves in the order of the seed report, which counts them 1 to 3.
    pub const ALL: [Self; 3] = [Self::Bypass1, Self::Bypass2, Self::Spring];

    /// Name of the valve's column in recordings and logs: `valve1`, `valve2` or `valve3`.
    #[must_use]
    pub fn column(self) -> &'static str {
        self.into()
    }

    /// Number of the valve in the seed report, the CAN database and scenario files, 1 to 3.
    #[must_use]
    pub const fn number(self) -> usize {
        self as usize + 1
    }

    /// The valve with a number from 1 to 3; `None` for any other.
    ///
    /// ```
    /// use oleo_interface::Valve;
    /// assert_eq!(Valve::from_number(3), Some(Valve::Spring));
    /// assert_eq!(Valve::from_number(0), None);
    /// ```
    #[must_use]
    pub const fn from_number(number: usize) -> Option<Self> {
        match number {
            1 => Some(Self::Bypass1),
            2 => Some(Self::Bypass2),
            3 => Some(Self::Spring),
            _ => None,
        }
    }

    /// Position in [`Valve::ALL`], 0 to 2.
    #[must_use]
    pub const fn index(self) -> usize {
        self as usize
    }
}

/// One value for each valve of a strut.
///
/// ```
/// use oleo_interface::{StrutValves, Valve};
/// let soft_spring_only = StrutValves::from_fn(|valve| valve == Valve::Spring);
/// assert_eq!(soft_spring_only.into_array(), [false, false, true]);
/// assert!(soft_spring_only[Valve::Spring]);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct StrutValves<T>([T; 3]);

impl<T> StrutValves<T> {
    /// From the values for valve 1, valve 2 and valve 3.
    pub const fn new(bypass_1: T, bypass_2: T, spring: T) -> Self {
        Self([bypass_1, bypass_2, spring])
    }

    /// From an array in the order of [`Valve::ALL`].
    pub const fn from_array(values: [T; 3]) -> Self {
        Self(values)
    }

    /// The same value for every valve.
    pub const fn splat(value: T) -> Self
    where
        T: Copy,
    {
        Self([value; 3])
    }

    /// From a function of the valve.
    pub fn from_fn(value: impl FnMut(Valve) -> T) -> Self {
        Self(Valve::ALL.map(value))
    }

    /// The values in the order of [`Valve::ALL`].
    pub fn into_array(self) -> [T; 3] {
        self.0
    }

    /// The values in the same order, where they are.
    pub const fn as_array(&self) -> &[T; 3] {
        &self.0
    }

    /// References to the values, to change them.
    pub fn each_mut(&mut self) -> StrutValves<&mut T> {
        StrutValves(self.0.each_mut())
    }

    /// Apply a function to every value.
    pub fn map<U>(self, function: impl FnMut(T) -> U) -> StrutValves<U> {
        StrutValves(self.0.map(function))
    }

    /// The value of this and of another for each valve, as pairs.
    pub fn zip<U>(self, other: StrutValves<U>) -> StrutValves<(T, U)> {
        let [a, b, c] = self.0;
        let [d, e, f] = other.0;
        StrutValves([(a, d), (b, e), (c, f)])
    }

    /// Valve and value, in the order of [`Valve::ALL`].
    pub fn iter(&self) -> impl Iterator<Item = (Valve, &T)> {
        Valve::ALL.into_iter().zip(&self.0)
    }
}

impl<T> Index<Valve> for StrutValves<T> {
    type Output = T;
    fn index(&self, valve: Valve) -> &T {
        let [bypass_1, bypass_2, spring] = &self.0;
        match valve {
            Valve::Bypass1 => bypass_1,
            Valve::Bypass2 => bypass_2,
            Valve::Spring => spring,
        }
    }
}

impl<T> IndexMut<Valve> for StrutValves<T> {
    fn index_mut(&mut self, valve: Valve) -> &mut T {
        let [bypass_1, bypass_2, spring] = &mut self.0;
        match valve {
            Valve::Bypass1 => bypass_1,
            Valve::Bypass2 => bypass_2,
            Valve::Spring => spring,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn index_finds_what_was_put_there() {
        let positions = StrutValves::from_fn(Valve::index);
        for valve in Valve::ALL {
            assert_eq!(positions[valve], valve.index());
            assert_eq!(valve.column().parse(), Ok(valve));
            assert_eq!(Valve::from_number(valve.number()), Some(valve));
        }
        assert_eq!(Valve::VARIANTS, Valve::ALL);
    }
}
