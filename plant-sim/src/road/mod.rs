//! Roads: the surfaces on which the wheels roll.
//!
//! A [`Road`] is a height for every station and lateral position, defined everywhere, so that no simulation ends
//! because a surface did. Vehicles only know the trait; where heights come from (a measured file, a standard's
//! spectrum, an obstacle) is decided here and nowhere else. [`from_name_or_path`] is the door for a command line.
//!
//! ```text
//!  file.crg -> crg -> grid ----+                               names: belgian, apg-left, apg-right, apg-both,
//!  file.csv -> profile_file ---+-> lanes -> entry (smooth) ->         iso-a .. iso-f, flat, or a path
//!  spectrum table -> random ---+
//!  obstacle, flat --------------------------------------------> Road --> side slope, bend --> Road
//! ```

mod apg;
pub mod belgian;
mod bend;
pub mod crg;
mod entry;
mod error;
mod grid;
mod inverse_fft;
pub mod iso8608;
mod lanes;
mod named;
mod profile_file;
mod random;
mod side_slope;
pub mod spectrum;
mod tracks;

pub use apg::ApgObstacle;
pub use bend::Bend;
pub use entry::{ENTRY_M, EnteredSmoothly};
pub use error::RoadError;
pub use grid::GridRoad;
pub use lanes::{LANE_M, Lanes};
pub use named::{NAMES, from_name_or_path};
pub use profile_file::profile_from_csv;
pub use random::{TrackSpectrum, synthesise};
pub use side_slope::SideSlope;
pub use tracks::TwoTracks;

/// A road surface.
///
/// `station_m` runs forward along the track, 0 where the front axle starts; `lateral_m` is positive to the left of
/// the track's centre line. Heights are in metres, positive up, finite for every finite argument.
pub trait Road: Send + Sync {
    /// Height of the surface, m.
    fn height_m(&self, station_m: f64, lateral_m: f64) -> f64;

    /// Length of the surface as it was measured, m, for a road from a file. Beyond it the road is its mirror image.
    fn measured_length_m(&self) -> Option<f64> {
        None
    }
}

/// Level ground at height 0.
#[derive(Debug, Clone, Copy, Default)]
pub struct Flat;

impl Road for Flat {
    fn height_m(&self, _station_m: f64, _lateral_m: f64) -> f64 {
        0.0
    }
}

/// Half the distance between the tracks of the built-in roads and of two-track files, m: the Defender 110's.
pub const HALF_TRACK_M: f64 = 0.743;
