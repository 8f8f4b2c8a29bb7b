//! Columns of a run: quantities, and signals or states.

use std::cmp::Ordering;
use std::path::Path;

use crate::failure::Failure;

/// The columns of a run, of one length.
#[derive(Clone, Debug, Default)]
pub struct Traces {
    columns: Vec<(String, Trace)>,
}

/// The values of one column.
#[derive(Clone, Debug)]
pub enum Trace {
    /// A quantity. It is interpolated between samples; NaN is "not defined here".
    Quantity(Vec<f64>),
    /// A signal or a state, as text. It is held until the next sample.
    State(Vec<String>),
}

impl Trace {
    /// Whether two columns have the same values, to the last digit. What is not defined is the same as what is not defined.
    pub fn is_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Quantity(a), Self::Quantity(b)) => {
                let same = |(a, b): (&f64, &f64)| a == b || (a.is_nan() && b.is_nan());
                a.len() == b.len() && a.iter().zip(b).all(same)
            }
            (Self::State(a), Self::State(b)) => a == b,
            _ => false,
        }
    }
}

impl Traces {
    /// Columns of numbers by name.
    pub fn of(columns: impl IntoIterator<Item = (String, Vec<f64>)>) -> Self {
        let columns = columns.into_iter().map(|(name, values)| {
            let trace = match is_state(&name) {
                true => Trace::State(values.iter().map(f64::to_string).collect()),
                false => Trace::Quantity(values),
            };
            (name, trace)
        });
        Self {
            columns: columns.collect(),
        }
    }

    /// All columns of a CSV file. An empty cell of a quantity is not defined.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let file = path.display();
        let bad = |error: csv::Error| {
            Failure::new(format!(
                "{file}: cannot be read: {error}; give a folder of results or a CSV file with a header"
            ))
        };
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .from_path(path)
            .map_err(bad)?;
        let names: Vec<String> = reader.headers().map_err(bad)?.iter().map(str::to_owned).collect();
        if let Some(twice) = (names.iter().enumerate()).find_map(|(i, name)| names[..i].contains(name).then_some(name))
        {
            return Err(Failure::new(format!(
                "{file}:1: there are two columns {twice}; give each a name of its own"
            )));
        }
        let mut columns: Vec<(String, Trace)> = (names.into_iter())
            .map(|name| match is_state(&name) {
                true => (name, Trace::State(Vec::new())),
                false => (name, Trace::Quantity(Vec::new())),
            })
            .collect();
        let mut row = csv::StringRecord::new();
        while reader.read_record(&mut row).map_err(bad)? {
            for ((name, trace), cell) in columns.iter_mut().zip(&row) {
                match trace {
                    // One and the same number may be written in several ways.
                    Trace::State(values) => {
                        values.push(cell.parse::<f64>().map_or(cell.to_owned(), |number| number.to_string()))
                    }
                    Trace::Quantity(values) if cell.is_empty() => values.push(f64::NAN),
                    Trace::Quantity(values) => values.push(cell.parse().map_err(|_| {
                        let line = row.position().map_or(0, csv::Position::line);
                        Failure::new(format!("{file}:{line}: {name} is {cell:?}; a number is needed"))
                    })?),
                }
            }
        }
        Ok(Self { columns })
    }

    /// Names in the order of the file.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(|(name, _)| name.as_str())
    }

    /// A column.
    pub fn trace(&self, name: &str) -> Option<&Trace> {
        (self.columns.iter().find(|(known, _)| known == name)).map(|(_, trace)| trace)
    }

    /// The column over which the others are compared. It must increase from the first sample to the last.
    pub fn axis(&self, name: &str, run: &str) -> Result<&[f64], Failure> {
        let Some(Trace::Quantity(axis)) = self.trace(name) else {
            return Err(Failure::new(format!(
                "{run}: there is no column {name}, over which runs are compared"
            )));
        };
        if axis.len() < 2 {
            return Err(Failure::new(format!(
                "{run}: {name} has {} samples; two or more are needed",
                axis.len()
            )));
        }
        if let Some(sample) = axis.iter().position(|at| !at.is_finite()) {
            return Err(Failure::new(format!(
                "{run}: {name} is no number in sample {}; every sample needs one",
                sample + 1
            )));
        }
        let falls = |pair: &[f64]| pair[1].partial_cmp(&pair[0]) != Some(Ordering::Greater);
        match axis.windows(2).position(falls) {
            None => Ok(axis),
            Some(i) => Err(Failure::new(format!(
                "{run}: {name} does not increase at {}; compare over another axis with --over",
                axis[i + 1]
            ))),
        }
    }
}

/// Whether a column is a signal or a state, whose values between samples mean nothing. These are the columns of words and of numbers
/// without a unit that commands write.
fn is_state(name: &str) -> bool {
    const STATES: [&str; 4] = ["mode", "fault", "handling", "rollover_guard"];
    STATES.contains(&name)
        || name.ends_with("_word")
        || name.ends_with("_open")
        || is_numbered(name, "valve")
        || is_numbered(name, "acting")
}

/// `valve1`, or `valve1_front_left`.
fn is_numbered(name: &str, stem: &str) -> bool {
    let number = name
        .strip_prefix(stem)
        .map(|rest| rest.split('_').next().unwrap_or(rest));
    number.is_some_and(|number| number.parse::<u8>().is_ok())
}
