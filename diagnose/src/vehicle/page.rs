//! `report.html` of a vehicle: which corner and which effect, the corners beside each other, then the evidence of each corner.

use oleo_interface::Corner;
use oleo_report::{Cell, Column, Page, Table, Verdict as Colour, significant};

use super::body;
use super::campaign::VehicleCampaign;
use super::diagnosis::{VehicleDiagnosis, VehicleEffect};
use super::driven;
use crate::diagnosis::Verdict;
use crate::effect::of;
use crate::page::{evidence, table_of_effects, words};
use crate::vocabulary::{Place, SpecimenKind, VehiclePart};

/// Builds `report.html`.
#[must_use]
pub fn page(campaign: &VehicleCampaign, diagnosis: &VehicleDiagnosis, command: &str, runtime_s: f64) -> Page {
    let mut page = Page::new(&format!("Diagnosis of {}", campaign.model.name), command);
    page.fact("Specimen", "vehicle with four two-stage hydropneumatic struts");
    let first = &*campaign.corners[Corner::FrontLeft].specimen;
    let names: Vec<&str> = first.recordings().iter().map(|r| r.name.as_str()).collect();
    page.fact("Drives used", &format!("{}: {}", names.len(), names.join(", ")));
    let simulated: usize = diagnosis.corners.values().map(|d| d.simulated).sum();
    page.fact(
        "Computation",
        &format!("{simulated} stretches of one strut simulated in {runtime_s:.0} s"),
    );
    let colour = match diagnosis.verdict() {
        Verdict::Consistent if names_body(diagnosis) => Colour::Attention,
        Verdict::Consistent => Colour::Pass,
        Verdict::MissingPhysics => Colour::Attention,
        Verdict::Unexplained => Colour::Fail,
    };
    page.verdict(colour, &headline(diagnosis));
    if !diagnosis.effects.is_empty() {
        page.outcome(effects_table(diagnosis));
    }
    page.text(
        "The noise ratio is the RMS of recording minus simulation, divided by the noise of each sample: that of the sensor, the rounding \
         of the bus, and what the readings leave unknown of the motion and of the edges of the valves. A ratio of 1 means that only these \
         are left. A held-out noise ratio is computed on stretches that were not used in \
         the fit. Each strut is simulated with its displacement and the commands to its valves; it receives no measured pressure. No \
         force is recorded in a vehicle, so that friction of the main seal and contact at the end stops cannot be seen.",
    );
    if let Some(found) = &diagnosis.body {
        body::section(&mut page, found);
    }
    if let Some(felt) = &diagnosis.driven {
        driven::section(&mut page, felt);
    }
    page.section("The four corners beside each other");
    page.text("Held-out noise ratios of each strut, recalibrated within its tolerances and improved by the effects that were found there.");
    page.table(corners(diagnosis));
    for shared in diagnosis.effects_of(VehiclePart::All) {
        common(&mut page, diagnosis, shared);
    }
    for (corner, own) in diagnosis.corners.iter() {
        let name = words::sentence(&corner.name().replace('-', " "));
        if own.verdict() == Verdict::Consistent {
            continue;
        }
        page.section(&format!("{name}: evidence"));
        page.text(&format!(
            "The sections up to the next corner are about the {} strut alone.",
            corner.name()
        ));
        evidence(&mut page, &campaign.corners[corner], own);
    }
    page.section("What was used of the drives");
    for note in &campaign.notes {
        page.text(note);
    }
    not_tested(&mut page, campaign);
    page
}

/// The verdict in one or two sentences.
#[must_use]
pub fn headline(diagnosis: &VehicleDiagnosis) -> String {
    let ratios = |ratio: fn(&crate::Diagnosis) -> f64| {
        let all = diagnosis.corners.values().map(ratio);
        significant(all.fold(0.0, f64::max), 3)
    };
    let after = ratios(|d| d.selection.improved_ratio);
    let unexplained: Vec<&str> = (diagnosis.corners.iter())
        .filter(|(_, d)| d.selection.incomplete)
        .map(|(corner, _)| corner.name())
        .collect();
    let mut text = match diagnosis.verdict() {
        Verdict::Consistent => format!(
            "Nothing is missing at any corner: recalibrated within their tolerances, the models of all four struts predict held-out \
             stretches with RMS errors of at most {after} times the noise."
        ),
        Verdict::MissingPhysics => {
            let found = |wrong_number: bool| -> Vec<String> {
                let found = diagnosis.effects.iter().filter(|e| e.effect.selected.is_some());
                (found.filter(|e| e.effect.is_wrong_number() == wrong_number))
                    .map(phrase)
                    .collect()
            };
            format!(
                "{}. At the worst corner the held-out RMS error falls from {} to {after} times the noise.",
                words::of_the_model(&found(false).join("; "), &found(true).join("; ")),
                ratios(|d| d.selection.calibrated_ratio),
            )
        }
        Verdict::Unexplained => {
            "The model does not match the drives, and none of the effects that were tried explains it.".into()
        }
    };
    if !unexplained.is_empty() {
        text += &format!(" Part of the misfit remains unexplained ({}).", unexplained.join(", "));
    }
    text += &diagnosis.body.as_ref().map_or_else(String::new, body::sentence);
    text
}

/// Whether the balance of the body names something.
fn names_body(diagnosis: &VehicleDiagnosis) -> bool {
    (diagnosis.balanced()).is_some_and(|findings| !findings.effects.is_empty())
}

/// An effect as a phrase: its name, the place in the strut, and the corner.
fn phrase(found: &VehicleEffect) -> String {
    let e = &found.effect;
    let name = of(e.id).called(SpecimenKind::TwoStageStrut, &e.label);
    let place = words::at(&Place::on_rig(e.place.site.clone()));
    match e.place.part {
        Some(VehiclePart::Corner(corner)) => format!("{name} {place} of the {} strut", corner.name()),
        _ => format!("{name} {place} of all four struts, with one value"),
    }
}

/// The effects, for the page and for standard output.
#[must_use]
pub fn effects_table(diagnosis: &VehicleDiagnosis) -> Table {
    table_of_effects(diagnosis.effects.iter().map(|found| (&found.effect, found.ratios)))
}

fn corners(diagnosis: &VehicleDiagnosis) -> Table {
    let mut table = Table::new([
        Column::text("Strut"),
        Column::text("Found"),
        Column::number("Recalibrated"),
        Column::number("Improved"),
        Column::text("Largest calibration, part of its tolerance"),
    ]);
    for (corner, own) in diagnosis.corners.iter() {
        let found: Vec<String> = own.effects.iter().map(words::effect_name).collect();
        let most = own
            .calibration
            .iter()
            .max_by(|a, b| a.tolerance_used.total_cmp(&b.tolerance_used));
        table.row([
            Cell::from(corner.name()),
            if found.is_empty() {
                Cell::good("nothing")
            } else {
                Cell::warning(found.join(", "))
            },
            Cell::from(format!("{:.2}", own.selection.calibrated_ratio)),
            Cell::from(format!("{:.2}", own.selection.improved_ratio)),
            Cell::from(most.map_or_else(String::new, |c| {
                format!("{}: {:.0} %", c.estimate.key, 100.0 * c.tolerance_used)
            })),
        ]);
    }
    table
}

/// A common value beside those of the corners.
fn common(page: &mut Page, diagnosis: &VehicleDiagnosis, shared: &VehicleEffect) {
    let e = &shared.effect;
    page.text(&format!(
        "All four struts have the effect {}, and their estimates do not contradict each other. It is therefore reported once for the \
         vehicle, with the mean of the four, weighted by their intervals. A strut with an interval that contains nothing does not show it alone, but \
         its recordings do not speak against it.",
        words::effect_name(e)
    ));
    let mut table = Table::new([
        Column::text("Parameter"),
        Column::text("Part"),
        Column::text("Value (95 % interval)"),
    ]);
    for (k, pooled) in e.parameters.iter().enumerate() {
        let mut row = |part: &str, value: f64, ci95: [f64; 2]| {
            let (value, interval) = words::value_and_interval(value, ci95);
            table.row([pooled.key.clone(), part.to_owned(), format!("{value} ({interval})")]);
        };
        row("vehicle", pooled.value, pooled.ci95);
        for (corner, own) in diagnosis.at_corners(e, k).iter() {
            if let Some(own) = own {
                row(corner.name(), own.value, own.ci95);
            }
        }
    }
    page.table(table);
}

/// What the drives cannot show, once for all corners that share the reason.
fn not_tested(page: &mut Page, campaign: &VehicleCampaign) {
    let mut rows: Vec<([String; 3], Vec<&str>)> = Vec::new();
    for (corner, own) in campaign.corners.iter() {
        for missing in crate::json::not_tested(&*own.specimen) {
            let text = |key: &str| missing[key].as_str().unwrap_or_default().to_owned();
            let row = [text("id"), text("place"), text("why")];
            match rows.iter_mut().find(|(known, _)| *known == row) {
                Some((_, corners)) => corners.push(corner.name()),
                None => rows.push((row, vec![corner.name()])),
            }
        }
    }
    let mut table = Table::new([
        Column::text("Effect that was not tested"),
        Column::text("Place"),
        Column::text("Corners"),
        Column::text("Reason, and what to record"),
    ]);
    for ([id, place, why], corners) in rows {
        let corners = if corners.len() == Corner::ALL.len() {
            "all".to_owned()
        } else {
            corners.join(", ")
        };
        table.row([id, place, corners, why]);
    }
    page.details("Effects that these drives cannot show", table);
}
