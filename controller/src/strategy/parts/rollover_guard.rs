//! Roll-over prevention: everything stiff at once, whatever the running means say.
//!
//! The running means are a second behind. The guard looks at the roll angle relative to the axles, extrapolated over the slowest
//! valve's response, and requires a lateral acceleration to the same side, because a one-sided bump also rolls the body:
//!
//! ```text
//!   raise     |phi + 0.09 s phi'| > 4.6 deg   and   a_y sign(phi + ...) > 3 m/s2
//!   release   |phi| < 2.3 deg for 0.5 s
//! ```
//!
//! The angles are this project's choice: 4.6 degrees is about half of what the strut travel of 120 mm at 1 m spacing allows.

use crate::estimate::Estimate;
use crate::range::{ConfigurationError, Hysteresis, within};
use crate::timing::ticks;

/// Slowest valve response (report: 40 to 90 ms).
const HORIZON_S: f32 = 0.09;
const RELEASE_TICKS: u16 = ticks(500);

/// Thresholds of the guard. See [`strategy::Tuning`](crate::strategy::Tuning) for an example.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuning {
    /// Predicted roll angle relative to the axles above which the guard acts, and roll angle below which it lets go, rad,
    /// 0.005 to 1.
    pub roll_rad: Hysteresis,
    /// Estimated lateral acceleration to the same side above which the guard acts, m/s2, 0.5 to 10.
    pub lateral_m_s2: f32,
}

impl Default for Tuning {
    fn default() -> Self {
        Self {
            roll_rad: Hysteresis { begin: 0.08, end: 0.04 }, // assumed: 4.6 and 2.3 degrees relative to the axles
            lateral_m_s2: 3.0,                               // assumed
        }
    }
}

impl Tuning {
    /// Whether every value is within its range; the names are those of the roll angle and of the lateral acceleration in the
    /// strategy that has the guard.
    pub(crate) fn check(&self, [roll, lateral]: [&'static str; 2]) -> Result<(), ConfigurationError> {
        self.roll_rad.check(roll, 0.005, 1.0)?;
        within(lateral, self.lateral_m_s2, 0.5, 10.0)
    }
}

/// State of the guard.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct State {
    hold: u16,
}

impl State {
    pub const INITIAL: Self = Self { hold: 0 };

    /// One tick; returns whether the guard is active.
    pub fn step(&mut self, tuning: &Tuning, estimate: &Estimate) -> bool {
        let ahead = estimate.roll_rad + HORIZON_S * estimate.roll_rate_rad_s;
        let outward = if ahead < 0.0 {
            -estimate.lateral.acceleration_m_s2.slow
        } else {
            estimate.lateral.acceleration_m_s2.slow
        };
        if ahead.abs() > tuning.roll_rad.begin && outward > tuning.lateral_m_s2 {
            self.hold = RELEASE_TICKS;
        } else if estimate.roll_rad.abs() < tuning.roll_rad.end {
            self.hold = self.hold.saturating_sub(1);
        }
        self.hold > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lateral::{Bands, Lateral};

    #[test]
    fn needs_roll_and_cornering_to_the_same_side_and_lets_go_later() {
        let tuning = Tuning::default();
        let at = |roll_rad, roll_rate_rad_s, quick| Estimate {
            roll_rad,
            roll_rate_rad_s,
            lateral: Lateral {
                acceleration_m_s2: Bands { quick, slow: quick },
                ..Lateral::default()
            },
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
            let mut guard = State::INITIAL;
            assert_eq!(
                guard.step(&tuning, &at(sign * roll, sign * rate, sign * lateral)),
                active
            );
        }
        let mut guard = State::INITIAL;
        guard.step(&tuning, &at(0.1, 0.0, 5.0));
        assert!(guard.step(&tuning, &at(0.06, 0.0, 0.0)), "still rolled");
        for _ in 1..RELEASE_TICKS {
            assert!(guard.step(&tuning, &at(0.01, 0.0, 0.0)));
        }
        assert!(!guard.step(&tuning, &at(0.01, 0.0, 0.0)));
    }
}
