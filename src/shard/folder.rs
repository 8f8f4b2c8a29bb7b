//! A folder of shards. Many processes write into it at once, each its own files, so that it has no list of its files: their names say
//! what they are. A folder with anything else in it is refused.

use std::fs::{File, OpenOptions, TryLockError};
use std::path::{Path, PathBuf};

use super::file::ShardFile;
use super::identity::Identity;
use super::part::Part;
use crate::failure::Failure;

/// End of the name of a shard that is finished.
const FINISHED: &str = ".records";
/// End of the name of the ledger of a shard that is being run.
const BEGUN: &str = ".begun";
/// Beginning of the names of both.
const SHARD: &str = "shard-";
/// Beginning of the names of files that are being written.
const PARTIAL: &str = ".oleo-partial-";
/// What `oleo submit` puts beside the shards.
const SUBMITTED: [&str; 4] = ["shards.sbatch", "merge.sbatch", "job", "log"];

/// The folder.
pub struct ShardFolder(PathBuf);

/// A part that this process runs. Another one that wants it is refused while this lives.
pub struct Begun {
    /// The ledger of its finished runs.
    pub ledger: PathBuf,
    _lock: File,
}

impl ShardFolder {
    /// Makes the folder, or takes one that holds nothing but shards.
    pub fn create(path: PathBuf) -> Result<Self, Failure> {
        let wrong = |what: String| Failure::new(format!("{}: {what}", path.display()));
        std::fs::create_dir_all(&path)
            .map_err(|error| wrong(format!("cannot be made a folder: {error}; name another with --out")))?;
        let foreign = |name: &String| {
            let own = name.starts_with(PARTIAL)
                || SUBMITTED.contains(&name.as_str())
                || name.starts_with(SHARD) && (name.ends_with(FINISHED) || name.ends_with(BEGUN));
            !own
        };
        match names(&path)?.into_iter().find(foreign) {
            Some(found) => Err(wrong(format!(
                "has files that are no shards, such as {found}; name another folder with --out"
            ))),
            None => Ok(Self(path)),
        }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// Where a part is when it is finished.
    pub fn finished(&self, part: Part) -> PathBuf {
        self.0.join(format!("{}{FINISHED}", stem(part)))
    }

    /// Takes a part, so that no other process runs it at the same time. What an interrupted one has finished is in the ledger, whose
    /// name is that of the study: no other study goes on in it.
    pub fn begin(&self, part: Part, identity: &Identity) -> Result<Begun, Failure> {
        let ledger = self.0.join(format!("{}.{}{BEGUN}", stem(part), identity.token()));
        let wrong = |what: String| Failure::new(format!("{}: {what}", ledger.display()));
        let lock = (OpenOptions::new().append(true).create(true).open(&ledger))
            .map_err(|error| wrong(format!("cannot be written: {error}; name another folder with --out")))?;
        match lock.try_lock() {
            Err(TryLockError::WouldBlock) => Err(Failure::new(format!(
                "shard {part} in {}: another process is running it; wait for that one, or end it",
                self.0.display()
            ))),
            // Some network file systems have no locks; then whoever starts a part twice runs it twice.
            Err(TryLockError::Error(_)) | Ok(()) => Ok(Begun { ledger, _lock: lock }),
        }
    }

    /// The parts of a study that are not finished in a folder, which need not be there. Shards of another study are refused.
    pub fn missing(path: &Path, of: u32, identity: &Identity) -> Result<Vec<Part>, Failure> {
        let folder = Self(path.to_owned());
        let mut missing = Vec::new();
        for part in Part::all(of) {
            let path = folder.finished(part);
            // What cannot be read is run again.
            let Some(there) = ShardFile::read(&path).ok() else {
                missing.push(part);
                continue;
            };
            if let Some(difference) = identity.difference(&there.header.identity) {
                return Err(Failure::new(format!(
                    "{}: {difference}; name another folder with --folder",
                    path.display()
                )));
            }
        }
        Ok(missing)
    }

    /// The finished shards in a folder, by name.
    pub fn shards(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
        let is_shard = |name: &String| name.starts_with(SHARD) && name.ends_with(FINISHED);
        let names = names(folder)?.into_iter().filter(is_shard);
        Ok(names.map(|name| folder.join(name)).collect())
    }
}

/// `shard-03-of-12`: names in order of their numbers.
fn stem(part: Part) -> String {
    let width = part.of.to_string().len();
    format!("{SHARD}{:0width$}-of-{}", part.number, part.of)
}

/// The names of all entries, sorted.
fn names(folder: &Path) -> Result<Vec<String>, Failure> {
    let wrong = |error: std::io::Error| {
        Failure::new(format!(
            "{}: cannot be read as a folder: {error}; give a folder of shards",
            folder.display()
        ))
    };
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(wrong)? {
        names.push(entry.map_err(wrong)?.file_name().to_string_lossy().into_owned());
    }
    names.sort();
    Ok(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_with_other_files_is_refused_and_a_part_is_run_once_at_a_time() {
        let place = tempfile::tempdir().expect("a folder");
        let path = place.path().join("a/shards");
        let folder = ShardFolder::create(path.clone()).expect("made");
        let part = Part { number: 3, of: 12 };
        assert_eq!(folder.finished(part), path.join("shard-03-of-12.records"));
        let identity = Identity {
            command: String::new(),
            arguments: vec![],
            version: String::new(),
            inputs: vec![],
        };
        let begun = folder.begin(part, &identity).expect("free");
        let error = folder.begin(part, &identity).err().expect("taken").to_string();
        assert!(error.starts_with("shard 3/12 in "), "{error}");
        folder.begin(Part { number: 4, of: 12 }, &identity).expect("free");
        drop(begun);
        folder.begin(part, &identity).expect("free again");
        std::fs::write(folder.finished(part), "").expect("written");
        assert_eq!(ShardFolder::shards(&path).expect("a folder"), [folder.finished(part)]);
        ShardFolder::create(path.clone()).expect("only shards");
        std::fs::write(path.join("notes.txt"), "").expect("written");
        let error = ShardFolder::create(path.clone()).err().expect("refused").to_string();
        assert!(error.contains("such as notes.txt"), "{error}");
        assert!(ShardFolder::create(path.join("notes.txt")).is_err());
        assert!(ShardFolder::shards(&path.join("absent")).is_err());
    }
}
