//! The model so far, and a candidate beside it.

use std::sync::Arc;

use nalgebra::DVector;

use crate::error::DiagnoseError;
use crate::estimation::normal_equations::Answering;
use crate::estimation::{Fit, LeastSquares, NormalEquations, Point, Sensitivity};
use crate::specimen::{Series, Specimen};

/// The model so far with everything that screening reuses.
pub struct Screen<'p, 'a> {
    pub(super) problem: &'p LeastSquares<'a>,
    pub(super) fit: &'p Fit,
    pub(super) base: Arc<Vec<Sensitivity>>,
    /// What is known of `base`.
    pub(super) answering: Answering,
    pub(super) truths: Vec<Series>,
}

/// A candidate on its way to its best values.
#[derive(Clone)]
pub struct ScreenedCandidate {
    /// The model so far with the candidate.
    pub(super) point: Point,
    /// Normal equations of the model's coordinates and the candidate's. The derivatives may be those of the point before the last
    /// step, the residuals are always those of the point.
    pub(super) normals: Vec<NormalEquations>,
    /// The step that the model's own coordinates make in response.
    pub(super) response: DVector<f64>,
    /// Cost with the response.
    pub cost: f64,
    pub(super) damping: f64,
    pub(super) arrived: bool,
    /// True once it got the steps of a promising candidate.
    pub advanced: bool,
}

impl<'p, 'a> Screen<'p, 'a> {
    /// Prepares screening beside a fitted model.
    ///
    /// # Errors
    /// As [`crate::estimation::Evaluation::truths`].
    pub fn new(problem: &'p LeastSquares<'a>, fit: &'p Fit) -> Result<Self, DiagnoseError> {
        let truths = problem.evaluation.truths(&fit.point)?;
        let base = if let Some(kept) = &fit.sensitivities {
            Arc::clone(kept)
        } else {
            let all: Vec<usize> = (0..fit.point.z.len()).collect();
            Arc::new(problem.evaluation.sensitivities(&fit.point, &all, Some(&truths))?)
        };
        Ok(Self {
            problem,
            fit,
            answering: Answering::of(&problem.blocks, &base),
            base,
            truths,
        })
    }

    pub(super) fn specimen(&self) -> &'a dyn Specimen {
        self.problem.specimen()
    }
}

/// The candidate beside a fitted model as a fit: the response is carried out in the linear approximation.
pub fn finished(problem: &LeastSquares<'_>, fit: &Fit, candidate: &ScreenedCandidate) -> Fit {
    let old = fit.point.z.len();
    let mut point = candidate.point.clone();
    let (ranges, prior) = (point.ranges(problem.specimen()), point.prior(problem.specimen()));
    (0..old).for_each(|k| point.z[k] += candidate.response[k]);
    let mut step = DVector::zeros(point.z.len());
    step.rows_mut(0, old).copy_from(&candidate.response);
    let normals = (candidate.normals.iter())
        .map(|n| NormalEquations {
            cost: n.cost_after(&step),
            g: &n.g - &n.h * &step,
            h: n.h.clone(),
        })
        .collect();
    let mut fit = Fit::new(point, normals, prior, candidate.cost, ranges);
    fit.screened = true;
    fit
}

/// Cost of a screened candidate; infinite where it cannot be simulated.
pub fn cost_of(candidate: &Option<ScreenedCandidate>) -> f64 {
    candidate.as_ref().map_or(f64::INFINITY, |c| c.cost)
}
