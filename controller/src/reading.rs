//! The inputs of the controller: twenty sensor readings, each with its validity.
//!
//! A number whose sensor or frame is not trusted must not be used by accident. So a value can only be had together with the answer
//! whether it is valid.

use oleo_interface::{Corners, Gauge, StrutPressures};

use crate::sensor_message::MessageSet;

/// One sensor reading. A value that is not finite is never valid.
///
/// ```
/// use oleo_controller::Reading;
/// assert_eq!(Reading::new(0.012).value(), Some(0.012));
/// assert_eq!(Reading::new(f32::NAN), Reading::INVALID);
/// assert_eq!(Reading::INVALID.value(), None);
/// ```
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Reading(f32);

impl Reading {
    /// A reading without a value.
    pub const INVALID: Self = Self(f32::NAN);

    /// A reading in SI units. NaN and infinite values become [`Reading::INVALID`].
    pub fn new(value: f32) -> Self {
        if value.is_finite() { Self(value) } else { Self::INVALID }
    }

    /// The value, if it is valid.
    pub fn value(self) -> Option<f32> {
        self.is_valid().then_some(self.0)
    }

    /// Whether the value may be used.
    pub fn is_valid(self) -> bool {
        !self.0.is_nan()
    }

    /// The value, or NaN: for a comparison that nothing invalid passes.
    pub(crate) fn value_or_nan(self) -> f32 {
        self.0
    }
}

impl Default for Reading {
    fn default() -> Self {
        Self::INVALID
    }
}

impl PartialEq for Reading {
    /// Two invalid readings are equal.
    fn eq(&self, other: &Self) -> bool {
        self.value() == other.value()
    }
}

/// All that the controller is told in a tick. By default nothing is valid.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Inputs {
    /// Strut displacement from the static position, m, compression positive, -0.25 to 0.25.
    pub displacement: Corners<Reading>,
    /// Gauge pressures p1 to p4 of each strut, Pa, -4.9e6 to 35e6.
    pub pressure: Corners<StrutPressures<Reading>>,
    /// Sensor messages that are late or not trusted at present; none where no bus is in between. The set names the
    /// cause; the readings of such a message are invalid anyway.
    pub lost_messages: MessageSet,
    /// A frame with one of the controller's own identifiers was heard: somebody else sends commands.
    pub foreign_sender: bool,
    /// The output stage could not switch a solenoid in the last tick.
    pub solenoid_failed: bool,
}

impl Inputs {
    /// Inputs without a bus: every finite value is a valid reading, no message is lost.
    ///
    /// ```
    /// use oleo_controller::{Corner, Corners, Gauge, Inputs, StrutPressures};
    /// let displacement_m = Corners::from_array([0.01, 0.01, f32::NAN, 0.0]);
    /// let inputs = Inputs::from_values(displacement_m, Corners::splat(StrutPressures::splat(Gauge(2.0e6))));
    /// assert_eq!(inputs.displacement[Corner::FrontLeft].value(), Some(0.01));
    /// assert!(!inputs.displacement[Corner::RearLeft].is_valid());
    /// assert_eq!(inputs.pressure[Corner::RearLeft].p4.value(), Some(2.0e6));
    /// ```
    pub fn from_values(displacement_m: Corners<f32>, pressure: Corners<StrutPressures<Gauge<f32>>>) -> Self {
        Self {
            displacement: displacement_m.map(Reading::new),
            pressure: pressure.map(|strut| strut.map(|point| Reading::new(point.pa()))),
            lost_messages: MessageSet::EMPTY,
            foreign_sender: false,
            solenoid_failed: false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn not_a_number_is_not_a_reading() {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert_eq!(Reading::new(bad).value(), None);
        }
        assert_eq!(Reading::new(-0.1).value(), Some(-0.1));
    }

    #[test]
    fn readings_are_equal_with_equal_values_or_with_none() {
        assert_eq!(Reading::new(f32::INFINITY), Reading::default());
        assert_eq!(Reading::new(0.5), Reading::new(0.5));
        assert_ne!(Reading::new(0.5), Reading::new(0.25));
        assert_ne!(Reading::new(0.5), Reading::INVALID);
    }
}
