//! Ride mode or handling mode, by which acceleration is larger.
//!
//! On rough ground the body shakes vertically and hardly turns; in a lane change it is the other way round. With running
//! mean squares over about 1 s (exponentially weighted) of the lateral surrogate `L` and the vertical acceleration `V`:
//!
//! ```text
//!   ride -> handling   L > r_on^2  V   and  L > l_on^2         r_on  1.0, l_on  1.0 m/s2
//!   handling -> ride   L < r_off^2 V   or   L < l_off^2        r_off 0.8, l_off 0.6 m/s2
//! ```
//!
//! Source: the comparison of running RMS values is Els' (*recalled*, see `vehicle.md`); floors and hysteresis are this
//! project's, because on a smooth straight both values are near zero and their ratio means nothing. Squares are compared, so
//! that no root is needed.

use crate::estimate::Estimate;
use crate::range::{ConfigurationError, Hysteresis};
use crate::timing::ticks;

/// Shortest stay in handling mode: a lane change has two bends, and between them a moment without lateral acceleration.
const HANDLING_DWELL_TICKS: u16 = ticks(1_500);

/// Thresholds of the decision. See [`strategy::Tuning`](crate::strategy::Tuning) for an example.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuning {
    /// Lateral over vertical running RMS at which handling mode begins and ends, 0.05 to 20.
    pub ratio: Hysteresis,
    /// Lateral running RMS that handling mode needs to begin, and below which it ends, m/s2, 0.05 to 10.
    pub floor_m_s2: Hysteresis,
}

impl Default for Tuning {
    fn default() -> Self {
        Self {
            ratio: Hysteresis { begin: 1.0, end: 0.8 }, // recalled: Els switches at equality; hysteresis assumed
            floor_m_s2: Hysteresis { begin: 1.0, end: 0.6 }, // assumed: on a smooth straight both are near zero
        }
    }
}

impl Tuning {
    /// Whether every value is within its range.
    pub(crate) fn check(&self) -> Result<(), ConfigurationError> {
        self.ratio
            .check("tuning.strategy.ride_handling.running_rms.ratio", 0.05, 20.0)?;
        self.floor_m_s2
            .check("tuning.strategy.ride_handling.running_rms.floor_m_s2", 0.05, 10.0)
    }
}

/// The thresholds, squared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Parameters {
    ratio_2: Hysteresis,
    floor_2: Hysteresis,
}

impl Parameters {
    /// From a tuning that has been checked.
    pub(crate) fn new(tuning: &Tuning) -> Self {
        Self {
            ratio_2: tuning.ratio.squared(),
            floor_2: tuning.floor_m_s2.squared(),
        }
    }
}

/// State of the mode decision.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct State {
    handling: bool,
    dwell: u16,
}

impl State {
    pub const INITIAL: Self = Self {
        handling: false,
        dwell: 0,
    };

    /// One tick; returns whether the vehicle is in handling mode.
    pub fn step(&mut self, parameters: &Parameters, estimate: &Estimate) -> bool {
        let (lateral, vertical) = (estimate.lateral_mean_square, estimate.vertical_mean_square);
        let Parameters { ratio_2, floor_2 } = parameters;
        self.dwell = self.dwell.saturating_sub(1);
        if self.handling {
            if (lateral < ratio_2.end * vertical || lateral < floor_2.end) && self.dwell == 0 {
                self.handling = false;
            }
        } else if lateral > ratio_2.begin * vertical && lateral > floor_2.begin {
            self.handling = true;
            self.dwell = HANDLING_DWELL_TICKS;
        }
        self.handling
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn estimate(lateral_rms: f32, vertical_rms: f32) -> Estimate {
        Estimate {
            lateral_mean_square: lateral_rms * lateral_rms,
            vertical_mean_square: vertical_rms * vertical_rms,
            ..Estimate::default()
        }
    }

    #[test]
    fn lateral_must_dominate_and_exceed_its_floor() {
        let parameters = Parameters::new(&Tuning::default());
        for (lateral, vertical, handling) in [
            (0.0, 0.0, false),
            (0.9, 0.1, false),
            (1.1, 0.1, true),
            (3.0, 3.1, false),
            (3.1, 3.0, true),
        ] {
            assert_eq!(
                { State::INITIAL }.step(&parameters, &estimate(lateral, vertical)),
                handling,
                "{lateral} {vertical}"
            );
        }
    }

    #[test]
    fn hysteresis_and_dwell() {
        let parameters = Parameters::new(&Tuning::default());
        let mut mode = State::INITIAL;
        assert!(mode.step(&parameters, &estimate(2.0, 1.0)));
        // Nothing lateral any more: stays for the dwell.
        for _ in 1..HANDLING_DWELL_TICKS {
            assert!(mode.step(&parameters, &estimate(0.0, 1.0)));
        }
        assert!(!mode.step(&parameters, &estimate(0.0, 1.0)));
        // Between the thresholds neither changes.
        assert!(!mode.step(&parameters, &estimate(0.9, 1.0)));
        mode.step(&parameters, &estimate(2.0, 1.0));
        for _ in 0..3 * HANDLING_DWELL_TICKS {
            assert!(mode.step(&parameters, &estimate(0.9, 1.0)));
        }
    }

    /// Either threshold ends the mode by itself: 0.8 of the vertical RMS, and 0.6 m/s2.
    #[test]
    fn either_threshold_ends_the_mode() {
        let parameters = Parameters::new(&Tuning::default());
        for (lateral, vertical, stays) in [
            (2.0, 2.4, true),
            (2.0, 2.6, false),
            (0.65, 0.1, true),
            (0.55, 0.1, false),
        ] {
            let mut mode = State {
                handling: true,
                dwell: 0,
            };
            assert_eq!(
                mode.step(&parameters, &estimate(lateral, vertical)),
                stays,
                "{lateral}, {vertical} m/s2"
            );
        }
    }
}
