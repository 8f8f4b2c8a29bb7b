//! Adds parallel lanes to a surface that is known only under one vehicle.
//!
//! Synthesised roads and files have two wheel tracks or a strip of a few metres. A vehicle that changes lanes leaves them, and
//! with heights that are constant outside both of its sides would roll over the same track. Here every lane has a pair of
//! tracks of its own: the surface itself, further along.

use super::{HALF_TRACK_M, Road};

/// Width of a lane, m: about the offset of both lane changes of ISO 3888, and the width of a rural road's lane.
pub const LANE_M: f64 = 3.5;
/// How much further along the next lane to the left shows the surface, m. Not near a simple fraction of the periods in use.
const FURTHER_M: f64 = 37.37;
/// What a wheel needs beside its track, m: sideways motion of the axle, and half the base of the slope.
const BESIDE_M: f64 = 0.25;

/// Lanes of [`LANE_M`] beside each other. Inside a lane the surface as it is; between the lanes, heights from one to the next
/// by a straight line.
#[derive(Debug, Clone)]
pub struct Lanes<R> {
    surface: R,
    half_width_m: f64,
}

impl<R: Road> Lanes<R> {
    /// Lanes of a surface that is known for `half_width_m` to either side. At least the wheels' tracks are shown, at most a lane
    /// less a strip of 0.25 m on either side.
    pub fn new(surface: R, half_width_m: f64) -> Self {
        let least = HALF_TRACK_M + BESIDE_M;
        Self {
            surface,
            half_width_m: half_width_m.clamp(least, 0.5 * LANE_M - BESIDE_M),
        }
    }
}

impl<R: Road> Road for Lanes<R> {
    #[inline]
    fn height_m(&self, station_m: f64, lateral_m: f64) -> f64 {
        let half = self.half_width_m;
        // The lane below most wheels, without a division.
        if lateral_m.abs() <= half {
            return self.surface.height_m(station_m, lateral_m);
        }
        let lane = (lateral_m / LANE_M).round();
        let inside = lateral_m - lane * LANE_M;
        let at = |lane: f64, place: f64| self.surface.height_m(station_m + lane * FURTHER_M, place);
        if inside.abs() <= half {
            return at(lane, inside);
        }
        let side = 1.0f64.copysign(inside);
        let share = (inside.abs() - half) / (LANE_M - 2.0 * half);
        (1.0 - share) * at(lane, side * half) + share * at(lane + side, -side * half)
    }

    fn measured_length_m(&self) -> Option<f64> {
        self.surface.measured_length_m()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Waves;
    impl Road for Waves {
        fn height_m(&self, station_m: f64, lateral_m: f64) -> f64 {
            libm::sin(0.3 * station_m) * lateral_m.clamp(-HALF_TRACK_M, HALF_TRACK_M)
        }
    }

    #[test]
    fn the_first_lane_is_the_surface_itself() {
        let road = Lanes::new(Waves, HALF_TRACK_M);
        for (station, lateral) in [(3.0, 0.743), (17.3, -0.9), (-4.0, 0.1)] {
            assert_eq!(road.height_m(station, lateral), Waves.height_m(station, lateral));
        }
    }

    #[test]
    fn every_lane_has_left_and_right_and_joins_the_next() {
        let road = Lanes::new(Waves, HALF_TRACK_M);
        for lane in [-2.0, -1.0, 1.0, 5.0] {
            let left = road.height_m(10.0, lane * LANE_M + HALF_TRACK_M);
            let expected = Waves.height_m(10.0 + lane * FURTHER_M, HALF_TRACK_M);
            assert!((left - expected).abs() < 1e-12);
            assert!((road.height_m(10.0, lane * LANE_M - HALF_TRACK_M) + expected).abs() < 1e-12);
        }
        let mut last = road.height_m(10.0, -20.0);
        for i in 1..40_000 {
            let height = road.height_m(10.0, -20.0 + 0.001 * f64::from(i));
            assert!(
                (height - last).abs() < 0.0025,
                "a step at {}",
                -20.0 + 0.001 * f64::from(i)
            );
            last = height;
        }
    }
}
