//! The four corners of the vehicle, its axles and its sides.
//!
//! A corner is an enum and not a number, so that a fifth corner cannot be written. [`Corners`] and [`Axles`] hold one
//! value for each; indexing them cannot fail and cannot panic.

use core::ops::{Index, IndexMut};

use strum::{EnumString, IntoStaticStr, VariantArray};

/// An axle of the vehicle.
///
/// ```
/// use oleo_interface::{Axle, Corner, Side};
/// assert_eq!(Axle::Rear.corner(Side::Left), Corner::RearLeft);
/// assert_eq!("rear".parse(), Ok(Axle::Rear));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, IntoStaticStr, EnumString, VariantArray)]
#[strum(serialize_all = "snake_case")]
pub enum Axle {
    /// The front axle.
    Front,
    /// The rear axle.
    Rear,
}

/// A side of the vehicle, seen in the direction of travel. See [`Axle`] for an example.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, IntoStaticStr, EnumString, VariantArray)]
#[strum(serialize_all = "snake_case")]
pub enum Side {
    /// Left, where y is positive (ISO 8855).
    Left,
    /// Right, where y is negative.
    Right,
}

/// A corner of the vehicle, where one strut stands.
///
/// ```
/// use oleo_interface::{Axle, Corner, Side};
/// let corner = Corner::FrontRight;
/// assert_eq!((corner.axle(), corner.side()), (Axle::Front, Side::Right));
/// assert_eq!((corner.name(), corner.key()), ("front-right", "front_right"));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, IntoStaticStr, EnumString, VariantArray)]
#[strum(serialize_all = "snake_case")]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Corner {
    /// The corner at the front on the left; index 0.
    FrontLeft,
    /// The corner at the front on the right; index 1.
    FrontRight,
    /// The corner at the rear on the left; index 2.
    RearLeft,
    /// The corner at the rear on the right; index 3.
    RearRight,
}

impl Axle {
    /// Both axles, front first.
    pub const ALL: [Self; 2] = [Self::Front, Self::Rear];

    /// Name in column names and files: `front` or `rear`.
    #[must_use]
    pub fn key(self) -> &'static str {
        self.into()
    }

    /// The corner of this axle on one side.
    #[must_use]
    pub const fn corner(self, side: Side) -> Corner {
        match (self, side) {
            (Self::Front, Side::Left) => Corner::FrontLeft,
            (Self::Front, Side::Right) => Corner::FrontRight,
            (Self::Rear, Side::Left) => Corner::RearLeft,
            (Self::Rear, Side::Right) => Corner::RearRight,
        }
    }
}

impl Side {
    /// Both sides, left first.
    pub const ALL: [Self; 2] = [Self::Left, Self::Right];

    /// Name in column names and files: `left` or `right`.
    #[must_use]
    pub fn key(self) -> &'static str {
        self.into()
    }
}

impl Corner {
    /// All corners, in the order of the CAN database: front left, front right, rear left, rear right.
    pub const ALL: [Self; 4] = [Self::FrontLeft, Self::FrontRight, Self::RearLeft, Self::RearRight];

    /// Name in column names and files: `front_left`, `front_right`, `rear_left` or `rear_right`.
    #[must_use]
    pub fn key(self) -> &'static str {
        self.into()
    }

    /// Name in sentences and places: `front-left`, `front-right`, `rear-left` or `rear-right`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::FrontLeft => "front-left",
            Self::FrontRight => "front-right",
            Self::RearLeft => "rear-left",
            Self::RearRight => "rear-right",
        }
    }

    /// The corner with a [`name`](Self::name).
    ///
    /// ```
    /// use oleo_interface::Corner;
    /// assert_eq!(Corner::named("rear-left"), Some(Corner::RearLeft));
    /// assert_eq!(Corner::named("rear"), None);
    /// ```
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|corner| corner.name() == name)
    }

    /// Position in [`Corner::ALL`], 0 to 3.
    #[must_use]
    pub const fn index(self) -> usize {
        self as usize
    }

    /// The axle that this corner belongs to.
    #[must_use]
    pub const fn axle(self) -> Axle {
        match self {
            Self::FrontLeft | Self::FrontRight => Axle::Front,
            Self::RearLeft | Self::RearRight => Axle::Rear,
        }
    }

    /// The side that this corner is on.
    #[must_use]
    pub const fn side(self) -> Side {
        match self {
            Self::FrontLeft | Self::RearLeft => Side::Left,
            Self::FrontRight | Self::RearRight => Side::Right,
        }
    }
}

/// One value for each corner.
///
/// ```
/// use oleo_interface::{Corner, Corners, Side};
/// let load_n = Corners::from_fn(|corner| if corner.side() == Side::Left { 4000.0 } else { 3900.0 });
/// assert_eq!(load_n[Corner::RearRight], 3900.0);
/// assert_eq!(load_n.map(|n| n / 1000.0).into_array(), [4.0, 3.9, 4.0, 3.9]);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Corners<T>([T; 4]);

impl<T> Corners<T> {
    /// From an array in the order of [`Corner::ALL`].
    pub const fn from_array(values: [T; 4]) -> Self {
        Self(values)
    }

    /// The same value at every corner.
    pub const fn splat(value: T) -> Self
    where
        T: Copy,
    {
        Self([value; 4])
    }

    /// From a function of the corner.
    pub fn from_fn(value: impl FnMut(Corner) -> T) -> Self {
        Self(Corner::ALL.map(value))
    }

    /// From a function of the corner that may fail.
    ///
    /// # Errors
    /// The error of the first corner, in the order of [`Corner::ALL`], at which it fails. The function is called for all four.
    pub fn try_from_fn<E>(value: impl FnMut(Corner) -> Result<T, E>) -> Result<Self, E> {
        let [a, b, c, d] = Corner::ALL.map(value);
        Ok(Self([a?, b?, c?, d?]))
    }

    /// From the values on the left and on the right of each axle.
    pub fn from_left_right(axles: Axles<[T; 2]>) -> Self {
        let ([front_left, front_right], [rear_left, rear_right]) = (axles.front, axles.rear);
        Self([front_left, front_right, rear_left, rear_right])
    }

    /// The same value at both corners of an axle.
    pub const fn from_axles(values: Axles<T>) -> Self
    where
        T: Copy,
    {
        Self([values.front, values.front, values.rear, values.rear])
    }

    /// The values in the order of [`Corner::ALL`].
    pub fn into_array(self) -> [T; 4] {
        self.0
    }

    /// References to the values on the left and on the right of an axle.
    pub const fn of_axle(&self, axle: Axle) -> [&T; 2] {
        let [front_left, front_right, rear_left, rear_right] = &self.0;
        match axle {
            Axle::Front => [front_left, front_right],
            Axle::Rear => [rear_left, rear_right],
        }
    }

    /// The values in the order of [`Corner::ALL`], borrowed.
    pub const fn as_array(&self) -> &[T; 4] {
        &self.0
    }

    /// References to the values.
    pub fn each_ref(&self) -> Corners<&T> {
        Corners(self.0.each_ref())
    }

    /// References to the values, to change them.
    pub fn each_mut(&mut self) -> Corners<&mut T> {
        Corners(self.0.each_mut())
    }

    /// Apply a function to every value.
    pub fn map<U>(self, function: impl FnMut(T) -> U) -> Corners<U> {
        Corners(self.0.map(function))
    }

    /// The value of this and of another at each corner, as pairs.
    pub fn zip<U>(self, other: Corners<U>) -> Corners<(T, U)> {
        let [a, b, c, d] = self.0;
        let [e, f, g, h] = other.0;
        Corners([(a, e), (b, f), (c, g), (d, h)])
    }

    /// The left and the right value of each axle, as pairs.
    pub fn by_axle(self) -> Axles<(T, T)> {
        let [front_left, front_right, rear_left, rear_right] = self.0;
        Axles {
            front: (front_left, front_right),
            rear: (rear_left, rear_right),
        }
    }

    /// Corner and value, in the order of [`Corner::ALL`].
    pub fn iter(&self) -> impl Iterator<Item = (Corner, &T)> {
        Corner::ALL.into_iter().zip(&self.0)
    }

    /// Corner and value to change, in the order of [`Corner::ALL`].
    pub fn iter_mut(&mut self) -> impl Iterator<Item = (Corner, &mut T)> {
        Corner::ALL.into_iter().zip(&mut self.0)
    }

    /// The values in the order of the corners, without the corners.
    pub fn values(&self) -> core::slice::Iter<'_, T> {
        self.0.iter()
    }

    /// The values alone, to change.
    pub fn values_mut(&mut self) -> core::slice::IterMut<'_, T> {
        self.0.iter_mut()
    }
}

impl<T> Index<Corner> for Corners<T> {
    type Output = T;
    fn index(&self, corner: Corner) -> &T {
        // Faster than a match. There is a value for every corner, so the compiler leaves out the other case.
        let [first, ..] = &self.0;
        self.0.get(corner.index()).unwrap_or(first)
    }
}

impl<T> IndexMut<Corner> for Corners<T> {
    fn index_mut(&mut self, corner: Corner) -> &mut T {
        let [front_left, front_right, rear_left, rear_right] = &mut self.0;
        match corner {
            Corner::FrontLeft => front_left,
            Corner::FrontRight => front_right,
            Corner::RearLeft => rear_left,
            Corner::RearRight => rear_right,
        }
    }
}

/// One value for each axle.
///
/// ```
/// use oleo_interface::{Axle, Axles};
/// let distance_m = Axles::new(1.389, 1.405);
/// assert_eq!(distance_m[Axle::Rear], 1.405);
/// assert_eq!(distance_m.map(|m| m > 1.4), Axles { front: false, rear: true });
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Axles<T> {
    /// Value of the front axle.
    pub front: T,
    /// Value of the rear axle.
    pub rear: T,
}

impl<T> Axles<T> {
    /// From the values of the front and the rear axle.
    pub const fn new(front: T, rear: T) -> Self {
        Self { front, rear }
    }

    /// The same value at both axles.
    pub const fn splat(value: T) -> Self
    where
        T: Copy,
    {
        Self {
            front: value,
            rear: value,
        }
    }

    /// From a function of the axle.
    pub fn from_fn(mut value: impl FnMut(Axle) -> T) -> Self {
        Self {
            front: value(Axle::Front),
            rear: value(Axle::Rear),
        }
    }

    /// Apply a function to both values.
    pub fn map<U>(self, mut function: impl FnMut(T) -> U) -> Axles<U> {
        Axles {
            front: function(self.front),
            rear: function(self.rear),
        }
    }

    /// References to the values.
    pub const fn each_ref(&self) -> Axles<&T> {
        Axles {
            front: &self.front,
            rear: &self.rear,
        }
    }

    /// The values, front first.
    pub fn into_array(self) -> [T; 2] {
        [self.front, self.rear]
    }

    /// The value of this and of another at each axle, as pairs.
    pub fn zip<U>(self, other: Axles<U>) -> Axles<(T, U)> {
        Axles {
            front: (self.front, other.front),
            rear: (self.rear, other.rear),
        }
    }

    /// Axle and value, front first.
    pub fn iter(&self) -> impl Iterator<Item = (Axle, &T)> {
        [(Axle::Front, &self.front), (Axle::Rear, &self.rear)].into_iter()
    }

    /// Axle and value to change, front first.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = (Axle, &mut T)> {
        [(Axle::Front, &mut self.front), (Axle::Rear, &mut self.rear)].into_iter()
    }
}

impl<T> Index<Axle> for Axles<T> {
    type Output = T;
    fn index(&self, axle: Axle) -> &T {
        match axle {
            Axle::Front => &self.front,
            Axle::Rear => &self.rear,
        }
    }
}

impl<T> IndexMut<Axle> for Axles<T> {
    fn index_mut(&mut self, axle: Axle) -> &mut T {
        match axle {
            Axle::Front => &mut self.front,
            Axle::Rear => &mut self.rear,
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    #[test]
    fn the_first_corner_that_fails_is_told() {
        let right = |corner: Corner| {
            if corner.side() == Side::Right {
                Err(corner)
            } else {
                Ok(())
            }
        };
        assert_eq!(Corners::try_from_fn(right), Err(Corner::FrontRight));
        assert_eq!(Corners::try_from_fn(Ok::<_, ()>), Ok(Corners::from_array(Corner::ALL)));
    }

    #[test]
    fn index_finds_what_was_put_there() {
        let mut positions = Corners::from_fn(Corner::index);
        for corner in Corner::ALL {
            assert_eq!(positions[corner], corner.index());
            positions[corner] += 10;
            assert_eq!(positions.as_array()[corner.index()], corner.index() + 10);
        }
        let axles = Axles::from_fn(|axle| axle);
        assert!(Axle::ALL.into_iter().all(|axle| axles[axle] == axle));
        let again = Corners::from_left_right(Axles::from_fn(|axle| positions.of_axle(axle).map(|i| *i)));
        assert_eq!(again, positions);
    }

    #[test]
    fn pairs_keep_corner_axle_and_side() {
        let name = Corners::from_fn(Corner::name);
        for (corner, (index, name)) in Corners::from_fn(Corner::index).zip(name).iter() {
            assert_eq!((*index, *name), (corner.index(), corner.name()));
        }
        let axles = Corners::from_fn(|corner| corner).by_axle();
        for (axle, (left, right)) in axles.iter() {
            assert_eq!((*left, *right), (axle.corner(Side::Left), axle.corner(Side::Right)));
        }
        let twice = Corners::from_axles(Axles::from_fn(|axle| axle));
        assert!(Corner::ALL.into_iter().all(|corner| twice[corner] == corner.axle()));
        assert_eq!(Axles::new(1, 2).zip(Axles::splat(3)).into_array(), [(1, 3), (2, 3)]);
        assert_eq!(Corners::splat(7).into_array(), [7; 4]);
    }

    #[test]
    fn a_corner_is_an_axle_and_a_side() {
        for axle in Axle::ALL {
            for side in Side::ALL {
                let corner = axle.corner(side);
                assert_eq!((corner.axle(), corner.side()), (axle, side));
            }
        }
    }

    #[test]
    fn names_are_read_back() {
        for corner in Corner::ALL {
            assert_eq!(corner.key().parse(), Ok(corner));
            assert_eq!(corner.name().replace('-', "_"), corner.key());
        }
        assert_eq!(Corner::VARIANTS, Corner::ALL);
        assert!("front".parse::<Corner>().is_err());
    }
}
