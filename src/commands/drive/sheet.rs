//! Writes the results of a drive: tables, CSV files and the page.

use oleo_hil::drive::{COLUMNS, Driven, Measure, Model, Plan, Signal, column, measures};
use oleo_hil::page::ending_in_words;
use oleo_plant_sim::course::Sample;
use oleo_report::{Column, OutputDirectory, Table, significant};
use serde_json::{Map, Value, json};

use super::arguments::Args;
use super::page::{page, settings, verdict};
use crate::failure::Failure;
use oleo_hil::parameter_files::Parameters;

/// RMS of the difference over RMS of the first, at the same places of the road: the handling model's speed gives way on
/// a rough road, the ride model's is constant.
fn difference(a: &[Sample], b: &[Sample], of: fn(&Sample) -> f64) -> f64 {
    let (mut apart, mut size) = (0.0, 0.0);
    let mut from = 0;
    for sample in a {
        let station = sample.station_m;
        while from + 2 < b.len() && b[from + 1].station_m < station {
            from += 1;
        }
        let (Some(low), Some(high)) = (b.get(from), b.get(from + 1)) else {
            break;
        };
        if station > high.station_m || station < low.station_m {
            continue;
        }
        let share = (station - low.station_m) / (high.station_m - low.station_m);
        let (x, y) = (of(sample), of(low) + share * (of(high) - of(low)));
        apart += (x - y) * (x - y);
        size += x * x;
    }
    (apart / size).sqrt()
}

const COMPARED: [(&str, &str, Signal); 5] = [
    ("heave", "body vertical displacement (figures 2, 6)", |s| s.heave_m),
    ("heave_acceleration", "body vertical acceleration (figure 3)", |s| {
        s.vertical_acceleration_m_s2
    }),
    ("front_axle", "front axle vertical displacement (figure 4)", |s| {
        s.front_axle_heave_m
    }),
    ("roll", "body roll angle (figures 5, 7)", |s| s.roll_rad),
    ("pitch", "body pitch angle", |s| s.pitch_rad),
];

/// Prints the table and writes the folder.
pub fn publish(
    plan: &Plan,
    args: &Args,
    parameters: &Parameters,
    drives: &[Driven],
    mut out: Option<OutputDirectory>,
) -> Result<(), Failure> {
    let mut columns = vec![Column::text("Measure")];
    columns.extend(drives.iter().map(|driven| Column::number(driven.name)));
    columns.push(Column::text("Unit"));
    let mut table = Table::new(columns);
    let mut summary = Map::new();
    summary.insert("model".into(), json!(args.model.name()));
    let mut row = vec!["end of the run".to_owned()];
    row.extend((drives.iter()).map(|Driven { run, .. }| ending_in_words(Some(run.ending), run.cone_margin_m)));
    row.push(String::new());
    table.row(row);
    let all: Vec<Vec<Measure>> = (drives.iter())
        .map(|driven| measures(plan, driven, args.score_from_s))
        .collect();
    let longest = all.iter().max_by_key(|list| list.len()).cloned().unwrap_or_default();
    for (key, words, _, unit) in longest {
        let value = |list: &Vec<Measure>| list.iter().find(|m| m.0 == key).map(|m| m.2);
        let mut row = vec![words.to_owned()];
        row.extend(
            all.iter()
                .map(|list| value(list).map_or("-".to_owned(), |v| significant(v, 4))),
        );
        row.push(unit.to_owned());
        table.row(row);
    }
    for (Driven { name, run, .. }, list) in drives.iter().zip(&all) {
        let mut entry: Map<String, Value> = list.iter().map(|m| (m.0.to_owned(), json!(m.2))).collect();
        entry.insert("ending".into(), json!(run.ending.word()));
        if let Some(margin_m) = run.cone_margin_m {
            entry.insert("cone_hit".into(), json!(margin_m < 0.0));
        }
        entry.insert("duration_s".into(), json!(run.history.last().map_or(0.0, |s| s.time_s)));
        summary.insert(name.replace(' ', "_"), Value::Object(entry));
    }
    let mut comparison = None;
    if let (Model::Both, [ride, handling]) = (args.model, drives) {
        let mut rows = Table::new([
            Column::text("Signal"),
            Column::number("RMS difference at the same place on the road / RMS of the ride model"),
        ]);
        for (key, words, of) in COMPARED {
            let ratio = difference(&ride.run.history, &handling.run.history, of);
            rows.row([words.to_owned(), format!("{:.1} %", 100.0 * ratio)]);
            summary.insert(format!("difference_{key}"), json!(ratio));
        }
        comparison = Some(rows);
    }
    if let Some(out) = &mut out {
        let page = page(plan, args.model.name(), drives, &table, comparison.as_ref());
        for Driven { name, run, .. } in drives {
            let columns: Vec<(&str, Vec<f64>)> = COLUMNS.iter().map(|(name, of)| (*name, column(run, *of))).collect();
            let columns: Vec<(&str, &[f64])> = columns
                .iter()
                .map(|(name, values)| (*name, values.as_slice()))
                .collect();
            out.csv(&format!("{}.csv", name.replace(' ', "-")), &columns)?;
        }
        parameters.keep(out)?;
        out.summary("summary.json", Some(args.seed), &summary)?;
        out.page(&page)?;
    }
    let text = format!(
        "{}: road {}, {}\n{}\n{table}{}",
        plan.title,
        plan.road_name,
        settings(drives),
        verdict(plan, drives).1,
        comparison.map_or(String::new(), |table| table.to_string())
    );
    args.results.publish(out, &text)
}
