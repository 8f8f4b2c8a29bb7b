//! Why a road could not be made, in one line each.

/// A road that cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RoadError {
    /// Neither a built-in name nor a file.
    #[error("road '{spec}' is neither a file (.crg, .csv) nor one of {names}")]
    Unknown {
        /// As given.
        spec: String,
        /// The built-in names.
        names: String,
    },
    /// The file could not be read from disk.
    #[error("{path}: cannot be read: {reason}")]
    Unreadable {
        /// As given.
        path: String,
        /// The operating system's reason.
        reason: String,
    },
    /// Something is wrong at a line of a file.
    #[error("{path}:{line}: {problem}")]
    Line {
        /// As given.
        path: String,
        /// From 1.
        line: usize,
        /// What is wrong and what to do.
        problem: String,
    },
    /// Something is wrong with the binary part of a file.
    #[error("{path}: {problem}")]
    Payload {
        /// As given.
        path: String,
        /// What is wrong and what to do.
        problem: String,
    },
    /// The length asked for cannot be made.
    #[error("road length {length_m} m is not possible: give between 1 and {limit_m} m")]
    Length {
        /// As given.
        length_m: f64,
        /// Longest length that is made.
        limit_m: f64,
    },
}

impl RoadError {
    /// At a line of a file.
    pub(super) fn line(path: &str, line: usize, problem: impl Into<String>) -> Self {
        Self::Line {
            path: path.to_owned(),
            line,
            problem: problem.into(),
        }
    }

    /// In the data of a file.
    pub(super) fn payload(path: &str, problem: impl Into<String>) -> Self {
        Self::Payload {
            path: path.to_owned(),
            problem: problem.into(),
        }
    }
}
