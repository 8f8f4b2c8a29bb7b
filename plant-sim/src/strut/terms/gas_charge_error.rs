//! A gas charge outside its tolerance: the gas volume at static pressure is not what the model says.
//!
//! `V_static = V_nominal (1 + e)` (recordings README).

use super::equation::Equation;
use serde::{Deserialize, Serialize};

use crate::model_file::{Checked, Limit, Range};
use crate::strut::flow_path::FlowPath;

/// The accumulators hold more or less gas than the model says.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GasChargeError {
    /// Relative error of the gas volume of accumulator 1, `e`; usually -0.3 to 0.3.
    pub relative_error_1: f64,
    /// Relative error of the gas volume of accumulator 2.
    pub relative_error_2: f64,
}

const RELATIVE_ERROR: Range = Range::FromTo(-0.99, 100.0);

impl Checked for GasChargeError {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("relative_error_1", RELATIVE_ERROR, "", |t| t.relative_error_1),
        Limit::one("relative_error_2", RELATIVE_ERROR, "", |t| t.relative_error_2),
    ];
}

/// Gas volume at static pressure.
pub const EQUATION: Equation = Equation {
    text: "V_static = V_nominal (1 + e)",
    source: "definition of the recordings",
};

impl GasChargeError {
    /// Relative error of the gas volume of the accumulator at the end of a path.
    #[must_use]
    pub fn relative_error(&self, path: FlowPath) -> f64 {
        path.pick(self.relative_error_1, self.relative_error_2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_accumulator_has_its_own_error_and_none_loses_all_its_gas() {
        let mut term = GasChargeError {
            relative_error_1: -0.1,
            relative_error_2: 0.2,
        };
        assert_eq!(FlowPath::ALL.map(|path| term.relative_error(path)), [-0.1, 0.2]);
        term.relative_error_2 = -1.0;
        assert!(
            term.check()
                .unwrap_err()
                .to_string()
                .starts_with("relative_error_2 is -1: ")
        );
    }
}
