//! What the instruments of a strut would read.

use super::integrator::StrutOutput;

/// Predicted columns, one value a sample.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Prediction {
    /// Force of the load cell, N.
    pub force_n: Vec<f64>,
    /// Gauge pressures p1 to p4, Pa.
    pub pressure_pa: [Vec<f64>; 4],
}

impl Prediction {
    pub(super) fn with_capacity(samples: usize) -> Self {
        Self {
            force_n: Vec::with_capacity(samples),
            pressure_pa: std::array::from_fn(|_| Vec::with_capacity(samples)),
        }
    }

    #[inline(always)]
    pub(super) fn push(&mut self, output: StrutOutput) {
        self.force_n.push(output.force_n);
        for (column, pressure) in self.pressure_pa.iter_mut().zip(output.pressure_pa) {
            column.push(pressure);
        }
    }
}
