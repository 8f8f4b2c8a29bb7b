//! The columns that a specimen needs in its recordings.

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
    /// How the column is treated.
    pub kind: ColumnKind,
    /// Whether a recording may do without it. Its readings are then missing (NaN).
    pub optional: bool,
}

impl ColumnSpec {
    /// A column of this name and treatment.
    #[must_use]
    pub fn new(name: &str, kind: ColumnKind) -> Self {
        Self {
            name: name.to_owned(),
            kind,
            optional: false,
        }
    }

    /// A compared column that a recording may do without.
    #[must_use]
    pub fn optional(name: &str) -> Self {
        Self {
            optional: true,
            ..Self::new(name, ColumnKind::Output)
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
