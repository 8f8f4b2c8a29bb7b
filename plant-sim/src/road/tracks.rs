//! A road known along two wheel paths: the form of synthesised roads, made for fast look-up.

use super::{HALF_TRACK_M, Road};

/// Heights along a left and a right track at even spacing; linear between samples and across, constant outside the
/// tracks, and repeated from the start beyond the last sample.
#[derive(Debug, Clone)]
pub struct TwoTracks {
    per_m: f64,
    /// `[left, right]`, with the first sample again at the end so that interpolation needs no wrap.
    heights_m: Vec<[f64; 2]>,
}

impl TwoTracks {
    /// Tracks at [`HALF_TRACK_M`] either side, from samples `spacing_m` apart. The samples are one period.
    pub fn periodic(spacing_m: f64, mut heights_m: Vec<[f64; 2]>) -> Self {
        let first = heights_m.first().copied().unwrap_or([0.0; 2]);
        if heights_m.is_empty() {
            heights_m.push(first);
        }
        heights_m.push(first);
        Self {
            per_m: 1.0 / spacing_m,
            heights_m,
        }
    }

    /// Length of one period of the track, m.
    pub fn length_m(&self) -> f64 {
        (self.heights_m.len() - 1) as f64 / self.per_m
    }

    /// The samples of one period, `[left, right]`.
    pub fn samples_m(&self) -> &[[f64; 2]] {
        &self.heights_m[..self.heights_m.len() - 1]
    }
}

impl Road for TwoTracks {
    #[inline]
    fn height_m(&self, station_m: f64, lateral_m: f64) -> f64 {
        let period = (self.heights_m.len() - 1) as f64;
        let mut place = station_m * self.per_m;
        if !(place >= 0.0 && place < period) {
            place -= period * (place / period).floor();
            // Stations beyond the resolution of a double have lost their place; they stay on the surface.
            if !(place >= 0.0 && place < period) {
                place = 0.0;
            }
        }
        let cell = place as usize;
        let fraction = place - cell as f64;
        let (Some(low), Some(high)) = (self.heights_m.get(cell), self.heights_m.get(cell + 1)) else {
            return self.heights_m.first().map_or(0.0, |first| 0.5 * (first[0] + first[1]));
        };
        let left = low[0] + fraction * (high[0] - low[0]);
        let right = low[1] + fraction * (high[1] - low[1]);
        // Both weights are written out so that a mirrored road gives mirrored bits.
        let offset = (lateral_m / (2.0 * HALF_TRACK_M)).clamp(-0.5, 0.5);
        (0.5 + offset) * left + (0.5 - offset) * right
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_met_on_their_track_and_the_period_repeats() {
        let road = TwoTracks::periodic(0.5, vec![[0.0, 1.0], [2.0, 3.0], [4.0, -5.0]]);
        assert_eq!(road.length_m(), 1.5);
        assert_eq!(road.height_m(0.5, HALF_TRACK_M), 2.0);
        assert_eq!(road.height_m(0.5, -HALF_TRACK_M), 3.0);
        assert_eq!(road.height_m(0.5, -9.0), 3.0);
        assert_eq!(road.height_m(0.5, 0.0), 2.5);
        assert_eq!(road.height_m(0.75, HALF_TRACK_M), 3.0);
        assert_eq!(
            road.height_m(1.25, HALF_TRACK_M),
            2.0,
            "between the last sample and the first of the next period"
        );
        assert_eq!(road.height_m(0.5 + 1.5 * 7.0, HALF_TRACK_M), 2.0);
        assert_eq!(road.height_m(0.5 - 1.5 * 7.0, HALF_TRACK_M), 2.0);
    }

    #[test]
    fn every_argument_has_a_height() {
        let road = TwoTracks::periodic(0.5, vec![[0.0, 1.0], [2.0, 3.0]]);
        for station in [1e300, -1e300, f64::MAX, 1e17, -1e-300] {
            assert!(road.height_m(station, 0.3).is_finite());
        }
    }
}
