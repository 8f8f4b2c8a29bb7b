//! Coulomb and Stribeck friction of the rod seal.
//!
//! The seal slides at `g = F_c + (F_s - F_c) exp(-(v/v_s)^2)` (Stribeck curve as in Canudas de Wit et al., "A new model for
//! control of systems with friction", IEEE TAC 40(3), 1995, without the bristle damping). Before it slides it shears
//! elastically, `dF/dx = k (1 - sgn(v) F / g)`, see [`advance_friction`](crate::strut::advance_friction).

use super::equation::Equation;
use serde::{Deserialize, Serialize};

use crate::lanes::{Number, decay};
use crate::model_file::{Checked, Limit, Range};

/// The rod seal rubs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SealFriction {
    /// Coulomb force while sliding fast, `F_c`, N; usually 50 to 500.
    #[serde(rename = "coulomb_force_N")]
    pub coulomb_force_n: f64,
    /// Breakaway force, `F_s`, N; usually 1 to 2 times the Coulomb force.
    #[serde(rename = "breakaway_force_N")]
    pub breakaway_force_n: f64,
    /// Stribeck speed, `v_s`, m/s; usually 1e-3 to 0.1.
    pub stribeck_speed_m_s: f64,
    /// Presliding stiffness, N/m; 2e6 in the recordings.
    #[serde(rename = "presliding_stiffness_N_m")]
    pub presliding_stiffness_n_m: f64,
}

/// Force of friction, N.
const FORCE_N: Range = Range::FromTo(0.0, 1e7);

impl Checked for SealFriction {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("coulomb_force_N", FORCE_N, "N", |t| t.coulomb_force_n),
        Limit::one("breakaway_force_N", FORCE_N, "N", |t| t.breakaway_force_n),
        Limit::one("stribeck_speed_m_s", Range::FromTo(1e-6, 1e3), "m/s", |t| {
            t.stribeck_speed_m_s
        }),
        Limit::one("presliding_stiffness_N_m", Range::FromTo(1.0, 1e15), "N/m", |t| {
            t.presliding_stiffness_n_m
        }),
    ];
}

/// The level `g`, and what [`advance_friction`](crate::strut::advance_friction) does with it.
pub const EQUATION: Equation = Equation {
    text: "dF/dx = k (1 - sgn(v) F / g), g = F_c + (F_s - F_c) exp(-(v/v_s)^2)",
    source: "Dahl 1968; Canudas de Wit et al., IEEE TAC 40(3), 1995",
};

impl SealFriction {
    /// Force at which the seal slides at a speed, N.
    #[inline]
    #[must_use]
    pub fn level_n(&self, speed_m_s: f64) -> f64 {
        self.level().at_n(speed_m_s)
    }

    /// Level at which the seal slides, as the solver uses it.
    #[must_use]
    pub(in crate::strut) fn level(&self) -> SealLevel {
        SealLevel {
            coulomb_n: self.coulomb_force_n,
            above_coulomb_n: self.breakaway_force_n - self.coulomb_force_n,
            stribeck_m_s: self.stribeck_speed_m_s,
        }
    }
}

/// Level at which a seal slides, of one strut or of several side by side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::strut) struct SealLevel<N = f64> {
    /// Level at high speed, N.
    pub coulomb_n: N,
    /// What the level of breakaway is higher, N.
    pub above_coulomb_n: N,
    /// Stribeck speed, m/s.
    pub stribeck_m_s: N,
}

impl<N: Number> SealLevel<N> {
    /// Level at a sliding speed (m/s), N.
    #[inline(always)]
    #[must_use]
    pub fn at_n(&self, speed_m_s: N) -> N {
        let ratio = speed_m_s / self.stribeck_m_s;
        self.coulomb_n + self.above_coulomb_n * decay(-ratio * ratio)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_level_falls_from_breakaway_to_coulomb() {
        let seal = SealFriction {
            coulomb_force_n: 100.0,
            breakaway_force_n: 150.0,
            stribeck_speed_m_s: 0.01,
            presliding_stiffness_n_m: 2e6,
        };
        assert_eq!(seal.level_n(0.0), 150.0);
        assert!((seal.level_n(0.01) - (100.0 + 50.0 * libm::exp(-1.0))).abs() < 1e-12);
        assert!((seal.level_n(0.1) - 100.0).abs() < 1e-12);
        assert_eq!(seal.level_n(-0.02), seal.level_n(0.02));
    }
}
