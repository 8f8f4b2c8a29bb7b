//! What the recordings of a gas spring excite.

use super::corner::Clock;
use super::extent::Extent;
use crate::recording::Recording;

/// The pressure must move by this many times its noise before anything can be tested.
const LEAST_MOVE: f64 = 8.0;

/// Ranges over all recordings of a gas spring, and what the corners of its motion say about the clocks.
pub struct GasSpring {
    /// Ranges of the columns, duration and sampling interval.
    pub extent: Extent,
    /// One for each recording whose motion has corners enough.
    pub clocks: Vec<Clock>,
    /// Why nothing can be tested.
    pub still: Option<String>,
}

impl GasSpring {
    /// Goes through all recordings once. `noise_pa` is the standard deviation of the pressure, Pa.
    #[must_use]
    pub fn of(recordings: &[Recording], noise_pa: f64, clocks: Vec<Clock>) -> Self {
        let extent = Extent::of(recordings);
        let still = extent.spread(1) < LEAST_MOVE * noise_pa;
        Self {
            extent,
            clocks,
            still: still.then(|| {
                "the pressure changes by less than eight times its noise; record strokes of a tenth of the volume"
                    .to_owned()
            }),
        }
    }
}
