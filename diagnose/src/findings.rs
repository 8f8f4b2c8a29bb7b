//! What is found in a campaign, as it is said and written: text, `report.json`, `report.html` and the improved `model.toml`.

use std::fmt::Write as _;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use oleo_report::{Cell, Column, OutputDirectory, OutputError, Page, Table};
use serde_json::Value;

use crate::campaign::{Campaign, CompleteRecordings, KeptBack};
use crate::diagnosis::Diagnosis;
use crate::error::DiagnoseError;
use crate::estimation::LeastSquares;
use crate::prediction::Predictions;
use crate::search::Progress;
use crate::{json, page};

/// A campaign with its diagnosis, and the predictions of what was kept back.
pub struct Findings {
    /// The campaign that was diagnosed.
    pub campaign: Campaign,
    /// Its diagnosis.
    pub diagnosis: Diagnosis,
    /// Predictions of what was kept back, if anything was.
    pub predictions: Option<Predictions>,
    kept_back: KeptBack,
    runtime_s: f64,
}

impl Findings {
    /// Diagnoses a campaign. `complete` holds all its recordings where a part was kept back; the run time counts from `begun`.
    ///
    /// # Errors
    /// A model that cannot be simulated; [`DiagnoseError::Interrupted`] once `stop` is set.
    pub fn of(
        campaign: Campaign,
        complete: Option<&CompleteRecordings>,
        kept_back: KeptBack,
        begun: Instant,
        stop: &AtomicBool,
        progress: Progress<'_>,
    ) -> Result<Self, DiagnoseError> {
        let problem = LeastSquares::new(&*campaign.specimen, stop);
        let diagnosis = Diagnosis::of(&problem, progress)?;
        let predictions = complete
            .map(|complete| Predictions::of(&problem, &diagnosis, complete, &kept_back))
            .transpose()?;
        Ok(Self {
            campaign,
            diagnosis,
            predictions,
            kept_back,
            runtime_s: begun.elapsed().as_secs_f64(),
        })
    }

    /// The content of `report.json`.
    #[must_use]
    pub fn report(&self) -> Value {
        let mut report = json::report(&self.campaign, &self.diagnosis, self.runtime_s);
        if let Some(predictions) = &self.predictions {
            report["kept_back"] = predictions.json(&self.kept_back);
        }
        report
    }

    /// The page, titled by the command that made it.
    #[must_use]
    pub fn page(&self, command: &str) -> Page {
        let mut page = page::page(&self.campaign, &self.diagnosis, command, self.runtime_s);
        if let Some(predictions) = &self.predictions {
            page.section("Prediction of held-out data");
            page.text(
                "Noise ratios. Every model was fitted to the same part of the recordings and then simulated freely over all of them. \
                 A ratio of 1 means that the error is no larger than the sensor's noise; lower is better.",
            )
            .table(prediction_table(predictions));
        }
        page
    }

    /// Writes all files. The diagnosis draws nothing at random; `seed` is only stated.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&self, out: &mut OutputDirectory, seed: Option<u64>, command: &str) -> Result<(), OutputError> {
        out.summary("report.json", seed, &self.report())?;
        out.page(&self.page(command))?;
        out.write(self.campaign.specimen.model_file(), &self.diagnosis.model_toml)
    }

    /// The result in a sentence and tables.
    #[must_use]
    pub fn text(&self) -> String {
        let diagnosis = &self.diagnosis;
        let mut text = format!(
            "{}: {}. The held-out noise ratio is {:.2} for the recalibrated and {:.2} for the improved model.\n",
            self.campaign.name,
            diagnosis.verdict(),
            diagnosis.selection.calibrated_ratio,
            diagnosis.selection.improved_ratio
        );
        // Writing to a text does not fail.
        if !diagnosis.effects.is_empty() {
            let _ = write!(text, "{}", page::effects_table(diagnosis));
        }
        if let Some(sentence) = page::complete_where_fitted(diagnosis) {
            let _ = writeln!(text, "{sentence}");
        }
        for equation in page::equations(diagnosis) {
            let _ = writeln!(text, "{equation}");
        }
        for finding in self.campaign.specimen.instruments() {
            let _ = writeln!(text, "{}", finding.text());
        }
        if let Some(predictions) = &self.predictions {
            let _ = write!(text, "\n{}", prediction_table(predictions));
        }
        if let Some(next) = &diagnosis.next_experiment {
            let _ = writeln!(text, "\n{next}");
        }
        text
    }
}

/// Noise ratios of every model on the fitted and on the held-out part.
fn prediction_table(predictions: &Predictions) -> Table {
    let mut columns = vec![Column::text("Model")];
    for channel in &predictions.channels {
        columns.push(Column::number(&format!("{channel}, fitted")));
        columns.push(Column::number(&format!("{channel}, held out")));
    }
    let mut table = Table::new(columns);
    for model in &predictions.models {
        let mut row = vec![Cell::from(model.model.as_str())];
        for (fitted, kept_back) in model.fitted.iter().zip(&model.kept_back) {
            row.push(Cell::from(format!("{fitted:.2}")));
            row.push(Cell::from(format!("{kept_back:.2}")));
        }
        table.row(row);
    }
    table
}
