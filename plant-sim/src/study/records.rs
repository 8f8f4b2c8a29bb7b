//! Finished runs in a file: one line of CSV a run, appended as it ends, so that a study that was interrupted goes on where it
//! stopped.
//!
//! A line begins with a key: a hash (FNV-1a, 64 bit) of everything that the result depends on. Other parameters have another key,
//! so that old lines are never mistaken for new ones. A line that an interruption cut short is taken out and its run made again.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::hash::Hasher as _;
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use csv::StringRecord;
use fnv::FnvHasher;

/// A file of records that cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}: give another --out folder, or empty this one", path.display())]
pub struct RecordsError {
    path: PathBuf,
    problem: std::io::Error,
}

/// Records by key, and the file they are appended to.
#[derive(Default)]
pub struct Records {
    known: BTreeMap<String, StringRecord>,
    file: Option<(PathBuf, Mutex<File>)>,
}

impl Records {
    /// Records that are forgotten with the program.
    pub fn in_memory() -> Self {
        Self::default()
    }

    /// Opens or creates the file `path`.
    ///
    /// # Errors
    /// The file cannot be read or written.
    pub fn open(path: &Path) -> Result<Self, RecordsError> {
        let wrap = |problem| RecordsError {
            path: path.to_owned(),
            problem,
        };
        let mut text = String::new();
        let mut file = OpenOptions::new()
            .read(true)
            .append(true)
            .create(true)
            .open(path)
            .map_err(wrap)?;
        file.read_to_string(&mut text).map_err(wrap)?;
        // Only what ends with a line break was written to its end. The rest is removed: whoever opens the file next could not tell
        // a number that was cut short from a whole one.
        let whole = text.rfind('\n').map_or("", |end| &text[..=end]);
        if whole.len() < text.len() {
            file.set_len(whole.len() as u64).map_err(wrap)?;
        }
        Ok(Self {
            known: known(whole),
            file: Some((path.to_owned(), Mutex::new(file))),
        })
    }

    /// Records from the text of such a file, to which none are added.
    pub fn of_text(text: &str) -> Self {
        Self {
            known: known(text),
            file: None,
        }
    }

    /// Number of records known so far.
    pub fn len(&self) -> usize {
        self.known.len()
    }

    /// Whether nothing is known.
    pub fn is_empty(&self) -> bool {
        self.known.is_empty()
    }

    /// The key of everything that a result depends on, written as text.
    pub fn key(depends_on: &str) -> String {
        let mut hash = FnvHasher::default();
        hash.write(depends_on.as_bytes());
        format!("{:016x}", hash.finish())
    }

    /// The fields of a record, its key first.
    pub fn get(&self, key: &str) -> Option<&StringRecord> {
        self.known.get(key)
    }

    /// Appends a record: its key, then its fields.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn add(&self, key: &str, fields: impl IntoIterator<Item = String>) -> Result<(), RecordsError> {
        let Some((path, file)) = &self.file else { return Ok(()) };
        let wrap = |problem| RecordsError {
            path: path.clone(),
            problem,
        };
        let mut line = csv::Writer::from_writer(Vec::new());
        line.write_record(std::iter::once(key.to_owned()).chain(fields))
            .map_err(|error| wrap(error.into()))?;
        let line = line.into_inner().map_err(|error| wrap(error.into_error()))?;
        // One write a line: whole lines only, whatever the thread.
        let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
        file.write_all(&line).map_err(wrap)
    }
}

/// The records of a text of whole lines; of several with one key the last.
fn known(whole: &str) -> BTreeMap<String, StringRecord> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .from_reader(whole.as_bytes());
    let mut known = BTreeMap::new();
    for record in reader.records().flatten() {
        if let Some(key) = record.get(0) {
            known.insert(key.to_owned(), record);
        }
    }
    known
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A process that is killed twice, the second time before it has run anything, leaves a line cut within its last number.
    #[test]
    fn a_line_cut_short_is_never_taken_for_a_whole_one() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("runs.csv");
        std::fs::write(&path, "a,0.125\nb,0.12").expect("written");
        for _ in 0..2 {
            let records = Records::open(&path).expect("readable");
            assert_eq!((records.len(), records.get("b")), (1, None));
        }
        let records = Records::open(&path).expect("readable");
        records.add("b", ["0.1234".to_owned()]).expect("written");
        let text = std::fs::read_to_string(&path).expect("a file");
        assert_eq!(text, "a,0.125\nb,0.1234\n");
        assert_eq!(Records::of_text(&text).len(), 2);
    }
}
