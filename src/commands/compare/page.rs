//! `report.html` of a comparison.

use oleo_report::{Axis, Curves, Figure as Drawing, Page, Style, Verdict};

use super::differences::{ComparedTrace, Differences};
use super::drawn::Drawn;
use super::quantity::{axis, quantity};
use super::run::Group;
use super::tables::{check_table, figure_table, trace_table};
use super::traces::Trace;
use crate::results::command_line;

/// The verdict, the figures and traces that differ, and all of them behind lines to click.
pub fn page(
    axis_name: &str,
    drawn: &Drawn,
    compared: &[(&Group, &Differences)],
    verdict: Option<Verdict>,
    sentence: &str,
) -> Page {
    let mut page = Page::new("Comparison", &command_line());
    let over = quantity(axis_name);
    page.fact("Compared over", &format!("{}, {}", over.0.to_lowercase(), over.1));
    match verdict {
        Some(verdict) => page.verdict(verdict, sentence),
        None => page.text(sentence),
    };
    for (group, found) in compared {
        let runs: Vec<&str> = group.runs.iter().map(|run| run.name.as_str()).collect();
        page.section(if group.name.is_empty() { "Runs" } else { &group.name });
        page.text(&format!("{} compared with {}.", runs[1..].join(", "), runs[0]));
        if !found.checks.is_empty() {
            page.outcome(check_table(&found.checks));
        }
        if !found.figures.is_empty() {
            let changed = figure_table(group, found.figures.iter().filter(|figure| !figure.is_same()));
            if !changed.is_empty() {
                page.table(changed);
            }
            page.details("All figures", figure_table(group, found.figures.iter()));
        }
        let drawn = drawn.among(&found.traces);
        let figures: Vec<_> = (drawn.iter())
            .filter_map(|trace| Some((quantity(&trace.name).0, overlaid(axis_name, group, trace)?)))
            .collect();
        if !figures.is_empty() {
            page.choice("Trace", figures);
        }
        page.table(trace_table(group, axis_name, &drawn));
        page.details(
            "All traces",
            trace_table(group, axis_name, &found.traces.iter().collect::<Vec<_>>()),
        );
    }
    page
}

/// A trace of all runs, and below it what the others are apart from the first.
fn overlaid(axis_name: &str, group: &Group, trace: &ComparedTrace) -> Option<Drawing> {
    let (words, unit, factor) = quantity(&trace.name);
    let scaled = |values: &[f64]| values.iter().map(|value| factor * value).collect::<Vec<f64>>();
    let mut curves = Curves::new(&words, axis(axis_name));
    curves.height(560).panel(axis(&trace.name));
    for run in &group.runs {
        let own = run.traces.axis(axis_name, &run.name).ok()?;
        let (style, values) = match run.traces.trace(&trace.name) {
            None => continue,
            Some(Trace::Quantity(values)) => (Style::Line, scaled(values)),
            // Words have no height.
            Some(Trace::State(words)) => (
                Style::Step,
                words.iter().map(|word| word.parse().ok()).collect::<Option<_>>()?,
            ),
        };
        curves.series(style, &run.name, own, &values);
    }
    let first = &group.runs[0];
    let places = first.traces.axis(axis_name, &first.name).ok()?;
    if let Some(Trace::Quantity(reference)) = first.traces.trace(&trace.name) {
        curves.panel(Axis::new(&format!("Difference from {}", first.name), unit));
        for run in &group.runs[1..] {
            if let Ok(Some(values)) = run.quantity_at(&trace.name, axis_name, places) {
                let apart: Vec<f64> = values
                    .iter()
                    .zip(reference)
                    .map(|(own, first)| factor * (own - first))
                    .collect();
                curves.series(Style::Line, &run.name, places, &apart);
            }
        }
    }
    Some(curves.into())
}
