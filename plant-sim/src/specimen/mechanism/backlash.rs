//! Backlash: a part that follows another only beyond a gap of the width `b`.
//!
//! The play operator: what is behind the gap stays where it is until the part in front touches one of its sides.

use serde::{Deserialize, Serialize};

use crate::model_file::{Checked, Limit, Range};
use crate::strut::Equation;

/// A gap in a joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Backlash {
    /// Width of the gap from side to side, `b`, m, 0 or more.
    #[serde(rename = "gap_m")]
    pub gap_m: f64,
}

impl Checked for Backlash {
    const LIMITS: &'static [Limit<Self>] = &[Limit::one("gap_m", Range::FromTo(0.0, 10.0), "m", |b| b.gap_m)];
}

impl Backlash {
    /// Position behind the gap, `y`, of a part in front of it at `x`.
    pub const EQUATION: Equation = Equation {
        text: "y = min(max(y, x - b/2), x + b/2)",
        source: "Krasnosel'skii & Pokrovskii, Systems with Hysteresis, 1989 (play operator)",
    };

    /// Position behind the gap, from what it was before and the position in front; all in m.
    #[must_use]
    pub fn behind_m(&self, before_m: f64, front_m: f64) -> f64 {
        let half = 0.5 * self.gap_m;
        before_m.max(front_m - half).min(front_m + half)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reversal_is_followed_after_the_gap() {
        let gap = Backlash { gap_m: 0.002 };
        let mut behind = 0.0;
        let mut follow = |front: f64| {
            behind = gap.behind_m(behind, front);
            behind
        };
        assert_eq!(follow(0.0005), 0.0);
        assert!((follow(0.010) - 0.009).abs() < 1e-15);
        // Back by less than the gap nothing follows; back by more it follows by the rest.
        assert!((follow(0.0085) - 0.009).abs() < 1e-15);
        assert!((follow(0.007) - 0.008).abs() < 1e-15);
    }
}
