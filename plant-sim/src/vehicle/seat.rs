//! The two seats at which ride comfort is judged, and the readings of an accelerometer on a seat.
//!
//! Seed report, section 3.2: "the driver position (right front) as well as the left rear passenger position".

use strum::{IntoStaticStr, VariantArray};

/// A seat of the report's two.
#[derive(Debug, Clone, Copy, PartialEq, Eq, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "snake_case")]
pub enum Seat {
    /// Driver's seat, right front in the preset.
    Driver,
    /// Passenger's seat, left rear in the preset.
    Passenger,
}

impl Seat {
    /// Both seats, the driver's first.
    pub const ALL: [Self; 2] = [Self::Driver, Self::Passenger];

    /// Name in column names and files: `driver` or `passenger`.
    pub fn key(self) -> &'static str {
        self.into()
    }
}

/// One value for each seat.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Seats<T> {
    /// Value at the driver's seat.
    pub driver: T,
    /// Value at the passenger's seat.
    pub passenger: T,
}

impl<T> Seats<T> {
    /// From a function of the seat.
    pub fn from_fn(mut value: impl FnMut(Seat) -> T) -> Self {
        Self {
            driver: value(Seat::Driver),
            passenger: value(Seat::Passenger),
        }
    }

    /// Apply a function to both values.
    pub fn map<U>(self, mut function: impl FnMut(T) -> U) -> Seats<U> {
        Seats {
            driver: function(self.driver),
            passenger: function(self.passenger),
        }
    }

    /// Seat and value, the driver's first.
    pub fn iter(&self) -> impl Iterator<Item = (Seat, &T)> {
        [(Seat::Driver, &self.driver), (Seat::Passenger, &self.passenger)].into_iter()
    }

    /// Seat and value to change, the driver's first.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = (Seat, &mut T)> {
        [(Seat::Driver, &mut self.driver), (Seat::Passenger, &mut self.passenger)].into_iter()
    }
}

impl<T> core::ops::Index<Seat> for Seats<T> {
    type Output = T;
    fn index(&self, seat: Seat) -> &T {
        match seat {
            Seat::Driver => &self.driver,
            Seat::Passenger => &self.passenger,
        }
    }
}

/// Acceleration that an accelerometer on a seat reads, along the body's axes, m/s2; 0 when the vehicle stands level.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SeatAcceleration {
    /// Forward acceleration of the seat, m/s2.
    pub fore_aft_m_s2: f64,
    /// To the left, m/s2. A roll angle adds the share of gravity that acts along the body's lateral axis.
    pub lateral_m_s2: f64,
    /// Upward, m/s2, less gravity at rest.
    pub vertical_m_s2: f64,
}
