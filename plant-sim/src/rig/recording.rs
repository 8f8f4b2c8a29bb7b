//! A recording as a file: named columns of numbers over time, and what a strut needs of them.

use std::io::Read;

use oleo_interface::StrutValves;

use super::plausible::implausible;
use crate::strut::Inputs;

/// What separates the columns of a header that is a single field: programs of many countries write semicolons, since their
/// numbers have decimal commas.
pub fn other_separator(header: &csv::StringRecord) -> Option<char> {
    let one = header.get(0).filter(|_| header.len() == 1)?;
    [';', '\t', '|'].into_iter().find(|separator| one.contains(*separator))
}

/// What to do about it.
pub fn wrong_separator(separator: char) -> String {
    let name = match separator {
        ';' => "semicolons".to_owned(),
        '\t' => "tabs".to_owned(),
        other => format!("'{other}'"),
    };
    format!("the columns are separated by {name}; write the file again with commas, and decimal points in its numbers")
}

/// Why a recording cannot be replayed; one line: file, line, what, what to do.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum RecordingError {
    /// A column is missing.
    #[error("{file}:1: there is no column {column}; a recording of this kind needs {needed}")]
    Column {
        /// Path of the recording.
        file: String,
        /// Name of the missing column.
        column: String,
        /// All that are needed.
        needed: String,
    },
    /// The columns are not separated by commas.
    #[error("{file}:1: {}", wrong_separator(*separator))]
    Separator {
        /// Path of the recording.
        file: String,
        /// What separates the columns.
        separator: char,
    },
    /// A value is not usable.
    #[error("{file}:{line}: {column} is {value:?}; {need}")]
    Value {
        /// Path of the recording.
        file: String,
        /// Line of the file, counted from 1.
        line: u64,
        /// Name of the column.
        column: String,
        /// Text that was found there.
        value: String,
        /// What is needed instead.
        need: &'static str,
    },
    /// A column in memory lacks, or its length is another than that of the time; or a value in it is not usable.
    #[error("{recording}: {what}")]
    Table {
        /// Name of the recording.
        recording: String,
        /// What is wrong, where, and what to do.
        what: String,
    },
    /// The file is not a table in CSV format.
    #[error("{file}: {reason}")]
    Csv {
        /// Path of the recording.
        file: String,
        /// What the reader says.
        reason: String,
    },
    /// Times or displacements are in another unit.
    #[error("{file}: {what}")]
    Implausible {
        /// Path of the recording.
        file: String,
        /// What is wrong and what to do.
        what: String,
    },
    /// The recording is too short.
    #[error("{file}: the recording has {samples} samples; a replay needs two or more")]
    Short {
        /// Path of the recording.
        file: String,
        /// Number of samples that were found.
        samples: usize,
    },
}

/// Columns of a recording, of one length; the first is `time_s`, which increases.
#[derive(Debug, Clone, PartialEq)]
pub struct Columns {
    names: Vec<String>,
    values: Vec<Vec<f64>>,
}

/// Columns that hold a switching signal.
const VALVES: [&str; 3] = ["valve1", "valve2", "valve3"];
const PRESSURES: [&str; 4] = ["p1_Pa", "p2_Pa", "p3_Pa", "p4_Pa"];

impl Columns {
    /// Reads the `needed` columns (with `time_s` before them) and those of `welcome` that are there; others are left aside.
    ///
    /// # Errors
    /// A missing column, text that is no finite number, a signal that is neither 0 nor 1, time that does not increase, fewer
    /// than two samples, times in milliseconds or displacements in millimetres.
    pub fn read(source: impl Read, file: &str, needed: &[&str], welcome: &[&str]) -> Result<Self, RecordingError> {
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(source);
        let csv_error = |error: csv::Error| RecordingError::Csv {
            file: file.to_owned(),
            reason: error.to_string(),
        };
        let header = reader.headers().map_err(csv_error)?.clone();
        if let Some(separator) = other_separator(&header) {
            return Err(RecordingError::Separator {
                file: file.to_owned(),
                separator,
            });
        }
        let (mut names, mut places) = (Vec::new(), Vec::new());
        for (name, must) in std::iter::once((&"time_s", true))
            .chain(needed.iter().map(|name| (name, true)))
            .chain(welcome.iter().map(|name| (name, false)))
        {
            match header.iter().position(|title| title == *name) {
                Some(place) => {
                    names.push((*name).to_owned());
                    places.push(place);
                }
                None if must => {
                    return Err(RecordingError::Column {
                        file: file.to_owned(),
                        column: (*name).to_owned(),
                        needed: format!("time_s, {}", needed.join(", ")),
                    });
                }
                None => {}
            }
        }
        let mut values: Vec<Vec<f64>> = vec![Vec::new(); names.len()];
        let mut row = csv::StringRecord::new();
        while reader.read_record(&mut row).map_err(csv_error)? {
            for ((name, &place), column) in names.iter().zip(&places).zip(&mut values) {
                let text = row.get(place).unwrap_or("");
                let value = text.parse().unwrap_or(f64::NAN);
                usable(name, value, column.last()).map_err(|need| RecordingError::Value {
                    file: file.to_owned(),
                    line: row.position().map_or(0, csv::Position::line),
                    column: name.clone(),
                    value: text.to_owned(),
                    need,
                })?;
                column.push(value);
            }
        }
        Self::checked(file, names, values)
    }

    /// As [`Self::read`], from the names and values of columns in memory. `recording` names it in errors.
    ///
    /// # Errors
    /// As [`Self::read`], and columns of different lengths; rows are counted from 0.
    pub fn of_table(
        table: &[(&str, &[f64])],
        recording: &str,
        needed: &[&str],
        welcome: &[&str],
    ) -> Result<Self, RecordingError> {
        let wrong = |what: String| RecordingError::Table {
            recording: recording.to_owned(),
            what,
        };
        let (mut names, mut values) = (Vec::new(), Vec::new());
        let wanted = std::iter::once(&"time_s").chain(needed).map(|name| (name, true));
        for (name, must) in wanted.chain(welcome.iter().map(|name| (name, false))) {
            let Some((_, column)) = table.iter().find(|(title, _)| title == name) else {
                match must {
                    true => {
                        let needed = needed.join(", ");
                        return Err(wrong(format!(
                            "there is no column {name}; a recording of this kind needs time_s, {needed}"
                        )));
                    }
                    false => continue,
                }
            };
            for (row, value) in column.iter().enumerate() {
                let before = row.checked_sub(1).and_then(|before| column.get(before));
                usable(name, *value, before).map_err(|need| wrong(format!("row {row}: {name} is {value}; {need}")))?;
            }
            names.push((*name).to_owned());
            values.push(column.to_vec());
        }
        let samples = values[0].len();
        match names.iter().zip(&values).find(|(_, column)| column.len() != samples) {
            Some((name, column)) => Err(wrong(format!(
                "{name} has {} values and time_s {samples}; give columns of one length",
                column.len()
            ))),
            None => Self::checked(recording, names, values),
        }
    }

    fn checked(file: &str, names: Vec<String>, values: Vec<Vec<f64>>) -> Result<Self, RecordingError> {
        let samples = values[0].len();
        if samples < 2 {
            return Err(RecordingError::Short {
                file: file.to_owned(),
                samples,
            });
        }
        let columns = Self { names, values };
        match implausible(columns.time_s(), columns.column("displacement_m")) {
            Some(what) => Err(RecordingError::Implausible {
                file: file.to_owned(),
                what,
            }),
            None => Ok(columns),
        }
    }

    /// Times of the samples, s.
    #[must_use]
    pub fn time_s(&self) -> &[f64] {
        &self.values[0]
    }

    /// A column, if it was read.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        self.names
            .iter()
            .position(|other| other == name)
            .map(|place| self.values[place].as_slice())
    }
}

/// Whether a value of a column can be used, behind the value before it; if not, what is needed instead.
fn usable(name: &str, value: f64, before: Option<&f64>) -> Result<(), &'static str> {
    if !value.is_finite() {
        return Err("a finite number is needed");
    }
    if name == "time_s" && before.is_some_and(|before| value <= *before) {
        return Err("time must increase; sort the rows and drop duplicates");
    }
    if VALVES.contains(&name) && value != 0.0 && value != 1.0 {
        return Err("a switching signal is 0 (closed) or 1 (open)");
    }
    Ok(())
}

/// Inputs and recorded channels of a strut.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedStrut {
    /// Sample times, s, increasing.
    pub time_s: Vec<f64>,
    /// Measured displacement, m, compression positive.
    pub displacement_m: Vec<f64>,
    /// Switching signals at each sample, true for open.
    pub signals: Vec<StrutValves<bool>>,
    /// Load cell, N, where recorded.
    pub force_n: Option<Vec<f64>>,
    /// p1 to p4, Pa gauge, where recorded.
    pub pressure_pa: [Option<Vec<f64>>; 4],
}

impl RecordedStrut {
    /// Reads a strut's recording.
    ///
    /// # Errors
    /// As [`Columns::read`].
    pub fn read(source: impl Read, file: &str) -> Result<Self, RecordingError> {
        Columns::read(source, file, &Self::NEEDED, &Self::WELCOME).map(|columns| Self::of(&columns))
    }

    /// The inputs of a strut, which its recording must have beside the time.
    pub const NEEDED: [&'static str; 4] = ["displacement_m", VALVES[0], VALVES[1], VALVES[2]];
    /// Its channels, of which any may be recorded.
    pub const WELCOME: [&'static str; 5] = ["force_N", PRESSURES[0], PRESSURES[1], PRESSURES[2], PRESSURES[3]];

    /// The recording in columns that were read with [`Self::NEEDED`] and [`Self::WELCOME`].
    #[must_use]
    pub fn of(columns: &Columns) -> Self {
        let of = |name: &str| columns.column(name).map(<[f64]>::to_vec);
        let valves = VALVES.map(|name| of(name).unwrap_or_default());
        let signals = (0..columns.time_s().len())
            .map(|at| StrutValves::from_fn(|valve| valves[valve.index()][at] == 1.0))
            .collect();
        Self {
            time_s: columns.time_s().to_vec(),
            displacement_m: of("displacement_m").unwrap_or_default(),
            signals,
            force_n: of("force_N"),
            pressure_pa: PRESSURES.map(of),
        }
    }

    /// The inputs, with the displacement smoothed by its stated noise (m).
    #[must_use]
    pub fn inputs(&self, noise_m: f64) -> Inputs {
        Inputs::from_recording(&self.time_s, &self.displacement_m, &self.signals, noise_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str =
        "time_s,displacement_m,p1_Pa,valve1,valve2,valve3,remark\n0,0,4e6,0,1,1,a\n0.1,1e-3,4.1e6,1,1,1,b\n";

    #[test]
    fn reads_inputs_and_what_else_was_recorded() {
        let recording = RecordedStrut::read(GOOD.as_bytes(), "r.csv").expect("good");
        assert_eq!(recording.displacement_m, [0.0, 1e-3]);
        assert_eq!(recording.signals[0], StrutValves::new(false, true, true));
        assert_eq!(recording.pressure_pa[0].as_deref(), Some(&[4e6, 4.1e6][..]));
        assert!(recording.force_n.is_none() && recording.pressure_pa[1].is_none());
    }

    #[test]
    fn columns_in_memory_are_read_as_those_of_a_file() {
        let file = Columns::read(GOOD.as_bytes(), "r.csv", &["displacement_m"], &["p1_Pa"]).expect("good");
        let (time, x, p1) = ([0.0, 0.1], [0.0, 1e-3], [4e6, 4.1e6]);
        let table = |time| [("p1_Pa", &p1[..]), ("time_s", time), ("displacement_m", &x[..])];
        let read = |time, needed| Columns::of_table(&table(time), "r", &[needed], &["p1_Pa"]);
        assert_eq!(read(&time, "displacement_m"), Ok(file));
        for (time, needed, complaint) in [
            (
                &time[..],
                "force_N",
                "r: there is no column force_N; a recording of this kind needs time_s, force_N",
            ),
            (
                &[0.0, f64::NAN],
                "p1_Pa",
                "r: row 1: time_s is NaN; a finite number is needed",
            ),
            (
                &[0.0, 0.0],
                "p1_Pa",
                "r: row 1: time_s is 0; time must increase; sort the rows and drop duplicates",
            ),
            (
                &[0.0],
                "displacement_m",
                "r: displacement_m has 2 values and time_s 1; give columns of one length",
            ),
        ] {
            assert_eq!(
                read(time, needed).map_err(|error| error.to_string()),
                Err(complaint.to_owned())
            );
        }
    }

    #[test]
    fn refusals_name_file_line_and_column() {
        for (from, to, part) in [
            ("displacement_m", "x_m", "r.csv:1: there is no column displacement_m"),
            ("1e-3", "nan", "r.csv:3: displacement_m is \"nan\""),
            ("0.1,", "0,", "r.csv:3: time_s is \"0\"; time must increase"),
            ("4.1e6,1,", "4.1e6,0.5,", "r.csv:3: valve1 is \"0.5\""),
        ] {
            let bad = GOOD.replacen(from, to, 1);
            let error = RecordedStrut::read(bad.as_bytes(), "r.csv")
                .expect_err(part)
                .to_string();
            assert!(error.starts_with(part) && !error.contains('\n'), "{error}");
        }
        let empty = "time_s,displacement_m,valve1,valve2,valve3\n";
        assert!(RecordedStrut::read(empty.as_bytes(), "r.csv").is_err());
    }
}
