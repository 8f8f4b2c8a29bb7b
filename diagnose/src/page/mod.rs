//! `report.html`: the verdict in one sentence, then where the misfit is, which effect explains it, the improved model, how much
//! better it predicts, and what to record next.

mod effects;
mod explained;
mod improvement;
mod locations;
mod model;
mod next;
mod portrait;
mod shown;
pub mod words;

use oleo_report::{Column, Page, Table, Verdict as Colour, significant};

use crate::campaign::Campaign;
use crate::diagnosis::{Diagnosis, Effect, Verdict};
use crate::effect::{Candidate, of, unlisted};
use crate::specimen::Specimen;
use crate::vocabulary::SpecimenKind;

/// Builds `report.html`.
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
        "Computation",
        &format!("{} recordings simulated in {runtime_s:.0} s", diagnosis.simulated),
    );
    page.verdict(colour(diagnosis), &headline(specimen, diagnosis));
    if !diagnosis.effects.is_empty() {
        page.outcome(in_brief(specimen.kind(), diagnosis));
    }
    page.text(&format!(
        "The noise ratio is the RMS of recording minus simulation, divided by the sensor noise; a ratio of 1 means that only \
         noise is left. A held-out noise ratio is computed on stretches of the recordings that were not used in the fit. The \
         simulation receives {} and no other measured value.",
        specimen.inputs_in_words()
    ));
    if !specimen.instruments().is_empty() {
        page.section("The instruments");
        page.text(
            "The recordings themselves show that these instruments are not as the model file states them. The noise by which residuals \
             are judged is the one given here.",
        );
        for finding in specimen.instruments() {
            page.text(&finding.text());
        }
    }
    evidence(&mut page, campaign, diagnosis);
    next::section(&mut page, campaign, diagnosis);
    if !campaign.notes.is_empty() {
        page.section("Notes on the recordings");
        campaign.notes.iter().for_each(|n| {
            page.text(n);
        });
    }
    page
}

/// The sections that show why the diagnosis says what it says.
pub(crate) fn evidence(page: &mut Page, campaign: &Campaign, diagnosis: &Diagnosis) {
    let specimen = &*campaign.specimen;
    portrait::section(page, specimen, diagnosis);
    locations::section(page, campaign, diagnosis);
    effects::section(page, campaign, diagnosis);
    model::section(page, specimen.kind(), diagnosis);
    improvement::section(page, campaign, diagnosis);
}

fn colour(diagnosis: &Diagnosis) -> Colour {
    match diagnosis.verdict() {
        Verdict::Consistent => Colour::Pass,
        Verdict::MissingPhysics if !diagnosis.selection.incomplete && !has_ambiguous_rival(diagnosis) => {
            Colour::Attention
        }
        _ => Colour::Fail,
    }
}

/// Whether the recordings cannot tell an effect from another one. The tolerances of the model speak against a wrong number.
fn has_ambiguous_rival(diagnosis: &Diagnosis) -> bool {
    (diagnosis.selection.effects.iter()).any(|effect| effect.ambiguous_rival().is_some())
}

/// The verdict in one or two sentences.
#[must_use]
pub fn headline(specimen: &dyn Specimen, diagnosis: &Diagnosis) -> String {
    let (kind, all) = (specimen.kind(), specimen.candidates());
    let (before, after) = (diagnosis.selection.calibrated_ratio, diagnosis.selection.improved_ratio);
    let (before, after) = (significant(before, 3), significant(after, 3));
    let mut text = match diagnosis.verdict() {
        Verdict::Consistent => format!(
            "Nothing is missing: recalibrated within its tolerances, the model predicts the held-out recordings with an RMS \
             error of {after} times the sensor noise."
        ),
        Verdict::MissingPhysics => format!(
            "{}. With {}, the RMS error on held-out recordings is {after} times the sensor noise; without \
             {}, it is {before} times.",
            words::of_the_model(
                &list(&phrases(kind, diagnosis, |e| !e.is_wrong_number())),
                &list(&phrases(kind, diagnosis, Effect::is_wrong_number)),
            ),
            these(diagnosis, "this effect", "these effects"),
            these(diagnosis, "it", "them"),
        ),
        Verdict::Unexplained => format!(
            "The model does not match the recordings: the held-out RMS error is {after} times the sensor noise. None of the \
             effects that were tried explains it."
        ),
    };
    if diagnosis.selection.incomplete && diagnosis.verdict() == Verdict::MissingPhysics {
        text += " Part of the misfit remains, and none of the effects that were tried explains it.";
    }
    if let Some(sentence) = complete_where_fitted(diagnosis) {
        text += " ";
        text += &sentence;
    }
    for effect in &diagnosis.selection.effects {
        let said = |c: &Candidate| format!("{} {}", of(c.id).called(kind, &c.label), words::at(&c.place));
        if let Some(rival) = effect.ambiguous_rival() {
            text += &format!(
                " The recordings cannot distinguish {} from {}. The last section says what to record to separate them.",
                said(&all[effect.candidate]),
                said(&all[rival])
            );
        }
        if let Some(number) = &effect.as_good {
            let candidate = &all[number.candidate];
            text += &format!(
                " The recordings cannot distinguish {} from {}{}, but the tolerance that the model states speaks \
                 against the latter.",
                said(&all[effect.candidate]),
                said(candidate),
                unlisted::equation(candidate, &number.values).map_or_else(String::new, |found| format!(" ({found})")),
            );
        }
    }
    text
}

/// Says why a model counts as complete although its held-out error is large; `None` where that is not so.
#[must_use]
pub fn complete_where_fitted(diagnosis: &Diagnosis) -> Option<String> {
    diagnosis.selection.complete_where_fitted.map(|fitted| {
        format!(
            "Where the model was fitted, the error is {} times the noise: nothing is missing there. It is larger on \
             parts that were held out, because the others do not determine every number well.",
            significant(fitted, 3)
        )
    })
}

/// The word for the effects found: the first for one effect, the second for several.
fn these(diagnosis: &Diagnosis, one: &'static str, several: &'static str) -> &'static str {
    let found = diagnosis.effects.iter().filter(|e| e.selected.is_some());
    if found.count() == 1 { one } else { several }
}

/// Some of the effects as phrases, one for each id, with all its places.
fn phrases(kind: SpecimenKind, diagnosis: &Diagnosis, of_these: fn(&Effect) -> bool) -> Vec<String> {
    let mut out: Vec<(String, String)> = Vec::new();
    let found = diagnosis.effects.iter().filter(|e| e.selected.is_some());
    for e in found.filter(|e| of_these(e)) {
        let mut name = of(e.id).called(kind, &e.label);
        if let Some(equation) = &e.equation {
            name += &format!(", {equation},");
        }
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
        [] => String::new(),
        [one] => one.clone(),
        [rest @ .., last] => format!("{} and {last}", rest.join(", ")),
    }
}

/// One row for each effect: its place, its size, the confidence in it and the improvement by it.
fn in_brief(kind: SpecimenKind, diagnosis: &Diagnosis) -> Table {
    let mut table = Table::new([
        Column::text("Missing effect"),
        Column::text("Place"),
        Column::text("Size (95 % interval)"),
        Column::number("Confidence"),
        Column::number("Held-out noise ratio without it"),
        Column::number("Held-out noise ratio with it"),
    ]);
    for e in &diagnosis.effects {
        let large: Vec<String> = (e.parameters.iter())
            .map(|p| {
                let (name, unit) = words::parameter(&p.key);
                let (value, interval) = words::value_and_interval(p.value, p.ci95);
                if unit.is_empty() {
                    format!("{name} {value} ({interval})")
                } else {
                    format!("{name} {value} {unit} ({interval})")
                }
            })
            .collect();
        let place = words::at(&e.place);
        table.row([
            format!("{} ({})", of(e.id).named(kind, &e.label), words::effect_name(e)),
            place.trim_start_matches("in ").trim_start_matches("at ").to_owned(),
            match points(e) {
                Some(n) if !effects::has_readable_numbers(e) => {
                    format!("a law of {n} points, drawn in the section \"What\"")
                }
                _ if e.selected.is_none() => "unknown, because no law was fitted".into(),
                _ if large.is_empty() => "none, because the effect is either present or absent".into(),
                _ => large.join("; "),
            },
            format!("{:.2}", e.confidence),
            format!("{:.2}", e.ratio_without),
            format!("{:.2}", e.ratio_with),
        ]);
    }
    table
}

/// Number of points of a law that was fitted as a table.
fn points(effect: &Effect) -> Option<usize> {
    effects::law(effect).map(|law| law.argument.len())
}

/// The laws that were found as equations, one line each, with their places.
#[must_use]
pub fn equations(diagnosis: &Diagnosis) -> Vec<String> {
    (diagnosis.effects.iter())
        .filter_map(|e| Some(format!("{}: {}", e.place.as_reported(), e.equation.as_ref()?)))
        .collect()
}

/// The effects, as printed on standard output.
#[must_use]
pub fn effects_table(diagnosis: &Diagnosis) -> Table {
    table_of_effects((diagnosis.effects.iter()).map(|e| (e, [e.ratio_without, e.ratio_with])))
}

/// Effects, each with its noise ratio without and with it, as a table.
pub(crate) fn table_of_effects<'a>(effects: impl Iterator<Item = (&'a Effect, [f64; 2])>) -> Table {
    let mut table = Table::new([
        Column::text("Effect"),
        Column::text("Place"),
        Column::number("Confidence"),
        Column::text("Parameters (95 % interval)"),
        Column::number("Noise ratio without it"),
        Column::number("Noise ratio with it"),
    ]);
    for (e, [without, with]) in effects {
        let numbers: Vec<String> = (e.parameters.iter())
            .map(|p| {
                let (value, interval) = words::value_and_interval(p.value, p.ci95);
                format!("{} = {value} ({interval})", p.key)
            })
            .collect();
        table.row([
            words::effect_name(e),
            e.place.as_reported(),
            format!("{:.2}", e.confidence),
            match points(e) {
                Some(n) if !effects::has_readable_numbers(e) => format!("a law of {n} points"),
                _ => numbers.join("; "),
            },
            format!("{without:.2}"),
            format!("{with:.2}"),
        ]);
    }
    table
}
