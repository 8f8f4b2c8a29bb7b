//! One file of results, whole or absent, in a folder that may hold anything.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write as _};
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use super::csv_text::{self, Numbers};
use super::marker::Marker;
use super::{OutputError, PARTIAL, folder_above, move_into_place, open_to_others};
use crate::interrupt;

/// What makes a folder of recordings a campaign; recordings there are not replaced.
const CAMPAIGN: &str = "model.toml";

/// A file being written beside its place.
#[derive(Debug)]
pub struct OutputFile {
    target: PathBuf,
    staging: TempDir,
}

impl OutputFile {
    /// Checks at once that `target` can be written. It may not be an input; a file in a folder of recordings is replaced with
    /// `force` only.
    ///
    /// # Errors
    /// `target` a folder or an input, no permission.
    pub fn stage(target: &Path, inputs: &[PathBuf], force: bool) -> Result<Self, OutputError> {
        interrupt::install();
        let path = target.to_path_buf();
        if target.is_dir() || target.file_name().is_none() {
            return Err(OutputError::AFolder { path });
        }
        let same = |input: &PathBuf| {
            let known = (fs::canonicalize(input), fs::canonicalize(target));
            matches!(known, (Ok(a), Ok(b)) if a == b)
        };
        if inputs.iter().any(same) {
            return Err(OutputError::Input { path });
        }
        let folder = folder_above(target)?;
        let recordings = folder.join(CAMPAIGN).exists() && Marker::read(&folder).is_none();
        if recordings && target.exists() && !force {
            return Err(OutputError::NotOurs { path });
        }
        let mut folders = interrupt::staged();
        let staging = (tempfile::Builder::new().prefix(PARTIAL))
            .tempdir_in(&folder)
            .map_err(|source| OutputError::Io {
                action: "write here",
                path: folder.clone(),
                source,
            })?;
        folders.push(staging.path().to_path_buf());
        Ok(Self { target: path, staging })
    }

    /// A path for another file that is needed until this one is written, on the same file system. It is removed in any case.
    #[must_use]
    pub fn scratch(&self, name: &str) -> PathBuf {
        self.staging.path().join(format!("scratch-{name}"))
    }

    /// Writes columns of numbers and moves the file into place.
    ///
    /// # Errors
    /// Columns of different lengths; the file cannot be written.
    pub fn csv(self, columns: &[Numbers]) -> Result<PathBuf, OutputError> {
        let rows = csv_text::check(&self.target.display().to_string(), columns, &[])?;
        self.put(|staged| csv_text::write(&mut BufWriter::new(File::create(staged)?), rows, columns, &[]))
    }

    /// Writes bytes and moves the file into place.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn bytes(self, bytes: &[u8]) -> Result<PathBuf, OutputError> {
        self.put(|staged| fs::write(staged, bytes))
    }

    /// Lets `write` write the file piece by piece, and moves it into place unless `write` says why there is nothing to keep.
    ///
    /// # Errors
    /// The file cannot be written; inside, what `write` says.
    pub fn stream<E>(
        self,
        write: impl FnOnce(&mut BufWriter<File>) -> io::Result<Result<(), E>>,
    ) -> Result<Result<PathBuf, E>, OutputError> {
        let mut refused = None;
        let written = self.put(|staged| {
            let mut file = BufWriter::new(File::create(staged)?);
            if let Err(error) = write(&mut file)? {
                refused = Some(error);
                return Err(io::ErrorKind::Interrupted.into());
            }
            file.flush()
        });
        match refused {
            Some(error) => Ok(Err(error)),
            None => written.map(Ok),
        }
    }

    fn put(self, write: impl FnOnce(&Path) -> io::Result<()>) -> Result<PathBuf, OutputError> {
        let refused = |source| OutputError::Io {
            action: "write",
            path: self.target.clone(),
            source,
        };
        let staged = self.staging.path().join("file");
        write(&staged).map_err(refused)?;
        open_to_others(&staged).map_err(refused)?;
        // Held to the end: a signal waits for the file.
        let mut folders = interrupt::staged();
        move_into_place(&staged, &self.target).map_err(refused)?;
        interrupt::forget(&mut folders, self.staging.path());
        Ok(self.target)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write(target: &Path, inputs: &[PathBuf], force: bool) -> Result<PathBuf, OutputError> {
        OutputFile::stage(target, inputs, force)?.csv(&[("time_s", &[0.0, 0.1])])
    }

    #[test]
    fn a_file_is_replaced_unless_it_is_an_input_or_a_recording() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name);
        let inputs = [path("a.csv")];
        for name in ["a.csv", "b.csv"] {
            fs::write(path(name), "mine").expect("written");
        }
        let error = write(&path("./a.csv"), &inputs, true).expect_err("an input");
        assert!(matches!(error, OutputError::Input { .. }), "{error}");
        write(&path("b.csv"), &inputs, false).expect("replaced");
        assert_eq!(fs::read_to_string(path("b.csv")).expect("a file"), "time_s\n0\n0.1\n");
        fs::write(path("model.toml"), "").expect("written");
        let error = write(&path("b.csv"), &inputs, false).expect_err("a recording");
        assert!(matches!(error, OutputError::NotOurs { .. }), "{error}");
        write(&path("b.csv"), &inputs, true).expect("forced");
        write(&path("new.csv"), &inputs, false).expect("nothing is replaced");
        assert!(matches!(
            write(folder.path(), &inputs, true),
            Err(OutputError::AFolder { .. })
        ));
        assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 4);
        let stream = |name: &str, answer: Result<(), &str>| {
            let file = OutputFile::stage(&path(name), &inputs, false).expect("staged");
            file.stream(|out| out.write_all(b"half").map(|()| answer.map_err(str::to_owned)))
                .expect("the disk is not full")
        };
        assert_eq!(stream("half.log", Err("no")), Err("no".to_owned()));
        assert!(!path("half.log").exists());
        assert_eq!(stream("new/half.log", Err("no")), Err("no".to_owned()));
        assert!(!path("new").exists());
        assert_eq!(stream("new/whole.log", Ok(())), Ok(path("new/whole.log")));
        assert_eq!(stream("whole.log", Ok(())), Ok(path("whole.log")));
    }
}
