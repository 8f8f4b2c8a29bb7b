//! Reads a recording from columns in memory, as from the file with the same content.

use std::path::Path;

use super::columns::{ColumnSpec, GapPolicy};
use super::rows::{Rows, not_finite, place, place_of};
use super::series::Recording;
use super::thinning::Room;
use crate::error::DiagnoseError;

/// Name and values of a column in memory.
pub type NamedColumn<'c> = (&'c str, &'c [f64]);

/// Reads one recording from its columns, which are of one length. Columns that are not asked for are left aside.
///
/// ```
/// use oleo_diagnose::recording::{ColumnKind, ColumnSpec, GapPolicy, of_table};
/// let specs = [ColumnSpec::new("p_Pa", ColumnKind::Output)];
/// let (time, mut pressure): (Vec<f64>, Vec<f64>) = (0..100).map(|k| (0.01 * f64::from(k), 1e6 + f64::from(k))).unzip();
/// let recording = of_table("strokes", &[("time_s", &time), ("p_Pa", &pressure)], &specs, GapPolicy::Cut)?;
/// assert_eq!((recording.len(), recording.columns[0][99]), (100, 1_000_099.0));
/// pressure[7] = f64::NAN;
/// let complaint = of_table("strokes", &[("time_s", &time), ("p_Pa", &pressure)], &specs, GapPolicy::Cut).unwrap_err();
/// assert!(complaint.to_string().starts_with("strokes, row 7: p_Pa is 'NaN'"), "{complaint}");
/// # Ok::<(), oleo_diagnose::DiagnoseError>(())
/// ```
///
/// # Errors
/// One line with recording, row (counted from 0) and remedy, for what is an error in a file too.
pub fn of_table(
    name: &str,
    table: &[NamedColumn],
    specs: &[ColumnSpec],
    gaps: GapPolicy,
) -> Result<Recording, DiagnoseError> {
    let titles: Vec<&str> = table.iter().map(|(title, _)| *title).collect();
    let in_table = |what: String| DiagnoseError::file(name, what);
    let time_s = table[place(&titles, "time_s").map_err(in_table)?].1;
    let columns = specs
        .iter()
        .map(|spec| Ok(place_of(&titles, spec).map_err(in_table)?.map(|found| table[found].1)))
        .collect::<Result<Vec<_>, DiagnoseError>>()?;
    if let Some((title, other)) = table.iter().find(|(_, values)| values.len() != time_s.len()) {
        let (other, samples) = (other.len(), time_s.len());
        let what = format!("column '{title}' has {other} values and 'time_s' {samples}; give columns of one length");
        return Err(DiagnoseError::file(name, what));
    }
    // A file has a line of titles as well, by which it is judged whether to thin.
    let mut taken = Rows::new(specs, time_s.len() + 1);
    let mut values = vec![0.0; specs.len()];
    for (row, time) in time_s.iter().enumerate() {
        let fail = |what: String| DiagnoseError::Row {
            recording: name.to_owned(),
            row,
            what,
        };
        let finite = |value: f64, title: &str| match value.is_finite() {
            true => Ok(value),
            false => Err(fail(not_finite(title, &value.to_string()))),
        };
        let time = finite(*time, "time_s")?;
        for ((value, column), spec) in values.iter_mut().zip(&columns).zip(specs) {
            *value = column.map_or(Ok(f64::NAN), |column| finite(column[row], &spec.name))?;
        }
        if taken.push(time, &values).map_err(fail)? == Room::Full {
            break;
        }
    }
    taken.finish(name.to_owned(), Path::new(name), gaps)
}
