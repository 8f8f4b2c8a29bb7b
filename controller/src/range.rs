//! Ranges of parameters, and the error for a value outside its range.

use core::fmt;

/// A value outside the range for which the controller was designed. See [`Builder`](crate::Builder) for an example.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConfigurationError {
    /// Name of the value: its field in [`Builder`](crate::Builder).
    pub name: &'static str,
    /// The value, in the unit that its name ends in.
    pub value: f32,
    /// Smallest and largest permitted value.
    pub range: (f32, f32),
}

impl fmt::Display for ConfigurationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (least, most) = self.range;
        write!(
            f,
            "controller configuration: {} = {}: give a value from {least} to {most}",
            self.name, self.value
        )
    }
}

impl core::error::Error for ConfigurationError {}

/// Whether a value is a number within a range, both ends included.
pub(crate) fn within(name: &'static str, value: f32, least: f32, most: f32) -> Result<(), ConfigurationError> {
    if value >= least && value <= most {
        Ok(())
    } else {
        Err(ConfigurationError {
            name,
            value,
            range: (least, most),
        })
    }
}

/// Two thresholds: a state begins above one and ends below the other, so that it does not change every tick.
///
/// ```
/// use oleo_controller::{Builder, Hysteresis};
/// let mut builder = Builder::default();
/// builder.tuning.strategy.ride_handling.running_rms.ratio = Hysteresis { begin: 0.8, end: 1.0 };
/// let error = builder.build().unwrap_err();
/// assert_eq!((error.value, error.range), (1.0, (0.05, 0.8))); // the end is above the begin
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hysteresis {
    /// The state begins above this value.
    pub begin: f32,
    /// The state ends below this value, which is not above `begin`.
    pub end: f32,
}

impl Hysteresis {
    /// Whether both thresholds are within a range and in the right order.
    pub(crate) fn check(&self, name: &'static str, least: f32, most: f32) -> Result<(), ConfigurationError> {
        within(name, self.begin, least, most)?;
        within(name, self.end, least, self.begin)
    }

    /// Both thresholds squared, to be compared with a mean square.
    pub(crate) fn squared(self) -> Self {
        Self {
            begin: self.begin * self.begin,
            end: self.end * self.end,
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::ToString;

    #[test]
    fn both_ends_are_within_and_what_is_no_number_is_not() {
        assert_eq!(within("a", 1.0, 1.0, 2.0), Ok(()));
        assert_eq!(within("a", 2.0, 1.0, 2.0), Ok(()));
        assert_eq!(
            within("a_m", f32::NAN, 1.0, 2.5).unwrap_err().to_string(),
            "controller configuration: a_m = NaN: give a value from 1 to 2.5"
        );
    }

    #[test]
    fn a_hysteresis_ends_below_its_begin() {
        let check = |begin, end| Hysteresis { begin, end }.check("a", 0.1, 2.0);
        assert_eq!(check(1.0, 1.0), Ok(()));
        assert_eq!(check(1.0, 1.1).unwrap_err().range, (0.1, 1.0));
        assert_eq!(check(3.0, 1.0).unwrap_err().range, (0.1, 2.0));
    }

    #[test]
    fn thresholds_are_squared() {
        let squared = Hysteresis { begin: 3.0, end: 0.5 }.squared();
        assert_eq!((squared.begin, squared.end), (9.0, 0.25));
    }
}
