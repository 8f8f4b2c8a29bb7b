//! The least-squares problem: a specimen, the blocks of its recordings that count, and the thresholds of the search.

use std::sync::atomic::AtomicBool;

use super::blocks::{Block, Blocks};
use super::evaluation::Evaluation;
use super::fit::Fit;
use super::point::Point;
use crate::criteria::Criteria;
use crate::error::DiagnoseError;
use crate::recording::Recording;
use crate::specimen::{Folding, Series, Specimen};

/// A specimen whose parameters are estimated on some blocks of its recordings.
pub struct LeastSquares<'a> {
    /// Simulates the specimen.
    pub evaluation: Evaluation<'a>,
    /// The blocks that count.
    pub blocks: Blocks,
    /// Thresholds of fits and of the search.
    pub criteria: Criteria,
}

impl<'a> LeastSquares<'a> {
    /// All recordings of a specimen. `stop`, set from another thread, ends the work at the next simulation.
    #[must_use]
    pub fn new(specimen: &'a dyn Specimen, stop: &'a AtomicBool) -> Self {
        Self::over(Evaluation::new(specimen, stop), Criteria::default())
    }

    /// The same with other thresholds.
    #[must_use]
    pub fn with_criteria(self, criteria: Criteria) -> Self {
        Self { criteria, ..self }
    }

    /// Another specimen with all its recordings, stopped by the same flag.
    #[must_use]
    pub fn on<'b>(&self, specimen: &'b dyn Specimen) -> LeastSquares<'b>
    where
        'a: 'b,
    {
        LeastSquares::over(self.evaluation.on(specimen), self.criteria)
    }

    fn over(evaluation: Evaluation<'a>, criteria: Criteria) -> Self {
        let specimen = evaluation.specimen();
        let samples: Vec<usize> = specimen.recordings().iter().map(Recording::len).collect();
        Self {
            blocks: Blocks::cut(&samples, specimen.folding()),
            evaluation,
            criteria,
        }
    }

    /// The same on some of the blocks.
    #[must_use]
    pub fn keeping(&self, wanted: impl Fn(&Block) -> bool) -> Self {
        Self {
            evaluation: self.evaluation.clone(),
            blocks: self.blocks.keeping(wanted),
            criteria: self.criteria,
        }
    }

    /// The specimen.
    #[must_use]
    pub const fn specimen(&self) -> &'a dyn Specimen {
        self.evaluation.specimen()
    }

    /// True where fitting without each fold is cheap enough to be done instead of approximated.
    #[must_use]
    pub fn refits_folds(&self) -> bool {
        let few_folds =
            self.specimen().recordings().len() == 1 || self.specimen().folding() == Folding::WholeRecordings;
        self.specimen().simulates_in_milliseconds() && few_folds
    }

    /// Noise ratio that a fitted model would reach if it were complete; computed once for each fit.
    #[must_use]
    pub fn floor(&self, fitted: &Fit) -> f64 {
        let specimen = self.specimen();
        *(fitted.floor).get_or_init(|| specimen.noise_floor(&fitted.point.hypothesis(specimen)))
    }

    /// Noise ratio up to which a fitted model counts as complete.
    #[must_use]
    pub fn complete_up_to(&self, fitted: &Fit) -> f64 {
        let completeness = &self.criteria.completeness;
        completeness
            .noise_ratio
            .max(completeness.over_floor * self.floor(fitted))
    }

    /// Number of residuals: all values of the channels that were measured.
    #[must_use]
    pub fn residuals(&self) -> usize {
        let specimen = self.specimen();
        (self.blocks.as_slice().iter())
            .flat_map(|b| (0..specimen.channels().len()).map(move |c| b.of(specimen.measured(b.recording, c))))
            .map(|measured| measured.iter().filter(|v| !v.is_nan()).count())
            .sum()
    }

    /// Sum of squared residuals of every block.
    #[must_use]
    pub fn block_costs(&self, residuals: &[Series]) -> Vec<f64> {
        (self.blocks.as_slice().iter())
            .map(|b| {
                (residuals[b.recording].iter())
                    .map(|c| b.of(c).iter().map(|r| r * r).sum::<f64>())
                    .sum()
            })
            .collect()
    }

    /// Cost: the squared residuals of every block, then the prior's cost of departing from nominal.
    #[must_use]
    pub fn cost(&self, point: &Point, residuals: &[Series]) -> f64 {
        self.block_costs(residuals).iter().sum::<f64>() + point.prior_cost(self.specimen())
    }

    /// Cost at a point.
    ///
    /// # Errors
    /// As [`Evaluation::truths`].
    pub fn cost_at(&self, point: &Point) -> Result<f64, DiagnoseError> {
        Ok(self.cost(point, &self.evaluation.residuals_at(point)?))
    }

    /// Cost at each of several points, all simulated at once; an error where one cannot be simulated.
    #[must_use]
    pub fn costs_at_each(&self, points: &[Point]) -> Vec<Result<f64, DiagnoseError>> {
        let evaluation = &self.evaluation;
        (evaluation.truths_at_each(points).into_iter().zip(points))
            .map(|(truths, point)| Ok(self.cost(point, &evaluation.residuals(&evaluation.observed(point, &truths?)))))
            .collect()
    }
}
