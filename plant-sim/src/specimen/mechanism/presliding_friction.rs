//! Presliding friction: `dF/dx = k (1 - sgn(v) F / g)`, a hysteresis over displacement before the contact slides.
//!
//! The asperities of a contact, or the particle chains of a magneto-rheological fluid, shear elastically with the stiffness
//! `k` until they slide at the level `g`. With a constant level this is Dahl's model. With a level that falls with speed,
//! `g = F_c + (F_s - F_c) exp(-(v/v_s)^2)`, it is the LuGre model without its damping of the presliding motion, which no
//! recording of a force in full strokes can show.

use serde::{Deserialize, Serialize};

use crate::model_file::{Checked, InvalidValue, Limit, Range};
use crate::strut::Equation;

/// Dry friction with an elastic displacement before it slides.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PreslidingFriction {
    /// Friction force when it slides, `F_c`, N, 0 or more.
    #[serde(rename = "coulomb_force_N")]
    pub coulomb_force_n: f64,
    /// Stiffness before it slides, `k`, N/m.
    #[serde(rename = "presliding_stiffness_N_m")]
    pub presliding_stiffness_n_m: f64,
    /// Breakaway force of the LuGre model, `F_s`, N, at least the Coulomb force. Dahl's model has none.
    #[serde(rename = "breakaway_force_N", skip_serializing_if = "Option::is_none")]
    pub breakaway_force_n: Option<f64>,
    /// Stribeck speed of the LuGre model, `v_s`, m/s. Dahl's model has none.
    #[serde(rename = "stribeck_speed_m_s", skip_serializing_if = "Option::is_none")]
    pub stribeck_speed_m_s: Option<f64>,
}

impl Checked for PreslidingFriction {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("coulomb_force_N", Range::FromTo(0.0, 1e9), "N", |f| f.coulomb_force_n),
        Limit::one("presliding_stiffness_N_m", Range::FromTo(1e-3, 1e15), "N/m", |f| {
            f.presliding_stiffness_n_m
        }),
        Limit::optional("breakaway_force_N", Range::FromTo(0.0, 1e9), "N", |f| {
            f.breakaway_force_n
        }),
        Limit::optional("stribeck_speed_m_s", Range::FromTo(1e-6, 100.0), "m/s", |f| {
            f.stribeck_speed_m_s
        }),
    ];

    fn check_together(&self) -> Result<(), InvalidValue> {
        match (self.breakaway_force_n, self.stribeck_speed_m_s) {
            (None, None) => Ok(()),
            (Some(breakaway), Some(_)) if breakaway >= self.coulomb_force_n => Ok(()),
            (Some(breakaway), Some(_)) => {
                let what = format!(
                    "is {breakaway}: must be at least coulomb_force_N, which is {}",
                    self.coulomb_force_n
                );
                Err(InvalidValue::new("breakaway_force_N", what))
            }
            (Some(_), None) => Err(InvalidValue::new(
                "stribeck_speed_m_s",
                "is missing: breakaway_force_N falls to coulomb_force_N with it",
            )),
            (None, Some(_)) => Err(InvalidValue::new(
                "breakaway_force_N",
                "is missing: with stribeck_speed_m_s both must be given, or neither",
            )),
        }
    }
}

impl PreslidingFriction {
    /// Force against the motion as it builds up over displacement.
    pub const EQUATION: Equation = Equation {
        text: "dF/dx = k (1 - sgn(v) F / g), g = F_c + (F_s - F_c) exp(-(v/v_s)^2), with F_s = F_c unless it is given",
        source: "Dahl, Aerospace Corporation 1968; Canudas de Wit, Olsson, Astrom & Lischinsky, IEEE Trans. Autom. Control 40(3), 1995",
    };

    /// Force at which the friction slides at a speed (m/s), N.
    #[must_use]
    pub fn level_n(&self, speed_m_s: f64) -> f64 {
        match (self.breakaway_force_n, self.stribeck_speed_m_s) {
            (Some(breakaway), Some(stribeck)) => {
                let ratio = speed_m_s / stribeck;
                self.coulomb_force_n + (breakaway - self.coulomb_force_n) * libm::exp(-ratio * ratio)
            }
            _ => self.coulomb_force_n,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::specimen::mechanism::stribeck_friction::StribeckFriction;

    fn dahl() -> PreslidingFriction {
        PreslidingFriction {
            coulomb_force_n: 500.0,
            presliding_stiffness_n_m: 1e6,
            breakaway_force_n: None,
            stribeck_speed_m_s: None,
        }
    }

    #[test]
    fn the_level_is_constant_in_dahls_model_and_stribecks_in_the_lugre_model() {
        assert_eq!((dahl().level_n(0.0), dahl().level_n(3.0)), (500.0, 500.0));
        let lugre = PreslidingFriction {
            breakaway_force_n: Some(700.0),
            stribeck_speed_m_s: Some(0.02),
            ..dahl()
        };
        let stribeck = StribeckFriction {
            coulomb_force_n: 500.0,
            breakaway_force_n: 700.0,
            stribeck_speed_m_s: 0.02,
        };
        for speed in [0.0, 0.005, -0.02, 0.3] {
            assert_eq!(lugre.level_n(speed), stribeck.level_n(speed));
        }
    }

    #[test]
    fn half_of_the_lugre_numbers_is_refused() {
        let only = |breakaway_force_n, stribeck_speed_m_s| {
            let friction = PreslidingFriction {
                breakaway_force_n,
                stribeck_speed_m_s,
                ..dahl()
            };
            friction.check().map_err(|invalid| invalid.to_string())
        };
        assert_eq!(only(None, None), Ok(()));
        assert_eq!(only(Some(600.0), Some(0.01)), Ok(()));
        assert!(only(Some(600.0), None).is_err_and(|e| e.starts_with("stribeck_speed_m_s is missing")));
        assert!(only(None, Some(0.01)).is_err_and(|e| e.starts_with("breakaway_force_N is missing")));
        assert!(only(Some(1.0), Some(0.01)).is_err_and(|e| e.starts_with("breakaway_force_N is 1")));
    }
}
