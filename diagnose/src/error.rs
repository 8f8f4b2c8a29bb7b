//! Errors in the user's files, each as one line that says what is wrong, where, and what to do.

use std::path::PathBuf;

/// A campaign that cannot be diagnosed, or a result that cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum DiagnoseError {
    /// A file or folder cannot be read or written.
    #[error("{}: {what}", path.display())]
    File {
        /// Path of the file or folder.
        path: PathBuf,
        /// What is wrong and what to do.
        what: String,
    },
    /// A recording is too short to conclude anything from; others of its campaign may do.
    #[error("{}: {what}", path.display())]
    TooShort {
        /// Path of the recording.
        path: PathBuf,
        /// How short and what to do.
        what: String,
    },
    /// A line of a file is wrong.
    #[error("{}, line {line}: {what}", path.display())]
    Line {
        /// Path of the file.
        path: PathBuf,
        /// Line number, the header is 1.
        line: u64,
        /// What is wrong and what to do.
        what: String,
    },
    /// A row of a recording in memory is wrong.
    #[error("{recording}, row {row}: {what}")]
    Row {
        /// Name of the recording.
        recording: String,
        /// Index of the row, the first is 0.
        row: usize,
        /// What is wrong and what to do.
        what: String,
    },
    /// The model file is wrong.
    #[error(transparent)]
    ModelFile(#[from] oleo_plant_sim::model_file::ModelFileError),
    /// A recording of another program cannot be read by its map of columns.
    #[error(transparent)]
    ColumnMap(#[from] oleo_plant_sim::rig::ColumnMapError),
    /// A recording cannot be replayed.
    #[error(transparent)]
    Recording(#[from] oleo_plant_sim::rig::RecordingError),
    /// The model cannot be used with these recordings; the text says why.
    #[error("{0}")]
    Model(String),
    /// The model cannot be simulated on a recording.
    #[error("recording {recording}: {what}")]
    Simulation {
        /// Name of the recording.
        recording: String,
        /// Why it failed, and what to do.
        what: String,
    },
    /// The caller asked to stop.
    #[error("the command was stopped; nothing was written")]
    Interrupted,
    /// The result could not be written.
    #[error("{0}")]
    Output(String),
}

impl DiagnoseError {
    pub(crate) fn file(path: impl Into<PathBuf>, what: impl Into<String>) -> Self {
        Self::File {
            path: path.into(),
            what: what.into(),
        }
    }
}
