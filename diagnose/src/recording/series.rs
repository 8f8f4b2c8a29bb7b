//! The samples of one recording.

use crate::median::median;

/// Even or nearly even samples of one specimen.
#[derive(Debug, Clone)]
pub struct Recording {
    /// File name of the recording without `.csv`.
    pub name: String,
    /// Sample times, s, strictly increasing.
    pub time_s: Vec<f64>,
    /// One series a requested column, same order.
    pub columns: Vec<Vec<f64>>,
    /// What was done to it that a reader of the report must know.
    pub notes: Vec<String>,
}

impl Recording {
    /// Number of samples in the recording.
    #[must_use]
    pub fn len(&self) -> usize {
        self.time_s.len()
    }

    /// True without samples (never, as read).
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.time_s.is_empty()
    }

    /// The first samples of it.
    #[must_use]
    pub fn first(&self, samples: usize) -> Self {
        let part = |series: &Vec<f64>| series[..samples.min(series.len())].to_vec();
        Self {
            name: self.name.clone(),
            time_s: part(&self.time_s),
            columns: self.columns.iter().map(part).collect(),
            notes: self.notes.clone(),
        }
    }

    /// Median sampling interval, s.
    #[must_use]
    pub fn interval_s(&self) -> f64 {
        median_interval(&self.time_s)
    }
}

/// Median of the steps of time, s; 0 for fewer than two samples.
#[must_use]
pub fn median_interval(time_s: &[f64]) -> f64 {
    median(time_s.windows(2).map(|w| w[1] - w[0]).collect())
}
