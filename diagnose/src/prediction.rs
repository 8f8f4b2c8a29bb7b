//! Prediction of what was kept from the fit: the given model, the improved one and every rival in its place, each
//! fitted on the same part and simulated freely over whole recordings.
//!
//! Selection already judges by held-out blocks, but it chooses by them too. Here nothing has seen what is predicted.

use rayon::prelude::*;

use crate::campaign::{CompleteRecordings, KeptBack};
use crate::diagnosis::Diagnosis;
use crate::error::DiagnoseError;
use crate::estimation::{LeastSquares, Point, fit};
use crate::search::Screen;
use crate::vocabulary::Column;

/// Noise ratios of one model.
#[derive(Debug, Clone)]
pub struct ModelPrediction {
    /// Name of the model, such as "improved".
    pub model: String,
    /// Noise ratio of each channel on the fitted part.
    pub fitted: Vec<f64>,
    /// Noise ratio of each channel on the held-out part.
    pub kept_back: Vec<f64>,
}

/// Noise ratios of all models on the fitted and on the held-out part.
#[derive(Debug, Clone)]
pub struct Predictions {
    /// Columns of the channels.
    pub channels: Vec<Column>,
    /// The models: as given, recalibrated, improved, then the rivals with the best predictor first.
    pub models: Vec<ModelPrediction>,
}

/// A rival must explain this part of the recalibrated model's misfit on the fitted part to be listed.
const WORTH_SHOWING: f64 = 0.02;

/// Name of the improved model, and what the names of those made from it begin with.
const IMPROVED_NAME: &str = "improved";

impl Predictions {
    /// Fits the rivals, predicts with every model.
    ///
    /// # Errors
    /// [`DiagnoseError::Interrupted`] if the caller asked to stop; a given model that cannot be simulated on the held-out part.
    pub fn of(
        problem: &LeastSquares<'_>,
        diagnosis: &Diagnosis,
        complete: &CompleteRecordings,
        kept_back: &KeptBack,
    ) -> Result<Self, DiagnoseError> {
        let selection = &diagnosis.selection;
        let given = predict(
            "as given",
            problem,
            &Point::nominal(problem.specimen()),
            complete,
            kept_back,
        )?;
        let mut models = vec![
            given,
            predict(
                "recalibrated within tolerance",
                problem,
                &selection.calibrated.point,
                complete,
                kept_back,
            )?,
            predict(IMPROVED_NAME, problem, &selection.best.point, complete, kept_back)?,
        ];
        let mut rivals: Vec<ModelPrediction> = rivals(problem, diagnosis)?
            .par_iter()
            .filter_map(|(name, point)| predict(name, problem, point, complete, kept_back).ok())
            .collect();
        // Rivals that change nothing would only hide the others.
        let fitted = |p: &ModelPrediction| p.fitted.iter().map(|v| v * v).sum::<f64>();
        let plain = fitted(&models[1]);
        rivals.retain(|r| r.model.starts_with(IMPROVED_NAME) || fitted(r) < (1.0 - WORTH_SHOWING) * plain);
        let badness = |p: &ModelPrediction| p.kept_back.iter().map(|v| v * v).sum::<f64>();
        rivals.sort_by(|a, b| badness(a).total_cmp(&badness(b)));
        models.extend(rivals);
        Ok(Self {
            channels: problem.specimen().channels().iter().map(|c| c.column.clone()).collect(),
            models,
        })
    }

    /// As a value for the report.
    #[must_use]
    pub fn json(&self, kept_back: &KeptBack) -> serde_json::Value {
        let by_channel = |ratios: &[f64]| -> serde_json::Map<String, serde_json::Value> {
            (self.channels.iter().map(ToString::to_string))
                .zip(ratios.iter().map(|&r| serde_json::json!(r)))
                .collect()
        };
        let models: Vec<serde_json::Value> = (self.models.iter())
            .map(|m| {
                serde_json::json!({ "model": m.model, "noise_ratio_fitted": by_channel(&m.fitted),
                                    "noise_ratio_kept_back": by_channel(&m.kept_back) })
            })
            .collect();
        serde_json::json!({ "fit_until": kept_back.fit_until, "held_out": kept_back.recordings, "models": models })
    }
}

/// The improved model without each of its effects, and, where simulating is cheap, each candidate alone.
fn rivals(problem: &LeastSquares<'_>, diagnosis: &Diagnosis) -> Result<Vec<(String, Point)>, DiagnoseError> {
    let best = &diagnosis.selection.best.point;
    let specimen = problem.specimen();
    let converged = problem.criteria.fitting.converged;
    let all = specimen.candidates();
    let mut points = Vec::new();
    // A rival that cannot be simulated predicts nothing.
    let mut add = |name: String, start: Point| match fit(problem, start, converged) {
        Ok(fitted) => {
            points.push((name, fitted.point));
            Ok(())
        }
        Err(DiagnoseError::Simulation { .. }) => Ok(()),
        Err(other) => Err(other),
    };
    if best.effects.len() > 1 {
        for (position, &effect) in best.effects.iter().enumerate() {
            let less = best.without_effect(specimen, position);
            add(format!("improved, without {}", all[effect].name()), less)?;
        }
    }
    if specimen.simulates_in_milliseconds() {
        for added in (0..all.len()).filter(|c| all[*c].untestable.is_none() && !best.effects.contains(c)) {
            let values: Vec<f64> = all[added].parameters.iter().map(|p| p.start).collect();
            let vocabulary = !all[added].is_unlisted() && !all[added].is_instrument_fault();
            if vocabulary && !best.effects.iter().any(|&e| all[e].excludes(&all[added])) {
                let more = best.with_effect(specimen, added, &values);
                add(format!("improved, with {} added", all[added].name()), more)?;
            }
        }
        let alone: Vec<usize> = (0..all.len())
            .filter(|c| all[*c].untestable.is_none() && best.effects != [*c])
            .collect();
        let screened = Screen::new(problem, &diagnosis.selection.calibrated)?.all(&alone)?;
        for (candidate, start) in alone.into_iter().zip(screened) {
            let Some(start) = start else { continue };
            add(format!("{} alone", all[candidate].name()), start.point)?;
        }
    }
    Ok(points)
}

fn predict(
    name: &str,
    problem: &LeastSquares<'_>,
    point: &Point,
    complete: &CompleteRecordings,
    kept_back: &KeptBack,
) -> Result<ModelPrediction, DiagnoseError> {
    let fitted = problem.specimen();
    let model_toml = (fitted.model_toml(&point.hypothesis(fitted))).map_err(DiagnoseError::Output)?;
    let specimen = complete.specimen(&model_toml)?;
    let everything = problem.on(&*specimen);
    let residuals = everything.evaluation.residuals_at(&Point::nominal(&*specimen))?;
    let channels = specimen.channels().len();
    let (mut fitted, mut unseen) = (vec![(0.0, 0_usize); channels], vec![(0.0, 0_usize); channels]);
    for (r, series) in residuals.iter().enumerate() {
        let samples = specimen.time_s(r).len();
        let split = kept_back
            .fitted_samples(specimen.recording_name(r), samples)
            .min(samples);
        for (c, residual) in series.iter().enumerate() {
            let (seen, not_seen) = residual.split_at(split);
            for (sum, part) in [(&mut fitted[c], seen), (&mut unseen[c], not_seen)] {
                sum.0 += part.iter().map(|v| v * v).sum::<f64>();
                sum.1 += part.len();
            }
        }
    }
    let ratio = |sums: Vec<(f64, usize)>| sums.iter().map(|(s, n)| (s / (*n).max(1) as f64).sqrt()).collect();
    Ok(ModelPrediction {
        model: name.to_owned(),
        fitted: ratio(fitted),
        kept_back: ratio(unseen),
    })
}
