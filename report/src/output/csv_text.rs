//! Columns as CSV text.

use std::io::{self, Write};

use super::OutputError;

/// A column of numbers: its name with unit, and its values.
pub type Numbers<'a> = (&'a str, &'a [f64]);

/// A column of words: its name and its values.
pub type Words<'a> = (&'a str, &'a [&'a str]);

/// A table of numbers that is written row by row, so that one of any length needs no memory.
pub struct CsvRows<W>(W);

impl<W: Write> CsvRows<W> {
    /// Writes the header: names with units.
    ///
    /// # Errors
    /// The file cannot be written; here and below.
    pub fn begin(mut out: W, names: &[String]) -> io::Result<Self> {
        writeln!(out, "{}", names.join(","))?;
        Ok(Self(out))
    }

    /// Writes a row, with a value for each column.
    ///
    /// # Errors
    /// As [`Self::begin`].
    pub fn row(&mut self, values: &[f64]) -> io::Result<()> {
        numbers_of_a_row(&mut self.0, values.iter().copied())?;
        writeln!(self.0)
    }
}

/// Refuses columns of different lengths. `name` is the file.
pub(super) fn check(name: &str, numbers: &[Numbers], words: &[Words]) -> Result<usize, OutputError> {
    let mut lengths = (numbers.iter().map(|column| (column.0, column.1.len())))
        .chain(words.iter().map(|column| (column.0, column.1.len())));
    let rows = lengths.clone().next().map_or(0, |(_, rows)| rows);
    match lengths.find(|(_, length)| *length != rows) {
        None => Ok(rows),
        Some((odd, length)) => Err(OutputError::Format {
            name: name.to_owned(),
            reason: format!("column {odd} has {length} rows where others have {rows}"),
        }),
    }
}

/// Writes a header and `rows` lines; words stand behind numbers.
pub(super) fn write(file: &mut impl Write, rows: usize, numbers: &[Numbers], words: &[Words]) -> io::Result<()> {
    let header: Vec<&str> = (numbers.iter().map(|column| column.0))
        .chain(words.iter().map(|column| column.0))
        .collect();
    writeln!(file, "{}", header.join(","))?;
    for row in 0..rows {
        let mut comma = numbers_of_a_row(file, numbers.iter().map(|(_, values)| values[row]))?;
        for (_, values) in words {
            write!(file, "{comma}{}", values[row])?;
            comma = ",";
        }
        writeln!(file)?;
    }
    file.flush()
}

/// Writes numbers with commas between them; returns what stands between them and the next.
fn numbers_of_a_row(file: &mut impl Write, values: impl Iterator<Item = f64>) -> io::Result<&'static str> {
    let mut comma = "";
    for value in values {
        file.write_all(comma.as_bytes())?;
        number(file, value)?;
        comma = ",";
    }
    Ok(comma)
}

/// A number as files of results have it: with nine significant digits, which is more than any sensor has.
pub fn rounded(value: f64) -> f64 {
    format!("{value:.8e}").parse().unwrap_or(value)
}

/// Writes a number, with an exponent where zeros would hide its digits.
fn number(file: &mut impl Write, value: f64) -> io::Result<()> {
    let rounded = rounded(value);
    if value == 0.0 || (1e-5..1e15).contains(&value.abs()) {
        write!(file, "{rounded}")
    } else {
        write!(file, "{rounded:e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_nine_digits_and_words_follow_them() {
        let values = [2.0 / 3.0, 1e-81, -123_456_789_012.0, 0.005, f64::NAN];
        let (numbers, words) = ([("x_m", &values[..])], [("mode", &["a", "b", "c", "d", ""][..])]);
        let mut text = Vec::new();
        let rows = check("a.csv", &numbers, &words).expect("of one length");
        write(&mut text, rows, &numbers, &words).expect("written");
        let expected = "x_m,mode\n0.666666667,a\n1e-81,b\n-123456789000,c\n0.005,d\nNaN,\n";
        assert_eq!(String::from_utf8_lossy(&text), expected);
        let mut rows = Vec::new();
        let mut table = CsvRows::begin(&mut rows, &["a".to_owned(), "b".to_owned()]).expect("memory");
        table.row(&[2.0 / 3.0, f64::NAN]).expect("memory");
        assert_eq!(String::from_utf8_lossy(&rows), "a,b\n0.666666667,NaN\n");
        assert!(check("b.csv", &[("x_m", &[1.0])], &[("mode", &[])]).is_err());
    }
}
