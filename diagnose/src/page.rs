//! `report.html`: where, what, model, how much better, what to record next, for somebody who was not there.

use oleo_report::{Axis, Bars, Cell, Column, Curves, Page, Style, Table, Verdict, significant};

use crate::campaign::Campaign;
use crate::diagnosis::Diagnosis;
use crate::json;

/// Samples drawn of one residual.
const DRAWN: usize = 4000;

/// The page.
#[must_use]
pub fn page(campaign: &Campaign, diagnosis: &Diagnosis, command: &str, runtime_s: f64) -> Page {
    let specimen = &*campaign.specimen;
    let mut page = Page::new(&format!("Diagnosis of {}", campaign.name), command);
    let selection = &diagnosis.selection;
    page.fact("specimen", specimen.kind());
    page.fact("recordings", &specimen.recordings().to_string());
    page.fact("simulations of one recording", &diagnosis.simulated.to_string());
    page.fact("time", &format!("{runtime_s:.1} s"));
    let names: Vec<String> = diagnosis
        .effects
        .iter()
        .map(|e| format!("{} ({})", e.id, e.place))
        .collect();
    let (verdict, sentence) = match diagnosis.verdict() {
        "consistent" => (
            Verdict::Pass,
            "Nothing is missing: the model, recalibrated within its tolerances, agrees with every recording."
                .to_owned(),
        ),
        "missing_physics" => (Verdict::Fail, format!("The model lacks: {}.", names.join(", "))),
        _ => (
            Verdict::Fail,
            "The model disagrees with the recordings, and nothing in the vocabulary explains it.".to_owned(),
        ),
    };
    page.verdict(
        verdict,
        &format!(
            "{sentence} Held-out noise ratio {:.2} before, {:.2} after (1 is perfect).",
            selection.noise_ratio.0, selection.noise_ratio.1
        ),
    );
    page.outcome(effects_table(diagnosis));
    where_it_is(&mut page, campaign, diagnosis);
    what_it_is(&mut page, campaign, diagnosis);
    the_model(&mut page, diagnosis);
    how_much_better(&mut page, diagnosis);
    page.section("What to record next");
    page.text(
        diagnosis
            .next_experiment
            .as_deref()
            .unwrap_or("Nothing is needed to tell the effects found from their rivals."),
    );
    let missing = json::not_tested(specimen);
    if missing.is_empty() {
        page.text("The recordings excite every effect of the vocabulary.");
    } else {
        let mut table = Table::new([
            Column::text("Not tested"),
            Column::text("Place"),
            Column::text("Because"),
        ]);
        for m in &missing {
            table.row([text(&m["id"]), text(&m["place"]), text(&m["why"])]);
        }
        page.text("Not tested is not the same as absent:").table(table);
    }
    if !campaign.notes.is_empty() {
        page.section("Remarks on the recordings");
        campaign.notes.iter().for_each(|n| {
            page.text(n);
        });
    }
    page
}

fn text(value: &serde_json::Value) -> Cell {
    Cell::from(value.as_str().unwrap_or_default())
}

/// The effects, as printed on standard output too.
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
                let end = |v: f64| if v.is_finite() { significant(v, 3) } else { "?".into() };
                format!(
                    "{} = {} [{}, {}]",
                    p.key,
                    significant(p.value, 4),
                    end(p.ci95[0]),
                    end(p.ci95[1])
                )
            })
            .collect();
        let name = if e.label.is_empty() {
            e.id.clone()
        } else {
            format!("{}: {}", e.id, e.label)
        };
        table.row([
            name,
            e.place.clone(),
            format!("{:.2}", e.confidence),
            numbers.join("; "),
            format!("{:.2}", e.held_out.0),
            format!("{:.2}", e.held_out.1),
        ]);
    }
    table
}

fn where_it_is(page: &mut Page, campaign: &Campaign, diagnosis: &Diagnosis) {
    let specimen = &*campaign.specimen;
    page.section("Where");
    let mut table = Table::new([
        Column::text("Place"),
        Column::number("Share of excess"),
        Column::text("Recording"),
        Column::text("Channel"),
        Column::text("Time, s"),
        Column::text("Condition"),
    ]);
    for l in &diagnosis.locations {
        table.row([
            l.place.clone(),
            format!("{:.0} %", 100.0 * l.share_of_excess),
            specimen.recording_name(l.recording).to_owned(),
            l.channel.clone(),
            format!("{:.2} to {:.2}", l.t_s[0], l.t_s[1]),
            l.condition.clone(),
        ]);
    }
    if table.is_empty() {
        page.text("No place stands out: no misfit beyond the noise is left after recalibration.");
    } else {
        page.text(
            "Share of excess: part of the misfit beyond noise of the recalibrated model that goes with this place.",
        )
        .table(table);
    }
    if diagnosis.relations.iter().any(|r| r.noise_ratio.is_some()) {
        let mut table = Table::new([
            Column::text("Relation between measured neighbours"),
            Column::number("Noise ratio"),
            Column::number("Samples"),
        ]);
        for r in &diagnosis.relations {
            let value = r.noise_ratio.map_or("not excited".into(), |v| format!("{v:.2}"));
            table.row([r.name.to_owned(), value, r.samples.to_string()]);
        }
        page.text("These need no simulation: 1 means the measured signals agree with each other, much more that physics or an instrument between them is not as believed.").table(table);
    }
    // The recording in which it shows most; where nothing was found, the first.
    let first = diagnosis.locations.first();
    let recording = first.map_or(0, |l| l.recording);
    let channel = first
        .and_then(|l| specimen.channels().iter().position(|c| c.name == l.channel))
        .unwrap_or(0);
    let time = specimen.time_s(recording);
    let every = time.len().div_ceil(DRAWN);
    let thin = |v: &[f64]| -> Vec<f64> { v.iter().step_by(every).copied().collect() };
    let (before, after) = (
        &diagnosis.residuals.0[recording][channel],
        &diagnosis.residuals.1[recording][channel],
    );
    let name = &specimen.channels()[channel].name;
    let mut curves = Curves::new(
        &format!("Residual of {name} in {}", specimen.recording_name(recording)),
        Axis::new("Time", "s"),
    );
    curves.caption("Recording minus simulation over the sensor's noise; marked: where the misfit is largest.");
    let panel = curves.panel(Axis::new("Residual", "noise"));
    panel
        .line("recalibrated only", &thin(time), &thin(before))
        .line("improved model", &thin(time), &thin(after));
    if let Some(l) = first {
        panel.region(l.t_s[0], l.t_s[1], "largest misfit");
    }
    page.figure(curves);
    for (state, values) in specimen.states(recording) {
        let (quantity, unit) = state.rsplit_once(", ").unwrap_or((state, ""));
        let mut curves = Curves::new(
            &format!("Residual of {name} over {quantity}"),
            Axis::new(quantity, unit),
        );
        curves
            .panel(Axis::new("Residual", "noise"))
            .series(Style::Points, "recalibrated only", &thin(&values), &thin(before))
            .series(Style::Points, "improved model", &thin(&values), &thin(after));
        page.figure(curves);
    }
}

fn what_it_is(page: &mut Page, campaign: &Campaign, diagnosis: &Diagnosis) {
    let specimen = &*campaign.specimen;
    let all = specimen.candidates();
    page.section("What");
    for chosen in &diagnosis.selection.chosen {
        let rival = chosen.rival.map_or(
            "no rival could be fitted in its place".to_owned(),
            |(id, lead, error)| {
                format!(
                    "its strongest rival, {}, is worse by {} in squared noise units (standard error {}){}",
                    all[id].name(),
                    significant(lead, 3),
                    significant(error, 2),
                    if chosen.ambiguous {
                        ": the recordings cannot tell the two apart"
                    } else {
                        ""
                    }
                )
            },
        );
        page.text(&format!(
            "{}: without it the held-out noise ratio is {:.2}, with it {:.2}; {rival}.",
            all[chosen.candidate].name(),
            chosen.without,
            diagnosis.selection.noise_ratio.1
        ));
    }
    if diagnosis.selection.chosen.is_empty() {
        page.text("No effect improves held-out blocks by more than chance and smoothing errors do.");
    }
    let mut table = Table::new([Column::text("Rejected"), Column::text("Place"), Column::text("Because")]);
    for r in json::rejected(specimen, diagnosis) {
        table.row([text(&r["id"]), text(&r["place"]), text(&r["why"])]);
    }
    page.details("Rejected candidates, with figures", table);
}

fn the_model(page: &mut Page, diagnosis: &Diagnosis) {
    page.section("Model");
    page.text("The improved model is model.toml beside this page; it runs in oleo predict, oleo rig and oleo hil as it is. Recalibration within tolerance is part of it and is not physics:");
    let mut table = Table::new([
        Column::text("Calibration"),
        Column::number("Value"),
        Column::text("95 % interval"),
        Column::number("Part of tolerance used"),
    ]);
    for (e, z) in &diagnosis.calibration {
        table.row([
            e.key.clone(),
            significant(e.value, 3),
            format!("{} to {}", significant(e.ci95[0], 3), significant(e.ci95[1], 3)),
            format!("{:.2}", 0.5 * z.abs()),
        ]);
    }
    page.details("Calibration", table);
    for (a, b, r) in &diagnosis.correlated {
        page.text(&format!(
            "Correlated estimates: {a} and {b}, r = {r:.2}; only their combination is well determined."
        ));
    }
}

fn how_much_better(page: &mut Page, diagnosis: &Diagnosis) {
    page.section("How much better");
    let channels = &diagnosis.channels;
    let names: Vec<&str> = channels.iter().map(|c| c.name.as_str()).collect();
    let column = |f: fn(&crate::diagnosis::ChannelFigures) -> f64| channels.iter().map(f).collect::<Vec<_>>();
    let mut bars = Bars::new(
        "Noise ratio per channel",
        names,
        Axis::new("RMS residual", "noise").logarithmic(),
    );
    bars.caption("Held out: simulated with parameters fitted without the block that is judged. 1 is perfect.");
    bars.series("as given", &column(|c| c.before))
        .series("recalibrated, held out", &column(|c| c.held_out_before))
        .series("improved, held out", &column(|c| c.held_out_after));
    page.figure(bars);
    let mut table = Table::new([
        Column::text("Channel"),
        Column::number("As given"),
        Column::number("Recalibrated, held out"),
        Column::number("Improved"),
        Column::number("Improved, held out"),
        Column::number("Lag-one correlation"),
    ]);
    for c in channels {
        table.row([
            c.name.clone(),
            format!("{:.2}", c.before),
            format!("{:.2}", c.held_out_before),
            format!("{:.2}", c.after),
            format!("{:.2}", c.held_out_after),
            format!("{:.2}", c.lag_one),
        ]);
    }
    page.text("Lag-one correlation of the improved model's residuals: 0 is white noise, 1 a slow error that is left.")
        .table(table);
}
