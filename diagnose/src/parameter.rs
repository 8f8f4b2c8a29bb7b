//! A number that a fit may change: its unit, its range, and how far it may be off before that means something.
//!
//! Fits work in a coordinate `z` of order one, so that steps, damping and convergence need no knowledge of units. For a
//! calibration value `z` is the deviation over its prior standard deviation, half of the stated tolerance.

use crate::vocabulary::{EffectId, Place, Site};

/// How `z` maps to the value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scale {
    /// `value = start + scale z`.
    Linear(f64),
    /// `value = start exp(scale z)`: for positive quantities known to an order of magnitude.
    Log(f64),
}

/// A parameter that is fitted, with its start value and range.
///
/// ```
/// use oleo_diagnose::parameter::Parameter;
/// // A gas volume that may be 2 % off: one coordinate is half of that.
/// let volume = Parameter::calibration("static_gas_volume", 0.02);
/// assert_eq!(volume.value(-1.0), -0.01);
/// // A positive number that is known to an order of magnitude.
/// let modulus = Parameter::log("bulk_modulus_Pa", 1.4e9, (1e8, 1e10));
/// assert!((modulus.z(modulus.value(0.7)) - 0.7).abs() < 1e-12);
/// ```
#[derive(Debug, Clone)]
pub struct Parameter {
    /// Name with unit, as in the report.
    pub key: String,
    /// Value at `z = 0`.
    pub start: f64,
    /// Map between `z` and value.
    pub scale: Scale,
    /// Smallest value that the parameter may have.
    pub lower: f64,
    /// Largest value that the parameter may have.
    pub upper: f64,
    /// Range while no effect of the model takes over a part of what the value stands for; `None` where that is no matter.
    pub tolerated: Option<(f64, f64)>,
    /// Calibration: `z` is normal with standard deviation 1 before the recordings are seen.
    pub prior: bool,
    /// Changes only what an instrument shows, so the physics need not be simulated again.
    pub instrument_only: bool,
    /// The only recording in which it matters, by its index; `None` if it may matter in all.
    pub only_in: Option<usize>,
    /// The effect beside which alone it matters; `None` if it matters without any.
    pub only_beside: Option<Beside>,
    /// The size of the effect: zero is "not there", and every larger value is more of it.
    pub is_size: bool,
    /// How the number is reported.
    pub shown: Shown,
}

/// An effect that a number waits for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Beside {
    /// The effect.
    pub effect: EffectId,
    /// The site at which it has to act; `None` if any will do.
    pub site: Option<Site>,
}

impl Beside {
    /// An effect, wherever it acts.
    #[must_use]
    pub const fn anywhere(effect: EffectId) -> Self {
        Self { effect, site: None }
    }

    /// Whether it is the effect of this id at this place.
    #[must_use]
    pub fn is(&self, effect: EffectId, place: &Place) -> bool {
        effect == self.effect && self.site.as_ref().is_none_or(|site| *site == place.site)
    }
}

/// How a fitted number is reported.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shown {
    /// As it was fitted.
    AsFitted,
    /// As this key, and inverted: a compliance is fitted (zero is "not there"), a stiffness is what people know.
    AsInverse(&'static str),
    /// As the number of the model that was believed to be this one: the relative departure from it is fitted (zero is "as believed").
    AsNumberBelievedToBe(f64),
}

/// Calibration may use a little more than the stated tolerance before it is no longer called calibration.
const TOLERANCE_BOUND: f64 = 1.1;

impl Parameter {
    /// Deviation from nominal within a tolerance (relative or in the value's unit).
    #[must_use]
    pub fn calibration(key: impl Into<String>, tolerance: f64) -> Self {
        Self {
            key: key.into(),
            start: 0.0,
            scale: Scale::Linear(0.5 * tolerance),
            lower: -TOLERANCE_BOUND * tolerance,
            upper: TOLERANCE_BOUND * tolerance,
            tolerated: None,
            prior: true,
            instrument_only: false,
            only_in: None,
            only_beside: None,
            is_size: false,
            shown: Shown::AsFitted,
        }
    }

    /// The same for a value that was identified without the missing effects, and holds a part of them. Beside an effect that
    /// takes over this part ([`crate::effect::Candidate::takes_from`]) it may fall to `least`.
    ///
    /// ```
    /// use oleo_diagnose::parameter::Parameter;
    /// // An equivalent viscous coefficient holds friction too: beside friction it may fall to zero.
    /// let viscous = Parameter::calibration_down_to("viscous", 0.3, -1.0);
    /// let (low, high) = viscous.tolerated_z_range();
    /// assert!((viscous.value(low) + 0.33).abs() < 1e-12 && (viscous.value(high) - 0.33).abs() < 1e-12);
    /// assert_eq!(viscous.value(viscous.z_range().0), -1.0);
    /// ```
    #[must_use]
    pub fn calibration_down_to(key: impl Into<String>, tolerance: f64, least: f64) -> Self {
        let alone = Self::calibration(key, tolerance);
        Self {
            tolerated: Some((alone.lower, alone.upper)),
            lower: alone.lower.min(least),
            ..alone
        }
    }

    /// Free value on a linear scale.
    #[must_use]
    pub fn linear(key: impl Into<String>, start: f64, scale: f64, range: (f64, f64)) -> Self {
        Self {
            key: key.into(),
            start,
            scale: Scale::Linear(scale),
            lower: range.0,
            upper: range.1,
            tolerated: None,
            prior: false,
            instrument_only: false,
            only_in: None,
            only_beside: None,
            is_size: false,
            shown: Shown::AsFitted,
        }
    }

    /// Free positive value on a logarithmic scale.
    #[must_use]
    pub fn log(key: impl Into<String>, start: f64, range: (f64, f64)) -> Self {
        Self {
            scale: Scale::Log(0.5),
            ..Self::linear(key, start, 1.0, range)
        }
    }

    /// Free amount of something that is absent at zero. `visible` is an amount that would show.
    #[must_use]
    pub fn amount(key: impl Into<String>, visible: f64, most: f64) -> Self {
        Self::departure(key, visible, (0.0, most))
    }

    /// Free departure, of either sign where the range has both, from what is believed; there is none at zero. `visible` is a
    /// departure that would show.
    #[must_use]
    pub fn departure(key: impl Into<String>, visible: f64, range: (f64, f64)) -> Self {
        Self {
            is_size: true,
            ..Self::linear(key, 0.0, visible, range)
        }
    }

    /// The same, reported as its inverse.
    #[must_use]
    pub fn shown_as_inverse(self, key: &'static str) -> Self {
        Self {
            shown: Shown::AsInverse(key),
            ..self
        }
    }

    /// The same relative departure, reported as the number that departs from this one.
    #[must_use]
    pub fn shown_as_number(self, believed: f64) -> Self {
        Self {
            shown: Shown::AsNumberBelievedToBe(believed),
            ..self
        }
    }

    /// The same, touching only the instrument.
    #[must_use]
    pub fn on_instrument(self) -> Self {
        Self {
            instrument_only: true,
            ..self
        }
    }

    /// Value of the parameter at the fitted coordinate `z`.
    #[must_use]
    pub fn value(&self, z: f64) -> f64 {
        match self.scale {
            Scale::Linear(s) => self.start + s * z,
            Scale::Log(s) => self.start * libm::exp(s * z),
        }
        .clamp(self.lower, self.upper)
    }

    /// The key under which the number is reported.
    #[must_use]
    pub fn reported_key(&self) -> &str {
        match self.shown {
            Shown::AsInverse(key) => key,
            Shown::AsFitted | Shown::AsNumberBelievedToBe(_) => &self.key,
        }
    }

    /// A fitted value as it is reported.
    ///
    /// ```
    /// use oleo_diagnose::parameter::Parameter;
    /// let flexibility = Parameter::amount("compliance_m_N", 1e-8, 1e-4).shown_as_inverse("stiffness_N_m");
    /// assert_eq!((flexibility.reported_key(), flexibility.reported(1e-7)), ("stiffness_N_m", 1e7));
    /// let modulus = Parameter::departure("bulk_modulus_Pa", 0.02, (-0.9, 9.0)).shown_as_number(1.4e9);
    /// assert!((modulus.reported(0.1) - 1.54e9).abs() < 1.0);
    /// ```
    #[must_use]
    pub fn reported(&self, value: f64) -> f64 {
        match self.shown {
            Shown::AsFitted => value,
            Shown::AsInverse(_) => 1.0 / value,
            Shown::AsNumberBelievedToBe(believed) => believed * (1.0 + value),
        }
    }

    /// Fitted coordinate `z` of a value.
    #[must_use]
    pub fn z(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear(s) => (value - self.start) / s,
            Scale::Log(s) => libm::log(value / self.start) / s,
        }
    }

    /// Smallest and largest value of the fitted coordinate `z`.
    #[must_use]
    pub fn z_range(&self) -> (f64, f64) {
        let (a, b) = (self.z(self.lower), self.z(self.upper));
        (a.min(b), a.max(b))
    }

    /// The same while no effect takes over a part of what the value stands for.
    #[must_use]
    pub fn tolerated_z_range(&self) -> (f64, f64) {
        let (lower, upper) = self.tolerated.unwrap_or((self.lower, self.upper));
        let (a, b) = (self.z(lower), self.z(upper));
        (a.min(b), a.max(b))
    }

    /// `d value / d z` at `z`.
    #[must_use]
    pub fn slope(&self, z: f64) -> f64 {
        match self.scale {
            Scale::Linear(s) => s,
            Scale::Log(s) => s * self.start * libm::exp(s * z),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_are_inverse() {
        let p = Parameter::log("tau_s", 3.0, (0.1, 50.0));
        assert!((p.z(p.value(0.7)) - 0.7).abs() < 1e-12);
        let c = Parameter::calibration("volume", 0.01);
        assert!((c.value(2.0) - 0.01).abs() < 1e-15);
        assert!((c.value(99.0) - 0.011).abs() < 1e-15);
    }
}
