//! "What": the effects with equation and source, the rivals tested in their place, everything that was rejected.

use oleo_report::{Axis, Cell, Column, Curves, Page, Style, Table, significant};

use super::{name, words};
use crate::campaign::Campaign;
use crate::diagnosis::{Diagnosis, Effect};
use crate::effect::{Candidate, of};

pub fn section(page: &mut Page, campaign: &Campaign, diagnosis: &Diagnosis) {
    let all = campaign.specimen.candidates();
    page.section("What");
    let found = diagnosis.effects.iter().any(|e| e.selected.is_some());
    if !found {
        page.text("No effect improves held-out stretches by more than chance and the smoothing of the inputs do.");
    }
    for e in &diagnosis.effects {
        effect(page, campaign, e);
    }
    if found {
        page.text(
            "The strongest rival of each effect was fitted in its place, everything else fitted again with it, and judged on \
             the same held-out stretches. Lead: by how much the effect fits better, in standard errors over the stretches.",
        )
        .table(rivals(all, diagnosis));
    }
    let rejected = rejected(all, diagnosis);
    let summary = format!("All {} rejected candidates, with figures", rejected.len());
    page.details(&summary, rejected);
}

fn effect(page: &mut Page, campaign: &Campaign, e: &Effect) {
    let (kind, known) = (campaign.specimen.kind(), of(e.id));
    let named = known.named(kind, &e.label);
    if e.selected.is_none() {
        page.text(&format!(
            "{} {}: a misfit that can be predicted from the inputs is left, but no law that was tried improves unseen stretches enough to be named.",
            named,
            words::at(&e.place)
        ));
        return;
    }
    page.text(&format!(
        "{} {} ({}){}",
        words::sentence(named),
        words::at(&e.place),
        name(e),
        known.equation_in(kind, &e.label).map_or_else(
            || ".".to_owned(),
            |equation| format!(": {}; {}. Source: {}.", equation.text, known.meaning(), equation.source)
        ),
    ));
    if !e.parameters.is_empty() && e.law.as_ref().is_none_or(|l| l.get("argument").is_none()) {
        let mut table = Table::new([
            Column::text("Parameter"),
            Column::number("Value"),
            Column::text("95 % interval"),
            Column::text("Unit"),
        ]);
        for p in &e.parameters {
            let (name, unit) = words::quantity(&p.key);
            let (value, interval) = words::value_and_interval(p.value, p.ci95);
            let name = match known.symbol(&p.key) {
                None | Some("") => name,
                Some(symbol) => format!("{name}, {symbol}"),
            };
            table.row([name, value, interval, unit]);
        }
        page.table(table);
    }
    if let Some(figure) = e.law.as_ref().and_then(|law| tabulated(e, law)) {
        page.figure(figure);
    }
}

/// A law given as a table, drawn.
fn tabulated(effect: &Effect, law: &serde_json::Value) -> Option<Curves> {
    let series = |key: &str| -> Option<Vec<f64>> {
        law.get(key)?
            .as_array()?
            .iter()
            .map(serde_json::Value::as_f64)
            .collect()
    };
    let (argument, value) = (series("argument")?, series("value")?);
    let depends_on = law.get("depends_on")?.as_str()?.replace('_', " ");
    let unit = |quantity: &str| match quantity {
        "displacement" => "m",
        "speed" => "m/s",
        "p1" | "pressure drop" | "drop" => "Pa",
        "flow" => "m3/s",
        "force" => "N",
        "volume" => "m3",
        _ => "",
    };
    // Labels read "force over displacement", "series drop over flow, path 1", "flow beside pack 1 over ...".
    let given = ["force", "volume", "drop", "flow"].into_iter().find(|g| {
        effect
            .label
            .split(" over ")
            .next()
            .is_some_and(|first| first.contains(g))
    })?;
    let mut curves = Curves::new(
        &format!("The fitted law: {}", effect.label),
        Axis::new(&depends_on, unit(&depends_on)),
    );
    curves.caption("Linear between the points; zero at rest.");
    curves
        .panel(Axis::new(given, unit(given)))
        .series(Style::LineAndPoints, "fitted", &argument, &value);
    Some(curves)
}

fn rivals(all: &[Candidate], diagnosis: &Diagnosis) -> Table {
    let mut table = Table::new([
        Column::text("Effect"),
        Column::number("Noise ratio without"),
        Column::number("with it"),
        Column::text("Strongest rival in its place"),
        Column::number("Noise ratio with the rival"),
        Column::number("Lead, standard errors"),
        Column::text("Judgement"),
    ]);
    let with = diagnosis.selection.improved_ratio;
    let count: usize = diagnosis.residuals.improved.iter().flatten().map(Vec::len).sum();
    for c in &diagnosis.selection.effects {
        let mut row: Vec<Cell> = vec![
            all[c.candidate].name().into(),
            format!("{:.2}", c.ratio_without).into(),
            format!("{with:.2}").into(),
        ];
        match c.rival {
            Some(rival) => {
                let (lead, error) = (rival.lead.total, rival.lead.standard_error);
                let ratio = (with * with + lead / count.max(1) as f64).max(0.0).sqrt();
                row.extend([
                    all[rival.candidate].name().into(),
                    format!("{ratio:.2}").into(),
                    significant(lead / error.max(1.0), 2).into(),
                    if rival.ambiguous {
                        Cell::warning("cannot be told apart")
                    } else {
                        Cell::good("rival rejected")
                    },
                ]);
            }
            None => row.extend([
                "none could be fitted".into(),
                "-".into(),
                "-".into(),
                Cell::good("no rival"),
            ]),
        }
        table.row(row);
    }
    table
}

fn rejected(all: &[Candidate], diagnosis: &Diagnosis) -> Table {
    let selection = &diagnosis.selection;
    let after = selection.improved_ratio;
    let mut scores: Vec<_> = (selection.scores.iter())
        .filter(|t| !selection.best.point.effects.contains(&t.candidate))
        .collect();
    scores.sort_by(|a, b| a.alone.total_cmp(&b.alone));
    let mut table = Table::new([
        Column::text("Rejected"),
        Column::text("Place"),
        Column::number("Held-out noise ratio alone"),
        Column::number("added to the model found"),
        Column::text("Because"),
    ]);
    for t in scores {
        let c = &all[t.candidate];
        let because = match t.added {
            None => "excludes, or is excluded by, an effect found".to_owned(),
            Some(added) if added >= after => "does not improve what was held out".to_owned(),
            Some(added) => format!(
                "improves what was held out by {} % only",
                significant(100.0 * (1.0 - added / after), 2)
            ),
        };
        table.row([
            c.id.to_string(),
            c.place_and_label(),
            if t.alone.is_finite() {
                format!("{:.3}", t.alone)
            } else {
                "no fit".into()
            },
            t.added.map_or("-".into(), |a| format!("{a:.3}")),
            because,
        ]);
    }
    table
}
