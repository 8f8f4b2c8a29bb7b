//! A smooth start: a vehicle in equilibrium on level ground must not begin with a kerb.

use super::Road;

/// Length over which a road rises from level ground to its own heights, m.
pub const ENTRY_M: f64 = 5.0;

/// Level ground up to station 0, then the road, its heights blended in over [`ENTRY_M`] by `3 s^2 - 2 s^3`.
///
/// The road's own station 0 lies at [`ENTRY_M`], so that all of a measured file is driven over at its full height; what
/// is blended is the road's continuation before its start.
#[derive(Debug, Clone)]
pub struct EnteredSmoothly<R> {
    road: R,
}

impl<R: Road> EnteredSmoothly<R> {
    /// Puts level ground before a road.
    pub fn new(road: R) -> Self {
        Self { road }
    }
}

impl<R: Road> Road for EnteredSmoothly<R> {
    #[inline]
    fn height_m(&self, station_m: f64, lateral_m: f64) -> f64 {
        if station_m <= 0.0 {
            return 0.0;
        }
        let height_m = self.road.height_m(station_m - ENTRY_M, lateral_m);
        if station_m >= ENTRY_M {
            return height_m;
        }
        let s = station_m / ENTRY_M;
        s * s * (3.0 - 2.0 * s) * height_m
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
}
