//! Adds a side slope to a road.

use std::sync::Arc;

use super::Road;

/// Length over which the slope grows from nothing, m.
const GROWS_M: f64 = 30.0;

/// A road on a side slope that begins after `from_m` and grows over 30 m by `3 s^2 - 2 s^3`, as a road is banked.
#[derive(Clone)]
pub struct SideSlope {
    road: Arc<dyn Road>,
    slope: f64,
    from_m: f64,
}

impl SideSlope {
    /// `slope` is rise over run, positive where the left side is the higher one; it begins at the station `from_m`.
    pub fn new(road: Arc<dyn Road>, slope: f64, from_m: f64) -> Self {
        Self { road, slope, from_m }
    }
}

impl Road for SideSlope {
    fn height_m(&self, station_m: f64, lateral_m: f64) -> f64 {
        let s = ((station_m - self.from_m) / GROWS_M).clamp(0.0, 1.0);
        self.road.height_m(station_m, lateral_m) + s * s * (3.0 - 2.0 * s) * self.slope * lateral_m
    }

    fn measured_length_m(&self) -> Option<f64> {
        self.road.measured_length_m()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::road::Flat;

    #[test]
    fn leans_fully_after_thirty_metres() {
        let road = SideSlope::new(Arc::new(Flat), 0.1, 5.0);
        assert_eq!(road.height_m(4.0, 2.0), 0.0);
        assert!((road.height_m(20.0, 2.0) - 0.1).abs() < 1e-12, "half of it half-way");
        assert!((road.height_m(35.0, 2.0) - 0.2).abs() < 1e-12);
        assert!((road.height_m(90.0, -1.0) + 0.1).abs() < 1e-12);
    }
}
