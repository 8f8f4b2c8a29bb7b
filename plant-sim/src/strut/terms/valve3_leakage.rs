//! The closed valve 3 passes oil.
//!
//! The leak is an orifice in parallel with the valve: `Q = c dp / sqrt(|dp| + p_t)`, the law of
//! [`orifice`](crate::strut::orifice), never closed (report, 3.5.2).

use super::equation::Equation;
use serde::{Deserialize, Serialize};

use crate::model_file::{Checked, Limit, Range};

/// Leakage through the closed valve 3.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Valve3Leakage {
    /// Flow coefficient, `c`, m3/s/sqrt(Pa); usually 1e-10 to 1e-8.
    pub flow_coefficient: f64,
}

impl Checked for Valve3Leakage {
    const LIMITS: &'static [Limit<Self>] = &[Limit::one(
        "flow_coefficient",
        Range::FromTo(0.0, 1.0),
        "m3/s/sqrt(Pa)",
        |t| t.flow_coefficient,
    )];
}

/// Flow through the closed valve.
pub const EQUATION: Equation = Equation {
    text: "Q = c dp / sqrt(|dp| + p_t)",
    source: "Theron & Els, final report 2002, section 3.5.2",
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strut::orifice::{unit_drop, unit_flow};

    #[test]
    fn a_leak_passes_what_the_orifice_law_says() {
        let leak = Valve3Leakage { flow_coefficient: 2e-9 };
        let flow = leak.flow_coefficient * unit_flow(3e6, 2e4).0;
        assert!((flow - 2e-9 * 3e6 / 3.02e6_f64.sqrt()).abs() < 1e-18);
        assert!((unit_drop(flow / leak.flow_coefficient, 2e4).0 / 3e6 - 1.0).abs() < 1e-9);
    }
}
