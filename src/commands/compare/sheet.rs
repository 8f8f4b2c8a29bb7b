//! Writes a comparison: tables, the traces on one axis, the summary and the page.

use oleo_report::{
    Axis, Cell, Column, Curves, Figure as Drawing, OutputDirectory, Page, Style, Table, Verdict, significant,
};
use serde_json::{Value, json};

use super::differences::{Check, ComparedFigure, ComparedTrace, Differences};
use super::figures::Figure;
use super::quantity::{axis, quantity};
use super::run::{Group, Run};
use super::tolerance::Allowed;
use super::traces::{Difference, Trace, at_places};
use crate::failure::Failure;
use crate::results::{ResultsArgs, command_line};

/// Traces of a vehicle that are drawn unless others are asked for.
const USUAL: [&str; 20] = [
    "roll_rad",
    "lateral_acceleration_m_s2",
    "driver_acceleration_m_s2",
    "rear_left_acceleration_m_s2",
    "heave_m",
    "pitch_rad",
    "yaw_rate_rad_s",
    "steer_rad",
    "lateral_m",
    "speed_m_s",
    "displacement_front_left_m",
    "displacement_front_right_m",
    "displacement_rear_left_m",
    "displacement_rear_right_m",
    "force_front_left_N",
    "force_rear_left_N",
    "wheel_load_front_left_N",
    "wheel_load_rear_left_N",
    "front_valves_open",
    "rear_valves_open",
];

/// The traces that are drawn.
pub enum Drawn {
    /// Those of [`USUAL`] that there are, or all if there are none of these.
    Usual,
    /// The named ones.
    Named(Vec<String>),
}

impl Drawn {
    /// The named ones, if there are any.
    pub fn of(names: &[String]) -> Self {
        match names {
            [] => Self::Usual,
            names => Self::Named(names.to_vec()),
        }
    }

    fn among<'a>(&self, traces: &'a [ComparedTrace]) -> Vec<&'a ComparedTrace> {
        let of = |names: &dyn Fn(&str) -> bool| traces.iter().filter(|trace| names(&trace.name)).collect::<Vec<_>>();
        match self {
            Self::Named(names) => of(&|name| names.iter().any(|named| named == name)),
            Self::Usual => {
                let usual: Vec<&ComparedTrace> = USUAL.iter().flat_map(|usual| of(&|name| name == *usual)).collect();
                if usual.is_empty() { of(&|_| true) } else { usual }
            }
        }
    }
}

/// Those that are not the same in all runs.
fn changed<'a>(traces: &[&'a ComparedTrace]) -> Vec<&'a ComparedTrace> {
    traces.iter().copied().filter(|trace| !trace.is_same()).collect()
}

/// A comparison that is complete.
pub struct Sheet<'a> {
    /// Column over which was compared.
    pub axis: &'static str,
    /// Whether every difference is a failure.
    pub equal: bool,
    pub drawn: Drawn,
    pub compared: Vec<(&'a Group, &'a Differences)>,
}

impl Sheet<'_> {
    /// Prints the tables and writes the folder. Returns whether everything that was asked for is met.
    pub fn publish(&self, results: &ResultsArgs, mut out: Option<OutputDirectory>) -> Result<bool, Failure> {
        let (verdict, sentence) = self.verdict();
        let mut text = format!("{sentence}\n");
        for (group, found) in &self.compared {
            if !group.name.is_empty() {
                text += &format!("{}:\n", group.name);
            }
            let tables = [
                check_table(&found.checks),
                figure_table(group, found.figures.iter().filter(|figure| !figure.is_same())),
                trace_table(group, self.axis, &changed(&self.drawn.among(&found.traces))),
            ];
            for table in tables.iter().filter(|table| !table.is_empty()) {
                text += &table.to_string();
            }
        }
        if let Some(out) = &mut out {
            for (group, found) in &self.compared {
                self.write_traces(out, group, found)?;
            }
            out.summary("summary.json", None, &self.summary(verdict))?;
            out.page(&self.page(verdict, &sentence))?;
        }
        results.publish(out, &text)?;
        Ok(verdict != Some(Verdict::Fail))
    }

    /// Whether what was asked for is met, in a word and a sentence. Without tolerances nothing is asked for.
    fn verdict(&self) -> (Option<Verdict>, String) {
        let checks = || self.compared.iter().flat_map(|(_, found)| &found.checks);
        let failed = checks().filter(|check| !check.judged.passed).count();
        let (figures, traces) = (self.compared.iter())
            .map(|(_, found)| found.unequal())
            .fold((0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
        let all: (usize, usize) = (self.compared.iter())
            .map(|(_, found)| (found.figures.len(), found.traces.len()))
            .fold((0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
        let same = match (figures, traces) {
            (0, 0) => format!("All {} figures and {} traces are the same.", all.0, all.1),
            _ => format!(
                "{figures} of {} figures and {traces} of {} traces differ.",
                all.0, all.1
            ),
        };
        let tolerances = match (checks().count(), failed) {
            (0, _) => String::new(),
            (1, 0) => "The tolerance is met. ".to_owned(),
            (count, 0) => format!("All {count} tolerances are met. "),
            (1, _) => "The tolerance is not met. ".to_owned(),
            (count, failed) => format!("{failed} of {count} tolerances are not met. "),
        };
        let unequal = self.equal && (figures, traces) != (0, 0);
        let verdict = match (failed > 0 || unequal, self.equal || checks().count() > 0) {
            (true, _) => Some(Verdict::Fail),
            (false, true) => Some(Verdict::Pass),
            (false, false) => None,
        };
        (verdict, format!("{tolerances}{same}"))
    }

    /// The quantities of all runs at the samples of the first.
    fn write_traces(&self, out: &mut OutputDirectory, group: &Group, found: &Differences) -> Result<(), Failure> {
        let places = group.runs[0].traces.axis(self.axis, &group.runs[0].name)?;
        let mut columns = vec![(self.axis.to_owned(), places.to_vec())];
        for trace in &found.traces {
            for run in &group.runs {
                if let Some(values) = quantity_at(run, &trace.name, self.axis, places)? {
                    columns.push((format!("{}.{}", plain(&run.name), trace.name), values));
                }
            }
        }
        let columns: Vec<(&str, &[f64])> = columns
            .iter()
            .map(|(name, values)| (name.as_str(), values.as_slice()))
            .collect();
        let file = if group.name.is_empty() { "traces" } else { &group.name };
        Ok(out.csv(&format!("{}.csv", plain(file)), &columns)?)
    }

    fn summary(&self, verdict: Option<Verdict>) -> Value {
        let groups = self.compared.iter().map(|(group, found)| {
            let runs: Vec<&str> = group.runs.iter().map(|run| run.name.as_str()).collect();
            json!({
                "recording": (!group.name.is_empty()).then_some(&group.name),
                "runs": runs,
                "figures": found.figures.iter().map(figure_json).collect::<Vec<_>>(),
                "traces": found.traces.iter().map(|trace| trace_json(group, trace)).collect::<Vec<_>>(),
                "checks": found.checks.iter().map(check_json).collect::<Vec<_>>(),
            })
        });
        json!({
            "over": self.axis,
            "passed": verdict.map(|verdict| verdict == Verdict::Pass),
            "groups": groups.collect::<Vec<_>>(),
        })
    }

    fn page(&self, verdict: Option<Verdict>, sentence: &str) -> Page {
        let mut page = Page::new("Comparison", &command_line());
        let over = quantity(self.axis);
        page.fact("Compared over", &format!("{}, {}", over.0.to_lowercase(), over.1));
        match verdict {
            Some(verdict) => page.verdict(verdict, sentence),
            None => page.text(sentence),
        };
        for (group, found) in &self.compared {
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
            let drawn = self.drawn.among(&found.traces);
            page.choice(
                "Trace",
                drawn
                    .iter()
                    .filter_map(|trace| Some((quantity(&trace.name).0, self.overlaid(group, trace)?))),
            );
            page.table(trace_table(group, self.axis, &drawn));
            page.details(
                "All traces",
                trace_table(group, self.axis, &found.traces.iter().collect::<Vec<_>>()),
            );
        }
        page
    }

    /// A trace of all runs, and below it what the others are apart from the first.
    fn overlaid(&self, group: &Group, trace: &ComparedTrace) -> Option<Drawing> {
        let (words, unit, factor) = quantity(&trace.name);
        let scaled = |values: &[f64]| values.iter().map(|value| factor * value).collect::<Vec<f64>>();
        let mut curves = Curves::new(&words, axis(self.axis));
        curves.height(560).panel(axis(&trace.name));
        for run in &group.runs {
            let own = run.traces.axis(self.axis, &run.name).ok()?;
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
        let places = first.traces.axis(self.axis, &first.name).ok()?;
        if let Some(Trace::Quantity(reference)) = first.traces.trace(&trace.name) {
            curves.panel(Axis::new(&format!("Less {}", first.name), unit));
            for run in &group.runs[1..] {
                if let Ok(Some(values)) = quantity_at(run, &trace.name, self.axis, places) {
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
}

/// The values of a quantity of a run at some places of the axis; `None` if the run has none.
fn quantity_at(run: &Run, name: &str, axis: &str, places: &[f64]) -> Result<Option<Vec<f64>>, Failure> {
    let Some(Trace::Quantity(values)) = run.traces.trace(name) else {
        return Ok(None);
    };
    Ok(Some(at_places(places, run.traces.axis(axis, &run.name)?, values)))
}

/// A name that needs no quotes in a header or as the name of a file.
fn plain(name: &str) -> String {
    let kept = |c: char| {
        if c.is_ascii_alphanumeric() || "-_".contains(c) {
            c
        } else {
            '-'
        }
    };
    name.replace(": ", "-").chars().map(kept).collect()
}

fn check_table(checks: &[Check]) -> Table {
    let mut table = Table::new([
        Column::text("Tolerance"),
        Column::text("Run"),
        Column::number("Allowed"),
        Column::number("Found"),
        Column::text("Met"),
    ]);
    for check in checks {
        let found = match (check.judged.found, check.allowed) {
            (found, _) if found.is_nan() => "cannot be compared".to_owned(),
            (found, Allowed::Percent(_)) => format!("{} %", significant(found, 3)),
            (found, Allowed::Noise(_)) => format!("{} x noise", significant(found, 3)),
            (found, Allowed::Absolute(_)) => significant(found, 4),
        };
        table.row::<Cell>([
            check.name.as_str().into(),
            check.run.as_str().into(),
            check.allowed.to_string().into(),
            found.into(),
            Cell::check(check.judged.passed),
        ]);
    }
    table
}

/// A row for each figure, a column for each run. Behind a number stands how much larger it is than that of the first run.
fn figure_table<'a>(group: &Group, figures: impl Iterator<Item = &'a ComparedFigure>) -> Table {
    let mut columns = vec![Column::text("Figure")];
    columns.extend(group.runs.iter().map(|run| Column::number(&run.name)));
    let mut table = Table::new(columns);
    for figure in figures {
        let first = figure.values.first().and_then(Option::as_ref);
        let cell = |value: &Option<Figure>| match (value, first) {
            (None, _) => "-".to_owned(),
            (Some(Figure::Word(word)), _) => word.clone(),
            (Some(own @ Figure::Number(number)), Some(Figure::Number(of))) if Some(own) != first && *of != 0.0 => {
                format!("{} ({:+.1} %)", significant(*number, 4), 100.0 * (number / of - 1.0))
            }
            (Some(Figure::Number(number)), _) => significant(*number, 4),
        };
        let mut row = vec![figure.name.clone()];
        row.extend(figure.values.iter().map(cell));
        table.row(row);
    }
    table
}

/// A row for each trace and run.
fn trace_table(group: &Group, axis: &str, traces: &[&ComparedTrace]) -> Table {
    let (over, over_unit, _) = quantity(axis);
    let noisy = !group.noise.is_empty();
    let mut columns = vec![
        Column::text("Trace"),
        Column::text("Run"),
        Column::number("RMS of the difference"),
        Column::number("Of the first's RMS"),
        Column::number("Largest difference"),
        Column::number(&format!("At {}, {over_unit}", over.to_lowercase())),
        Column::text("Unit"),
    ];
    if noisy {
        columns.push(Column::number("RMS / noise"));
    }
    let mut table = Table::new(columns);
    for trace in traces {
        let (words, unit, factor) = quantity(&trace.name);
        for (run, difference) in group.runs[1..].iter().zip(&trace.differences) {
            let mut row = vec![words.clone(), run.name.clone()];
            let noise = group.noise.get(&trace.name);
            match difference {
                None => row.extend(["-", "-", "-", "-", unit].map(str::to_owned)),
                Some(Difference::State(share)) => {
                    row.extend([
                        format!("{} %", significant(100.0 * share, 3)),
                        "-".into(),
                        "-".into(),
                        "-".into(),
                        "of the samples".into(),
                    ]);
                }
                Some(Difference::Quantity {
                    rms,
                    reference_rms,
                    largest,
                    at,
                }) => row.extend([
                    significant(factor * rms, 4),
                    match *reference_rms {
                        0.0 => "-".to_owned(),
                        of => format!("{} %", significant(100.0 * rms / of, 3)),
                    },
                    significant(factor * largest, 4),
                    significant(*at, 5),
                    unit.to_owned(),
                ]),
            }
            if noisy {
                row.push(match (difference, noise) {
                    (Some(Difference::Quantity { rms, .. }), Some(noise)) => significant(rms / noise, 3),
                    _ => "-".to_owned(),
                });
            }
            table.row(row);
        }
    }
    table
}

fn figure_json(figure: &ComparedFigure) -> Value {
    let value = |value: &Option<Figure>| match value {
        None => Value::Null,
        Some(Figure::Number(number)) => json!(number),
        Some(Figure::Word(word)) => json!(word),
    };
    json!({ "name": figure.name, "values": figure.values.iter().map(value).collect::<Vec<_>>() })
}

fn trace_json(group: &Group, trace: &ComparedTrace) -> Value {
    let noise = group.noise.get(&trace.name);
    let difference = |difference: &Option<Difference>| match difference {
        None => Value::Null,
        Some(Difference::State(share)) => json!({ "share": share }),
        Some(Difference::Quantity {
            rms,
            reference_rms,
            largest,
            at,
        }) => json!({
            "rms": rms, "reference_rms": reference_rms, "largest": largest, "at": at,
            "noise_ratio": noise.map(|noise| rms / noise),
        }),
    };
    json!({ "name": trace.name, "differences": trace.differences.iter().map(difference).collect::<Vec<_>>() })
}

fn check_json(check: &Check) -> Value {
    let found = check.judged.found;
    json!({
        "name": check.name, "run": check.run, "allowed": check.allowed.to_string(),
        "found": found.is_finite().then_some(found), "passed": check.judged.passed,
    })
}
