//! `report.html`: where, what, model, how much better, what to record next, for somebody who was not there.

mod effects;
mod improvement;
mod locations;
mod model;
pub mod words;

use oleo_report::{Cell, Column, Page, Table, Verdict as Colour, significant};

use crate::campaign::Campaign;
use crate::diagnosis::{Diagnosis, Effect, Verdict};
use crate::effect::{Candidate, of};
use crate::json;
use crate::specimen::Specimen;
use crate::vocabulary::SpecimenKind;

/// The page.
#[must_use]
pub fn page(campaign: &Campaign, diagnosis: &Diagnosis, command: &str, runtime_s: f64) -> Page {
    let specimen = &*campaign.specimen;
    let mut page = Page::new(&format!("Diagnosis of {}", campaign.name), command);
    page.fact("Specimen", specimen.kind().as_str());
    let samples = specimen.samples();
    let names: Vec<&str> = specimen.recordings().iter().map(|r| r.name.as_str()).collect();
    page.fact(
        "Recordings",
        &format!("{}: {} ({samples} samples)", names.len(), names.join(", ")),
    );
    page.fact(
        "Work",
        &format!(
            "{} simulations of one recording in {runtime_s:.0} s",
            diagnosis.simulated
        ),
    );
    page.verdict(colour(diagnosis), &headline(specimen, diagnosis));
    if !diagnosis.effects.is_empty() {
        page.outcome(in_brief(specimen.kind(), diagnosis));
    }
    page.text(&format!(
        "Noise ratio: RMS of recording minus simulation over the sensor's noise. 1 is perfect. Held out: judged on stretches \
         that had no say in the fit. The model is simulated freely: it gets {}, and nothing else that was measured.",
        specimen.inputs_in_words()
    ));
    locations::section(&mut page, campaign, diagnosis);
    effects::section(&mut page, campaign, diagnosis);
    model::section(&mut page, diagnosis);
    improvement::section(&mut page, campaign, diagnosis);
    next(&mut page, campaign, diagnosis);
    if !campaign.notes.is_empty() {
        page.section("Remarks on the recordings");
        campaign.notes.iter().for_each(|n| {
            page.text(n);
        });
    }
    page
}

fn colour(diagnosis: &Diagnosis) -> Colour {
    match diagnosis.verdict() {
        Verdict::Consistent => Colour::Pass,
        Verdict::MissingPhysics if !diagnosis.selection.incomplete && diagnosis.ambiguous.is_empty() => {
            Colour::Attention
        }
        _ => Colour::Fail,
    }
}

/// The whole story in two sentences.
#[must_use]
pub fn headline(specimen: &dyn Specimen, diagnosis: &Diagnosis) -> String {
    let (kind, all) = (specimen.kind(), specimen.candidates());
    let (before, after) = (diagnosis.selection.calibrated_ratio, diagnosis.selection.improved_ratio);
    let (before, after) = (significant(before, 3), significant(after, 3));
    let mut text = match diagnosis.verdict() {
        Verdict::Consistent => format!(
            "Nothing is missing: recalibrated within its tolerances, the model predicts every recording to {after} times the \
             sensors' noise."
        ),
        Verdict::MissingPhysics => format!(
            "The model leaves out {}. With {}, what was held out of the fit is predicted to {after} times the sensors' \
             noise instead of {before} times.",
            list(&phrases(kind, diagnosis)),
            if phrases(kind, diagnosis).len() == 1 {
                "it"
            } else {
                "them"
            },
        ),
        Verdict::Unexplained => format!(
            "The model disagrees with the recordings ({after} times the sensors' noise), and no effect that was tried explains it."
        ),
    };
    if diagnosis.selection.incomplete && diagnosis.verdict() == Verdict::MissingPhysics {
        text += " That is not all: a misfit that no effect tried explains is left.";
    }
    for effect in &diagnosis.selection.effects {
        if let Some(rival) = effect.ambiguous_rival() {
            let said = |c: &Candidate| format!("{} {}", of(c.id).called(kind, &c.label), words::at(&c.place));
            text += &format!(
                " The recordings cannot tell {} from {}; what to record to separate them is said below.",
                said(&all[effect.candidate]),
                said(&all[rival])
            );
        }
    }
    text
}

/// Effects as phrases, one an id, with all its places.
fn phrases(kind: SpecimenKind, diagnosis: &Diagnosis) -> Vec<String> {
    let mut out: Vec<(String, String)> = Vec::new();
    for e in diagnosis.effects.iter().filter(|e| e.selected.is_some()) {
        let name = of(e.id).called(kind, &e.label);
        let place = words::at(&e.place);
        match out.iter_mut().find(|(known, _)| *known == name) {
            Some((_, places)) => *places += &format!(" and {place}"),
            None => out.push((name, place)),
        }
    }
    out.into_iter()
        .map(|(name, places)| format!("{name} {places}"))
        .collect()
}

fn list(items: &[String]) -> String {
    match items {
        [] => "something".into(),
        [one] => one.clone(),
        [rest @ .., last] => format!("{} and {last}", rest.join(", ")),
    }
}

/// Where, what, how large, how sure, how much better: a row an effect.
fn in_brief(kind: SpecimenKind, diagnosis: &Diagnosis) -> Table {
    let mut table = Table::new([
        Column::text("What is missing"),
        Column::text("Where"),
        Column::text("How large (95 % interval)"),
        Column::number("Confidence"),
        Column::number("Held-out noise ratio without it"),
        Column::number("with it"),
    ]);
    for e in &diagnosis.effects {
        let large: Vec<String> = (e.parameters.iter())
            .map(|p| {
                let (name, unit) = words::quantity(&p.key);
                let (value, interval) = words::value_and_interval(p.value, p.ci95);
                format!("{name} {value} {unit} ({interval})")
            })
            .collect();
        let place = words::at(&e.place);
        table.row([
            format!("{} ({})", of(e.id).named(kind, &e.label), name(e)),
            place.trim_start_matches("in ").trim_start_matches("at ").to_owned(),
            match points(e) {
                Some(n) => format!("a law of {n} points, drawn under What"),
                None if large.is_empty() => "it has no size: it is there or not".into(),
                None => large.join("; "),
            },
            format!("{:.2}", e.confidence),
            format!("{:.2}", e.ratio_without),
            format!("{:.2}", e.ratio_with),
        ]);
    }
    table
}

/// Points of a law given as a table; its increments are no numbers to read.
fn points(effect: &Effect) -> Option<usize> {
    Some(effect.law.as_ref()?.get("argument")?.as_array()?.len())
}

fn name(effect: &Effect) -> String {
    if effect.label.is_empty() {
        effect.id.to_string()
    } else {
        format!("{}: {}", effect.id, effect.label)
    }
}

fn next(page: &mut Page, campaign: &Campaign, diagnosis: &Diagnosis) {
    page.section("What to record next");
    page.text(
        diagnosis.next_experiment.as_deref().unwrap_or(
            "Nothing is needed: every effect found is told from its rivals, and nothing predictable is left.",
        ),
    );
    let missing = json::not_tested(&*campaign.specimen);
    if missing.is_empty() {
        page.text("Every effect of the vocabulary was tested: these recordings would show it.");
        return;
    }
    let mut table = Table::new([
        Column::text("Not tested"),
        Column::text("Place"),
        Column::text("Because, and what to record"),
    ]);
    for m in &missing {
        table.row([text(&m["id"]), text(&m["place"]), text(&m["why"])]);
    }
    page.text("These recordings cannot show the following effects. Not tested is not the same as absent:")
        .table(table);
}

fn text(value: &serde_json::Value) -> Cell {
    Cell::from(value.as_str().unwrap_or_default())
}

/// The effects, as printed on standard output.
#[must_use]
pub fn effects_table(diagnosis: &Diagnosis) -> Table {
    let mut table = Table::new([
        Column::text("Effect"),
        Column::text("Place"),
        Column::number("Confidence"),
        Column::text("Parameters (95 % interval)"),
        Column::number("Noise ratio without"),
        Column::number("with"),
    ]);
    for e in &diagnosis.effects {
        let numbers: Vec<String> = (e.parameters.iter())
            .map(|p| {
                let (value, interval) = words::value_and_interval(p.value, p.ci95);
                format!("{} = {value} ({interval})", p.key)
            })
            .collect();
        table.row([
            name(e),
            e.place.as_reported(),
            format!("{:.2}", e.confidence),
            points(e).map_or_else(|| numbers.join("; "), |n| format!("a law of {n} points")),
            format!("{:.2}", e.ratio_without),
            format!("{:.2}", e.ratio_with),
        ]);
    }
    table
}
