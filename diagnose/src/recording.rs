//! One recording, read from CSV and made safe to simulate.
//!
//! Everything that could silently spoil a diagnosis is caught here: a column in another unit, time that stands still,
//! a value that is not a number. What can be used soundly is used and said in a note: a recording with a hole is cut at
//! the hole, because nobody knows the state after it; one with more samples than needed is thinned while it is read, so
//! that memory stays bounded whatever its length.

use std::path::Path;

use crate::error::DiagnoseError;

/// Most samples kept of one recording. A campaign of ten such is still simulated in about a second.
pub const MAX_SAMPLES: usize = 200_000;
/// Fewest samples from which anything can be concluded.
pub const MIN_SAMPLES: usize = 50;
/// Longest sampling interval that thinning may make, s: of a recording with switching signals, whose edges must stay
/// where they were, and of any other. What is longer still is used from its start.
const MAX_THINNED_INTERVAL_S: (f64, f64) = (0.005, 0.05);
/// Rows at the start of a file by which its sampling interval is judged.
const FIRST_ROWS: usize = 64;
/// A step this many times the usual one is a hole.
const GAP_RATIO: f64 = 4.5;

/// How a column must be treated when a recording is thinned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColumnKind {
    /// A model input that is measured: the mean over the thinned stretch keeps its integral and lowers its noise.
    Input,
    /// A compared output: the sample itself, so its stated noise stays true.
    Output,
    /// A switching signal, 0 or 1.
    Switch,
}

/// A column that a specimen needs.
#[derive(Debug, Clone)]
pub struct ColumnSpec {
    /// Name with unit, for example `p1_Pa`.
    pub name: String,
    /// Its treatment.
    pub kind: ColumnKind,
}

impl ColumnSpec {
    /// A column of this name and treatment.
    #[must_use]
    pub fn new(name: &str, kind: ColumnKind) -> Self {
        Self {
            name: name.to_owned(),
            kind,
        }
    }
}

/// What to do with a hole in the time column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GapPolicy {
    /// The model has memory: only the longest stretch from the start is of use.
    Cut,
    /// The model's memory is short (friction) or the step is simply long: keep all.
    Keep,
}

/// Even or nearly even samples of one specimen.
#[derive(Debug, Clone)]
pub struct Recording {
    /// File stem.
    pub name: String,
    /// Seconds, strictly increasing.
    pub time_s: Vec<f64>,
    /// One series a requested column, same order.
    pub columns: Vec<Vec<f64>>,
    /// What was done to it that a reader of the report must know.
    pub notes: Vec<String>,
}

impl Recording {
    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.time_s.len()
    }

    /// True without samples (never, as read).
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.time_s.is_empty()
    }

    /// The first samples of it.
    #[must_use]
    pub fn first(&self, samples: usize) -> Self {
        let part = |series: &Vec<f64>| series[..samples.min(series.len())].to_vec();
        Self {
            name: self.name.clone(),
            time_s: part(&self.time_s),
            columns: self.columns.iter().map(part).collect(),
            notes: self.notes.clone(),
        }
    }

    /// Median sampling interval, s.
    #[must_use]
    pub fn interval_s(&self) -> f64 {
        median_interval(&self.time_s)
    }
}

fn median_interval(time_s: &[f64]) -> f64 {
    let mut steps: Vec<f64> = time_s.windows(2).map(|w| w[1] - w[0]).collect();
    if steps.is_empty() {
        return 0.0;
    }
    let middle = steps.len() / 2;
    *steps.select_nth_unstable_by(middle, f64::total_cmp).1
}

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
    let at: Vec<usize> = specs
        .iter()
        .map(|s| position(path, &header, &s.name))
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
            *value = number(index, &spec.name)?;
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
                "{} usable samples{why}, at least {MIN_SAMPLES} are needed; record longer or leave the file out",
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
                "{len} fields where the header names {expected_len}; the file may have been cut off while written"
            ),
        },
        (Some(p), csv::ErrorKind::Utf8 { .. }) => DiagnoseError::Line {
            path: path.to_path_buf(),
            line: p.line(),
            what: "not text; a recording is a CSV file in UTF-8".to_owned(),
        },
        _ => DiagnoseError::file(path, format!("not readable as CSV: {error}")),
    }
}

/// Index of a column; a column of the same quantity in another unit gets the message it deserves.
fn position(path: &Path, header: &csv::StringRecord, name: &str) -> Result<usize, DiagnoseError> {
    if let Some(found) = header.iter().position(|h| h == name) {
        return Ok(found);
    }
    let quantity = name.rsplit_once('_').map_or(name, |(q, _)| q);
    let other = header
        .iter()
        .find(|h| h.rsplit_once('_').map_or(*h, |(q, _)| q).eq_ignore_ascii_case(quantity));
    let what = match other {
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

/// Keeps at most [`MAX_SAMPLES`]: the middle one of every `stride` rows, an odd number, so that the mean of an input over
/// them is the input at the kept instant. Nothing is lost that the comparison needs: the model is compared at the kept
/// instants.
struct Thinner {
    kinds: Vec<ColumnKind>,
    rows: usize,
    stride: usize,
    /// Rows of the group begun, then the first rows of the file until the interval is known.
    within: usize,
    first: Vec<(f64, Vec<f64>)>,
    settled: bool,
    time_s: Vec<f64>,
    columns: Vec<Vec<f64>>,
    sums: Vec<f64>,
    middle: (f64, Vec<f64>),
    full: bool,
}

/// Whether more rows are wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Room {
    Left,
    Full,
}

impl Thinner {
    fn new(specs: &[ColumnSpec], rows: usize) -> Self {
        Self {
            kinds: specs.iter().map(|s| s.kind).collect(),
            rows,
            stride: 1,
            within: 0,
            first: Vec::new(),
            settled: rows <= MAX_SAMPLES,
            time_s: Vec::new(),
            columns: vec![Vec::new(); specs.len()],
            sums: vec![0.0; specs.len()],
            middle: (0.0, Vec::new()),
            full: false,
        }
    }

    fn push(&mut self, time: f64, values: &[f64]) -> Room {
        if self.settled {
            self.keep(time, values);
        } else {
            self.first.push((time, values.to_vec()));
            if self.first.len() == FIRST_ROWS {
                self.settle();
            }
        }
        if self.time_s.len() >= MAX_SAMPLES {
            self.full = true;
            return Room::Full;
        }
        Room::Left
    }

    /// Chooses the stride by the interval of the first rows.
    fn settle(&mut self) {
        self.settled = true;
        let times: Vec<f64> = self.first.iter().map(|(t, _)| *t).collect();
        let longest = if self.kinds.contains(&ColumnKind::Switch) {
            MAX_THINNED_INTERVAL_S.0
        } else {
            MAX_THINNED_INTERVAL_S.1
        };
        let allowed = (longest / median_interval(&times).max(1e-9)) as usize;
        let wanted = self.rows.div_ceil(MAX_SAMPLES);
        self.stride = wanted.min(allowed).max(1) | 1;
        if self.stride > allowed.max(1) {
            self.stride -= 2;
        }
        for (time, values) in std::mem::take(&mut self.first) {
            self.keep(time, &values);
        }
    }

    fn keep(&mut self, time: f64, values: &[f64]) {
        self.sums.iter_mut().zip(values).for_each(|(s, &v)| *s += v);
        if self.within == self.stride / 2 {
            self.middle = (time, values.to_vec());
        }
        self.within += 1;
        if self.within < self.stride {
            return;
        }
        self.time_s.push(self.middle.0);
        for (((column, kind), sum), middle) in
            (self.columns.iter_mut().zip(&self.kinds).zip(&self.sums)).zip(&self.middle.1)
        {
            column.push(match kind {
                ColumnKind::Input => sum / self.stride as f64,
                ColumnKind::Output | ColumnKind::Switch => *middle,
            });
        }
        self.within = 0;
        self.sums.fill(0.0);
    }

    fn finish(mut self, name: String) -> Recording {
        if !self.settled {
            self.settle();
        }
        let mut notes = Vec::new();
        if self.stride > 1 {
            notes.push(format!("one of {} samples was used", self.stride));
        }
        if let (true, Some(last)) = (self.full, self.time_s.last()) {
            notes.push(format!(
                "only the first {MAX_SAMPLES} of these were used, to {last} s; record less or slower to use all"
            ));
        }
        Recording {
            name,
            time_s: self.time_s,
            columns: self.columns,
            notes,
        }
    }
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
            "hole from {from} s to {to} s: the {lost} samples after it were not used"
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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
        assert!(r.notes[0].contains("one of 3 samples"), "{:?}", r.notes);
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
