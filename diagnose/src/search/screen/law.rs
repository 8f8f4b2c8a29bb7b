//! Where laws without a name begin: the shape of each that explains most.

use super::beside::{Screen, ScreenedCandidate};
use super::look::Look;
use super::steps::{Linearised, Moving, Start, Tried};
use crate::error::DiagnoseError;
use crate::estimation::Point;
use crate::vocabulary::Column;

/// A law at one of its shapes.
struct Shaped {
    shape: Vec<f64>,
    /// What a linear step would leave of the cost.
    left: f64,
    begun: Linearised,
}

impl Screen<'_, '_> {
    /// Laws after their first steps, side by side. At size zero a law changes nothing, so that there the answer of the recordings to its size is that of
    /// a regression, whatever its other numbers, its *shape*, are. The shape that explains most is stepped from; the other starts of this shape are
    /// larger sizes, which are simulated too.
    pub(super) fn begin_laws(&self, look: &Look<'_>, laws: &[usize]) -> Vec<Result<ScreenedCandidate, DiagnoseError>> {
        let (shapes, begun): (Vec<Option<Vec<f64>>>, Vec<_>) = (self.best_shapes(look, laws).into_iter())
            .map(|best| match best {
                Ok(best) => (Some(best.shape), Ok(best.begun)),
                Err(why) => (None, Err(why)),
            })
            .unzip();
        let mut moving = self.stepped(look, begun);
        self.move_to_larger(look, laws, &shapes, &mut moving);
        let mut shaped: Vec<&mut Result<Moving, DiagnoseError>> = (laws.iter().zip(&mut moving))
            .filter(|(law, _)| {
                self.specimen().candidates()[**law]
                    .parameters
                    .iter()
                    .any(|p| !p.is_size)
            })
            .map(|(_, moving)| moving)
            .collect();
        for moving in shaped.iter_mut().flat_map(|moving| moving.as_mut()) {
            moving.candidate.arrived = false;
        }
        self.advance(look, &mut shaped, self.problem.criteria.screening.first_steps);
        (moving.into_iter())
            .map(|moving| moving.map(|moving| moving.candidate))
            .collect()
    }

    /// Each law at the shape that explains most.
    fn best_shapes(&self, look: &Look<'_>, laws: &[usize]) -> Vec<Result<Shaped, DiagnoseError>> {
        let shapes: Vec<Vec<Vec<f64>>> = laws.iter().map(|&law| self.shapes(law)).collect();
        let mut best: Vec<Option<Result<Shaped, DiagnoseError>>> = laws.iter().map(|_| None).collect();
        let (many, one): (Vec<usize>, Vec<usize>) = (0..laws.len()).partition(|&k| shapes[k].len() > 1);
        let regression = laws.first().map_or(look, |&law| self.regression_look(law));
        self.keep_best(regression, laws, &shapes, &many, &mut best);
        self.keep_best(look, laws, &shapes, &one, &mut best);
        if regression.truths.len() < look.truths.len() {
            let chosen: Vec<Vec<Vec<f64>>> = (best.iter())
                .map(|best| match best {
                    Some(Ok(best)) => vec![best.shape.clone()],
                    _ => vec![],
                })
                .collect();
            many.iter()
                .filter(|&&k| !chosen[k].is_empty())
                .for_each(|&k| best[k] = None);
            self.keep_best(look, laws, &chosen, &many, &mut best);
        }
        (best.into_iter())
            .map(|best| best.unwrap_or(Err(DiagnoseError::Interrupted)))
            .collect()
    }

    /// Looks at the shapes of some of the laws, and keeps that of each which explains most.
    fn keep_best(
        &self,
        look: &Look<'_>,
        laws: &[usize],
        shapes: &[Vec<Vec<f64>>],
        which: &[usize],
        best: &mut [Option<Result<Shaped, DiagnoseError>>],
    ) {
        let all: Vec<(usize, &Vec<f64>)> = (which.iter())
            .flat_map(|&k| shapes[k].iter().map(move |shape| (k, shape)))
            .collect();
        for some in all.chunks(self.specimen().simulations_at_once()) {
            let starts = some
                .iter()
                .map(|&(k, shape)| self.at_shape(look, laws[k], shape))
                .collect();
            for (&(k, shape), begun) in some.iter().zip(self.at_each(look, starts)) {
                let shaped = begun.map(|begun| Shaped {
                    shape: shape.clone(),
                    left: self.left_by_linear_step(&begun.candidate),
                    begun,
                });
                match (&best[k], &shaped) {
                    (Some(Err(_)), _) => {}
                    (Some(Ok(lowest)), Ok(shaped)) if shaped.left >= lowest.left => {}
                    _ => best[k] = Some(shaped),
                }
            }
        }
    }

    /// Moves laws to the largest of their starts that leads lower than their first step.
    fn move_to_larger(
        &self,
        look: &Look<'_>,
        laws: &[usize],
        shapes: &[Option<Vec<f64>>],
        moving: &mut [Result<Moving, DiagnoseError>],
    ) {
        let starts: Vec<(usize, Point)> = (laws.iter().zip(shapes).enumerate())
            .filter_map(|(k, (&law, shape))| Some((k, law, shape.as_ref()?)))
            .flat_map(|(k, law, shape)| self.larger(law, shape).into_iter().map(move |point| (k, point)))
            .collect();
        let mut lowest: Vec<Option<Tried>> = laws.iter().map(|_| None).collect();
        for some in starts.chunks(self.specimen().simulations_at_once()) {
            let points: Vec<Point> = some.iter().map(|(_, point)| point.clone()).collect();
            for ((k, _), tried) in some.iter().zip(self.tried_at_each(look, &points)) {
                let Ok(first) = &moving[*k] else { continue };
                let reached = lowest[*k].as_ref().map_or(first.candidate.cost, |lowest| lowest.cost);
                match tried {
                    Ok(tried) if tried.cost < reached => lowest[*k] = Some(tried),
                    Ok(_) | Err(DiagnoseError::Simulation { .. }) => {}
                    Err(other) => moving[*k] = Err(other),
                }
            }
        }
        let (which, lowest): (Vec<usize>, Vec<Tried>) = (lowest.into_iter().enumerate())
            .filter_map(|(k, lowest)| Some((k, lowest?)))
            .unzip();
        let starts = (lowest.iter())
            .map(|lowest| Start {
                point: lowest.point.clone(),
                truths: lowest.truths.as_deref(),
            })
            .collect();
        let begun = self.at_each(look, starts);
        for ((k, lowest), begun) in which.into_iter().zip(lowest).zip(begun) {
            moving[k] = begun.map(|begun| Moving {
                candidate: begun.candidate,
                truths: lowest.truths,
            });
        }
    }

    /// The starts of a law that have a shape and a size.
    fn larger(&self, law: usize, shape: &[f64]) -> Vec<Point> {
        let description = &self.specimen().candidates()[law];
        (description.all_starts().into_iter())
            .filter(|start| description.without_sizes(start) == shape && *start != shape)
            .map(|start| self.fit.point.with_effect(self.specimen(), law, &start))
            .collect()
    }

    /// The shapes of a law: its starts without their sizes.
    fn shapes(&self, law: usize) -> Vec<Vec<f64>> {
        let description = &self.specimen().candidates()[law];
        let mut shapes: Vec<Vec<f64>> = Vec::new();
        for start in description.all_starts() {
            let shape = description.without_sizes(&start);
            if !shapes.contains(&shape) {
                shapes.push(shape);
            }
        }
        shapes
    }

    /// A law of a shape that does not act yet.
    fn at_shape<'l>(&self, look: &'l Look<'_>, law: usize, shape: &[f64]) -> Start<'l> {
        // A law of the instrument of the displacement works the motion out anew, which rounds otherwise: by as much as a slow law changes in a
        // derivative, so that this starts from what is simulated with the law.
        let changes_motion = self.specimen().candidates()[law].place.sensor() == Some(&Column::DISPLACEMENT);
        Start {
            point: self.fit.point.with_effect(self.specimen(), law, shape),
            truths: (!changes_motion).then_some(look.truths.as_slice()),
        }
    }
}
