//! Where a law that swings in time begins: the frequency and the phase that explain most.

use std::f64::consts::FRAC_PI_2;

use nalgebra::DVector;

use super::beside::{Screen, ScreenedCandidate};
use super::look::Look;
use super::steps::RESPONSE_DAMPING;
use crate::error::DiagnoseError;
use crate::estimation::Sensitivity;
use crate::estimation::bounded_step::bounded_step;
use crate::estimation::normal_equations::sum;
use crate::search::oscillation::{Line, Oscillations};
use crate::specimen::Series;

/// What the residual of the model so far holds at single frequencies.
pub(super) struct Swings {
    oscillations: Oscillations,
    lines: Vec<Line>,
}

impl Screen<'_, '_> {
    /// What the residual of the model so far holds.
    pub(super) fn swings(&self) -> Swings {
        let oscillations = Oscillations::of(self.specimen());
        let lines = oscillations.lines_of_channels(&self.residuals());
        Swings { oscillations, lines }
    }

    fn residuals(&self) -> Vec<&Series> {
        self.base.iter().map(|recording| &recording.residual).collect()
    }

    /// A law that swings after its first steps from the frequency that explains most; `None` where the residual holds no frequency that is not
    /// the excitation's.
    pub(super) fn begin_oscillation(
        &self,
        candidate: usize,
        swings: &Swings,
    ) -> Result<Option<ScreenedCandidate>, DiagnoseError> {
        let specimen = self.specimen();
        let (amplitude, look) = (self.fit.point.z.len(), self.first_look(candidate));
        let regression = self.regression_look(candidate);
        let numbers = &specimen.candidates()[candidate].parameters;
        // Of amplitude zero. A law that swings shortens the steps of the simulation, so that also the truth is simulated with it, once for a
        // frequency.
        let answers =
            |look: &Look<'_>, frequency_hz: f64, phases: &[f64]| -> Result<Vec<Vec<Sensitivity>>, DiagnoseError> {
                let evaluation = &look.evaluation;
                let at = |phase| (self.fit.point).with_effect(specimen, candidate, &[0.0, phase, frequency_hz]);
                let simulated = if numbers[0].instrument_only {
                    None
                } else {
                    Some(evaluation.truths(&at(FRAC_PI_2))?)
                };
                let truths = simulated.as_deref().unwrap_or(&look.truths);
                (phases.iter())
                    .map(|&phase| evaluation.sensitivities(&at(phase), &[amplitude], Some(truths)))
                    .collect()
            };
        let lowest = numbers[2].lower;
        let envelopes: Vec<Series> = (answers(&self.all, lowest, &[FRAC_PI_2])?.into_iter().flatten())
            .map(|mut s| s.columns.swap_remove(0))
            .collect();
        let mut lines = swings.oscillations.lines(&self.residuals(), &envelopes);
        lines.extend(&swings.lines);
        let mut best: Option<(f64, Vec<f64>)> = None;
        for line in lines {
            let f = line.frequency_hz;
            let mut answers = answers(regression, f, &[0.0, FRAC_PI_2])?.into_iter();
            let mut both = answers.next().unwrap_or_default();
            for (both, cosine) in both.iter_mut().zip(answers.flatten()) {
                both.columns.extend(cosine.columns);
            }
            let normals = self.extended(regression, &both);
            let [prior, z] = [&self.fit.prior, &DVector::from_column_slice(&self.fit.point.z)]
                .map(|own| own.clone().resize_vertically(amplitude + 2, 0.0));
            let (h, g) = sum(&normals, &prior, z.as_slice());
            let mut ranges = self.fit.point.ranges(specimen);
            ranges.resize(amplitude + 2, (f64::NEG_INFINITY, f64::INFINITY));
            let Some(step) = bounded_step(&h, &g, RESPONSE_DAMPING, z.as_slice(), &ranges) else {
                continue;
            };
            let gain = 2.0 * g.dot(&step) - step.dot(&(&h * &step));
            if best.as_ref().is_none_or(|(most, _)| gain > *most) {
                let (a, b) = (step[amplitude], step[amplitude + 1]);
                let size = numbers[0].value(libm::hypot(a, b));
                best = Some((gain, vec![size, libm::atan2(b, a), f]));
            }
        }
        match best {
            Some((_, start)) => self.begin_lower(look, candidate, &start, None),
            None => Ok(None),
        }
    }
}
