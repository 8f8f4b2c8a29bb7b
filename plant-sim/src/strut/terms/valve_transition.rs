//! The valves open and close gradually, not in a step.
//!
//! The opening is the straight line through the points of 5 % and 95 % of its movement (report, 3.6 asks for it; recordings
//! README), `u = 0.05 + 0.9 (t - t_05) / (t_95 - t_05)` with `0 <= u <= 1`. Without this term a valve moves in a step at its total response time.

use super::equation::Equation;
use serde::{Deserialize, Serialize};

use crate::model_file::{Checked, Limit};

/// How a valve moves between the 5 % and the 95 % point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TransitionShape {
    /// A straight line through the two points.
    Linear,
}

/// The valves move gradually.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ValveTransition {
    /// Shape of the movement.
    pub shape: TransitionShape,
}

impl Checked for ValveTransition {
    const LIMITS: &'static [Limit<Self>] = &[];
}

/// Opening `u` between the times `t_05` and `t_95` at which 5 % and 95 % of the movement are reached.
pub const EQUATION: Equation = Equation {
    text: "u = 0.05 + 0.9 (t - t_05) / (t_95 - t_05), 0 <= u <= 1",
    source: "Theron & Els, final report 2002, section 3.6",
};

impl ValveTransition {
    /// Times at which a movement begins and ends that passes 5 % at `early_s` and 95 % at `late_s`, s on the same clock as
    /// `edge_s`, the edge from which both are counted.
    #[must_use]
    pub fn movement_s(&self, edge_s: f64, early_s: f64, late_s: f64) -> (f64, f64) {
        match self.shape {
            TransitionShape::Linear => {
                let beyond = (late_s - early_s) * (0.05 / 0.9);
                (edge_s + early_s - beyond, edge_s + late_s + beyond)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_passes_the_two_points() {
        let linear = ValveTransition {
            shape: TransitionShape::Linear,
        };
        let (begins, ends) = linear.movement_s(1.0, 0.02, 0.05);
        let opening = |t: f64| (t - begins) / (ends - begins);
        assert!((opening(1.02) - 0.05).abs() < 1e-12 && (opening(1.05) - 0.95).abs() < 1e-12);
    }
}
