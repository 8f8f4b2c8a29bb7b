//! The file `.oleo` in a folder of results. It says which command wrote which files, so that the next command knows what
//! it may replace and remove: files of the list that are still as they were written, and nothing else.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Component, Path};

use serde::{Deserialize, Serialize};

use super::digest::of_file as digest;

/// Name of the file.
pub(super) const NAME: &str = ".oleo";

/// Contents of the file, as JSON.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub(super) struct Marker {
    /// The command that wrote the files, such as `oleo hil`.
    pub command: String,
    /// Version of the program that wrote them.
    pub version: String,
    /// Each file with its SHA-256 in hexadecimal, or `null` while a command is replacing it.
    pub files: BTreeMap<String, Option<String>>,
    /// Files of finished runs, which commands extend and from which an interrupted study resumes.
    #[serde(default)]
    pub ledgers: BTreeSet<String>,
}

impl Marker {
    /// The marker of a folder; `None` where there is none, or none that can be read.
    pub fn read(folder: &Path) -> Option<Self> {
        let text = fs::read_to_string(folder.join(NAME)).ok()?;
        let mut marker: Self = serde_json::from_str(&text).ok()?;
        // A name that would leave the folder was not written by this program.
        marker.files.retain(|name, _| is_inside(Path::new(name)));
        Some(marker)
    }

    /// The text of the file.
    pub fn text(&self) -> String {
        let mut text = serde_json::to_string_pretty(self).unwrap_or_default();
        text.push('\n');
        text
    }

    /// Whether a file of the list is no longer what was written. A file that was removed is no loss.
    pub fn was_changed(&self, folder: &Path, name: &str) -> bool {
        match (self.files.get(name), digest(&folder.join(name))) {
            (Some(Some(written)), Some(found)) => *written != found,
            _ => false,
        }
    }
}

/// Whether a relative path stays inside the folder to which it is relative.
pub(super) fn is_inside(name: &Path) -> bool {
    !name.as_os_str().is_empty() && name.components().all(|part| matches!(part, Component::Normal(_)))
}
