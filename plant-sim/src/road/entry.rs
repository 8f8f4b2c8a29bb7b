//! A smooth start of a road, because a vehicle in equilibrium on level ground must not start at a step.

use super::Road;

/// Length over which a road rises from level ground to its own heights, m.
pub const ENTRY_M: f64 = 5.0;

/// Where, over what length and with how many samples the level of a surface is taken.
const LEVEL_TRACK_M: f64 = 0.75;
const LEVEL_LENGTH_M: f64 = 1.0;
const LEVEL_SAMPLES: u32 = 100;

/// Level ground up to station 0, then the road, its heights blended in over [`ENTRY_M`] by `3 s^2 - 2 s^3`.
///
/// The road's own station 0 lies at [`ENTRY_M`], so that all of a measured file is driven over at its full height; what
/// is blended is the road's continuation before its start.
#[derive(Debug, Clone)]
pub struct EnteredSmoothly<R> {
    road: R,
    datum_m: f64,
}

impl<R: Road> EnteredSmoothly<R> {
    /// Puts level ground before a road.
    pub fn new(road: R) -> Self {
        Self { road, datum_m: 0.0 }
    }

    /// The same for a surface whose own zero is anywhere (a file's may be sea level): the level ground is at its mean height
    /// over the first metre of both wheel tracks. What stands above that is the surface; what lies below it is not a ramp.
    pub fn levelled(road: R) -> Self {
        let tracks_m = [-LEVEL_TRACK_M, LEVEL_TRACK_M];
        let heights = (0..=LEVEL_SAMPLES).flat_map(|i| {
            let station_m = LEVEL_LENGTH_M * f64::from(i) / f64::from(LEVEL_SAMPLES);
            tracks_m.map(|lateral_m| road.height_m(station_m, lateral_m))
        });
        let datum_m = heights.sum::<f64>() / (2.0 * f64::from(LEVEL_SAMPLES + 1));
        Self { road, datum_m }
    }
}

impl<R: Road> Road for EnteredSmoothly<R> {
    #[inline]
    fn height_m(&self, station_m: f64, lateral_m: f64) -> f64 {
        if station_m <= 0.0 {
            return 0.0;
        }
        let height_m = self.road.height_m(station_m - ENTRY_M, lateral_m) - self.datum_m;
        if station_m >= ENTRY_M {
            return height_m;
        }
        let s = station_m / ENTRY_M;
        s * s * (3.0 - 2.0 * s) * height_m
    }

    fn measured_length_m(&self) -> Option<f64> {
        self.road.measured_length_m()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Kerb;
    impl Road for Kerb {
        fn height_m(&self, _station_m: f64, _lateral_m: f64) -> f64 {
            0.1
        }
    }

    #[test]
    fn rises_without_step_or_kink() {
        let road = EnteredSmoothly::new(Kerb);
        assert_eq!(road.height_m(-3.0, 0.0), 0.0);
        assert_eq!(road.height_m(ENTRY_M, 0.0), 0.1);
        let slope = |s: f64| (road.height_m(s + 1e-6, 0.0) - road.height_m(s - 1e-6, 0.0)) / 2e-6;
        assert!(slope(0.0).abs() < 1e-6 && slope(ENTRY_M).abs() < 1e-6);
    }

    #[test]
    fn a_surface_at_any_height_is_entered_level() {
        let road = EnteredSmoothly::levelled(Kerb);
        for station_m in [0.0, 1.0, ENTRY_M, 50.0] {
            assert!(road.height_m(station_m, 0.3).abs() < 1e-12);
        }
    }
}
