//! Forces that the vocabulary has no name for, one number each and of either sign.

use serde::{Deserialize, Serialize};

use crate::model_file::{Checked, Limit, Range};
use crate::strut::Equation;

/// Forces without a name in the vocabulary.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct UnnamedForces {
    /// Viscous damping beside that of the model, `c`, N s/m.
    #[serde(rename = "viscous_N_s_m", skip_serializing_if = "Option::is_none")]
    pub viscous_n_s_m: Option<f64>,
    /// Turbulent damping, `d`, N s2/m2.
    #[serde(rename = "turbulent_N_s2_m2", skip_serializing_if = "Option::is_none")]
    pub turbulent_n_s2_m2: Option<f64>,
    /// Damping that differs between compression and rebound, `e`, N s/m: half the difference of the two.
    #[serde(rename = "one_sided_N_s_m", skip_serializing_if = "Option::is_none")]
    pub one_sided_n_s_m: Option<f64>,
    /// Cubic stiffness, `q`, N/m3.
    #[serde(rename = "cubic_N_m3", skip_serializing_if = "Option::is_none")]
    pub cubic_n_m3: Option<f64>,
}

/// A coefficient of either sign, so that a fit may cross zero.
const COEFFICIENT: Range = Range::FromTo(-1e15, 1e15);

impl Checked for UnnamedForces {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::optional("viscous_N_s_m", COEFFICIENT, "N s/m", |u| u.viscous_n_s_m),
        Limit::optional("turbulent_N_s2_m2", COEFFICIENT, "N s2/m2", |u| u.turbulent_n_s2_m2),
        Limit::optional("one_sided_N_s_m", COEFFICIENT, "N s/m", |u| u.one_sided_n_s_m),
        Limit::optional("cubic_N_m3", COEFFICIENT, "N/m3", |u| u.cubic_n_m3),
    ];
}

impl UnnamedForces {
    /// Equation of [`Self::viscous_n_s_m`].
    pub const VISCOUS: Equation = Equation {
        text: "F = c v",
        source: "Newton's law of viscosity; no name in the vocabulary",
    };
    /// Equation of [`Self::turbulent_n_s2_m2`].
    pub const TURBULENT: Equation = Equation {
        text: "F = d v |v|",
        source: "Bernoulli's equation of an orifice; no name in the vocabulary",
    };
    /// Equation of [`Self::one_sided_n_s_m`].
    pub const ONE_SIDED: Equation = Equation {
        text: "F = e |v|",
        source: "linear damping in either direction; no name in the vocabulary",
    };
    /// Equation of [`Self::cubic_n_m3`].
    pub const CUBIC: Equation = Equation {
        text: "F = q x^3",
        source: "Duffing 1918; no name in the vocabulary",
    };

    /// Force at a displacement (m) and a speed (m/s), N, and its slope over speed, N s/m.
    #[must_use]
    pub fn force_and_slope(&self, displacement_m: f64, speed_m_s: f64) -> (f64, f64) {
        let of = |number: Option<f64>| number.unwrap_or(0.0);
        let (x, v) = (displacement_m, speed_m_s);
        let (c, d, e) = (
            of(self.viscous_n_s_m),
            of(self.turbulent_n_s2_m2),
            of(self.one_sided_n_s_m),
        );
        let direction = if v < 0.0 { -1.0 } else { 1.0 };
        let force = c * v + d * v * v.abs() + e * v.abs() + of(self.cubic_n_m3) * x * x * x;
        (force, c + 2.0 * d * v.abs() + e * direction)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_force_is_that_of_its_equation() {
        let only = |set: fn(&mut UnnamedForces)| {
            let mut forces = UnnamedForces::default();
            set(&mut forces);
            [forces.force_and_slope(0.02, 0.5), forces.force_and_slope(-0.02, -0.5)]
        };
        assert_eq!(only(|f| f.viscous_n_s_m = Some(40.0)), [(20.0, 40.0), (-20.0, 40.0)]);
        assert_eq!(
            only(|f| f.turbulent_n_s2_m2 = Some(40.0)),
            [(10.0, 40.0), (-10.0, 40.0)]
        );
        assert_eq!(only(|f| f.one_sided_n_s_m = Some(40.0)), [(20.0, 40.0), (20.0, -40.0)]);
        let [(compressed, _), (extended, _)] = only(|f| f.cubic_n_m3 = Some(1e6));
        assert!((compressed - 8.0).abs() < 1e-12 && compressed == -extended);
    }
}
