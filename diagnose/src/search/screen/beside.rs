//! The model so far, and a candidate beside it.

use std::sync::Arc;

use nalgebra::DVector;

use super::look::Look;
use crate::error::DiagnoseError;
use crate::estimation::normal_equations::{Answering, total_cost};
use crate::estimation::{Fit, LeastSquares, NormalEquations, Point, Sensitivity};
use crate::specimen::Specimen;

/// The model so far with everything that screening reuses.
pub struct Screen<'p, 'a> {
    pub(super) problem: &'p LeastSquares<'a>,
    pub(super) fit: &'p Fit,
    pub(super) base: Arc<Vec<Sensitivity>>,
    /// What is known of `base`.
    pub(super) answering: Answering,
    /// All recordings.
    pub(super) all: Look<'a>,
    /// Those that hold most of what the model so far leaves, where that is far more than noise and these are fewer.
    pub(super) most: Option<Look<'a>>,
    /// Those that hold half of it, likewise.
    pub(super) half: Option<Look<'a>>,
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
    /// True while it was looked at on those recordings only that hold most of what the model so far leaves.
    pub(super) partly: bool,
    /// Steps that it was given as a promising candidate.
    pub(super) further_steps: usize,
}

impl<'p, 'a> Screen<'p, 'a> {
    /// Prepares screening beside a fitted model.
    ///
    /// # Errors
    /// As [`crate::estimation::Evaluation::truths`].
    pub fn new(problem: &'p LeastSquares<'a>, fit: &'p Fit) -> Result<Self, DiagnoseError> {
        let all = Look::at_all(problem, fit)?;
        let base = if let Some(kept) = &fit.sensitivities {
            Arc::clone(kept)
        } else {
            let own: Vec<usize> = (0..fit.point.z.len()).collect();
            Arc::new(problem.evaluation.sensitivities(&fit.point, &own, Some(&all.truths))?)
        };
        let gross = is_gross(problem, fit);
        let part = |part: f64| if gross { all.at_part(part, problem, fit) } else { None };
        Ok(Self {
            problem,
            fit,
            answering: Answering::of(&problem.blocks, &base),
            base,
            most: part(problem.criteria.screening.part_for_first_steps),
            half: part(0.5),
            all,
        })
    }

    pub(super) fn specimen(&self) -> &'a dyn Specimen {
        self.problem.specimen()
    }
}

/// True if a fitted model is so far off that a derivative at size zero may not show where an effect is.
pub(super) fn is_gross(problem: &LeastSquares<'_>, fit: &Fit) -> bool {
    let ratio = problem.criteria.screening.gross_noise_ratio;
    total_cost(&fit.normals) > ratio * ratio * problem.residuals() as f64
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
