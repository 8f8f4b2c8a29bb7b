//! Differences as tables, for the terminal and for the page.

use oleo_report::{Cell, Column, Table, significant};

use super::difference::{Difference, Size};
use super::differences::{Check, ComparedFigure, ComparedTrace};
use super::figures::Figure;
use super::quantity::quantity;
use super::run::Group;
use super::tolerance::Allowed;

/// A row for each tolerance and run.
pub fn check_table(checks: &[Check]) -> Table {
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

/// Digits at which numbers that differ look different, 4 to 9.
fn digits(values: &[Option<Figure>]) -> usize {
    let numbers = || {
        values.iter().filter_map(|value| match value {
            Some(Figure::Number(number)) => Some(*number),
            _ => None,
        })
    };
    let differ = |digits: &usize| {
        numbers().all(|a| numbers().all(|b| a == b || significant(a, *digits) != significant(b, *digits)))
    };
    (4..9).find(differ).unwrap_or(9)
}

/// A row for each figure, a column for each run. Behind a number stands how much larger it is than that of the first run.
pub fn figure_table<'a>(group: &Group, figures: impl Iterator<Item = &'a ComparedFigure>) -> Table {
    let mut columns = vec![Column::text("Figure")];
    columns.extend(group.runs.iter().map(|run| Column::number(&run.name)));
    let mut table = Table::new(columns);
    for figure in figures {
        let first = figure.values.first().and_then(Option::as_ref);
        let digits = digits(&figure.values);
        let cell = |value: &Option<Figure>| match (value, first) {
            (None, _) => "-".to_owned(),
            (Some(Figure::Word(word)), _) => word.clone(),
            (Some(Figure::Number(number)), Some(Figure::Number(of))) if number != of && *of != 0.0 => {
                let percent = significant(100.0 * (number - of) / of.abs(), 2);
                let sign = if number > of { "+" } else { "" };
                format!("{} ({sign}{percent} %)", significant(*number, digits))
            }
            (Some(Figure::Number(number)), _) => significant(*number, digits),
        };
        let mut row = vec![figure.name.clone()];
        row.extend(figure.values.iter().map(cell));
        table.row(row);
    }
    table
}

/// A row for each trace and run.
pub fn trace_table(group: &Group, axis: &str, traces: &[&ComparedTrace]) -> Table {
    let (over, over_unit, _) = quantity(axis);
    let noisy = !group.noise.is_empty();
    let mut columns = vec![
        Column::text("Trace"),
        Column::text("Run"),
        Column::number("RMS of the difference"),
        Column::number("Of the first's RMS"),
        Column::number("Largest difference"),
        Column::number("Compared"),
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
                None => row.extend(["-", "-", "-", "0 %", "-", unit].map(str::to_owned)),
                Some(Difference { size, compared }) => {
                    let compared = format!("{} %", significant(100.0 * compared, 3));
                    match size {
                        Size::State(share) => row.extend([
                            format!("{} %", significant(100.0 * share, 3)),
                            "-".into(),
                            "-".into(),
                            compared,
                            "-".into(),
                            "of the samples".into(),
                        ]),
                        Size::Quantity {
                            rms,
                            reference_rms,
                            largest,
                            at,
                        } => row.extend([
                            significant(factor * rms, 4),
                            match *reference_rms {
                                0.0 => "-".to_owned(),
                                of => format!("{} %", significant(100.0 * rms / of, 3)),
                            },
                            significant(factor * largest, 4),
                            compared,
                            significant(*at, 5),
                            unit.to_owned(),
                        ]),
                    }
                }
            }
            if noisy {
                row.push(match (difference.map(|difference| difference.size), noise) {
                    (Some(Size::Quantity { rms, .. }), Some(noise)) => significant(rms / noise, 3),
                    _ => "-".to_owned(),
                });
            }
            table.row(row);
        }
    }
    table
}
