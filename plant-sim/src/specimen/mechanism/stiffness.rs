//! A stiffness in parallel: `F = k x`.

use serde::{Deserialize, Serialize};

use crate::model_file::{Checked, Limit, Range};
use crate::strut::Equation;

/// A linear spring in parallel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stiffness {
    /// Force over displacement, `k`, N/m; negative for an arrangement that snaps through.
    #[serde(rename = "stiffness_N_m")]
    pub stiffness_n_m: f64,
}

impl Checked for Stiffness {
    const LIMITS: &'static [Limit<Self>] = &[Limit::one("stiffness_N_m", Range::FromTo(-1e12, 1e12), "N/m", |s| {
        s.stiffness_n_m
    })];
}

impl Stiffness {
    /// Force over displacement from the zero of the recording.
    pub const EQUATION: Equation = Equation {
        text: "F = k x",
        source: "Hooke's law",
    };
}
