//! A fitted model with its normal equations, from which everything that follows a fit is computed.

use std::sync::{Arc, OnceLock};

use nalgebra::DVector;

use super::bounded_step::bounded_step;
use super::evaluation::Sensitivity;
use super::normal_equations::{NormalEquations, sum};
use super::point::Point;

/// A fitted point with its normal equations.
#[derive(Debug, Clone)]
pub struct Fit {
    /// Effects and coordinates.
    pub point: Point,
    /// Normal equations of every block, at the point.
    pub normals: Vec<NormalEquations>,
    /// Diagonal of the prior's normal matrix.
    pub prior: DVector<f64>,
    /// Cost of all blocks with the prior.
    pub cost: f64,
    /// Range of every coordinate.
    pub ranges: Vec<(f64, f64)>,
    /// Residuals and derivatives, where they were kept (they are large).
    pub sensitivities: Option<Arc<Vec<Sensitivity>>>,
    /// True if the fit comes from screening: linear in the model's own parameters, and not converged.
    pub screened: bool,
    /// The folds left out in turn, once somebody has asked ([`super::held_out`]).
    pub(super) held_out: Arc<OnceLock<HeldOut>>,
}

/// A model judged on each fold by a fit that the fold had no say in.
#[derive(Debug, Clone)]
pub struct HeldOut {
    /// Cost of every block.
    pub costs: Vec<f64>,
    /// The point fitted without each fold.
    pub points: Vec<Point>,
}

impl Fit {
    /// A fit that nobody has judged yet.
    #[must_use]
    pub fn new(
        point: Point,
        normals: Vec<NormalEquations>,
        prior: DVector<f64>,
        cost: f64,
        ranges: Vec<(f64, f64)>,
    ) -> Self {
        Self {
            point,
            normals,
            prior,
            cost,
            ranges,
            sensitivities: None,
            screened: false,
            held_out: Arc::default(),
        }
    }

    /// The same without residuals and derivatives, to be kept.
    #[must_use]
    pub fn without_sensitivities(&self) -> Self {
        Self {
            sensitivities: None,
            ..self.clone()
        }
    }

    /// The change of coordinates when the selected blocks are left out, in the linear approximation and no coordinate by more
    /// than `largest`; `None` if the rest does not determine them. Coordinates at the end of their range stay there.
    #[must_use]
    pub fn step_without(&self, left_out: impl Fn(usize) -> bool, largest: f64) -> Option<DVector<f64>> {
        let z = &self.point.z;
        let kept = (self.normals.iter().enumerate())
            .filter(|(k, _)| !left_out(*k))
            .map(|(_, n)| n);
        let (h, mut g) = sum(kept, &self.prior, z);
        // Only the difference that leaving out makes: the gradient left at the full fit is rounding and bounds.
        let (_, full) = sum(&self.normals, &self.prior, z);
        g -= full;
        let near: Vec<(f64, f64)> = (self.ranges.iter().zip(z))
            .map(|(r, z)| (r.0.max(z - largest), r.1.min(z + largest)))
            .collect();
        bounded_step(&h, &g, 1e-6, z, &near)
    }
}
