//! Ranges and durations of the recordings of a specimen.

use crate::recording::Recording;

/// Ranges over all recordings of a specimen.
#[derive(Debug, Clone)]
pub struct Extent {
    spreads: Vec<f64>,
    /// Duration of the longest recording, s.
    pub duration_s: f64,
    /// Longest sampling interval, s.
    pub interval_s: f64,
}

impl Extent {
    /// Goes through all recordings once.
    #[must_use]
    pub fn of(recordings: &[Recording]) -> Self {
        let columns = recordings.first().map_or(0, |r| r.columns.len());
        let largest = |of: &dyn Fn(&Recording) -> f64| recordings.iter().map(of).fold(0.0, f64::max);
        Self {
            spreads: (0..columns).map(|c| largest(&|r| spread(&r.columns[c]))).collect(),
            duration_s: largest(&|r| r.time_s[r.len() - 1] - r.time_s[0]),
            interval_s: largest(&Recording::interval_s),
        }
    }

    /// Largest less smallest value of a column within one recording, the largest of all recordings.
    #[must_use]
    pub fn spread(&self, column: usize) -> f64 {
        self.spreads[column]
    }
}

/// Largest minus smallest value.
#[must_use]
pub fn spread(values: &[f64]) -> f64 {
    let (low, high) = range(values);
    high - low
}

/// Smallest and largest value.
#[must_use]
pub fn range(values: &[f64]) -> (f64, f64) {
    values
        .iter()
        .fold((f64::MAX, f64::MIN), |(low, high), &v| (low.min(v), high.max(v)))
}
