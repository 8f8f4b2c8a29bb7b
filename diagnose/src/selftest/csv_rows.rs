//! The tables of the self-test as rows of CSV files.

use serde::Serialize;

use super::summary::Summary;
use super::trial::Trial;
use crate::vocabulary::EffectId;

/// A row of `trials.csv`: one campaign.
#[derive(Debug, Serialize)]
pub struct TrialRow {
    name: String,
    hidden: String,
    size: String,
    left_out: String,
    instruments: String,
    said: String,
    reported: String,
    confidence: String,
    exact: bool,
    noise_ratio_before: f64,
    noise_ratio_after: f64,
    unseen_before: f64,
    unseen_after: f64,
    failed: String,
}

/// One row a trial; several effects are joined by spaces.
pub fn trials(trials: &[Trial]) -> impl Iterator<Item = TrialRow> {
    trials.iter().map(|t| {
        let join = |words: Vec<String>| words.join(" ");
        let mut places: Vec<String> = t
            .truth
            .iter()
            .map(|h| format!("{}@{}", h.id, h.place.as_reported()))
            .collect();
        let mut reported: Vec<String> = t
            .reported
            .iter()
            .map(|r| format!("{}@{}", r.id, r.place.as_reported()))
            .collect();
        let confidence = join(t.reported.iter().map(|r| format!("{:.3}", r.confidence)).collect());
        let hidden = join({
            places.dedup();
            places.clone()
        });
        let shown = join(reported.clone());
        for list in [&mut places, &mut reported] {
            list.sort();
            list.dedup();
        }
        TrialRow {
            name: t.name.clone(),
            hidden,
            size: join(t.hidden.iter().map(|h| format!("{:.3}", h.2)).collect()),
            left_out: t.left_out.map_or_else(String::new, |id| id.to_string()),
            instruments: t.flaw.map_or_else(String::new, |flaw| flaw.to_string()),
            said: join(t.said.iter().map(|(what, column)| format!("{what}@{column}")).collect()),
            reported: shown,
            confidence,
            exact: places == reported,
            noise_ratio_before: t.noise_ratio.0,
            noise_ratio_after: t.noise_ratio.1,
            unseen_before: t.unseen.0,
            unseen_after: t.unseen.1,
            failed: t.failed.clone().unwrap_or_default(),
        }
    })
}

/// Counts of one term at one size.
#[derive(Debug, Serialize)]
pub struct PowerRow {
    term: EffectId,
    size_in_noise: f64,
    campaigns: usize,
    found: usize,
    placed: usize,
    sized: usize,
    false_beside: usize,
}

/// Rows of `power.csv`, the detection rates.
pub fn power(summary: &Summary) -> impl Iterator<Item = PowerRow> {
    summary.power.iter().map(|p| PowerRow {
        term: p.term,
        size_in_noise: p.size,
        campaigns: p.found.of,
        found: p.found.hits,
        placed: p.placed.hits,
        sized: p.sized.hits,
        false_beside: p.false_beside.hits,
    })
}

/// One cell of the confusion matrix that is not zero.
#[derive(Debug, Serialize)]
pub struct ConfusionRow {
    hidden: String,
    reported: String,
    campaigns: usize,
}

/// Rows of `confusion.csv`, the confusion matrix.
pub fn confusion(summary: &Summary) -> impl Iterator<Item = ConfusionRow> {
    summary.confusion.iter().flat_map(|(hidden, row)| {
        row.iter().map(|(reported, campaigns)| ConfusionRow {
            hidden: hidden.clone(),
            reported: reported.clone(),
            campaigns: *campaigns,
        })
    })
}

/// A row of `coverage.csv`: the intervals of one parameter.
#[derive(Debug, Serialize)]
pub struct CoverageRow {
    term: EffectId,
    parameter: String,
    intervals: usize,
    covered: usize,
    unbounded: usize,
}

/// Rows of `coverage.csv`, the coverage of the confidence intervals.
pub fn coverage(summary: &Summary) -> impl Iterator<Item = CoverageRow> {
    (summary.coverage.iter())
        .filter(|c| !c.key.is_empty())
        .map(|c| CoverageRow {
            term: c.term,
            parameter: c.key.clone(),
            intervals: c.covered.of,
            covered: c.covered.hits,
            unbounded: c.unbounded,
        })
}
