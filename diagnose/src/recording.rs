//! One recording, read from CSV and made safe to simulate.
//!
//! Everything that could silently spoil a diagnosis is caught here: a column in another unit, time that stands still,
//! a value that is not a number. What can be used soundly is used and said in a note: a recording with a hole is cut at
//! the hole, because nobody knows the state after it; one with more samples than needed is thinned while it is read.

use std::path::Path;

use crate::error::DiagnoseError;

/// Most samples kept of one recording. A campaign of ten such is still simulated in about a second.
pub const MAX_SAMPLES: usize = 200_000;
/// Fewest samples from which anything can be concluded.
pub const MIN_SAMPLES: usize = 50;
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
    let file = std::fs::File::open(path).map_err(|e| DiagnoseError::file(path, e.to_string()))?;
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_reader(std::io::BufReader::with_capacity(1 << 20, file));
    let header = reader.headers().map_err(|e| csv_error(path, &e))?.clone();
    let time_at = position(path, &header, "time_s")?;
    let at: Vec<usize> = specs
        .iter()
        .map(|s| position(path, &header, &s.name))
        .collect::<Result<_, _>>()?;
    let mut thinner = Thinner::new(specs);
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
        thinner.push(time, &values);
    }
    let name = path
        .file_stem()
        .map_or_else(|| "recording".to_owned(), |s| s.to_string_lossy().into_owned());
    let mut recording = thinner.finish(name);
    if gaps == GapPolicy::Cut {
        cut_at_gap(&mut recording);
    }
    if recording.len() < MIN_SAMPLES {
        return Err(DiagnoseError::file(
            path,
            format!(
                "{} usable samples, at least {MIN_SAMPLES} are needed{}; record longer or leave the file out",
                recording.len(),
                recording.notes.first().map_or(String::new(), |n| format!(" ({n})"))
            ),
        ));
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

/// Keeps at most [`MAX_SAMPLES`] by taking one of `stride` rows, doubling `stride` when full. Nothing is lost that the
/// comparison needs: the model is compared at the kept instants, and its input is the mean around each.
struct Thinner {
    kinds: Vec<ColumnKind>,
    stride: usize,
    seen: usize,
    time_s: Vec<f64>,
    columns: Vec<Vec<f64>>,
    sums: Vec<f64>,
}

impl Thinner {
    fn new(specs: &[ColumnSpec]) -> Self {
        Self {
            kinds: specs.iter().map(|s| s.kind).collect(),
            stride: 1,
            seen: 0,
            time_s: Vec::new(),
            columns: vec![Vec::new(); specs.len()],
            sums: vec![0.0; specs.len()],
        }
    }

    fn push(&mut self, time: f64, values: &[f64]) {
        if self.stride == 1 {
            self.time_s.push(time);
            self.columns.iter_mut().zip(values).for_each(|(c, &v)| c.push(v));
            if self.time_s.len() > MAX_SAMPLES {
                self.halve();
            }
            return;
        }
        // Groups of `stride` rows; the kept instant is the middle row, so the mean of an input is centred on it.
        let within = self.seen % self.stride;
        if within == 0 {
            self.sums.fill(0.0);
        }
        self.sums.iter_mut().zip(values).for_each(|(s, &v)| *s += v);
        if within == self.stride / 2 {
            self.time_s.push(time);
            self.columns.iter_mut().zip(values).for_each(|(c, &v)| c.push(v));
        }
        if within + 1 == self.stride {
            for ((column, kind), sum) in self.columns.iter_mut().zip(&self.kinds).zip(&self.sums) {
                if *kind == ColumnKind::Input {
                    *column.last_mut().expect("the middle row was kept") = sum / self.stride as f64;
                }
            }
        }
        self.seen += 1;
        if self.time_s.len() > MAX_SAMPLES {
            self.halve();
        }
    }

    fn halve(&mut self) {
        let pairs = self.time_s.len() / 2;
        for (column, kind) in self.columns.iter_mut().zip(&self.kinds) {
            for k in 0..pairs {
                column[k] = match kind {
                    ColumnKind::Input => 0.5 * (column[2 * k] + column[2 * k + 1]),
                    ColumnKind::Output | ColumnKind::Switch => column[2 * k + 1],
                };
            }
            column.truncate(pairs);
        }
        for k in 0..pairs {
            self.time_s[k] = self.time_s[2 * k + 1];
        }
        self.time_s.truncate(pairs);
        self.stride *= 2;
        self.seen = 0;
    }

    fn finish(self, name: String) -> Recording {
        let mut notes = Vec::new();
        if self.stride > 1 {
            notes.push(format!("one of {} samples was used", self.stride));
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
