//! Writes a comparison: what is printed, the traces on one axis, the summary and the page.

use oleo_report::{OutputDirectory, Verdict};
use serde_json::{Value, json};

use super::difference::{Difference, Size};
use super::differences::{Check, ComparedFigure, ComparedTrace, Differences};
use super::drawn::Drawn;
use super::figures::Figure;
use super::page::page;
use super::run::{Group, plain};
use super::tables::{check_table, figure_table, trace_table};
use crate::failure::Failure;
use crate::results::ResultsArgs;

/// Those that are not the same in all runs.
fn changed<'a>(traces: &[&'a ComparedTrace]) -> Vec<&'a ComparedTrace> {
    traces.iter().copied().filter(|trace| !trace.is_same).collect()
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
            out.page(&page(self.axis, &self.drawn, &self.compared, verdict, &sentence))?;
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
        let count = |number: usize, what: &str| format!("{number} {what}{}", if number == 1 { "" } else { "s" });
        let of = |differ: usize, number: usize, what: &str| match number {
            0 => None,
            number => Some(format!("{differ} of {}", count(number, what))),
        };
        let same = match (figures, traces) {
            (0, 0) if all.0 == 0 => format!("All {} are the same.", count(all.1, "trace")),
            (0, 0) => format!(
                "All {} and {} are the same.",
                count(all.0, "figure"),
                count(all.1, "trace")
            ),
            _ => {
                let parts = [of(figures, all.0, "figure"), of(traces, all.1, "trace")];
                format!(
                    "{} differ.",
                    parts.into_iter().flatten().collect::<Vec<_>>().join(" and ")
                )
            }
        };
        // A tolerance is held against every run but the first.
        let tolerances = match (checks().count(), failed) {
            (0, _) => String::new(),
            (1, 0) => "The tolerance is met. ".to_owned(),
            (1, _) => "The tolerance is not met. ".to_owned(),
            (count, 0) => format!("The tolerances are met in all {count} comparisons. "),
            (count, failed) => format!("The tolerances are not met in {failed} of {count} comparisons. "),
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
                if let Some(values) = run.quantity_at(&trace.name, self.axis, places)? {
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
        Some(Difference { size, compared }) => match size {
            Size::State(share) => json!({ "share": share, "compared": compared }),
            Size::Quantity {
                rms,
                reference_rms,
                largest,
                at,
            } => json!({
                "rms": rms, "reference_rms": reference_rms, "largest": largest, "at": at,
                "noise_ratio": noise.map(|noise| rms / noise), "compared": compared,
            }),
        },
    };
    json!({ "name": trace.name, "same": trace.is_same, "differences": trace.differences.iter().map(difference).collect::<Vec<_>>() })
}

fn check_json(check: &Check) -> Value {
    let found = check.judged.found;
    json!({
        "name": check.name, "run": check.run, "allowed": check.allowed.to_string(),
        "found": found.is_finite().then_some(found), "passed": check.judged.passed,
    })
}
