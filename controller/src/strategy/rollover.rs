//! Roll-over prevention: stiff at once, whatever the running means say.
//!
//! Running means are a second behind. The guard looks at the roll angle relative to the axles extrapolated over the slowest valve's
//! response, together with a lateral surrogate to the same side (a one-sided bump rolls the body without it):
//!
//! ```text
//!   raise     |phi + 0.09 s phi'| > 4.6 deg   and   a_y sign(phi + ...) > 3 m/s2
//!   release   |phi| < 2.3 deg for 0.5 s
//! ```
//!
//! The angles are this project's choice: 4.6 degrees is about half of what the strut travel of 120 mm at 1 m spacing allows.

use crate::configuration::Configuration;
use crate::estimate::Estimate;
use crate::timing::ticks;

/// Slowest valve response (report: 40 to 90 ms).
const HORIZON_S: f32 = 0.09;
const RELEASE_TICKS: u16 = ticks(500);

/// State of the guard.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rollover {
    hold: u16,
}

impl Rollover {
    /// One tick; whether the guard is active.
    pub fn step(&mut self, c: &Configuration, estimate: &Estimate) -> bool {
        let [raise, release] = c.guard_roll_rad;
        let ahead = estimate.roll_rad + HORIZON_S * estimate.roll_rate_rad_s;
        let outward = if ahead < 0.0 {
            -estimate.lateral_acceleration_m_s2
        } else {
            estimate.lateral_acceleration_m_s2
        };
        if ahead.abs() > raise && outward > c.guard_lateral_m_s2 {
            self.hold = RELEASE_TICKS;
        } else if estimate.roll_rad.abs() < release {
            self.hold = self.hold.saturating_sub(1);
        }
        self.hold > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn needs_roll_and_cornering_to_the_same_side_and_lets_go_later() {
        let c = Configuration::defender110();
        let at = |roll_rad, roll_rate_rad_s, lateral_acceleration_m_s2| Estimate {
            roll_rad,
            roll_rate_rad_s,
            lateral_acceleration_m_s2,
            ..Estimate::default()
        };
        for (sign, roll, rate, lateral, active) in [
            (1.0, 0.10, 0.0, 5.0, true),
            (-1.0, 0.10, 0.0, 5.0, true),
            (1.0, 0.10, 0.0, -5.0, false),
            (1.0, 0.10, 0.0, 1.0, false),
            (1.0, 0.02, 0.9, 5.0, true),
            (1.0, 0.02, 0.0, 5.0, false),
        ] {
            let mut guard = Rollover::default();
            assert_eq!(guard.step(&c, &at(sign * roll, sign * rate, sign * lateral)), active);
        }
        let mut guard = Rollover::default();
        guard.step(&c, &at(0.1, 0.0, 5.0));
        assert!(guard.step(&c, &at(0.06, 0.0, 0.0)), "still rolled");
        for _ in 1..RELEASE_TICKS {
            assert!(guard.step(&c, &at(0.01, 0.0, 0.0)));
        }
        assert!(!guard.step(&c, &at(0.01, 0.0, 0.0)));
    }
}
