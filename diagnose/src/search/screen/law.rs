//! Where a law without a name begins: the shape of it that explains most.

use super::beside::{Screen, ScreenedCandidate};
use super::look::Look;
use super::steps::Linearised;
use crate::error::DiagnoseError;
use crate::estimation::Point;
use crate::vocabulary::Column;

impl Screen<'_, '_> {
    /// A law after its first steps. At size zero a law changes nothing, so that there the answer of the recordings to its size is that of a
    /// regression, whatever its other numbers, its *shape*, are. The shape that explains most is stepped from; the other starts of this shape are
    /// larger sizes, which are simulated too.
    pub(super) fn begin_law(
        &self,
        look: &Look<'_>,
        candidate: usize,
        starts: &[&Vec<f64>],
    ) -> Result<Option<ScreenedCandidate>, DiagnoseError> {
        let (specimen, fit) = (self.specimen(), self.fit);
        let parameters = &specimen.candidates()[candidate].parameters;
        let shape_of = |values: &[f64]| -> Vec<f64> {
            (parameters.iter().zip(values))
                .map(|(p, v)| if p.is_size { 0.0 } else { *v })
                .collect()
        };
        let mut shapes: Vec<Vec<f64>> = Vec::new();
        for start in starts {
            let shape = shape_of(start);
            if !shapes.contains(&shape) {
                shapes.push(shape);
            }
        }
        // A law of the instrument of the displacement works the motion out anew, which rounds otherwise: by as much as a slow law changes in a
        // derivative, so that this starts from what is simulated with the law.
        let changes_motion = specimen.candidates()[candidate].place.sensor() == Some(&Column::DISPLACEMENT);
        let at_shape = |shape: &Vec<f64>| fit.point.with_effect(specimen, candidate, shape);
        let begun_at = |look: &Look<'_>, shapes: &[Vec<f64>]| -> Result<Vec<Linearised>, DiagnoseError> {
            if changes_motion {
                shapes
                    .iter()
                    .map(|shape| self.at(look, at_shape(shape), None))
                    .collect()
            } else {
                self.at_each(look, shapes.iter().map(at_shape).collect())
            }
        };
        let regression = if shapes.len() > 1 {
            self.regression_look(candidate)
        } else {
            look
        };
        let mut best: Option<(f64, Vec<f64>, Linearised)> = None;
        for shapes in shapes.chunks(specimen.simulations_at_once()) {
            for (shape, begun) in shapes.iter().zip(begun_at(regression, shapes)?) {
                let left = self.left_by_linear_step(&begun.candidate);
                if best.as_ref().is_none_or(|(least, ..)| left < *least) {
                    best = Some((left, shape.clone(), begun));
                }
            }
        }
        let Some((_, shape, mut begun)) = best else {
            return Ok(None);
        };
        if regression.truths.len() < look.truths.len() {
            begun = begun_at(look, std::slice::from_ref(&shape))?.pop().unwrap_or(begun);
        }
        self.step(look, &mut begun)?;
        let mut candidate_at_best = begun.candidate;
        let larger: Vec<Point> = (starts.iter())
            .filter(|start| shape_of(start) == shape && ***start != shape)
            .map(|start| fit.point.with_effect(specimen, candidate, start))
            .collect();
        for points in larger.chunks(specimen.simulations_at_once()) {
            for (tried, point) in self.tried_at_each(look, points).into_iter().zip(points) {
                match tried {
                    Ok(tried) if tried.cost < candidate_at_best.cost => {
                        candidate_at_best = self.at(look, point.clone(), tried.truths.as_deref())?.candidate;
                    }
                    Ok(_) | Err(DiagnoseError::Simulation { .. }) => {}
                    Err(other) => return Err(other),
                }
            }
        }
        if parameters.iter().any(|p| !p.is_size) {
            candidate_at_best.arrived = false;
            self.advance(
                look,
                &mut candidate_at_best,
                self.problem.criteria.screening.first_steps,
            )?;
        }
        Ok(Some(candidate_at_best))
    }
}
