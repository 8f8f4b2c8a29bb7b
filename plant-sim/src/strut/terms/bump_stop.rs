//! Rubber buffers at the ends of travel: bump stop and rebound stop.
//!
//! `F = k d + c d^3` of the compression `d` beyond the clearance: the linear-plus-cubic form used for progressive buffers
//! (figures *assumed*). It is defined for every displacement, so that nothing ends because a table does; the report's
//! program stopped at its bump stops.

use super::equation::Equation;
use serde::{Deserialize, Serialize};

use crate::model_file::{Checked, Limit, Range};

/// The travel ends at buffers. Clearances are counted from the static position.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BumpStop {
    /// Free jounce travel, m; usually 0.05 to 0.15.
    pub bump_clearance_m: f64,
    /// Free rebound travel, m, positive; usually 0.05 to 0.15.
    pub rebound_clearance_m: f64,
    /// Linear stiffness, `k`, N/m; usually 1e4 to 2e5.
    #[serde(rename = "stiffness_N_m")]
    pub stiffness_n_m: f64,
    /// Cubic stiffness, `c`, N/m3; usually up to 1e10.
    #[serde(rename = "progression_N_m3")]
    pub progression_n_m3: f64,
}

/// Clearance, m.
const CLEARANCE_M: Range = Range::FromTo(-100.0, 100.0);

impl Checked for BumpStop {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("bump_clearance_m", CLEARANCE_M, "m", |t| t.bump_clearance_m),
        Limit::one("rebound_clearance_m", CLEARANCE_M, "m", |t| t.rebound_clearance_m),
        Limit::one("stiffness_N_m", Range::FromTo(0.0, 1e12), "N/m", |t| t.stiffness_n_m),
        Limit::one("progression_N_m3", Range::FromTo(0.0, 1e18), "N/m3", |t| {
            t.progression_n_m3
        }),
    ];
}

/// Force of one stop; `d` is the travel beyond its clearance.
pub const EQUATION: Equation = Equation {
    text: "F = k d + c d^3",
    source: "linear-plus-cubic form of progressive rubber buffers, assumed",
};

impl BumpStop {
    /// Force of the stops at a displacement (m) from the static position, N, compression positive.
    #[inline]
    #[must_use]
    pub fn force_n(&self, displacement_m: f64) -> f64 {
        let bump = (displacement_m - self.bump_clearance_m).max(0.0);
        let rebound = (-displacement_m - self.rebound_clearance_m).max(0.0);
        let force = |d: f64| d * (self.stiffness_n_m + self.progression_n_m3 * d * d);
        force(bump) - force(rebound)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn silent_between_the_stops_and_odd_beyond_them() {
        let stops = BumpStop {
            bump_clearance_m: 0.05,
            rebound_clearance_m: 0.05,
            stiffness_n_m: 2e5,
            progression_n_m3: 1e8,
        };
        assert_eq!(stops.force_n(0.05), 0.0);
        assert_eq!(stops.force_n(0.06), -stops.force_n(-0.06));
        assert!((stops.force_n(0.06) - (2e3 + 100.0)).abs() < 1e-6);
    }
}
