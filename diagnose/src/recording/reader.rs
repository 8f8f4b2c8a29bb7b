//! Reads a recording from CSV. Input that cannot be used is refused with one line that names file, line and remedy.

use std::path::Path;

use oleo_plant_sim::rig::{ColumnMap, other_separator, wrong_separator};

use super::columns::{ColumnKind, ColumnSpec, GapPolicy};
use super::series::Recording;
use super::thinning::{Room, Thinner};
use crate::error::DiagnoseError;

/// Fewest samples from which anything can be concluded.
pub const MIN_SAMPLES: usize = 50;
/// A step this many times the usual one is a hole.
const GAP_RATIO: f64 = 4.5;

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
        .map(|s| match position(path, &header, &s.name) {
            Ok(at) => Ok(Some(at)),
            Err(_) if s.optional && !is_in_another_form(&header, &s.name) => Ok(None),
            Err(error) => Err(error),
        })
        .collect::<Result<_, _>>()?;
    let mut thinner = Thinner::new(specs, rows);
    let mut row = csv::StringRecord::new();
    let mut last_time = f64::NEG_INFINITY;
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
                _ => Err(fail(format!(
                    "{name} is '{text}', not a finite number; repair or cut the recording there"
                ))),
            }
        };
        let time = number(time_at, "time_s")?;
        if time <= last_time {
            let how = if time == last_time {
                "is repeated"
            } else {
                "goes backwards"
            };
            return Err(fail(format!(
                "time_s {how} ({time} after {last_time}); sort the rows and drop duplicates"
            )));
        }
        last_time = time;
        for ((value, &index), spec) in values.iter_mut().zip(&at).zip(specs) {
            *value = index.map_or(Ok(f64::NAN), |index| number(index, &spec.name))?;
            if spec.kind == ColumnKind::Switch && *value != 0.0 && *value != 1.0 {
                return Err(fail(format!(
                    "{} is {value}; a switching signal is 0 (closed) or 1 (open)",
                    spec.name
                )));
            }
        }
        if thinner.push(time, &values) == Room::Full {
            break;
        }
    }
    let name = path
        .file_stem()
        .map_or_else(|| "recording".to_owned(), |s| s.to_string_lossy().into_owned());
    let mut recording = thinner.finish(name);
    if gaps == GapPolicy::Cut {
        cut_at_gap(&mut recording);
    }
    if recording.len() < MIN_SAMPLES {
        let why = recording.notes.first().map_or(String::new(), |n| format!(" ({n})"));
        return Err(DiagnoseError::TooShort {
            path: path.to_path_buf(),
            what: format!(
                "there are {} usable samples{why}, but at least {MIN_SAMPLES} are needed; record longer or leave the file out",
                recording.len()
            ),
        });
    }
    Ok(recording)
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

/// Index of a column; a column of the same quantity in another unit gets the message it deserves.
fn position(path: &Path, header: &csv::StringRecord, name: &str) -> Result<usize, DiagnoseError> {
    if let Some(found) = header.iter().position(|h| h == name) {
        return Ok(found);
    }
    if let Some(separator) = other_separator(header) {
        return Err(DiagnoseError::Line {
            path: path.to_path_buf(),
            line: 1,
            what: wrong_separator(separator),
        });
    }
    let what = match in_another_unit(header, name) {
        Some(other) => format!("column '{other}' has an unknown unit; '{name}' is expected (SI, unit in the name)"),
        None => format!(
            "column '{name}' is missing; the file has: {}",
            header.iter().collect::<Vec<_>>().join(", ")
        ),
    };
    Err(DiagnoseError::Line {
        path: path.to_path_buf(),
        line: 1,
        what,
    })
}

/// The column that has the quantity of another column's name in another unit.
fn in_another_unit<'h>(header: &'h csv::StringRecord, name: &str) -> Option<&'h str> {
    let quantity = |name: &str| name.rsplit_once('_').map_or(name.len(), |(quantity, _)| quantity.len());
    let wanted = &name[..quantity(name)];
    header.iter().find(|h| h[..quantity(h)].eq_ignore_ascii_case(wanted))
}

/// Whether a column is there after all, in another unit or behind another separator.
fn is_in_another_form(header: &csv::StringRecord, name: &str) -> bool {
    other_separator(header).is_some() || in_another_unit(header, name).is_some()
}

fn cut_at_gap(recording: &mut Recording) {
    let usual = recording.interval_s();
    if let Some(gap) = recording
        .time_s
        .windows(2)
        .position(|w| w[1] - w[0] > GAP_RATIO * usual)
    {
        let (from, to) = (recording.time_s[gap], recording.time_s[gap + 1]);
        let lost = recording.len() - gap - 1;
        recording.time_s.truncate(gap + 1);
        recording.columns.iter_mut().for_each(|c| c.truncate(gap + 1));
        recording.notes.push(format!(
            "there is a gap from {from} s to {to} s; the {lost} samples after it were not used"
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::MAX_SAMPLES;
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
            let _ = writeln!(text, "{t:.4},{},{}", 0.1 * t, 2.0 * t);
        }
        let r = parsed(&text, 500_000).expect("valid");
        assert!(r.len() <= MAX_SAMPLES && r.len() > MAX_SAMPLES / 2, "{}", r.len());
        for k in 0..r.len() {
            assert!((r.columns[0][k] - 0.1 * r.time_s[k]).abs() < 1e-9, "input at {k}");
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
