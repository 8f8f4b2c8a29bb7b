//! States: what a residual may depend on.

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

use strum::{Display, IntoStaticStr};

/// A quantity that was recorded, or follows from what was recorded, and over which residuals are shown and explained.
///
/// The text is the quantity with its unit after a comma.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Display, IntoStaticStr)]
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
    /// A quantity of somebody else's model, by its text.
    #[strum(transparent)]
    Named(&'static str),
}

/// Texts of quantities that are named while the program runs. They stay, so that a state can be copied like the others; there are as many as models have columns.
static NAMES: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());

/// What the text of a simulated quantity begins with.
const SIMULATED: &str = "simulated ";

impl State {
    /// A quantity of somebody else's model: its name, and its unit after a comma.
    #[must_use]
    pub fn named(text: &str) -> Self {
        let mut names = NAMES.lock().unwrap_or_else(PoisonError::into_inner);
        let known = names.get(text).copied().unwrap_or_else(|| {
            let kept: &'static str = Box::leak(text.to_owned().into_boxed_str());
            names.insert(kept);
            kept
        });
        Self::Named(known)
    }

    /// A quantity that somebody else's model gives.
    #[must_use]
    pub fn simulated(text: &str) -> Self {
        Self::named(&format!("{SIMULATED}{text}"))
    }

    /// Whether the specimen was made to do it, so that a complete model leaves nothing that depends on it: displacement, speed, inputs of
    /// somebody else's model and their rates.
    #[must_use]
    pub fn is_driven(self) -> bool {
        match self {
            Self::Displacement | Self::Speed => true,
            Self::Named(text) => !text.starts_with(SIMULATED),
            _ => false,
        }
    }

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
    fn a_text_is_a_quantity_and_its_unit() {
        assert_eq!(State::P1MinusP2.quantity_and_unit(), ("p1 - p2", "Pa"));
        assert_eq!(State::Direction.quantity_and_unit(), ("direction of travel", ""));
        let rate = State::named("rate of x, m/s");
        assert!(rate.is_driven() && State::Speed.is_driven() && !State::simulated("x, m").is_driven());
        assert_eq!(rate.quantity_and_unit(), ("rate of x", "m/s"));
        assert_eq!(
            (rate, rate.to_string()),
            (State::named("rate of x, m/s"), "rate of x, m/s".to_owned())
        );
    }
}
