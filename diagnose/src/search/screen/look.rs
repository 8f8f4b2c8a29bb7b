//! The recordings on which a candidate is looked at.
//!
//! A gross effect shows in a few recordings far more than in the others: where the noise ratio is 100, two or three of ten often hold seven
//! tenths of the cost. What only sorts out, such as the size of an effect to start from, is then asked of those that hold half of it; every candidate
//! makes its first steps on those that hold seven tenths, with the others as the model so far leaves them; and the promising ones go on on all.

use std::sync::Arc;

use crate::error::DiagnoseError;
use crate::estimation::{Evaluation, Fit, LeastSquares};
use crate::specimen::Series;

/// Recordings, and the model so far in them.
pub struct Look<'a> {
    /// Simulates these recordings.
    pub evaluation: Evaluation<'a>,
    /// True quantities in the model so far, one series a recording.
    pub truths: Arc<Vec<Series>>,
}

impl<'a> Look<'a> {
    /// At all recordings.
    ///
    /// # Errors
    /// As [`Evaluation::truths`].
    pub fn at_all(problem: &LeastSquares<'a>, fit: &Fit) -> Result<Self, DiagnoseError> {
        Ok(Self {
            evaluation: problem.evaluation.clone(),
            truths: Arc::new(problem.evaluation.truths(&fit.point)?),
        })
    }

    /// The same look by one of many who look at the same time.
    pub fn of_many(&self) -> Self {
        Self {
            evaluation: self.evaluation.of_many(),
            truths: Arc::clone(&self.truths),
        }
    }

    /// At the recordings that hold at least this part of what a fitted model leaves; `None` if these are all of them.
    pub fn at_part(&self, part: f64, problem: &LeastSquares<'a>, fit: &Fit) -> Option<Self> {
        let enough = holding(part, &cost_of_recordings(problem, fit));
        (enough.len() < self.truths.len()).then(|| Self {
            evaluation: self.evaluation.of_recordings(&enough),
            truths: Arc::new(enough.iter().map(|&r| self.truths[r].clone()).collect()),
        })
    }
}

/// Cost of each recording in a fitted model.
fn cost_of_recordings(problem: &LeastSquares<'_>, fit: &Fit) -> Vec<f64> {
    let mut costs = vec![0.0; problem.specimen().recordings().len()];
    for (block, normals) in problem.blocks.as_slice().iter().zip(&fit.normals) {
        costs[block.recording] += normals.cost;
    }
    costs
}

/// The fewest recordings that together hold this part of all costs, in their order.
fn holding(part: f64, costs: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..costs.len()).collect();
    order.sort_by(|&a, &b| costs[b].total_cmp(&costs[a]));
    let enough = part * costs.iter().sum::<f64>();
    let mut held = 0.0;
    let mut wanted: Vec<usize> = Vec::new();
    for r in order {
        if held >= enough && !wanted.is_empty() {
            break;
        }
        held += costs[r];
        wanted.push(r);
    }
    wanted.sort_unstable();
    wanted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fewest_recordings_hold_the_part() {
        assert_eq!(holding(0.9, &[1.0, 80.0, 2.0, 17.0]), [1, 3]);
        assert_eq!(holding(0.9, &[1.0; 4]), [0, 1, 2, 3]);
        assert_eq!(holding(0.7, &[1.0; 4]), [0, 1, 2]);
        // Nothing is left at all: any recording holds it.
        assert_eq!(holding(0.9, &[0.0, 0.0]), [0]);
        assert_eq!(holding(0.9, &[]), [] as [usize; 0]);
    }
}
