//! A road with a height of its own under each wheel: each place takes that of the wheel in whose quarter of the vehicle it is.
//!
//! The vehicle holds its road as something that does not change, so that what changes is in atomic numbers. One instance is used by one thread at a time, so
//! that their order does not matter.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use oleo_interface::{Axle, Corners, Side};
use oleo_plant_sim::handling::HandlingVehicle;
use oleo_plant_sim::road::Road;

/// A road and the heights that are added to it.
pub struct RaisedRoad {
    base: Arc<dyn Road>,
    /// Middle between the axles, ahead of the centre of mass, m.
    middle_m: f64,
    /// Place of the centre of mass, and cosine and sine of the heading.
    pose: [AtomicU64; 4],
    height_m: Corners<AtomicU64>,
}

fn read(number: &AtomicU64) -> f64 {
    f64::from_bits(number.load(Ordering::Relaxed))
}

fn write(place: &AtomicU64, number: f64) {
    place.store(number.to_bits(), Ordering::Relaxed);
}

impl RaisedRoad {
    /// `station_m` is where the centre of mass is at the start, straight ahead; `middle_m` how far the middle between the axles is ahead of it.
    pub fn on(base: Arc<dyn Road>, station_m: f64, middle_m: f64) -> Self {
        Self {
            base,
            middle_m,
            pose: [station_m, 0.0, 1.0, 0.0].map(|number| AtomicU64::new(number.to_bits())),
            height_m: Corners::from_fn(|_| AtomicU64::new(0)),
        }
    }

    /// Takes other heights, m.
    pub fn raise(&self, heights_m: Corners<f64>) {
        for (corner, height_m) in self.height_m.iter() {
            write(height_m, heights_m[corner]);
        }
    }

    /// Takes the vehicle's place and heading.
    pub fn follow(&self, model: &HandlingVehicle) {
        if self.height_m.iter().all(|(_, height_m)| read(height_m) == 0.0) {
            return;
        }
        let motion = model.motion();
        let [x, y, _] = motion.position_m;
        let (sin, cos) = libm::sincos(motion.yaw_rad);
        for (place, number) in self.pose.iter().zip([x, y, cos, sin]) {
            write(place, number);
        }
    }
}

impl Road for RaisedRoad {
    fn height_m(&self, station_m: f64, lateral_m: f64) -> f64 {
        let [x, y, cos, sin] = self.pose.each_ref().map(read);
        let (dx, dy) = (station_m - x, lateral_m - y);
        let (ahead_m, left_m) = (dx * cos + dy * sin, dy * cos - dx * sin);
        let axle = if ahead_m > self.middle_m {
            Axle::Front
        } else {
            Axle::Rear
        };
        let side = if left_m > 0.0 { Side::Left } else { Side::Right };
        self.base.height_m(station_m, lateral_m) + read(&self.height_m[axle.corner(side)])
    }
}
