//! Oil that passes beside the damper packs (the report's manufacturing error, 3.5.2).
//!
//! The leak is an orifice in parallel with the pack: `Q = c dp / sqrt(|dp| + p_t)`, the law of
//! [`orifice`](crate::strut::orifice), never closed.

use super::equation::Equation;
use serde::{Deserialize, Serialize};

use crate::model_file::{Checked, Limit, Range};
use crate::strut::flow_path::FlowPath;

/// The damper packs leak.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DamperLeakage {
    /// Flow coefficient beside pack 1, `c`, m3/s/sqrt(Pa); usually 1e-8 to 1e-6.
    pub flow_coefficient_1: f64,
    /// Flow coefficient beside pack 2, m3/s/sqrt(Pa).
    pub flow_coefficient_2: f64,
}

/// Flow coefficient, m3/s/sqrt(Pa).
const COEFFICIENT: Range = Range::FromTo(0.0, 1.0);

impl Checked for DamperLeakage {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("flow_coefficient_1", COEFFICIENT, "m3/s/sqrt(Pa)", |t| {
            t.flow_coefficient_1
        }),
        Limit::one("flow_coefficient_2", COEFFICIENT, "m3/s/sqrt(Pa)", |t| {
            t.flow_coefficient_2
        }),
    ];
}

/// Flow beside the pack.
pub const EQUATION: Equation = Equation {
    text: "Q = c dp / sqrt(|dp| + p_t)",
    source: "Theron & Els, final report 2002, section 3.5.2",
};

impl DamperLeakage {
    /// Flow coefficient beside the pack of a path, m3/s/sqrt(Pa).
    #[must_use]
    pub fn flow_coefficient(&self, path: FlowPath) -> f64 {
        path.pick(self.flow_coefficient_1, self.flow_coefficient_2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strut::orifice::unit_flow;

    #[test]
    fn leaks_by_the_square_root_law_far_above_the_transition() {
        let leak = DamperLeakage {
            flow_coefficient_1: 4e-8,
            flow_coefficient_2: 0.0,
        };
        let flow = |path| leak.flow_coefficient(path) * unit_flow(1e8, 2e4).0;
        assert!((flow(FlowPath::One) / (4e-8 * 1e4) - 1.0).abs() < 2e-4);
        assert_eq!(flow(FlowPath::Two), 0.0);
    }
}
