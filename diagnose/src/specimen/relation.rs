//! A relation between measured neighbours, tested on the recordings alone.

/// Fewest samples from which a relation is judged.
const LEAST_SAMPLES: usize = 20;

/// A relation between measured neighbours that holds whatever happens elsewhere.
#[derive(Debug, Clone)]
pub struct MeasuredRelation {
    /// The relation in words.
    pub name: &'static str,
    /// RMS of its misfit after removing a constant, in units of its noise; `None` where too few samples can test it.
    pub noise_ratio: Option<f64>,
    /// Samples that can test it.
    pub samples: usize,
}

impl MeasuredRelation {
    /// Tests a relation on the values of its misfit. `noise` is their standard deviation where the relation holds.
    #[must_use]
    pub fn tested(name: &'static str, noise: f64, misfit: &[f64]) -> Self {
        let samples = misfit.len();
        let noise_ratio = (samples >= LEAST_SAMPLES).then(|| {
            let mean = misfit.iter().sum::<f64>() / samples as f64;
            let variance = misfit.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / samples as f64;
            variance.sqrt() / noise
        });
        Self {
            name,
            noise_ratio,
            samples,
        }
    }
}
