//! The four places in a strut at which its oil pressure is measured.
//!
//! ```text
//!   displacement     path 1: damper 1 || valve 1           accumulator 1 (0.1 l)
//!   force        p1 ------------------------------------ p2 [gas 1]
//!                |   path 2: damper 2 || valve 2   p3   valve 3   accumulator 2 (0.4 l)
//!                +---------------------------------------------- p4 [gas 2]
//! ```

use core::ops::{Index, IndexMut};

use strum::{EnumString, IntoStaticStr, VariantArray};

/// A place in the strut at which the oil pressure is measured. See [`StrutPressures`] for an example.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, IntoStaticStr, EnumString, VariantArray)]
#[strum(serialize_all = "snake_case")]
pub enum PressurePoint {
    /// Main cylinder. Its pressure times the piston area is the strut force without friction and stops.
    P1,
    /// Oil side of accumulator 1, behind damper 1.
    P2,
    /// Between damper 2 and valve 3.
    P3,
    /// Oil side of accumulator 2, behind valve 3.
    P4,
}

impl PressurePoint {
    /// All points in the order of the recordings' columns.
    pub const ALL: [Self; 4] = [Self::P1, Self::P2, Self::P3, Self::P4];

    /// Name in columns and files: `p1`, `p2`, `p3` or `p4`.
    #[must_use]
    pub fn key(self) -> &'static str {
        self.into()
    }

    /// Position in [`PressurePoint::ALL`], 0 to 3.
    #[must_use]
    pub const fn index(self) -> usize {
        self as usize
    }
}

/// One value for each pressure point of a strut.
///
/// ```
/// use oleo_interface::{Gauge, PressurePoint, StrutPressures};
/// let mut pressure = StrutPressures::splat(Gauge(2.0e6_f32));
/// pressure.p4 = Gauge(2.5e6);
/// assert_eq!(pressure[PressurePoint::P4] - pressure.p1, 0.5e6);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StrutPressures<T> {
    /// Value at [`PressurePoint::P1`], the main chamber.
    pub p1: T,
    /// Value at [`PressurePoint::P2`], accumulator 1.
    pub p2: T,
    /// Value at [`PressurePoint::P3`], between damper 2 and valve 3.
    pub p3: T,
    /// Value at [`PressurePoint::P4`], accumulator 2.
    pub p4: T,
}

impl<T> StrutPressures<T> {
    /// The same value at every point.
    pub const fn splat(value: T) -> Self
    where
        T: Copy,
    {
        Self {
            p1: value,
            p2: value,
            p3: value,
            p4: value,
        }
    }

    /// From an array in the order of [`PressurePoint::ALL`].
    pub fn from_array([p1, p2, p3, p4]: [T; 4]) -> Self {
        Self { p1, p2, p3, p4 }
    }

    /// From a function of the point.
    pub fn from_fn(value: impl FnMut(PressurePoint) -> T) -> Self {
        Self::from_array(PressurePoint::ALL.map(value))
    }

    /// The values in the order of [`PressurePoint::ALL`].
    pub fn into_array(self) -> [T; 4] {
        [self.p1, self.p2, self.p3, self.p4]
    }

    /// References to the values.
    pub fn each_ref(&self) -> StrutPressures<&T> {
        StrutPressures {
            p1: &self.p1,
            p2: &self.p2,
            p3: &self.p3,
            p4: &self.p4,
        }
    }

    /// References to the values, to change them.
    pub fn each_mut(&mut self) -> StrutPressures<&mut T> {
        StrutPressures {
            p1: &mut self.p1,
            p2: &mut self.p2,
            p3: &mut self.p3,
            p4: &mut self.p4,
        }
    }

    /// Apply a function to every value.
    pub fn map<U>(self, function: impl FnMut(T) -> U) -> StrutPressures<U> {
        StrutPressures::from_array(self.into_array().map(function))
    }

    /// The value of this and of another at each point, as pairs.
    pub fn zip<U>(self, other: StrutPressures<U>) -> StrutPressures<(T, U)> {
        StrutPressures {
            p1: (self.p1, other.p1),
            p2: (self.p2, other.p2),
            p3: (self.p3, other.p3),
            p4: (self.p4, other.p4),
        }
    }

    /// Point and value, in the order of [`PressurePoint::ALL`].
    pub fn iter(&self) -> impl Iterator<Item = (PressurePoint, &T)> {
        PressurePoint::ALL.into_iter().zip(self.each_ref().into_array())
    }
}

impl<T> Index<PressurePoint> for StrutPressures<T> {
    type Output = T;
    fn index(&self, point: PressurePoint) -> &T {
        match point {
            PressurePoint::P1 => &self.p1,
            PressurePoint::P2 => &self.p2,
            PressurePoint::P3 => &self.p3,
            PressurePoint::P4 => &self.p4,
        }
    }
}

impl<T> IndexMut<PressurePoint> for StrutPressures<T> {
    fn index_mut(&mut self, point: PressurePoint) -> &mut T {
        match point {
            PressurePoint::P1 => &mut self.p1,
            PressurePoint::P2 => &mut self.p2,
            PressurePoint::P3 => &mut self.p3,
            PressurePoint::P4 => &mut self.p4,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn index_finds_what_was_put_there() {
        let mut values = StrutPressures::from_fn(PressurePoint::index);
        assert_eq!(values.into_array(), [0, 1, 2, 3]);
        for (point, value) in values.iter() {
            assert_eq!((*value, values[point]), (point.index(), point.index()));
            assert_eq!(point.key().parse(), Ok(point));
        }
        for value in values.each_mut().into_array() {
            *value += 10;
        }
        for (point, (a, b)) in values.zip(values.map(|value| value * 2)).iter() {
            assert_eq!((*a, *b), (point.index() + 10, 2 * point.index() + 20));
        }
        assert_eq!(PressurePoint::VARIANTS, PressurePoint::ALL);
    }
}
