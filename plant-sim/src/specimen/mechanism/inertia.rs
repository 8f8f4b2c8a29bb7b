//! Inertia of a moving part: `F = m d2x/dt2`.

use serde::{Deserialize, Serialize};

use crate::model_file::{Checked, Limit, Range};
use crate::strut::Equation;

/// A mass that moves with the specimen, beside the one that its model has.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Inertia {
    /// Moving mass, `m`, kg; negative where the model believes in too much.
    #[serde(rename = "moving_mass_kg")]
    pub moving_mass_kg: f64,
}

impl Checked for Inertia {
    const LIMITS: &'static [Limit<Self>] = &[Limit::one("moving_mass_kg", Range::FromTo(-1e9, 1e9), "kg", |i| {
        i.moving_mass_kg
    })];
}

impl Inertia {
    /// Force that accelerates the part.
    pub const EQUATION: Equation = Equation {
        text: "F = m d2x/dt2",
        source: "Newton's second law",
    };
}
