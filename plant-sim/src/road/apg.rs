//! The report's APG obstacle (section 2.2): a platform 150 mm high and 300 mm wide on top with straight ramps of 11.3
//! degrees up and down, under the wheels of one side or of both.

use oleo_interface::Side;

use super::Road;

/// Height of the platform, m (report).
const HEIGHT_M: f64 = 0.150;
/// Length of its top, m (report).
const TOP_M: f64 = 0.300;
/// tan(11.3 degrees), the slope of the ramps (report): they are 0.7507 m long.
const SLOPE: f64 = 0.1998197176992368;

/// The obstacle on level ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ApgObstacle {
    /// Where the ramp up begins, m.
    pub start_m: f64,
    /// Whose wheels pass over it: those of one side (the report's left), or of both where `None`.
    pub side: Option<Side>,
}

impl ApgObstacle {
    /// From the foot of one ramp to that of the other, m.
    pub fn length_m() -> f64 {
        2.0 * HEIGHT_M / SLOPE + TOP_M
    }
}

impl Road for ApgObstacle {
    fn height_m(&self, station_m: f64, lateral_m: f64) -> f64 {
        let here = match self.side {
            Some(Side::Left) => lateral_m > 0.0,
            Some(Side::Right) => lateral_m < 0.0,
            None => true,
        };
        if !here {
            return 0.0;
        }
        let middle_m = self.start_m + 0.5 * Self::length_m();
        let from_edge_m = 0.5 * Self::length_m() - (station_m - middle_m).abs();
        (SLOPE * from_edge_m).clamp(0.0, HEIGHT_M)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn has_the_report_s_measures() {
        assert!((SLOPE - libm::tan(11.3 * core::f64::consts::PI / 180.0)).abs() < 1e-15);
        let road = ApgObstacle {
            start_m: 10.0,
            side: Some(Side::Left),
        };
        let height = |s: f64| road.height_m(s, 0.743);
        assert_eq!(height(9.99), 0.0);
        assert!((height(10.0 + 0.150 / SLOPE) - 0.150).abs() < 1e-12);
        assert!((height(10.0 + 0.150 / SLOPE + 0.300) - 0.150).abs() < 1e-12);
        assert!((height(10.5) - 0.5 * SLOPE).abs() < 1e-12);
        assert_eq!(height(10.0 + ApgObstacle::length_m() + 1e-9), 0.0);
        assert_eq!(road.height_m(10.9, -0.743), 0.0);
        let both = ApgObstacle {
            start_m: 10.0,
            side: None,
        };
        assert_eq!(both.height_m(10.9, -0.743), both.height_m(10.9, 0.743));
    }
}
