//! What is kept of the diagnosis of one campaign or log: one line of JSON of a ledger.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use serde::{Deserialize, Serialize};

use crate::failure::Failure;

/// The outcome of one campaign.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// Name of the folder or the log.
    pub name: String,
    /// SHA-256 of its files together.
    pub sha256: String,
    /// The answer in one word; `None` where there is no diagnosis.
    pub verdict: Option<String>,
    /// Held-out noise ratio of the recalibrated and of the improved model, of a vehicle the worst of its struts.
    pub noise_ratio: Option<[f64; 2]>,
    /// What was found.
    pub effects: Vec<Found>,
    /// Why there is no diagnosis, where there is none.
    pub failed: Option<String>,
}

/// An effect that was found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Found {
    /// Its id.
    pub id: String,
    /// Its place.
    pub place: String,
    /// Reported confidence.
    pub confidence: f64,
}

/// Entries by name, and the file they are appended to.
pub struct Entries {
    known: BTreeMap<String, Entry>,
    file: Option<(PathBuf, Mutex<File>)>,
    /// Whether an entry counts only while the files are as they were. From shards, which say which files they are of, it counts.
    pub compares_files: bool,
}

impl Entries {
    /// Entries that are forgotten with the program.
    pub fn in_memory() -> Self {
        Self::of_text("")
    }

    /// Entries from the text of a ledger.
    pub fn of_text(text: &str) -> Self {
        let entries = text.lines().filter_map(|line| serde_json::from_str::<Entry>(line).ok());
        Self {
            known: entries.map(|entry| (entry.name.clone(), entry)).collect(),
            file: None,
            compares_files: false,
        }
    }

    /// Opens or creates a ledger. A line that an interruption cut short is no JSON, and its campaign is diagnosed again.
    pub fn open(path: &Path) -> Result<Self, Failure> {
        let wrong = |error: std::io::Error| {
            Failure::new(format!(
                "{}: {error}; give another --out folder, or empty this one",
                path.display()
            ))
        };
        let mut file = OpenOptions::new().append(true).create(true).open(path).map_err(wrong)?;
        let text = std::fs::read_to_string(path).map_err(wrong)?;
        if !text.is_empty() && !text.ends_with('\n') {
            file.write_all(b"\n").map_err(wrong)?;
        }
        Ok(Self {
            file: Some((path.to_owned(), Mutex::new(file))),
            compares_files: true,
            ..Self::of_text(&text)
        })
    }

    /// The entry of a name, whose files have this digest where they are compared.
    pub fn get(&self, name: &str, sha256: Option<&str>) -> Option<&Entry> {
        let entry = self.known.get(name)?;
        sha256.is_none_or(|now| now == entry.sha256).then_some(entry)
    }

    /// Keeps an entry: one write a line, whole lines only, whatever the thread.
    pub fn keep(&self, entry: &Entry) -> Result<(), Failure> {
        let Some((path, file)) = &self.file else { return Ok(()) };
        let line = serde_json::to_string(entry)? + "\n";
        let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
        file.write_all(line.as_bytes())
            .map_err(|error| Failure::new(format!("{}: {error}", path.display())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_entry_counts_while_its_files_are_as_they_were() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("diagnoses.jsonl");
        let entry = Entry {
            name: "a".into(),
            sha256: "1".into(),
            verdict: Some("consistent".into()),
            noise_ratio: Some([1.0 / 3.0, 1.0]),
            effects: vec![Found {
                id: "oil_leak".into(),
                place: "main_seal".into(),
                confidence: 0.1 + 0.2,
            }],
            failed: None,
        };
        Entries::open(&path).expect("a file").keep(&entry).expect("kept");
        let mut text = std::fs::read_to_string(&path).expect("a file");
        text += &text.clone().replace("\"a\"", "\"b\"")[..20];
        std::fs::write(&path, &text).expect("written");
        let again = Entries::open(&path).expect("a file");
        assert!(again.compares_files);
        assert_eq!(again.get("a", Some("1")), Some(&entry));
        assert_eq!((again.get("a", Some("2")), again.get("b", None)), (None, None));
        again.keep(&entry).expect("kept");
        assert_eq!(
            Entries::of_text(&std::fs::read_to_string(&path).expect("a file")).get("a", None),
            Some(&entry)
        );
    }
}
