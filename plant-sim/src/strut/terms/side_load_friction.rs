//! Friction of the guides that carry the bending moment of an offset mounting.
//!
//! The guides slide at `g = mu |F| / (1 + s x)` (report, 3.5.1): the moment grows with the strut force `F`, and the guides
//! carry it over their overlap, which grows with jounce. `1/s` is the overlap at static position.

use super::equation::Equation;
use serde::{Deserialize, Serialize};

use crate::lanes::Number;
use crate::model_file::{Checked, Limit, Range};

/// The guides rub in proportion to the strut force.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SideLoadFriction {
    /// Friction force over strut force at static position, `mu`; usually 0 to 0.1.
    pub coefficient: f64,
    /// Relative growth of the guides' overlap with displacement, `s`, 1/m; usually 0 to 5, 0 for a constant overlap.
    #[serde(default)]
    pub overlap_growth_1_m: f64,
}

impl Checked for SideLoadFriction {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("coefficient", Range::FromTo(0.0, 10.0), "", |t| t.coefficient),
        Limit::one("overlap_growth_1_m", Range::FromTo(-1e3, 1e3), "1/m", |t| {
            t.overlap_growth_1_m
        }),
    ];
}

/// Force at which the guides slide.
pub const EQUATION: Equation = Equation {
    text: "g = mu |F| / (1 + s x)",
    source: "Theron & Els, final report 2002, section 3.5.1",
};

/// The overlap of the guides never falls below this fraction of the one at static position.
const LEAST_OVERLAP: f64 = 0.1;

impl SideLoadFriction {
    /// Force at which the guides slide, as the solver uses it.
    #[must_use]
    pub(in crate::strut) fn level(&self) -> GuideLevel {
        GuideLevel {
            coefficient: self.coefficient,
            overlap_growth_1_m: self.overlap_growth_1_m,
        }
    }

    /// Force at which the guides slide, N, under a strut force (N) at a displacement (m).
    #[inline]
    #[must_use]
    pub fn level_n(&self, strut_force_n: f64, displacement_m: f64) -> f64 {
        self.level().at_n(strut_force_n, displacement_m)
    }
}

/// Force at which guides slide, of one strut or of several side by side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::strut) struct GuideLevel<N = f64> {
    /// Friction force over strut force at static position.
    pub coefficient: N,
    /// Relative growth of the guides' overlap with displacement, 1/m.
    pub overlap_growth_1_m: N,
}

impl<N: Number> GuideLevel<N> {
    /// Force at which the guides slide, N, under a strut force (N) at a displacement (m).
    #[inline(always)]
    #[must_use]
    pub fn at_n(&self, strut_force_n: N, displacement_m: N) -> N {
        let overlap = self.overlap_growth_1_m * displacement_m + 1.0;
        self.coefficient * strut_force_n.abs() / overlap.at_least(overlap.of(LEAST_OVERLAP))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grows_with_the_strut_force_and_shrinks_with_the_overlap() {
        let side = SideLoadFriction {
            coefficient: 0.02,
            overlap_growth_1_m: 2.5,
        };
        assert!((side.level_n(8000.0, 0.0) - 160.0).abs() < 1e-9);
        assert!((side.level_n(-8000.0, 0.1) - 128.0).abs() < 1e-9);
        assert_eq!(
            side.level_n(8000.0, -10.0),
            1600.0,
            "the overlap never falls below a tenth"
        );
    }
}
