//! Bump and rebound stops: rubber buffers at the ends of travel.
//!
//! `F = k d + c d^3` of the compression `d` beyond the clearance: the linear-plus-cubic form used for progressive
//! buffers, defined for every displacement, so that nothing ends because a table does (the report's program stopped at
//! its bump stops).

use super::effects::BumpStop;

/// Force of the stops at a displacement from the static position, N, compression positive.
#[inline]
#[must_use]
pub fn stop_force_n(stops: &BumpStop, displacement_m: f64) -> f64 {
    let bump = (displacement_m - stops.bump_clearance_m).max(0.0);
    let rebound = (-displacement_m - stops.rebound_clearance_m).max(0.0);
    let force = |d: f64| d * (stops.stiffness_n_m + stops.progression_n_m3 * d * d);
    force(bump) - force(rebound)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn silent_between_odd_beyond() {
        let s = BumpStop {
            bump_clearance_m: 0.05,
            rebound_clearance_m: 0.05,
            stiffness_n_m: 2e5,
            progression_n_m3: 1e8,
        };
        assert_eq!(stop_force_n(&s, 0.05), 0.0);
        assert_eq!(stop_force_n(&s, 0.06), -stop_force_n(&s, -0.06));
        assert!((stop_force_n(&s, 0.06) - (2e3 + 100.0)).abs() < 1e-6);
    }
}
