//! Why a log cannot be read, in one line.

use std::path::{Path, PathBuf};

/// Why a log cannot be read: file, place, what, what to do.
#[derive(Debug, thiserror::Error)]
#[error("{}: {what}", path.display())]
pub struct LogError {
    /// Path of the log.
    pub path: PathBuf,
    /// What is wrong and where in the file, and what to do.
    pub what: String,
}

impl LogError {
    /// An error in a log.
    pub fn new(path: &Path, what: impl Into<String>) -> Self {
        // A message of a library may have several lines.
        let what: String = what.into();
        Self {
            path: path.to_path_buf(),
            what: what.split(['\n', '\r']).collect::<Vec<_>>().join(" "),
        }
    }

    /// A file that cannot be read at all.
    pub fn unreadable(path: &Path, error: &std::io::Error) -> Self {
        Self::new(path, format!("{error}; check the path"))
    }
}
