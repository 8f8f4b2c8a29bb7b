//! Errors of a model, with and without the file that it was read from.

use super::document::Document;
use super::path::{KeyPath, Step};

/// A value that a model cannot have: where it stands and what would be right.
///
/// ```
/// use oleo_plant_sim::strut::{Strut, StrutModel};
/// let mut model = StrutModel::defender110(8000.0);
/// model.accumulator[1].static_gas_volume_m3 = -4e-4;
/// let invalid = Strut::at_rest(&model, Default::default()).unwrap_err();
/// assert_eq!(
///     invalid.to_string(),
///     "[accumulator 2] static_gas_volume_m3 is -0.0004: must be from 1e-9 to 10 m3"
/// );
/// ```
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{path} {what}")]
pub struct InvalidValue {
    path: KeyPath,
    what: String,
}

impl InvalidValue {
    /// A complaint about the value of a key or about an entry. `what` goes on behind its name: `is -1: must be above 0`.
    #[must_use]
    pub fn new(step: impl Into<Step>, what: impl Into<String>) -> Self {
        Self {
            path: KeyPath::to(step),
            what: what.into(),
        }
    }

    /// The same complaint seen from one table or array further out.
    #[must_use]
    pub fn inside(mut self, step: impl Into<Step>) -> Self {
        self.path = self.path.inside(step);
        self
    }

    /// Where the value stands.
    #[must_use]
    pub fn path(&self) -> &KeyPath {
        &self.path
    }

    /// The same complaint about a file, with the line on which the value stands. `text` is the file's content.
    #[must_use]
    pub fn in_file(&self, text: &str, file: &str) -> ModelFileError {
        let line = Document::parse(text).ok().map(|document| document.line_of(&self.path));
        ModelFileError::new(file, line, &self.to_string())
    }
}

/// A model file that cannot be used. It is shown as one line: `FILE:LINE: [table] key is VALUE: what would be right`.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{file}{}: {what}", line.map(|line| format!(":{line}")).unwrap_or_default())]
pub struct ModelFileError {
    file: String,
    line: Option<usize>,
    what: String,
}

impl ModelFileError {
    /// A complaint about a file, about one of its lines where that is known (the first line is 1).
    #[must_use]
    pub fn new(file: &str, line: Option<usize>, what: &str) -> Self {
        // A value or a key may hold line breaks; a complaint is one line.
        let one_line = |text: &str| -> String {
            let words: Vec<&str> = text.split(|c: char| c.is_whitespace() || c.is_control()).collect();
            words
                .into_iter()
                .filter(|word| !word.is_empty())
                .collect::<Vec<_>>()
                .join(" ")
        };
        Self {
            file: one_line(file),
            line,
            what: one_line(what),
        }
    }

    /// Name of the file as the caller gave it.
    #[must_use]
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Line, counted from 1, where one is to blame.
    #[must_use]
    pub fn line(&self) -> Option<usize> {
        self.line
    }
}
