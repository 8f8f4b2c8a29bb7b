//! A hypothesis: the given model with calibrated values and added effects.

/// A model to simulate: values of the calibration, and the effects that are present with the values of their parameters.
#[derive(Debug, Clone, Default)]
pub struct Hypothesis {
    /// Values of the specimen's calibration parameters, in their order.
    pub calibration: Vec<f64>,
    /// Index of each candidate that is present, and the values of its parameters.
    pub effects: Vec<(usize, Vec<f64>)>,
}
