//! The section "The improved model": what was added to the model file, what recalibration changed, and the file itself.

use oleo_report::{Cell, Column, Page, Table, significant};

use super::words;
use crate::diagnosis::{Correlation, Diagnosis};
use crate::vocabulary::SpecimenKind;

pub fn section(page: &mut Page, kind: SpecimenKind, diagnosis: &Diagnosis) {
    page.section("The improved model");
    let file = match kind {
        SpecimenKind::CoSimulation => "map.toml",
        _ => "model.toml",
    };
    if kind == SpecimenKind::CoSimulation {
        page.text(
            "The improved model is the model as it was given, run with the file map.toml beside this page: it has the format of the given map, with \
             the recalibrated values and with what was added from outside. Give it to oleo diagnose --fmu as --map.",
        );
    } else {
        page.text(
        "The improved model is the file model.toml beside this page. It has the format of the given model. To simulate the inputs \
         of another recording with it, run oleo predict --model model.toml RECORDING.csv --out SIM.csv.",
        );
    }
    if kind == SpecimenKind::TwoStageStrut {
        page.text("oleo rig and oleo hil accept the file with the option --strut model.toml.");
    }
    let changes = changes(&diagnosis.given_toml, &diagnosis.model_toml);
    // Sensor offsets are calibration and have a table of their own.
    let added: Vec<&Change> = (changes.iter())
        .filter(|c| c.before.is_none() && c.key.starts_with("effects.") && !c.key.contains("sensor_offset"))
        .collect();
    if !added.is_empty() {
        let mut table = Table::new([Column::text("Added to the model"), Column::text("Value")]);
        for c in added {
            table.row([c.key.clone(), short(&c.after, file)]);
        }
        page.table(table);
    }
    page.code(&format!("{file}, to copy"), &diagnosis.model_toml);
    calibration(page, diagnosis);
}

fn calibration(page: &mut Page, diagnosis: &Diagnosis) {
    if diagnosis.calibration.is_empty() {
        page.text("The model states no tolerances, so nothing was recalibrated.");
        return;
    }
    let most = diagnosis
        .calibration
        .iter()
        .map(|c| c.tolerance_used)
        .fold(0.0, f64::max);
    page.text(&format!(
        "Recalibration is part of every fit and adds no physics: the values below were estimated again within the tolerances that \
         the model states. The largest change uses {:.0} % of its tolerance.",
        100.0 * most
    ));
    let mut table = Table::new([
        Column::text("Recalibrated value"),
        Column::number("Change"),
        Column::text("95 % interval"),
        Column::text("Unit"),
        Column::text("Part of the tolerance used"),
    ]);
    for c in &diagnosis.calibration {
        let (e, used) = (&c.estimate, c.tolerance_used);
        let (name, unit) = words::quantity(&e.key);
        let (value, interval) = words::value_and_interval(e.value, e.ci95);
        let text = format!("{:.0} %", 100.0 * used);
        table.row([
            name.into(),
            value.into(),
            interval.into(),
            unit.into(),
            if used > 1.0 {
                Cell::warning(format!("{text}, which is beyond the tolerance"))
            } else {
                Cell::from(text)
            },
        ]);
    }
    page.details("Calibration, value by value", table);
    if !diagnosis.correlations.is_empty() {
        let mut table = Table::new([
            Column::text("First estimate"),
            Column::text("Second estimate"),
            Column::number("Correlation"),
        ]);
        for Correlation {
            keys: [a, b],
            coefficient,
        } in &diagnosis.correlations
        {
            table.row([a.clone(), b.clone(), significant(*coefficient, 3)]);
        }
        let summary = format!(
            "{} pairs of estimates are strongly correlated, so only a combination of the two is well determined",
            table.len()
        );
        page.details(&summary, table);
    }
}

/// A value of a model file as a table of the page shows it: a list is drawn above, and stands in the file below.
fn short(value: &str, file: &str) -> String {
    let list = (value.parse::<toml::Value>().ok()).and_then(|value| value.as_array().map(Vec::len));
    match list {
        Some(count) => format!("{count} values, in {file}"),
        None => value.parse().map_or(value.to_owned(), |v: f64| significant(v, 5)),
    }
}

/// A value that differs between two model files.
#[derive(Debug, PartialEq)]
struct Change {
    key: String,
    before: Option<String>,
    after: String,
}

/// Keys of `after` that `before` lacks or has with another value. Files that cannot be read have no changes.
fn changes(before: &str, after: &str) -> Vec<Change> {
    let (Ok(before), Ok(after)) = (before.parse::<toml::Table>(), after.parse::<toml::Table>()) else {
        return Vec::new();
    };
    let mut out = Vec::new();
    compare(
        "",
        Some(&toml::Value::Table(before)),
        &toml::Value::Table(after),
        &mut out,
    );
    out
}

fn compare(key: &str, before: Option<&toml::Value>, after: &toml::Value, out: &mut Vec<Change>) {
    match after {
        toml::Value::Table(table) => {
            for (k, value) in table {
                let inner = if key.is_empty() {
                    k.clone()
                } else {
                    format!("{key}.{k}")
                };
                compare(&inner, before.and_then(|b| b.get(k)), value, out);
            }
        }
        toml::Value::Array(list) if list.iter().any(toml::Value::is_table) => {
            for (k, value) in list.iter().enumerate() {
                compare(&format!("{key}[{}]", k + 1), before.and_then(|b| b.get(k)), value, out);
            }
        }
        value if before != Some(value) => out.push(Change {
            key: key.to_owned(),
            before: before.map(ToString::to_string),
            after: value.to_string(),
        }),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_is_counted_and_a_number_is_rounded() {
        assert_eq!(short("[0.1, 0.2, 1e-81]", "model.toml"), "3 values, in model.toml");
        assert_eq!(short("0.123456789", "model.toml"), "0.12346");
        assert_eq!(short("\"displacement\"", "model.toml"), "\"displacement\"");
    }

    #[test]
    fn additions_and_changes_are_told_apart() {
        let before = "[cylinder]\nbore_m = 0.05\n[[valve]]\nc = 1.0\n[effects]\n";
        let after =
            "[cylinder]\nbore_m = 0.05\n[[valve]]\nc = 2.0\n[effects.oil_compressibility]\nbulk_modulus_Pa = 1.4e9\n";
        let found = changes(before, after);
        assert_eq!(found.len(), 2);
        let key = |k: &str| found.iter().find(|c| c.key == k).expect("a change");
        assert_eq!(key("effects.oil_compressibility.bulk_modulus_Pa").before, None);
        assert_eq!(key("valve[1].c").before.as_deref(), Some("1.0"));
        assert!(changes(before, before).is_empty() && changes("?", "!").is_empty());
    }
}
