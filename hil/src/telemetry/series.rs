//! Columns that are complete, as rows in the order of time.

use std::io::{self, Seek, Write};

use super::McapFile;
use super::topic::{Column, Value};

/// The columns of a run, and the name that tells it from the other runs of a file.
pub struct Series {
    /// First part of the names of its topics; `None` where it is the only run.
    pub run: Option<String>,
    /// Time of each row, s.
    pub time_s: Vec<f64>,
    /// Names with units, and a value for each row.
    pub columns: Vec<(String, Vec<f64>)>,
}

/// Writes runs side by side, each from its own start.
///
/// # Errors
/// The file cannot be written.
pub fn write_series<W: Write + Seek>(out: W, program: &str, series: &[Series]) -> io::Result<()> {
    let mut file = McapFile::new(out, program)?;
    let mut order: Vec<(u64, usize, usize)> = Vec::new();
    for (run, one) in series.iter().enumerate() {
        let names: Vec<Column> = one.columns.iter().map(|(name, _)| Column::number(name)).collect();
        file.add(one.run.as_deref(), &names)?;
        order.extend((one.time_s.iter().enumerate()).map(|(row, time_s)| (nanoseconds(*time_s), run, row)));
    }
    order.sort_unstable();
    let mut values = Vec::new();
    for (time_ns, run, row) in order {
        values.clear();
        let of_row = |(_, column): &(String, Vec<f64>)| Value::Number(column.get(row).copied().unwrap_or(f64::NAN));
        values.extend(series[run].columns.iter().map(of_row));
        file.row(run, time_ns, &values)?;
    }
    file.finish()
}

/// Nanoseconds, rounded; a time before the start is the start.
#[must_use]
pub fn nanoseconds(time_s: f64) -> u64 {
    libm::round(time_s * 1e9) as u64
}
