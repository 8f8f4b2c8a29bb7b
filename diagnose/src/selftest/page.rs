//! The results of the self-test as tables and as a page with figures.

use oleo_report::{Axis, Column, Curves, Field, FieldStyle, Page, Style, Table, Verdict, significant};

use super::plan::SIZES;
use super::statistics::Rate;
use super::summary::{Nameless, Summary};
use crate::effect::in_struts;
use crate::vocabulary::EffectId;

/// The claim that is tested on complete models.
const MOST_FALSE_ALARMS: f64 = 0.01;

/// Tables with their titles.
#[must_use]
pub fn tables(s: &Summary) -> Vec<(&'static str, Table)> {
    let mut all = Vec::new();
    if !s.power.is_empty() {
        all.push((
            "Detection rate: found, placed, sized / campaigns, by size in units of noise",
            power_table(s),
        ));
    }
    if !s.confusion.is_empty() {
        all.push(("Confusion: reported effects by concealed effect", confusion_table(s)));
    }
    if s.false_alarms.of + s.pairs_exact.of + s.triples_exact.of > 0 {
        all.push(("Rates", rates_table(s)));
    }
    if !s.several.is_empty() {
        all.push(("Several effects at once, by size in units of noise", several_table(s)));
    }
    if !s.coverage.is_empty() {
        all.push((
            "Coverage of the 95 % intervals, for effects found at the right place",
            coverage_table(s),
        ));
    }
    if !s.reliability.is_empty() {
        all.push(("Confidence against observed frequency", reliability_table(s)));
    }
    if let Some(c) = &s.calibration {
        let mut table = Table::new([Column::text("Evidence"), Column::number("Weight")]);
        for (name, weight) in c.names.iter().zip(&c.weights) {
            table.row([(*name).to_owned(), format!("{weight:.3}")]);
        }
        all.push(("Weights of the evidence, fitted to these campaigns", table));
    }
    if !s.nameless.is_empty() {
        all.push(("Effects removed from the search", nameless_table(s)));
    }
    if !s.instruments.is_empty() {
        all.push(("Instruments with flaws", instruments_table(s)));
    }
    if !s.failed.is_empty() {
        let mut table = Table::new([Column::text("Campaign"), Column::text("Reason")]);
        for (name, why) in &s.failed {
            table.row([name.as_str(), why.as_str()]);
        }
        all.push(("Campaigns without a diagnosis", table));
    }
    all
}

fn fraction(rate: Rate) -> String {
    format!("{} / {}", rate.hits, rate.of)
}

fn with_interval(rate: Rate) -> String {
    if rate.of == 0 {
        return "-".into();
    }
    let [low, high] = rate.interval();
    format!("{:.3} [{low:.3}, {high:.3}]", rate.part())
}

fn power_table(s: &Summary) -> Table {
    let mut columns = vec![Column::text("Concealed effect")];
    columns.extend(SIZES.map(|size| Column::text(&format!("{size}"))));
    columns.push(Column::number("False effect reported as well"));
    let mut table = Table::new(columns);
    for term in in_struts() {
        let rows: Vec<_> = s.power.iter().filter(|p| p.term == term).collect();
        if rows.is_empty() {
            continue;
        }
        let mut cells = vec![term.to_string()];
        for size in SIZES {
            let cell = rows.iter().find(|p| p.size == size).map(|p| {
                let (f, l, z) = (p.found.hits, p.placed.hits, p.sized.hits);
                format!("{f} {l} {z} / {}", p.found.of)
            });
            cells.push(cell.unwrap_or_default());
        }
        let beside = rows.iter().fold(Rate::default(), |sum, p| Rate {
            hits: sum.hits + p.false_beside.hits,
            of: sum.of + p.false_beside.of,
        });
        cells.push(fraction(beside));
        table.row(cells);
    }
    table
}

fn confusion_table(s: &Summary) -> Table {
    let mut table = Table::new([
        Column::text("Concealed effect"),
        Column::text("Reported effects and number of campaigns"),
    ]);
    for (hidden, row) in &s.confusion {
        let mut reported: Vec<(&String, &usize)> = row.iter().collect();
        reported.sort_by(|a, b| b.1.cmp(a.1).then(a.0.cmp(b.0)));
        let text: Vec<String> = reported.iter().map(|(id, n)| format!("{id} {n}")).collect();
        table.row([hidden.clone(), text.join(", ")]);
    }
    table
}

fn rates_table(s: &Summary) -> Table {
    let mut table = Table::new([
        Column::text("Rate"),
        Column::number("Campaigns"),
        Column::number("Fraction [95 % interval]"),
    ]);
    for (name, rate) in [
        (
            "false alarms: an effect is reported although the model is complete",
            s.false_alarms,
        ),
        ("two concealed effects: exactly these two are reported", s.pairs_exact),
        ("two concealed effects: each of them is found", s.pairs_found),
        (
            "three concealed effects: exactly these three are reported",
            s.triples_exact,
        ),
        ("three concealed effects: each of them is found", s.triples_found),
        (
            "unseen recordings are predicted better with the found effects",
            s.unseen_better,
        ),
        ("the true size is inside its 95 % interval", s.size_coverage),
    ] {
        table.row([name.to_owned(), fraction(rate), with_interval(rate)]);
    }
    table
}

fn several_table(s: &Summary) -> Table {
    let mut table = Table::new([
        Column::number("Concealed effects"),
        Column::number("Size"),
        Column::number("Found, of the effects of this size"),
        Column::number("Exact, of the campaigns whose smallest effect has this size"),
    ]);
    for row in &s.several {
        table.row([
            row.concealed.to_string(),
            row.size.to_string(),
            fraction(row.found),
            fraction(row.exact),
        ]);
    }
    table
}

fn coverage_table(s: &Summary) -> Table {
    let mut table = Table::new([
        Column::text("Effect"),
        Column::text("Parameter"),
        Column::number("Covered"),
        Column::number("Fraction [95 % interval]"),
        Column::number("Intervals without an end"),
    ]);
    for c in s.coverage.iter().filter(|c| !c.key.is_empty()) {
        table.row([
            c.term.to_string(),
            c.key.clone(),
            fraction(c.covered),
            with_interval(c.covered),
            c.unbounded.to_string(),
        ]);
    }
    table
}

fn reliability_table(s: &Summary) -> Table {
    let mut table = Table::new([
        Column::text("Confidence"),
        Column::number("Mean confidence"),
        Column::number("Effects that are present"),
        Column::number("Fraction [95 % interval]"),
    ]);
    for r in &s.reliability {
        table.row([
            format!("{:.1} to {:.1}", r.from, r.to),
            format!("{:.2}", r.mean),
            fraction(r.there),
            with_interval(r.there),
        ]);
    }
    table
}

fn nameless_table(s: &Summary) -> Table {
    let mut table = Table::new([
        Column::text("Removed effect"),
        Column::number("Reported as unlisted"),
        Column::number("At its place"),
        Column::number("Under another name"),
        Column::number("Noise ratio on unseen recordings before"),
        Column::number("Noise ratio on unseen recordings after"),
        Column::number("Of the true model"),
        Column::number("Within 1.2 times that"),
        Column::text("Reported places"),
    ]);
    for n in &s.nameless {
        let places: Vec<String> = n.places.iter().map(|(p, count)| format!("{p} {count}")).collect();
        table.row([
            n.term.to_string(),
            fraction(n.unlisted),
            fraction(n.placed),
            fraction(n.misnamed),
            significant(n.before, 3),
            significant(n.after, 3),
            significant(n.floor, 3),
            fraction(n.near_floor),
            places.join(", "),
        ]);
    }
    if s.nameless.len() > 1 {
        let sum = |rate: fn(&Nameless) -> Rate| {
            fraction((s.nameless.iter()).fold(Rate::default(), |sum, n| Rate {
                hits: sum.hits + rate(n).hits,
                of: sum.of + rate(n).of,
            }))
        };
        table.row([
            "all".to_owned(),
            sum(|n| n.unlisted),
            sum(|n| n.placed),
            sum(|n| n.misnamed),
            String::new(),
            String::new(),
            String::new(),
            sum(|n| n.near_floor),
            String::new(),
        ]);
    }
    table
}

fn instruments_table(s: &Summary) -> Table {
    let mut table = Table::new([
        Column::text("Flaw of the instruments"),
        Column::number("Said"),
        Column::number("Something else said as well or instead"),
        Column::number("False effect reported"),
        Column::number("Unnamed remainder reported"),
        Column::number("Concealed effects found"),
        Column::number("Noise ratio"),
    ]);
    for f in &s.instruments {
        table.row([
            f.flaw.to_string(),
            fraction(f.said),
            fraction(f.said_else),
            fraction(f.false_effect),
            fraction(f.remainder),
            fraction(f.found),
            significant(f.noise_ratio, 3),
        ]);
    }
    table
}

/// Builds the page of the self-test.
#[must_use]
pub fn page(s: &Summary, command: &str) -> Page {
    let mut page = Page::new("Self-test of the diagnosis", command);
    page.fact("campaigns", &s.trials.to_string());
    page.fact("seed", &s.seed.to_string());
    let rate = s.false_alarms;
    if rate.of > 0 {
        // Judged by the rate seen; the interval says how much that is worth.
        let verdict = if rate.part() <= MOST_FALSE_ALARMS {
            Verdict::Pass
        } else {
            Verdict::Fail
        };
        let sentence = format!(
            "An effect was reported for {} of {} complete models, a rate of {}. The claimed limit is {MOST_FALSE_ALARMS}.",
            rate.hits,
            rate.of,
            with_interval(rate)
        );
        page.verdict(verdict, &sentence);
    }
    let mut tables = tables(s).into_iter();
    if let Some((title, table)) = tables.next() {
        page.outcome(table);
        page.section(title).text(
            "The size of an effect is the RMS, over all channels and samples, of what the effect changes after recalibration \
             within tolerance, divided by the noise. Each campaign is counted at the nearest size. An effect is found if its \
             name is reported, placed if it is reported at its place and no other, and sized if its first parameter is within a \
             fifth of the truth or the 95 % interval contains the truth.",
        );
        if !s.power.is_empty() {
            page.figure(power_picture(s));
        }
    }
    for (title, table) in tables {
        page.section(title).table(table);
        if title.starts_with("Confusion") {
            page.figure(confusion_picture(s));
        }
        if title.starts_with("Confidence") {
            page.figure(reliability_picture(s));
        }
    }
    page.section("Limits of the self-test").text(
        "The recordings are simulated with the same equations that the search uses, on a finer grid. Whether these equations are \
         right is tested with recordings of an independent simulator and of real hardware.",
    );
    page
}

/// Part of the campaigns in which each term is found, by size.
fn power_picture(s: &Summary) -> Field {
    let part = |term: EffectId, size: f64| {
        (s.power.iter().find(|p| p.term == term && p.size == size)).map_or(f64::NAN, |p| p.placed.part())
    };
    let z: Vec<Vec<f64>> = in_struts()
        .into_iter()
        .map(|t| SIZES.iter().map(|&size| part(t, size)).collect())
        .collect();
    let sizes: Vec<String> = SIZES.iter().map(f64::to_string).collect();
    let columns: Vec<f64> = (0..SIZES.len()).map(|k| k as f64).collect();
    let rows: Vec<f64> = (0..in_struts().len()).map(|k| k as f64).collect();
    let axes = [
        Axis::new("Size", "units of noise").ticks(columns.iter().copied().zip(sizes.iter().map(String::as_str))),
        Axis::new("", "").ticks(rows.iter().copied().zip(in_struts().into_iter().map(EffectId::as_str))),
        Axis::new("Part", ""),
    ];
    let mut field = Field::new("Found at its place", FieldStyle::HeatMap, axes, &columns, &rows, &z);
    field.caption("A gap means that no campaign had this size.");
    field
}

/// Rows concealed, columns reported, as part of the row's campaigns.
fn confusion_picture(s: &Summary) -> Field {
    let hidden: Vec<&str> = s.confusion.keys().map(String::as_str).collect();
    let mut reported: Vec<&str> = s
        .confusion
        .values()
        .flat_map(|r| r.keys().map(String::as_str))
        .collect();
    reported.sort_unstable();
    reported.dedup();
    let total = |row: &str| {
        let all: usize = s
            .power
            .iter()
            .filter(|p| p.term.as_str() == row)
            .map(|p| p.found.of)
            .sum();
        if all > 0 { all } else { s.false_alarms.of.max(1) }
    };
    let z: Vec<Vec<f64>> = (hidden.iter())
        .map(|h| {
            let of = total(h) as f64;
            reported
                .iter()
                .map(|r| s.confusion[*h].get(*r).map_or(0.0, |n| *n as f64 / of))
                .collect()
        })
        .collect();
    let x: Vec<f64> = (0..reported.len()).map(|k| k as f64).collect();
    let y: Vec<f64> = (0..hidden.len()).map(|k| k as f64).collect();
    let axes = [
        Axis::new("Reported", "").ticks(x.iter().copied().zip(reported.iter().copied())),
        Axis::new("Concealed", "").ticks(y.iter().copied().zip(hidden.iter().copied())),
        Axis::new("Fraction of campaigns", ""),
    ];
    Field::new("Confusion, all sizes", FieldStyle::HeatMap, axes, &x, &y, &z)
}

fn reliability_picture(s: &Summary) -> Curves {
    let column = |of: &dyn Fn(&super::summary::Reliability) -> f64| s.reliability.iter().map(of).collect::<Vec<f64>>();
    let mut curves = Curves::new("Reliability", Axis::new("Confidence reported", "").range(0.45, 1.02));
    curves
        .panel(Axis::new("Fraction that is present", "").range(0.0, 1.05))
        .series(Style::Dashed, "calibrated", &[0.5, 1.0], &[0.5, 1.0])
        .points_with_interval(
            "reports",
            &column(&|r| r.mean),
            &column(&|r| r.there.part()),
            &column(&|r| r.there.interval()[0]),
            &column(&|r| r.there.interval()[1]),
        );
    curves
}
