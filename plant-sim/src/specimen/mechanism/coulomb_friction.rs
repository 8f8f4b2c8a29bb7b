//! Coulomb friction: `F = F_c sgn(v)`.
//!
//! The force against the motion has the same size at every speed, and holds any smaller force at rest.

use serde::{Deserialize, Serialize};

use crate::model_file::{Checked, Limit, Range};
use crate::strut::Equation;

/// Dry friction of constant size.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CoulombFriction {
    /// Friction force, `F_c`, N, 0 or more.
    #[serde(rename = "coulomb_force_N")]
    pub coulomb_force_n: f64,
}

impl Checked for CoulombFriction {
    const LIMITS: &'static [Limit<Self>] = &[Limit::one("coulomb_force_N", Range::FromTo(0.0, 1e9), "N", |f| {
        f.coulomb_force_n
    })];
}

impl CoulombFriction {
    /// Force against the motion.
    pub const EQUATION: Equation = Equation {
        text: "F = F_c sgn(v)",
        source: "Coulomb 1785; Armstrong-Helouvry, Dupont & Canudas de Wit, Automatica 30(7), 1994",
    };

    /// Force at which the friction slides, N; the same at every speed.
    #[must_use]
    pub const fn level_n(&self) -> f64 {
        self.coulomb_force_n
    }
}
