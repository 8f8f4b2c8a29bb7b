//! The noise of a column and its colour, from differences of its readings.

use super::differences::{deviation, differences, variance_of_coloured};
use crate::recording::Recording;

/// The other stride of differences, by which coloured noise is told from white: it must be long enough to tell, and short enough
/// that the motion between samples does not count.
const LONG_STRIDE: usize = 4;
/// Fewest differences that a deviation is taken from.
const FEWEST: usize = 150;
/// Recordings whose interval is at most this many times the shortest are taken together.
const SAME_RATE: f64 = 1.5;
/// Correlation of neighbours from which noise is called coloured.
pub const LEAST_CORRELATION: f64 = 0.3;
/// Halvings in the search for a correlation.
const HALVINGS: usize = 30;
/// Largest correlation that the two strides can tell.
const LARGEST_CORRELATION: f64 = 0.9;

/// What differences say of the noise of a column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// Standard deviation at the shortest sampling interval, as if the noise were white.
    pub fast: f64,
    /// The same of all slower recordings together, where there are any.
    pub slow: Option<f64>,
    /// Correlation of neighbouring samples at the shortest interval, 0 or more.
    pub correlation: f64,
}

/// Measures a column; `None` where there are too few readings. `counts` says whether a sample of a recording is of use.
pub fn measured(recordings: &[Recording], column: usize, counts: &dyn Fn(usize, usize) -> bool) -> Option<Measured> {
    let shortest = recordings
        .iter()
        .map(Recording::interval_s)
        .fold(f64::INFINITY, f64::min);
    let is_fast = |r: &Recording| r.interval_s() <= SAME_RATE * shortest;
    let of = |r: usize, stride: usize| -> Vec<f64> {
        (differences(&recordings[r].columns[column], stride).enumerate())
            .filter(|(k, d)| d.is_finite() && counts(r, *k))
            .map(|(_, d)| d)
            .collect()
    };
    let together = |fast: bool| {
        let own = (0..recordings.len()).filter(|&r| is_fast(&recordings[r]) == fast);
        let all: Vec<f64> = own.flat_map(|r| of(r, 1)).collect();
        (all.len() >= FEWEST).then(|| deviation(all.into_iter())).flatten()
    };
    let fast = together(true)?;
    // Motion that a long stride lets through only adds: the second lowest is of recordings in which little moves.
    let mut rises: Vec<f64> = (0..recordings.len())
        .filter(|&r| is_fast(&recordings[r]))
        .filter_map(|r| {
            let (short, long) = (of(r, 1), of(r, LONG_STRIDE));
            if long.len() < FEWEST {
                return None;
            }
            Some(deviation(long.into_iter())? / deviation(short.into_iter())?)
        })
        .filter(|rise| rise.is_finite())
        .collect();
    rises.sort_by(f64::total_cmp);
    let rise = rises.get(usize::from(rises.len() > 2)).copied().unwrap_or(1.0);
    Some(Measured {
        fast,
        slow: together(false),
        correlation: correlation(rise),
    })
}

/// Strides of the differences that tell how large noise can be whose colour is not known: up to 40 ms on a bus that samples every 5 ms.
const STRIDES: [usize; 4] = [1, 2, 4, 8];

/// The most that the noise of readings can be, as a standard deviation, from the readings less what a model makes of them, one series a recording: the largest
/// that differences of [`STRIDES`] leave. Coloured noise shows in the long ones, and what the model lacks only adds. `None` where too few readings change.
pub fn at_most(beside_model: &[Vec<f64>]) -> Option<f64> {
    let left = |stride: usize| -> Option<f64> {
        // Readings that stand still, beside a model that does, hide the noise in the steps of the converter.
        let moving = (beside_model.iter())
            .flat_map(|series| differences(series, stride))
            .filter(|d| d.is_finite() && *d != 0.0);
        let moving: Vec<f64> = moving.collect();
        (moving.len() >= FEWEST)
            .then(|| deviation(moving.into_iter()))
            .flatten()
    };
    let each: Vec<f64> = STRIDES.into_iter().map(left).collect::<Option<_>>()?;
    each.into_iter().reduce(f64::max)
}

/// Correlation of neighbours at which differences of the long stride are this many times those of the short one.
fn correlation(rise: f64) -> f64 {
    let at = |r: f64| (variance_of_coloured(libm::pow(r, LONG_STRIDE as f64)) / variance_of_coloured(r)).sqrt();
    let (mut low, mut high) = (0.0, LARGEST_CORRELATION);
    if rise >= at(high) {
        return high;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if at(middle) < rise {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    /// Normal noise of standard deviation one whose neighbours are correlated.
    pub fn noise(seed: u64, samples: usize, correlation: f64) -> Vec<f64> {
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let fresh = (1.0 - correlation * correlation).sqrt();
        let mut state: f64 = StandardNormal.sample(&mut random);
        (0..samples)
            .map(|_| {
                let drawn: f64 = StandardNormal.sample(&mut random);
                state = correlation * state + fresh * drawn;
                state
            })
            .collect()
    }

    /// A recording of these columns.
    pub fn recording(interval_s: f64, columns: Vec<Vec<f64>>) -> Recording {
        Recording {
            name: "recording".into(),
            time_s: (0..columns[0].len()).map(|k| interval_s * k as f64).collect(),
            columns,
            notes: vec![],
        }
    }

    #[test]
    fn what_a_model_leaves_is_at_most_noise_whatever_its_colour() {
        let slow = |k: usize| 40.0 * libm::sin(0.02 * k as f64);
        let beside = |colour: f64| -> Vec<f64> {
            let fresh = noise(4, 8000, colour).into_iter().enumerate();
            fresh.map(|(k, v)| if k < 500 { 0.0 } else { slow(k) + v }).collect()
        };
        for (colour, least) in [(0.0, 0.97), (0.3, 0.95), (0.7, 0.9)] {
            let most = at_most(&[beside(colour)]).expect("noise");
            assert!(most > least && most < 1.06, "{colour}: {most}");
        }
        // What is missing in the model, and as fast as the strides are, counts as noise.
        let fast: Vec<f64> = (beside(0.0).iter().enumerate())
            .map(|(k, v)| v + 5.0 * libm::sin(0.3 * k as f64))
            .collect();
        assert!(at_most(&[fast]).expect("noise") > 3.0);
        assert_eq!(at_most(&[vec![0.0; 4000]]), None);
    }

    #[test]
    fn size_and_colour_are_measured() {
        for (size, colour) in [(1.0, 0.0), (0.5, 0.0), (1.0, 0.5), (0.8, 0.6)] {
            let series: Vec<Vec<f64>> = (0..3)
                .map(|seed| noise(seed, 4000, colour).iter().map(|v| size * v).collect())
                .collect();
            let recordings: Vec<Recording> = series.into_iter().map(|s| recording(0.002, vec![s])).collect();
            let m = measured(&recordings, 0, &|_, _| true).expect("noise");
            assert!((m.correlation - colour).abs() < 0.15, "{m:?}");
            let total = m.fast / variance_of_coloured(m.correlation).sqrt();
            assert!((total / size - 1.0).abs() < 0.2 && m.slow.is_none(), "{m:?} {total}");
        }
    }
}
