//! A rubber bush in series with the strut: the strut moves less than the actuator.
//!
//! `x_strut = x - (F - F_static) / k` (rubber bush, report 3.3).

use super::equation::Equation;
use serde::{Deserialize, Serialize};

use crate::lanes::Number;
use crate::model_file::{Checked, Limit, Range};

/// The mounting is soft.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MountCompliance {
    /// Stiffness, `k`, N/m; usually 5e5 to 2e7.
    #[serde(rename = "stiffness_N_m")]
    pub stiffness_n_m: f64,
}

impl Checked for MountCompliance {
    const LIMITS: &'static [Limit<Self>] = &[Limit::one("stiffness_N_m", Range::FromTo(1.0, 1e16), "N/m", |t| {
        t.stiffness_n_m
    })];
}

impl MountCompliance {
    /// The mount as the solver uses it.
    #[must_use]
    pub fn mount(&self) -> Mount {
        Mount {
            flexibility_m_n: 1.0 / self.stiffness_n_m,
        }
    }
}

/// A mount; rigid by default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Mount<N = f64> {
    /// One over the stiffness, m/N.
    pub flexibility_m_n: N,
}

/// Displacement that reaches the strut.
pub const EQUATION: Equation = Equation {
    text: "x_strut = x - (F - F_static) / k",
    source: "Theron & Els, final report 2002, section 3.3",
};

impl<N: Number> Mount<N> {
    /// Deflection under a force above the static one, m.
    #[inline(always)]
    #[must_use]
    pub fn deflection_m(&self, force_n: N) -> N {
        force_n * self.flexibility_m_n
    }
}

impl Mount {
    /// Volume by which the mount's deflection makes the chamber of a piston larger when its pressure rises, m3/Pa.
    #[must_use]
    pub fn volume_per_pressure_m3_pa(&self, piston_area_m2: f64) -> f64 {
        piston_area_m2 * piston_area_m2 * self.flexibility_m_n
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deflects_by_hookes_law() {
        let mount = MountCompliance { stiffness_n_m: 2e6 }.mount();
        assert_eq!(mount.deflection_m(4000.0), 2e-3);
        // 1 MPa on 2e-3 m2 is 2 kN, which is 1 mm, which is 2e-6 m3.
        assert!((mount.volume_per_pressure_m3_pa(2e-3) * 1e6 - 2e-6).abs() < 1e-18);
        assert_eq!(Mount::default().deflection_m(4000.0), 0.0);
    }
}
