//! Mass of the oil column of line 2: `dp = I dQ/dt` with `I = rho l / a` (Newton's law for the column).
//!
//! 1 m of 10 mm has 1.1e7 kg/m4.

use super::equation::Equation;
use serde::{Deserialize, Serialize};

use crate::lanes::Number;
use crate::model_file::{Checked, Limit, Range};

/// The oil column of line 2 has mass.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LineInertance {
    /// Inertance of path 2, `I`, kg/m4; usually 1e6 to 1e8.
    pub inertance_2_kg_m4: f64,
}

impl Checked for LineInertance {
    const LIMITS: &'static [Limit<Self>] = &[Limit::one(
        "inertance_2_kg_m4",
        Range::FromTo(0.0, 1e14),
        "kg/m4",
        |t| t.inertance_2_kg_m4,
    )];
}

/// Drop in series with the path.
pub const EQUATION: Equation = Equation {
    text: "dp = I dQ/dt, I = rho l / a",
    source: "Newton's law for the oil column",
};

/// An oil column during one implicit step: `dp = (I / h) (Q - Q_before)`.
#[derive(Debug, Clone, Copy)]
pub(in crate::strut) struct OilColumn<N> {
    /// Derivative of the drop by the flow, `I / h`, Pa s/m3.
    pub slope: N,
}

impl<N: Number> OilColumn<N> {
    /// A column of an inertance (kg/m4, 0 for none) during a step; `inverse_duration` is one over its length, 1/s.
    #[inline(always)]
    pub fn during(inertance_kg_m4: N, inverse_duration: N) -> Self {
        Self {
            slope: inertance_kg_m4 * inverse_duration,
        }
    }

    /// Pressure drop that changes the flow from the one to the other within the step, Pa.
    #[inline(always)]
    pub fn drop(self, before_m3_s: N, after_m3_s: N) -> N {
        self.slope * (after_m3_s - before_m3_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn accelerates_by_newtons_law() {
        // 1 m of 10 mm, oil of 870 kg/m3: 1e-3 m3/s gained in 2 ms needs I dQ/dt.
        let inertance = 870.0 * 1.0 / (0.25 * std::f64::consts::PI * 1e-4);
        let column = OilColumn::during(inertance, 1.0 / 2e-3);
        assert!((column.drop(1e-4, 1.1e-3) / (inertance * 0.5) - 1.0).abs() < 1e-12);
        assert_eq!(column.drop(1e-4, 1e-4), 0.0);
    }
}
