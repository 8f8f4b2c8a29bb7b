//! A road that follows a circle.

use core::f64::consts::{PI, TAU};
use std::sync::Arc;

use super::Road;

/// Before the start line the road goes down to level ground over this length, m, so that a second lap has no step.
const ENDS_M: f64 = 5.0;

/// A road whose stations run along a circle through the origin, tangent to x there. Every lap is over the same surface.
#[derive(Clone)]
pub struct Bend {
    road: Arc<dyn Road>,
    radius_m: f64,
}

impl Bend {
    /// `radius_m` is positive to the left. The road must be level at station 0, as all roads of
    /// [`from_name_or_path`](super::from_name_or_path) are.
    pub fn new(road: Arc<dyn Road>, radius_m: f64) -> Self {
        Self { road, radius_m }
    }
}

impl Road for Bend {
    fn height_m(&self, x_m: f64, y_m: f64) -> f64 {
        let (side, radius_m) = (1.0f64.copysign(self.radius_m), self.radius_m.abs());
        let to_centre_m = radius_m - side * y_m;
        // From the start line, in the sense of driving: the wheels just behind it are at the end of a lap.
        let angle = libm::atan2(x_m, to_centre_m);
        let angle = if angle < 0.0 { angle + TAU } else { angle };
        let station_m = radius_m * angle;
        let lateral_m = side * (radius_m - libm::hypot(x_m, to_centre_m));
        let height_m = self.road.height_m(station_m, lateral_m);
        let left_m = 2.0 * PI * radius_m - station_m;
        if left_m >= ENDS_M {
            return height_m;
        }
        let s = left_m / ENDS_M;
        s * s * (3.0 - 2.0 * s) * height_m
    }

    fn measured_length_m(&self) -> Option<f64> {
        self.road.measured_length_m()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Known;
    impl Road for Known {
        fn height_m(&self, station_m: f64, lateral_m: f64) -> f64 {
            if station_m <= 0.0 {
                0.0
            } else {
                0.01 * station_m + lateral_m
            }
        }
    }

    #[test]
    fn stations_run_along_the_circle() {
        for radius in [40.0, -40.0f64] {
            let road = Bend::new(Arc::new(Known), radius);
            let quarter = road.height_m(40.0, radius);
            assert!((quarter - 0.01 * 0.5 * PI * 40.0).abs() < 1e-9, "{quarter}");
            let outside = road.height_m(41.0, radius);
            assert!(
                (outside - quarter + 1.0f64.copysign(radius)).abs() < 1e-9,
                "the outside is right of a left bend"
            );
            let three = road.height_m(-40.0, radius);
            assert!((three - 0.01 * 1.5 * PI * 40.0).abs() < 1e-9);
        }
    }

    #[test]
    fn the_start_line_is_level_from_both_sides() {
        let road = Bend::new(Arc::new(Known), 40.0);
        assert!(road.height_m(-1e-6, 0.0).abs() < 1e-6 && road.height_m(1e-6, 0.0).abs() < 1e-6);
    }
}
