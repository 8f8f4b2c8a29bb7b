//! Recordings as other programs write them: a small TOML file says how their columns become those of a recording.
//!
//! ```toml
//! separator = ";"          # what is between two columns; a comma unless stated, "\t" is a tab
//! decimal_comma = true     # 0,5 is a half; a point is then between thousands
//! skip_lines = 2           # lines before the titles of the columns
//!
//! [columns]                # our name = title of theirs, with its unit where that is another
//! time_s = { title = "Zeit", unit = "ms" }
//! displacement_m = { title = "Federweg", unit = "mm", sign = -1 }
//! p1_Pa = { title = "Druck 1", unit = "bar" }
//! valve3 = { title = "Ventil 3", open = "AUF", closed = "ZU" }
//! ```
//!
//! Columns without an entry keep their title. Text that is not UTF-8 is read as Latin-1, as older spreadsheets write it.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::recording::other_separator;
use super::units::unit_size;

/// How the columns of a file become those of a recording.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ColumnMap {
    /// What is between two columns.
    #[serde(default = "comma")]
    pub separator: char,
    /// Whether numbers have a decimal comma, and points between thousands.
    #[serde(default)]
    pub decimal_comma: bool,
    /// Number of lines before the titles.
    #[serde(default)]
    pub skip_lines: usize,
    /// Our names of columns, each with what is known of theirs.
    pub columns: BTreeMap<String, Source>,
}

fn comma() -> char {
    ','
}

/// A column of the other file.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// Its title.
    pub title: String,
    /// Its unit; that of our name unless stated.
    pub unit: Option<String>,
    /// -1 where it counts the other way.
    #[serde(default = "positive")]
    pub sign: i8,
    /// What it holds for an open valve, instead of 1.
    pub open: Option<String>,
    /// What it holds for a closed valve, instead of 0.
    pub closed: Option<String>,
}

fn positive() -> i8 {
    1
}

/// Why a map, or a recording by it, cannot be used; one line: file, place, what, what to do.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}{}: {what}", line.map_or(String::new(), |line| format!(":{line}")))]
pub struct ColumnMapError {
    /// Path of the map or of the recording.
    pub file: String,
    /// Line of the file, counted from 1, where one is to blame.
    pub line: Option<u64>,
    /// What is wrong, and what to do.
    pub what: String,
}

impl Source {
    /// The factor from its numbers to ours.
    fn factor(&self, name: &str) -> Result<f64, String> {
        if self.sign != 1 && self.sign != -1 {
            return Err(format!("{name}: sign is {}; it is 1 or -1", self.sign));
        }
        let sign = f64::from(self.sign);
        match &self.unit {
            Some(unit) => Ok(sign * unit_size(name, unit)?),
            None => Ok(sign),
        }
    }
}

impl ColumnMap {
    /// Reads a map. `file` is the name that appears in errors.
    ///
    /// # Errors
    /// Unknown keys, missing titles, units that do not fit.
    pub fn from_toml(text: &str, file: &str) -> Result<Self, ColumnMapError> {
        let wrong = |line, what| ColumnMapError {
            file: file.to_owned(),
            line,
            what,
        };
        let map: Self = toml::from_str(text).map_err(|error| {
            let line = error
                .span()
                .map(|span| text[..span.start].matches('\n').count() as u64 + 1);
            wrong(line, error.message().to_owned())
        })?;
        if !map.separator.is_ascii() {
            return Err(wrong(
                None,
                format!("separator is {:?}; it must be an ASCII character", map.separator),
            ));
        }
        if map.decimal_comma && map.separator == ',' {
            let what = "the comma cannot be in numbers and between columns; set separator, such as \";\"";
            return Err(wrong(None, what.to_owned()));
        }
        for (name, source) in &map.columns {
            source.factor(name).map_err(|what| wrong(None, what))?;
        }
        Ok(map)
    }

    /// The text of a recording with our columns, separated by commas, every row in the line where it was. `file` is the name that
    /// appears in errors.
    ///
    /// # Errors
    /// A title that is not there, a separator that is another, a value that is no number.
    pub fn translate(&self, bytes: &[u8], file: &str) -> Result<String, ColumnMapError> {
        let wrong = |line, what| ColumnMapError {
            file: file.to_owned(),
            line,
            what,
        };
        let text = decoded(bytes);
        let mut rest = text.as_str();
        for _ in 0..self.skip_lines {
            rest = rest.split_once('\n').map_or("", |(_, rest)| rest);
        }
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(u8::try_from(self.separator).unwrap_or(b','))
            .trim(csv::Trim::All)
            .flexible(true)
            .from_reader(rest.as_bytes());
        let skipped = self.skip_lines as u64;
        let refused = |error: csv::Error| wrong(error.position().map(|at| at.line() + skipped), error.to_string());
        let header = reader.headers().map_err(refused)?.clone();
        let columns = self.places(&header).map_err(|what| wrong(Some(1 + skipped), what))?;
        let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
        let mut out = "\n".repeat(self.skip_lines) + &names.join(",");
        let mut lines = 1 + skipped;
        let mut row = csv::StringRecord::new();
        while reader.read_record(&mut row).map_err(refused)? {
            let line = row.position().map_or(0, csv::Position::line) + skipped;
            // Empty lines stay, so that later errors name the line of the file.
            while lines < line {
                out.push('\n');
                lines += 1;
            }
            for (index, column) in columns.iter().enumerate() {
                if index > 0 {
                    out.push(',');
                }
                let field = row.get(column.place).unwrap_or("");
                out += &self.value(column, field).map_err(|what| wrong(Some(line), what))?;
            }
        }
        out.push('\n');
        Ok(out)
    }

    /// Our columns with their places: those with an entry, and those that have our title already.
    fn places<'m>(&'m self, header: &csv::StringRecord) -> Result<Vec<Placed<'m>>, String> {
        let mut placed = Vec::new();
        for (name, source) in &self.columns {
            let Some(place) = header.iter().position(|title| title == source.title) else {
                return Err(missing(&source.title, self.separator, header));
            };
            placed.push(Placed {
                name: name.clone(),
                place,
                factor: source.factor(name)?,
                source: Some(source),
            });
        }
        for (place, title) in header.iter().enumerate() {
            let taken = placed
                .iter()
                .any(|column: &Placed| column.place == place || column.name == title);
            if !taken && !title.is_empty() {
                placed.push(Placed {
                    name: title.replace([',', '"'], " "),
                    place,
                    factor: 1.0,
                    source: None,
                });
            }
        }
        placed.sort_by_key(|column| column.place);
        Ok(placed)
    }

    /// A field as we write it. Fields of columns without an entry are kept, whatever they are.
    fn value(&self, column: &Placed, field: &str) -> Result<String, String> {
        if let Some(source) = column.source {
            if source.open.as_deref() == Some(field) {
                return Ok("1".into());
            }
            if source.closed.as_deref() == Some(field) {
                return Ok("0".into());
            }
        }
        match (self.number(field), column.source) {
            (Some(number), _) if column.factor == 1.0 => Ok(format!("{number}")),
            (Some(number), _) => Ok(format!("{}", number * column.factor)),
            (None, None) => Ok(field.replace([',', '"'], " ")),
            (None, Some(source)) => Err(format!(
                "{} is {field:?}, not a number; check separator, decimal_comma and skip_lines of the column map",
                source.title
            )),
        }
    }

    /// A number in the notation of the file.
    fn number(&self, field: &str) -> Option<f64> {
        if !self.decimal_comma {
            return field.parse().ok();
        }
        let (whole, decimals) = field.split_once(',').unwrap_or((field, ""));
        let mut groups = whole.split('.');
        // Points stand between thousands; elsewhere the file does not have decimal commas.
        let first = groups.next().unwrap_or("");
        let mut digits = first.to_owned();
        for group in groups {
            if group.len() != 3 || decimals.contains('.') {
                return None;
            }
            digits += group;
        }
        if decimals.is_empty() {
            return digits.parse().ok();
        }
        format!("{digits}.{decimals}").parse().ok()
    }
}

/// A column of the other file that has become ours.
struct Placed<'m> {
    name: String,
    place: usize,
    factor: f64,
    source: Option<&'m Source>,
}

/// What to say of a title that is not in the header.
fn missing(title: &str, separator: char, header: &csv::StringRecord) -> String {
    if let Some(other) = other_separator(header).filter(|other| *other != separator) {
        return format!(
            "the columns are separated by {other:?}, not by {separator:?}; set separator in the column map"
        );
    }
    let titles: Vec<String> = header.iter().map(|title| format!("{title:?}")).collect();
    format!(
        "there is no column with the title {title:?}; the titles are {}. Set title, separator or skip_lines in the column map",
        titles.join(", ")
    )
}

/// Bytes as text with plain line ends: UTF-8, with or without a mark at its begin, or else Latin-1.
fn decoded(bytes: &[u8]) -> String {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let text = match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().copied().map(char::from).collect(),
    };
    // The reader counts the line of a row before it has passed the second half of such a line end.
    text.replace("\r\n", "\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const GERMAN: &str = "separator = \";\"\ndecimal_comma = true\nskip_lines = 1\n[columns]\n\
        time_s = { title = \"Zeit\", unit = \"ms\" }\n\
        p1_Pa = { title = \"Druck \u{fc}ber Umgebung\", unit = \"bar\" }\n\
        displacement_m = { title = \"Weg\", unit = \"mm\", sign = -1 }\n\
        valve3 = { title = \"Ventil 3\", open = \"AUF\", closed = \"ZU\" }\n";

    #[test]
    fn a_german_spreadsheet_becomes_a_recording() {
        let map = ColumnMap::from_toml(GERMAN, "map.toml").expect("a map");
        let text = "Messung vom 3. Mai\r\nZeit;Weg;Druck \u{fc}ber Umgebung;Ventil 3;Bemerkung\r\n\
                    0;-10,5;1.041,25;AUF;Start, kalt\r\n2,5;0;40;ZU;\r\n";
        // As UTF-8 with a mark, and as an older spreadsheet writes it.
        let latin: Vec<u8> = text
            .chars()
            .map(|c| u8::try_from(u32::from(c)).expect("Latin-1"))
            .collect();
        for bytes in [format!("\u{feff}{text}").into_bytes(), latin] {
            let ours = map.translate(&bytes, "messung.csv").expect("a recording");
            assert_eq!(
                ours,
                "\ntime_s,displacement_m,p1_Pa,valve3,Bemerkung\n0,0.0105,104125000,1,Start  kalt\n0.0025,-0,4000000,0,\n"
            );
        }
    }

    #[test]
    fn what_is_wrong_is_said_with_its_place() {
        let map = ColumnMap::from_toml(GERMAN, "map.toml").expect("a map");
        let refused = |text: &str| {
            map.translate(text.as_bytes(), "m.csv")
                .expect_err("refused")
                .to_string()
        };
        let title = "Zeit;Weg;Druck \u{fc}ber Umgebung;Ventil 3";
        assert!(refused("x\nZeit,Weg\n0,1\n").starts_with("m.csv:2: there is no column with the title"));
        assert!(refused("x\nZeit\tWeg\n0\t1\n").contains("set separator"));
        let said = refused(&format!("x\n{title}\n0;1;2;ZU\n1;1.5;2;ZU\n"));
        assert!(said.starts_with("m.csv:4: Weg is \"1.5\", not a number"), "{said}");
        let bad = |text: &str| ColumnMap::from_toml(text, "map.toml").expect_err("refused").to_string();
        assert!(bad("[columns]\np1_Pa = { title = \"p\", unit = \"mm\" }\n").contains("the units are Pa, kPa"));
        assert!(bad("decimal_comma = true\n[columns]\n").contains("set separator"));
        assert!(bad("x = 1\n[columns]\n").starts_with("map.toml:1:"));
    }

    proptest! {
        #[test]
        fn any_number_survives_a_decimal_comma(value in -1e9..1e9_f64) {
            let map = ColumnMap::from_toml(GERMAN, "map.toml").expect("a map");
            prop_assert_eq!(map.number(&format!("{value}").replace('.', ",")), Some(value));
        }

        #[test]
        fn no_file_panics(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
            let map = ColumnMap::from_toml(GERMAN, "map.toml").expect("a map");
            let _ = map.translate(&bytes, "any.csv");
        }
    }
}
