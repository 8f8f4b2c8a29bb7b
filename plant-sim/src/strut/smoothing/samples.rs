//! The samples of a motion while it is being smoothed.

/// Displacement (m) of each sample, and its change per sampling interval just before and just after it.
pub(super) struct Samples {
    pub value: Vec<f64>,
    pub before: Vec<f64>,
    pub after: Vec<f64>,
}
