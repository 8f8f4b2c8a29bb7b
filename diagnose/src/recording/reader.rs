//! Reads a recording from CSV. Input that cannot be used is refused with one line that names file, line and remedy.

use std::path::Path;

use oleo_plant_sim::rig::{ColumnMap, other_separator, wrong_separator};

use super::columns::{ColumnSpec, GapPolicy};
use super::rows::{Rows, not_finite, place, place_of};
use super::series::Recording;
use super::thinning::Room;
use crate::error::DiagnoseError;

/// Reads one recording.
///
/// # Errors
/// One line naming file, line and remedy, for a missing column, another unit, text that is no number, NaN, time that
/// does not increase, a switch that is neither 0 nor 1, or too few samples.
pub fn read(path: &Path, specs: &[ColumnSpec], gaps: GapPolicy) -> Result<Recording, DiagnoseError> {
    let open = || std::fs::File::open(path).map_err(|e| DiagnoseError::file(path, e.to_string()));
    let rows = count_lines(open()?).map_err(|e| DiagnoseError::file(path, e.to_string()))?;
    parse(open()?, rows, path, specs, gaps)
}

/// Reads one recording that another program wrote, by a map of its columns.
///
/// # Errors
/// As [`read`], and what the map does not fit.
pub fn read_by(
    path: &Path,
    map: &ColumnMap,
    specs: &[ColumnSpec],
    gaps: GapPolicy,
) -> Result<Recording, DiagnoseError> {
    let bytes = std::fs::read(path).map_err(|e| DiagnoseError::file(path, e.to_string()))?;
    let text = map.translate(&bytes, &path.display().to_string())?;
    parse(text.as_bytes(), text.matches('\n').count(), path, specs, gaps)
}

/// Lines of a file, read in pieces.
fn count_lines(mut file: std::fs::File) -> std::io::Result<usize> {
    let mut piece = vec![0; 1 << 16];
    let mut lines = 0;
    loop {
        match std::io::Read::read(&mut file, &mut piece)? {
            0 => return Ok(lines),
            n => lines += piece[..n].iter().filter(|&&b| b == b'\n').count(),
        }
    }
}

/// Reads one recording from anything. `rows` is about how many there are; `path` names the recording and is not opened.
///
/// ```
/// use oleo_diagnose::recording::{ColumnKind, ColumnSpec, GapPolicy, parse};
/// let columns = [ColumnSpec::new("p_Pa", ColumnKind::Output)];
/// let read = |text: &str| parse(text.as_bytes(), 100, "strokes.csv".as_ref(), &columns, GapPolicy::Cut);
/// let rows: String = (0..100).map(|k| format!("{},{}\n", 0.01 * f64::from(k), 1e6 + f64::from(k))).collect();
/// let recording = read(&format!("time_s,p_Pa\n{rows}"))?;
/// assert_eq!((recording.len(), recording.columns[0][99]), (100, 1_000_099.0));
/// let complaint = read("time_s,p_bar\n0,10\n").unwrap_err().to_string();
/// assert!(complaint.contains("p_Pa"), "{complaint}");
/// # Ok::<(), oleo_diagnose::DiagnoseError>(())
/// ```
///
/// # Errors
/// As [`read`].
pub fn parse(
    source: impl std::io::Read,
    rows: usize,
    path: &Path,
    specs: &[ColumnSpec],
    gaps: GapPolicy,
) -> Result<Recording, DiagnoseError> {
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_reader(std::io::BufReader::with_capacity(1 << 20, source));
    let header = reader.headers().map_err(|e| csv_error(path, &e))?.clone();
    let time_at = position(path, &header, "time_s")?;
    let at: Vec<Option<usize>> = specs
        .iter()
        .map(|spec| position_of(path, &header, spec))
        .collect::<Result<_, _>>()?;
    let mut taken = Rows::new(specs, rows);
    let mut row = csv::StringRecord::new();
    let mut values = vec![0.0; specs.len()];
    while reader.read_record(&mut row).map_err(|e| csv_error(path, &e))? {
        let line = row.position().map_or(0, csv::Position::line);
        let fail = |what: String| DiagnoseError::Line {
            path: path.to_path_buf(),
            line,
            what,
        };
        let number = |index: usize, name: &str| {
            let text = row.get(index).unwrap_or("");
            match text.parse::<f64>() {
                Ok(v) if v.is_finite() => Ok(v),
                _ => Err(fail(not_finite(name, text))),
            }
        };
        let time = number(time_at, "time_s")?;
        for ((value, &index), spec) in values.iter_mut().zip(&at).zip(specs) {
            *value = index.map_or(Ok(f64::NAN), |index| number(index, &spec.name))?;
        }
        if taken.push(time, &values).map_err(fail)? == Room::Full {
            break;
        }
    }
    let name = path
        .file_stem()
        .map_or_else(|| "recording".to_owned(), |s| s.to_string_lossy().into_owned());
    taken.finish(name, path, gaps)
}

fn csv_error(path: &Path, error: &csv::Error) -> DiagnoseError {
    match (error.position(), error.kind()) {
        (Some(p), csv::ErrorKind::UnequalLengths { expected_len, len, .. }) => DiagnoseError::Line {
            path: path.to_path_buf(),
            line: p.line(),
            what: format!(
                "the row has {len} fields, but the header has {expected_len}; the file may have been cut off while it was written, or its \
                 numbers have decimal commas"
            ),
        },
        (Some(p), csv::ErrorKind::Utf8 { .. }) => DiagnoseError::Line {
            path: path.to_path_buf(),
            line: p.line(),
            what: "the file is not text; a recording is a CSV file in UTF-8".to_owned(),
        },
        _ => DiagnoseError::file(path, format!("the file is not readable as CSV: {error}")),
    }
}

/// Index of a column in the header.
fn position(path: &Path, header: &csv::StringRecord, name: &str) -> Result<usize, DiagnoseError> {
    let titles: Vec<&str> = header.iter().collect();
    place(&titles, name).map_err(|what| in_header(path, header, what))
}

/// Index of a column in the header; `None` if a recording may do without it.
fn position_of(path: &Path, header: &csv::StringRecord, spec: &ColumnSpec) -> Result<Option<usize>, DiagnoseError> {
    let titles: Vec<&str> = header.iter().collect();
    match place_of(&titles, spec) {
        // Behind another separator it may be there after all.
        Ok(None) if other_separator(header).is_some() => position(path, header, &spec.name).map(Some),
        found => found.map_err(|what| in_header(path, header, what)),
    }
}

fn in_header(path: &Path, header: &csv::StringRecord, what: String) -> DiagnoseError {
    DiagnoseError::Line {
        path: path.to_path_buf(),
        line: 1,
        what: other_separator(header).map_or(what, wrong_separator),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::{ColumnKind, MAX_SAMPLES};
    use std::fmt::Write as _;

    fn specs() -> Vec<ColumnSpec> {
        vec![
            ColumnSpec::new("displacement_m", ColumnKind::Input),
            ColumnSpec::new("p_Pa", ColumnKind::Output),
        ]
    }

    fn parsed(text: &str, rows: usize) -> Result<Recording, DiagnoseError> {
        parse(text.as_bytes(), rows, Path::new("a.csv"), &specs(), GapPolicy::Cut)
    }

    #[test]
    fn thinned_columns_stay_in_step() {
        let mut text = "time_s,displacement_m,p_Pa\n".to_owned();
        for k in 0..500_000 {
            let t = f64::from(k) * 1e-4;
            let _ = writeln!(text, "{t:.4},{},{}", 0.01 * t, 2.0 * t);
        }
        let r = parsed(&text, 500_000).expect("valid");
        assert!(r.len() <= MAX_SAMPLES && r.len() > MAX_SAMPLES / 2, "{}", r.len());
        for k in 0..r.len() {
            assert!((r.columns[0][k] - 0.01 * r.time_s[k]).abs() < 1e-9, "input at {k}");
            assert!((r.columns[1][k] - 2.0 * r.time_s[k]).abs() < 1e-9, "output at {k}");
        }
        assert!(r.notes[0].contains("one of every 3 samples"), "{:?}", r.notes);
    }

    #[test]
    fn what_cannot_be_thinned_is_cut() {
        let mut text = "time_s,displacement_m,p_Pa\n".to_owned();
        for k in 0..300_000 {
            let _ = writeln!(text, "{},0,1", f64::from(k) * 0.04);
        }
        let r = parsed(&text, 300_000).expect("valid");
        assert_eq!(r.len(), MAX_SAMPLES);
        assert!((r.interval_s() - 0.04).abs() < 1e-9);
        assert!(r.notes[0].contains("only the first"), "{:?}", r.notes);
    }

    proptest::proptest! {
        #[test]
        fn no_bytes_make_it_panic(bytes in proptest::collection::vec(proptest::prelude::any::<u8>(), 0..400)) {
            if let Err(e) = parse(&bytes[..], 7, Path::new("a.csv"), &specs(), GapPolicy::Cut) {
                proptest::prop_assert!(!e.to_string().contains('\n'), "{e}");
            }
        }

        #[test]
        fn no_table_makes_it_panic(
            rows in proptest::collection::vec(("[-0-9.eEinfNa ]{0,8}", "[-0-9.e]{0,6}", "[-0-9.e,\"]{0,6}"), 0..80),
            expected in 0_usize..400_000,
        ) {
            let mut text = "time_s,displacement_m,p_Pa\n".to_owned();
            for (t, x, p) in rows {
                let _ = writeln!(text, "{t},{x},{p}");
            }
            match parsed(&text, expected) {
                Ok(r) => {
                    proptest::prop_assert!(r.time_s.windows(2).all(|w| w[1] > w[0]));
                    proptest::prop_assert!(r.columns.iter().flatten().all(|v| v.is_finite()));
                }
                Err(e) => proptest::prop_assert!(!e.to_string().contains('\n'), "{e}"),
            }
        }
    }
}
