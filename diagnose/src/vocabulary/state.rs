//! States: what a residual may depend on.

use strum::{Display, EnumString, IntoStaticStr, VariantArray};

/// A quantity that was recorded, or follows from what was recorded, and over which residuals are shown and explained.
///
/// The text is the quantity with its unit after a comma.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Display, EnumString, IntoStaticStr, VariantArray,
)]
pub enum State {
    /// Displacement from the static position, jounce positive.
    #[strum(serialize = "displacement, m")]
    Displacement,
    /// Speed, m/s, positive in jounce.
    #[strum(serialize = "speed, m/s")]
    Speed,
    /// Size of the speed, whatever its direction.
    #[strum(serialize = "size of the speed, m/s")]
    SpeedMagnitude,
    /// Direction of travel: 1 in jounce, -1 in rebound, 0 at rest.
    #[strum(serialize = "direction of travel")]
    Direction,
    /// Acceleration, m/s2, positive in jounce.
    #[strum(serialize = "acceleration, m/s2")]
    Acceleration,
    /// Time since the last edge of a switching signal.
    #[strum(serialize = "time since a switching edge, s")]
    TimeSinceSwitching,
    /// Pressure of the only chamber.
    #[strum(serialize = "pressure, Pa")]
    Pressure,
    /// Gauge pressure of the main cylinder.
    #[strum(serialize = "p1, Pa")]
    P1,
    /// Pressure drop across damper 1 and its bypass.
    #[strum(serialize = "p1 - p2, Pa")]
    P1MinusP2,
    /// Pressure drop across damper 2 and its bypass.
    #[strum(serialize = "p1 - p3, Pa")]
    P1MinusP3,
    /// Pressure drop across valve 3.
    #[strum(serialize = "p3 - p4, Pa")]
    P3MinusP4,
    /// Sum of the chambers' pressures on their areas, all counted positive: what presses the seals.
    #[strum(serialize = "pressing force, N")]
    PressingForce,
}

impl State {
    /// The text: quantity, and unit after a comma.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        self.into()
    }

    /// Quantity and unit; the unit is empty for a number without one.
    #[must_use]
    pub fn quantity_and_unit(self) -> (&'static str, &'static str) {
        self.as_str().rsplit_once(", ").unwrap_or((self.as_str(), ""))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_read_back() {
        for &state in State::VARIANTS {
            assert_eq!(state.as_str().parse(), Ok(state));
        }
        assert_eq!(State::P1MinusP2.quantity_and_unit(), ("p1 - p2", "Pa"));
        assert_eq!(State::Direction.quantity_and_unit(), ("direction of travel", ""));
    }
}
