//! What the wheels roll over.
//!
//! A [`Road`] is a height for every station and lateral position, defined everywhere, so that no simulation ends
//! because a surface did. Vehicles only know the trait; where heights come from (a measured file, a standard's
//! spectrum, an obstacle) is decided here and nowhere else.

/// A road surface.
///
/// `station_m` runs forward along the track, 0 where the front axle starts; `lateral_m` is positive to the left of
/// the track's centre line. Heights are in metres, positive up, finite for every finite argument.
pub trait Road: Send + Sync {
    /// Height of the surface, m.
    fn height_m(&self, station_m: f64, lateral_m: f64) -> f64;
}

/// Level ground.
#[derive(Debug, Clone, Copy, Default)]
pub struct Flat;

impl Road for Flat {
    fn height_m(&self, _station_m: f64, _lateral_m: f64) -> f64 {
        0.0
    }
}
