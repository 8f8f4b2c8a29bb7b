//! Ride mode or handling mode, by which acceleration dominates.
//!
//! On rough ground the body shakes vertically and hardly turns; in a lane change it is the other way round. With running mean squares over
//! about 1 s (exponentially weighted) of the lateral surrogate `L` and the vertical acceleration `V`:
//!
//! ```text
//!   ride -> handling   L > r_on^2  V   and  L > l_on^2         r_on  1.0, l_on  1.0 m/s2
//!   handling -> ride   L < r_off^2 V   or   L < l_off^2        r_off 0.8, l_off 0.6 m/s2
//! ```
//!
//! Source: the comparison of running RMS values is Els' (*recalled*, see `vehicle.md`); floors and hysteresis are this project's, since on
//! a smooth straight both values are near nothing and their ratio means nothing. Squares are compared: no root is needed.

use crate::configuration::Configuration;
use crate::estimate::Estimate;
use crate::timing::ticks;

/// Shortest stay in handling mode: a lane change has two bends with a moment of no acceleration between.
const HANDLING_DWELL_TICKS: u16 = ticks(1_500);

/// State of the mode decision.
#[derive(Clone, Copy, Debug, Default)]
pub struct RideHandling {
    handling: bool,
    dwell: u16,
}

impl RideHandling {
    /// One tick; whether in handling mode.
    pub fn step(&mut self, c: &Configuration, estimate: &Estimate) -> bool {
        let (lateral, vertical) = (estimate.lateral_mean_square, estimate.vertical_mean_square);
        let [ratio_on, ratio_off] = c.handling_ratio_2;
        let [floor_on, floor_off] = c.handling_floor_2;
        self.dwell = self.dwell.saturating_sub(1);
        if self.handling {
            if (lateral < ratio_off * vertical || lateral < floor_off) && self.dwell == 0 {
                self.handling = false;
            }
        } else if lateral > ratio_on * vertical && lateral > floor_on {
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
    fn lateral_must_dominate_and_be_worth_it() {
        let c = Configuration::defender110();
        for (lateral, vertical, handling) in [
            (0.0, 0.0, false),
            (0.9, 0.1, false),
            (1.1, 0.1, true),
            (3.0, 3.1, false),
            (3.1, 3.0, true),
        ] {
            assert_eq!(
                RideHandling::default().step(&c, &estimate(lateral, vertical)),
                handling,
                "{lateral} {vertical}"
            );
        }
    }

    #[test]
    fn hysteresis_and_dwell() {
        let c = Configuration::defender110();
        let mut mode = RideHandling::default();
        assert!(mode.step(&c, &estimate(2.0, 1.0)));
        // Nothing lateral any more: stays for the dwell.
        for _ in 1..HANDLING_DWELL_TICKS {
            assert!(mode.step(&c, &estimate(0.0, 1.0)));
        }
        assert!(!mode.step(&c, &estimate(0.0, 1.0)));
        // Between the thresholds neither changes.
        assert!(!mode.step(&c, &estimate(0.9, 1.0)));
        mode.step(&c, &estimate(2.0, 1.0));
        for _ in 0..3 * HANDLING_DWELL_TICKS {
            assert!(mode.step(&c, &estimate(0.9, 1.0)));
        }
    }
}
