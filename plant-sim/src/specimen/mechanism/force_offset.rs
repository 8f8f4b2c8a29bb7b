//! A constant force: `F = F_0`.
//!
//! Gravity on an inclined axis, a cable that pulls, or the zero of a load cell or of a motor current. With a single force
//! recorded, these cannot be told apart.

use serde::{Deserialize, Serialize};

use crate::model_file::{Checked, Limit, Range};
use crate::strut::Equation;

/// A constant force.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForceOffset {
    /// Force that is needed at rest, `F_0`, N, of either sign.
    #[serde(rename = "force_N")]
    pub force_n: f64,
}

impl Checked for ForceOffset {
    const LIMITS: &'static [Limit<Self>] = &[Limit::one("force_N", Range::FromTo(-1e9, 1e9), "N", |f| f.force_n)];
}

impl ForceOffset {
    /// Force, the same everywhere and always.
    pub const EQUATION: Equation = Equation {
        text: "F = F_0",
        source: "definition of the recordings",
    };
}
