//! The ledger of finished campaigns, one line of JSON each, from which an interrupted self-test resumes.
//!
//! A line's key is the case's name, which fixes everything drawn in it. What the line does not know is the program that
//! wrote it: another build wants another folder, and the file's first line says which build it is of.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use super::trial::Trial;
use crate::error::DiagnoseError;

/// Raised with every change that makes old trials say something else.
const FORMAT: &str = concat!("{\"oleo_self_test\":1,\"version\":\"", env!("CARGO_PKG_VERSION"), "\"}");

/// Finished trials by name, and the file they are appended to.
pub struct Ledger {
    known: BTreeMap<String, Trial>,
    file: Option<(PathBuf, Mutex<File>)>,
}

impl Ledger {
    /// A ledger that is not kept.
    #[must_use]
    pub fn in_memory() -> Self {
        Self {
            known: BTreeMap::new(),
            file: None,
        }
    }

    /// Opens or creates a file. A line that an interruption cut short is skipped, and its trial made again.
    ///
    /// # Errors
    /// A file that cannot be read or written, or that another build wrote.
    pub fn open(path: &Path) -> Result<Self, DiagnoseError> {
        let wrap = |e: std::io::Error| DiagnoseError::file(path, e.to_string());
        let mut text = String::new();
        let mut file = OpenOptions::new()
            .read(true)
            .append(true)
            .create(true)
            .open(path)
            .map_err(wrap)?;
        file.read_to_string(&mut text).map_err(wrap)?;
        match text.lines().next() {
            None => file.write_all(format!("{FORMAT}\n").as_bytes()).map_err(wrap)?,
            Some(first) if first == FORMAT => {}
            Some(_) => {
                return Err(DiagnoseError::file(
                    path,
                    "was written by another version of the self-test; give another --out folder",
                ));
            }
        }
        if !text.is_empty() && !text.ends_with('\n') {
            file.write_all(b"\n").map_err(wrap)?;
        }
        Ok(Self {
            known: known(&text),
            file: Some((path.to_path_buf(), Mutex::new(file))),
        })
    }

    /// A ledger from the text of such a file, in which nothing is kept. Lines that are no trials are left out.
    #[must_use]
    pub fn of_text(text: &str) -> Self {
        Self {
            known: known(text),
            file: None,
        }
    }

    /// The finished campaign of this name, if the ledger contains it.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&Trial> {
        self.known.get(name)
    }

    /// Keeps a trial: one write a line, whole lines only, whatever the thread.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn keep(&self, trial: &Trial) -> Result<(), DiagnoseError> {
        let Some((path, file)) = &self.file else { return Ok(()) };
        let fail = |what: String| DiagnoseError::file(path, what);
        let mut line = serde_json::to_string(trial).map_err(|e| fail(e.to_string()))?;
        line.push('\n');
        let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
        file.write_all(line.as_bytes()).map_err(|e| fail(e.to_string()))
    }
}

fn known(text: &str) -> BTreeMap<String, Trial> {
    text.lines()
        .filter_map(|line| serde_json::from_str::<Trial>(line).ok())
        .map(|trial| (trial.name.clone(), trial))
        .collect()
}
