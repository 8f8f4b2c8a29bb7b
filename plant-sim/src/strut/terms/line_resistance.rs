//! Laminar loss of a line in series with a path: `dp = R Q`.
//!
//! Hagen-Poiseuille: `R = 128 mu l / (pi d^4)`; 1 m of 10 mm has 8e7 Pa s/m3 at 20 mPa s.

use super::equation::Equation;
use serde::{Deserialize, Serialize};

use crate::lanes::Number;
use crate::model_file::{Checked, Limit, Range};
use crate::strut::flow_path::FlowPath;

/// The lines of the paths resist the flow.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LineResistance {
    /// Resistance of path 1, `R`, Pa s/m3; usually up to 1e9.
    #[serde(rename = "resistance_1_Pa_s_m3")]
    pub resistance_1_pa_s_m3: f64,
    /// Resistance of path 2, Pa s/m3.
    #[serde(rename = "resistance_2_Pa_s_m3")]
    pub resistance_2_pa_s_m3: f64,
}

/// Resistance, Pa s/m3.
const RESISTANCE: Range = Range::FromTo(0.0, 1e15);

impl Checked for LineResistance {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("resistance_1_Pa_s_m3", RESISTANCE, "Pa s/m3", |t| {
            t.resistance_1_pa_s_m3
        }),
        Limit::one("resistance_2_Pa_s_m3", RESISTANCE, "Pa s/m3", |t| {
            t.resistance_2_pa_s_m3
        }),
    ];
}

impl LineResistance {
    /// The line of a path.
    #[must_use]
    pub fn line(&self, path: FlowPath) -> LaminarLine {
        LaminarLine {
            resistance_pa_s_m3: path.pick(self.resistance_1_pa_s_m3, self.resistance_2_pa_s_m3),
        }
    }
}

/// The line of one path; without resistance by default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LaminarLine<N = f64> {
    /// Hydraulic resistance of the line, Pa s/m3.
    pub resistance_pa_s_m3: N,
}

/// Drop in series with the path.
pub const EQUATION: Equation = Equation {
    text: "dp = R Q",
    source: "Hagen-Poiseuille",
};

impl<N: Number> LaminarLine<N> {
    /// Pressure drop at a flow, Pa, and its derivative by the flow, Pa s/m3.
    #[inline(always)]
    #[must_use]
    pub fn drop(&self, flow_m3_s: N) -> (N, N) {
        (self.resistance_pa_s_m3 * flow_m3_s, self.resistance_pa_s_m3)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_path_has_its_own_line() {
        let term = LineResistance {
            resistance_1_pa_s_m3: 8e7,
            resistance_2_pa_s_m3: 2e8,
        };
        assert_eq!(term.line(FlowPath::One).drop(1e-3), (8e4, 8e7));
        assert_eq!(term.line(FlowPath::Two).drop(-1e-3), (-2e5, 2e8));
        assert_eq!(LaminarLine::default().drop(1e-3), (0.0, 0.0));
    }
}
