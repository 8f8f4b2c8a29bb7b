//! What was measured, as tables, `summary.json`, `points.csv` and the page.

use oleo_report::{Axis, Column, Curves, OutputDirectory, Page, Style, Table, Verdict, significant};
use serde::Serialize;
use serde_json::{Value, json};

use super::growth::{Growth, Kind};
use super::measurement::{Extent, MeasuredCurve, MeasuredPoint};
use super::resources;
use crate::failure::Failure;

/// Seed of everything random: roads and sensors count up from it, recordings draw from the names of their streams.
const SEED: u64 = 1;

/// What stands on standard output.
pub fn text(curves: &[MeasuredCurve]) -> String {
    let sentences: Vec<String> = curves.iter().map(MeasuredCurve::in_words).collect();
    format!("{}{}\n", outcome(curves), sentences.join("\n"))
}

/// One line a curve.
fn outcome(curves: &[MeasuredCurve]) -> Table {
    let mut table = Table::new([
        Column::text("Curve"),
        Column::text("Work"),
        Column::number("Exponent of the time"),
        Column::text("Time"),
        Column::number("At the largest, ms"),
        Column::number("us an operation"),
        Column::number("Peak memory, MB"),
    ]);
    for curve in curves {
        let Some(last) = curve.points.last() else { continue };
        let exponent = curve.growth_of_large().map_or_else(|| "-".to_owned(), with_interval);
        table.row([
            curve.curve.name().to_owned(),
            format!("{} {}", last.size, curve.curve.unit()),
            exponent,
            kind_in_a_word(curve.kind()).to_owned(),
            significant(1e3 * last.processor_s.median, 3),
            significant(1e6 * an_operation_s(last), 3),
            last.peak_memory_bytes
                .map_or_else(|| "-".to_owned(), |bytes| significant(1e-6 * bytes, 3)),
        ]);
    }
    table
}

fn with_interval(growth: Growth) -> String {
    format!("{:.2} ({:.2} to {:.2})", growth.exponent, growth.low, growth.high)
}

fn kind_in_a_word(kind: Kind) -> &'static str {
    match kind {
        Kind::Constant => "constant",
        Kind::SlowerThanLinear => "slower than linear",
        Kind::Linear => "linear",
        Kind::FasterThanLinear => "faster than linear",
        Kind::Undecided => "undecided",
    }
}

/// Processor time of one operation, s.
fn an_operation_s(point: &MeasuredPoint) -> f64 {
    point.processor_s.median / point.operations.max(1) as f64
}

/// The points of a curve.
fn points_table(curve: &MeasuredCurve) -> Table {
    let has_instructions = curve.points.iter().any(|point| point.instructions.is_some());
    let mut columns = vec![
        Column::number(&capitalised(curve.curve.unit())),
        Column::number("Repeats"),
        Column::number("Processor time, ms"),
        Column::number("Least to largest"),
        Column::number("Clock, ms"),
        Column::number(&format!("us a {}", curve.curve.operation())),
        Column::number("Peak memory, MB"),
    ];
    if has_instructions {
        columns.push(Column::number("Million instructions"));
    }
    let mut table = Table::new(columns);
    for point in &curve.points {
        let ms = |seconds: f64| significant(1e3 * seconds, 3);
        let mut row = vec![
            point.size.to_string(),
            point.repeats.to_string(),
            ms(point.processor_s.median),
            format!("{} to {}", ms(point.processor_s.low), ms(point.processor_s.high)),
            ms(point.wall_s.median),
            significant(1e6 * an_operation_s(point), 3),
            point
                .peak_memory_bytes
                .map_or_else(|| "-".to_owned(), |bytes| significant(1e-6 * bytes, 3)),
        ];
        if has_instructions {
            row.push(
                point
                    .instructions
                    .map_or_else(|| "-".to_owned(), |count| significant(1e-6 * count as f64, 4)),
            );
        }
        table.row(row);
    }
    table
}

fn capitalised(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().collect::<String>() + letters.as_str()
    })
}

/// Writes all files.
pub fn write(
    out: &mut OutputDirectory,
    curves: &[MeasuredCurve],
    extent: &Extent,
    command: &str,
) -> Result<(), Failure> {
    out.csv_records("points.csv", rows(curves))?;
    out.summary("summary.json", Some(SEED), &summary(curves, extent))?;
    out.page(&page(curves, extent, command))?;
    Ok(())
}

/// One line of the table of all points.
#[derive(Serialize)]
struct Row<'a> {
    curve: &'a str,
    size: u64,
    repeats: usize,
    processor_s: f64,
    processor_least_s: f64,
    processor_largest_s: f64,
    clock_s: f64,
    operations: u64,
    peak_memory_bytes: Option<f64>,
    instructions: Option<u64>,
}

fn rows(curves: &[MeasuredCurve]) -> impl Iterator<Item = Row<'_>> {
    let of_curve = |curve: &'_ MeasuredCurve| {
        let name = curve.curve.name();
        let row = move |point: &MeasuredPoint| Row {
            curve: name,
            size: point.size,
            repeats: point.repeats,
            processor_s: point.processor_s.median,
            processor_least_s: point.processor_s.low,
            processor_largest_s: point.processor_s.high,
            clock_s: point.wall_s.median,
            operations: point.operations,
            peak_memory_bytes: point.peak_memory_bytes,
            instructions: point.instructions,
        };
        curve.points.iter().map(row).collect::<Vec<Row>>()
    };
    curves.iter().flat_map(of_curve)
}

fn summary(curves: &[MeasuredCurve], extent: &Extent) -> Value {
    let growth = |growth: Option<Growth>| {
        growth.map(|growth| json!({ "exponent": growth.exponent, "low": growth.low, "high": growth.high }))
    };
    let of_curve = |curve: &MeasuredCurve| {
        let points = curve.points.iter().map(|point| {
            json!({
                "size": point.size,
                "repeats": point.repeats,
                "processor_s": point.processor_s.median,
                "processor_least_s": point.processor_s.low,
                "processor_largest_s": point.processor_s.high,
                "clock_s": point.wall_s.median,
                "operations": point.operations,
                "peak_memory_bytes": point.peak_memory_bytes,
                "instructions": point.instructions,
                "outcome": point.outcome,
            })
        });
        let memory = (curve.memory())
            .map(|memory| json!({ "is_constant": memory.is_constant(), "bytes_per_unit": memory.bytes_per_unit }));
        json!({
            "name": curve.curve.name(),
            "unit": curve.curve.unit(),
            "operation": curve.curve.operation(),
            "growth": curve.kind().to_string(),
            "exponent": growth(curve.growth_of_large()),
            "exponent_of_all_points": growth(curve.growth()),
            "exponent_of_an_operation": growth(curve.growth_of_operation()),
            "exponent_of_instructions": growth(curve.growth_of_instructions()),
            "memory": memory,
            "in_words": curve.in_words(),
            "points": points.collect::<Vec<Value>>(),
        })
    };
    json!({
        "processor": resources::processor(),
        "cores": resources::cores(),
        "quick": extent.quick,
        "repeats": extent.repeats,
        "curves": curves.iter().map(of_curve).collect::<Vec<Value>>(),
    })
}

/// What the page says of its clocks.
const NOISE: &str = "Processor time leaves out the time in which other programs had the processor, but not what they do to caches, memory \
     and clock rate. Medians of repeats that went round all points; the columns beside them show how far the repeats lie apart. \
     Compare exponents and ratios within this page, not seconds with those of another day or machine.";
const COUNTED: &str = " Instructions are those of callgrind and depend on nothing but the program.";
const NOT_COUNTED: &str = " Instructions were not counted, so only clocks are given, which are noisy (--instructions counts them with valgrind).";

fn page(curves: &[MeasuredCurve], extent: &Extent, command: &str) -> Page {
    let mut page = Page::new("Cost as work grows", command);
    page.fact(
        "processor",
        &resources::processor().unwrap_or_else(|| "not told".to_owned()),
    );
    page.fact("Cores", &resources::cores().to_string());
    page.fact("Repeats", &extent.repeats.to_string());
    let named = |kind| -> Vec<&str> {
        let of_kind = curves.iter().filter(|curve| curve.kind() == kind);
        of_kind.map(|curve| curve.curve.name()).collect()
    };
    match (&named(Kind::FasterThanLinear)[..], &named(Kind::Undecided)[..]) {
        ([], []) => page.verdict(Verdict::Pass, "No measured cost grows faster than the work."),
        ([], undecided) => page.verdict(
            Verdict::Attention,
            &format!("Scatters too much to tell how it grows: {}.", undecided.join(", ")),
        ),
        (faster, _) => page.verdict(
            Verdict::Attention,
            &format!("Grows faster than the work: {}.", faster.join(", ")),
        ),
    };
    page.outcome(outcome(curves));
    let is_counted = curves.iter().any(|curve| curve.growth_of_instructions().is_some());
    page.text(&format!("{NOISE}{}", if is_counted { COUNTED } else { NOT_COUNTED }));
    for curve in curves {
        let counted = (curve.growth_of_instructions()).map(|growth| {
            format!(
                " Exponent of the instructions, where they were counted: {}.",
                with_interval(growth)
            )
        });
        page.section(curve.curve.in_words())
            .text(curve.curve.explained())
            .text(&format!("{}{}", curve.in_words(), counted.unwrap_or_default()))
            .figure(figure(curve))
            .table(points_table(curve));
    }
    page
}

fn figure(measured: &MeasuredCurve) -> Curves {
    let (work, cost) = (measured.work(), measured.processor_s());
    let unit = capitalised(measured.curve.unit());
    let mut figure = Curves::new(measured.curve.name(), Axis::new(&unit, "").logarithmic());
    figure.caption(
        "Processor time above, its least and largest as bars; peak memory below. The dashed line is in proportion to the work and goes through \
         the last point: points above it are the cost of what does not grow.",
    );
    let of = |value: fn(&MeasuredPoint) -> f64| measured.points.iter().map(value).collect::<Vec<f64>>();
    let (low, high) = (of(|point| point.processor_s.low), of(|point| point.processor_s.high));
    figure
        .panel(Axis::new("Processor time", "s").logarithmic())
        .points_with_interval("processor time", &work, &cost, &low, &high);
    if let (Some(last_work), Some(last_cost)) = (work.last(), cost.last()) {
        let linear: Vec<f64> = work.iter().map(|work| last_cost * work / last_work).collect();
        figure.series(Style::Dashed, "in proportion", &work, &linear);
    }
    let peaks: Option<Vec<f64>> = (measured.points.iter())
        .map(|point| point.peak_memory_bytes.map(|bytes| 1e-6 * bytes))
        .collect();
    if let Some(peaks) = peaks {
        figure.panel(Axis::new("Peak memory", "MB").logarithmic()).series(
            Style::LineAndPoints,
            "peak memory",
            &work,
            &peaks,
        );
    }
    figure
}
