//! Errors of roads, in one line each.

/// A road that cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RoadError {
    /// Neither a built-in name nor a file.
    #[error("road '{spec}' is neither a .crg or .csv file nor a built-in road: {names}")]
    Unknown {
        /// The text that the user gave.
        spec: String,
        /// The built-in roads, and which was probably meant.
        names: String,
    },
    /// The file could not be read from disk.
    #[error("{path}: cannot be read: {reason}")]
    Unreadable {
        /// The path as the user gave it.
        path: String,
        /// The operating system's reason.
        reason: String,
    },
    /// Something is wrong at a line of a file.
    #[error("{path}:{line}: {problem}")]
    Line {
        /// The path as the user gave it.
        path: String,
        /// Line of the file, counted from 1.
        line: usize,
        /// What is wrong and what to do.
        problem: String,
    },
    /// Something is wrong with the binary part of a file.
    #[error("{path}: {problem}")]
    Payload {
        /// The path as the user gave it.
        path: String,
        /// What is wrong and what to do.
        problem: String,
    },
    /// The length asked for cannot be made.
    #[error(
        "the drive needs {length_m:.0} m of road, and a road can be made from 1 to {limit_m} m long: change the duration or the speed"
    )]
    Length {
        /// The length that was asked for, m.
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
