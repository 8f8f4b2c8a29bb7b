//! What the controller may know: twenty sensor readings, each with its validity.
//!
//! A number whose sensor or frame is not trusted must not be usable by accident, so the value is only reachable together
//! with the question whether it is valid.

use crate::valves::CORNERS;

/// One sensor reading. A value that is not finite is never valid.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reading {
    value: f32,
    valid: bool,
}

impl Reading {
    /// A reading that says nothing.
    pub const INVALID: Self = Self {
        value: 0.0,
        valid: false,
    };

    /// A reading in SI units. NaN and infinite values become [`Reading::INVALID`].
    pub fn new(value: f32) -> Self {
        if value.is_finite() {
            Self { value, valid: true }
        } else {
            Self::INVALID
        }
    }

    /// The value where it is valid.
    pub fn value(self) -> Option<f32> {
        self.valid.then_some(self.value)
    }

    /// Whether the value may be used.
    pub fn is_valid(self) -> bool {
        self.valid
    }
}

/// Bits of [`Inputs::lost_messages`], in the order of the sensor messages.
pub type MessageSet = u8;

/// All that the controller is told in a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Inputs {
    /// Strut displacement from the static position, metres, compression positive; 0 front left to 3 rear right.
    pub displacement: [Reading; CORNERS],
    /// Gauge pressures p1 to p4 of each strut, pascal (see `docs/controller.md` for the places).
    pub pressure: [[Reading; 4]; CORNERS],
    /// Sensor messages whose contract is broken at present (timeout or untrusted): bit 0 to 3 the pressures of the four corners,
    /// bit 4 front and bit 5 rear displacements. 0 where no bus is in between. It names the cause; the readings
    /// concerned are invalid anyway.
    pub lost_messages: MessageSet,
    /// The output stage could not switch a solenoid in the last tick.
    pub solenoid_failed: bool,
}

impl Inputs {
    /// All readings valid, nothing lost: for callers without a bus. Units as the fields.
    pub fn from_values(displacement_m: [f32; CORNERS], pressure_pa: [[f32; 4]; CORNERS]) -> Self {
        Self {
            displacement: displacement_m.map(Reading::new),
            pressure: pressure_pa.map(|p| p.map(Reading::new)),
            lost_messages: 0,
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
}
