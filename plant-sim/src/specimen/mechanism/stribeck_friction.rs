//! Stribeck friction: `F = (F_c + (F_s - F_c) exp(-(v/v_s)^2)) sgn(v)`.
//!
//! A lubricated contact holds with the breakaway force `F_s` and slides with less, the faster the film builds up.

use serde::{Deserialize, Serialize};

use crate::model_file::{Checked, InvalidValue, Limit, Range};
use crate::strut::Equation;

/// Dry friction that falls from the breakaway force to the Coulomb force as speed rises.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StribeckFriction {
    /// Friction force at high speed, `F_c`, N, 0 or more.
    #[serde(rename = "coulomb_force_N")]
    pub coulomb_force_n: f64,
    /// Breakaway force, `F_s`, N, at least the Coulomb force.
    #[serde(rename = "breakaway_force_N")]
    pub breakaway_force_n: f64,
    /// Stribeck speed, `v_s`, m/s, usually 0.001 to 0.1.
    #[serde(rename = "stribeck_speed_m_s")]
    pub stribeck_speed_m_s: f64,
}

impl Checked for StribeckFriction {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("coulomb_force_N", Range::FromTo(0.0, 1e9), "N", |f| f.coulomb_force_n),
        Limit::one("breakaway_force_N", Range::FromTo(0.0, 1e9), "N", |f| {
            f.breakaway_force_n
        }),
        Limit::one("stribeck_speed_m_s", Range::FromTo(1e-6, 100.0), "m/s", |f| {
            f.stribeck_speed_m_s
        }),
    ];

    fn check_together(&self) -> Result<(), InvalidValue> {
        if self.breakaway_force_n < self.coulomb_force_n {
            let what = format!(
                "is {}: must be at least coulomb_force_N, which is {}",
                self.breakaway_force_n, self.coulomb_force_n
            );
            return Err(InvalidValue::new("breakaway_force_N", what));
        }
        Ok(())
    }
}

impl StribeckFriction {
    /// Force against the motion.
    pub const EQUATION: Equation = Equation {
        text: "F = (F_c + (F_s - F_c) exp(-(v/v_s)^2)) sgn(v)",
        source: "Stribeck 1902; Armstrong-Helouvry, Dupont & Canudas de Wit, Automatica 30(7), 1994",
    };

    /// Force at which the friction slides at a speed (m/s), N.
    #[must_use]
    pub fn level_n(&self, speed_m_s: f64) -> f64 {
        let ratio = speed_m_s / self.stribeck_speed_m_s;
        self.coulomb_force_n + (self.breakaway_force_n - self.coulomb_force_n) * libm::exp(-ratio * ratio)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_level_falls_from_breakaway_to_coulomb() {
        let friction = StribeckFriction {
            coulomb_force_n: 20.0,
            breakaway_force_n: 32.0,
            stribeck_speed_m_s: 0.01,
        };
        assert_eq!(friction.level_n(0.0), 32.0);
        assert!((friction.level_n(1.0) - 20.0).abs() < 1e-12);
        // At the Stribeck speed 1/e of the difference is left, in either direction.
        let expected = 20.0 + 12.0 / std::f64::consts::E;
        assert!((friction.level_n(0.01) - expected).abs() < 1e-12);
        assert_eq!(friction.level_n(-0.01), friction.level_n(0.01));
    }

    #[test]
    fn a_breakaway_force_below_the_coulomb_force_is_refused() {
        let friction = StribeckFriction {
            coulomb_force_n: 20.0,
            breakaway_force_n: 10.0,
            stribeck_speed_m_s: 0.01,
        };
        let complaint = friction.check().unwrap_err().to_string();
        assert_eq!(
            complaint,
            "breakaway_force_N is 10: must be at least coulomb_force_N, which is 20"
        );
    }
}
