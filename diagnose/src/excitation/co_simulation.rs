//! What the recordings of somebody else's model excite.

use super::extent::range;
use crate::correction::Quantity;
use crate::vocabulary::Column;

/// Ranges over all recordings of what laws and instruments may depend on.
pub struct CoSimulation {
    /// Compared columns, each with what is known of it.
    pub outputs: Vec<Reading>,
    /// Recorded inputs that are not switched, each with what is known of it.
    pub inputs: Vec<Reading>,
    /// What a law may depend on. Without what hardly varies.
    pub quantities: Vec<Known>,
    /// Parameters that may be changed while the model runs.
    pub tunable: Vec<String>,
    /// Duration of the longest recording, s.
    pub duration_s: f64,
    /// Longest sampling interval, s.
    pub interval_s: f64,
}

/// A quantity over all recordings.
pub struct Known {
    /// Which one.
    pub quantity: Quantity,
    /// Smallest and largest value.
    pub range: (f64, f64),
    /// Whether it has only two values.
    pub switches: bool,
}

/// A column of the recordings.
pub struct Reading {
    /// Its name.
    pub column: Column,
    /// Largest less smallest value within one recording, the largest of all.
    pub spread: f64,
}

/// Part of the largest size of a quantity that its range must reach for a law over it to be told from a constant.
const LEAST_RANGE: f64 = 1e-6;

impl CoSimulation {
    /// The range of a quantity over all recordings; `None` where it hardly varies.
    #[must_use]
    pub fn range_of<'s>(series: impl Iterator<Item = &'s [f64]>) -> Option<(f64, f64)> {
        let (low, high) = series.map(range).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))?;
        (high - low > LEAST_RANGE * low.abs().max(high.abs())).then_some((low, high))
    }
}
