//! A folder of results is whole or absent. Files are staged in a hidden folder on the same file system and renamed
//! into place at [`OutputDirectory::commit`]; an error, a panic or Ctrl-C before that leaves the destination as it was.
//!
//! A destination that does not exist is staged beside itself, or in the nearest folder above it that exists, and appears with one
//! rename; the folders between are made just before. One that exists is staged inside
//! itself (its parent may be another file system, or read-only) and its files are replaced one by one, each by one rename.
//!
//! The file `.oleo` in the folder lists what was written. The next command replaces and removes just these files, so that no
//! result of another run stays beside a new report. It refuses a folder with other files or with results of another command, a
//! result that was edited since, and its own inputs. All but the last are the user's to decide (`--force`).

mod csv_text;
pub mod digest;
mod error;
mod file;
mod marker;
mod origin;

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;
use tempfile::TempDir;

use crate::{Page, interrupt};
pub use csv_text::{CsvRows, rounded};
use csv_text::{Numbers, Words};
use digest::of_file as digest;
pub use error::OutputError;
pub use file::OutputFile;
use marker::{Marker, is_inside};
pub use origin::Origin;
use origin::{Input, Stamped};

/// What hidden folders of staged files begin with.
const PARTIAL: &str = ".oleo-partial-";

/// Results being written; see the module. Dropped without [`commit`](Self::commit) nothing remains.
#[derive(Debug)]
pub struct OutputDirectory {
    destination: PathBuf,
    existed: bool,
    /// Whether files that this program did not write, or that were edited since, may be replaced.
    force: bool,
    staging: Option<TempDir>,
    names: Vec<String>,
    /// What was in the folder before.
    before: Marker,
    origin: Origin,
    /// The inputs as they were before the work.
    inputs: Vec<Input>,
    /// Inputs as the system knows them.
    input_paths: Vec<PathBuf>,
    /// The text of the last summary.
    summary: String,
}

impl OutputDirectory {
    /// Checks at once that `destination` can be written, so that a long run does not end in a refusal. With `force` it may hold
    /// files that this program did not write.
    ///
    /// # Errors
    /// Destination not a folder, or with files that may not be replaced; no permission.
    pub fn stage(destination: impl AsRef<Path>, origin: Origin, force: bool) -> Result<Self, OutputError> {
        interrupt::install();
        let destination = destination.as_ref().to_path_buf();
        let refused = |action, source| OutputError::Io {
            action,
            path: destination.clone(),
            source,
        };
        let existed = match fs::metadata(&destination) {
            Ok(found) if !found.is_dir() => return Err(OutputError::NotAFolder { path: destination }),
            Ok(_) => true,
            // A link to nothing is in the way of the folder.
            Err(error) if is_absent(&error) && !destination.is_symlink() => false,
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                return Err(OutputError::NotAFolder { path: destination });
            }
            Err(source) => return Err(refused("write here", source)),
        };
        let whole = if existed {
            fs::canonicalize(&destination).map_err(|source| refused("write here", source))?
        } else {
            destination.clone()
        };
        if existed && whole.parent().is_none() {
            return Err(OutputError::Root { path: destination });
        }
        let stage_in = if existed { whole } else { folder_above(&destination)? };
        let input_paths: Vec<PathBuf> = (origin.inputs.iter())
            .filter_map(|input| fs::canonicalize(input).ok())
            .collect();
        let before = match existed {
            true => owned(&destination, &origin.command, force, &input_paths)?,
            false => Marker::default(),
        };
        let mut folders = interrupt::staged();
        let staging = (tempfile::Builder::new().prefix(PARTIAL))
            .tempdir_in(&stage_in)
            .map_err(|source| refused("write here", source))?;
        folders.push(staging.path().to_path_buf());
        drop(folders);
        Ok(Self {
            inputs: origin.inputs.iter().filter_map(|input| Input::of(input)).collect(),
            destination,
            existed,
            force,
            staging: Some(staging),
            names: Vec::new(),
            before,
            origin,
            input_paths,
            summary: String::new(),
        })
    }

    /// As [`Self::stage`], with a file of finished runs that commands extend and an interruption leaves. Returns its path too.
    /// The folder exists from now on.
    pub fn stage_with_ledger(
        destination: impl AsRef<Path>,
        origin: Origin,
        force: bool,
        ledger: &str,
    ) -> Result<(Self, PathBuf), OutputError> {
        let destination = destination.as_ref();
        // Staged once to be told of a folder that cannot be, and again when it is there.
        drop(Self::stage(destination, origin.clone(), force)?);
        fs::create_dir_all(destination).map_err(|source| OutputError::Io {
            action: "make this folder",
            path: destination.to_path_buf(),
            source,
        })?;
        let mut out = Self::stage(destination, origin, force)?;
        out.refuse(ledger)?;
        out.before.ledgers.insert(ledger.to_owned());
        let (command, version) = (out.origin.command.clone(), out.origin.version.clone());
        (out.before.command, out.before.version) = (command, version);
        out.mark(&out.before)?;
        Ok((out, destination.join(ledger)))
    }

    /// Says whether `name` may not be written: it is an input, or a file that this program did not write.
    ///
    /// # Errors
    /// [`OutputError::Input`] and [`OutputError::NotOurs`].
    pub fn refuse(&self, name: &str) -> Result<(), OutputError> {
        let path = self.destination.join(name);
        if (fs::canonicalize(&path)).is_ok_and(|target| self.input_paths.contains(&target)) {
            return Err(OutputError::Input { path });
        }
        let ours = self.before.files.contains_key(name) || self.before.ledgers.contains(name);
        if self.existed && !self.force && !ours && path.symlink_metadata().is_ok() {
            return Err(OutputError::NotOurs { path });
        }
        Ok(())
    }

    /// The output folder as the user gave it.
    pub fn destination(&self) -> &Path {
        &self.destination
    }

    /// Opens `name` (which may have folders: `runs/01.csv`) for writing, for logs written while a run goes on. A name used
    /// before starts anew.
    pub fn create(&mut self, name: &str) -> Result<BufWriter<File>, OutputError> {
        let path = self.path(name)?;
        File::create(&path)
            .map(BufWriter::new)
            .map_err(|source| self.refused("write", name, source))
    }

    /// Where `name` is staged, with its folder made, for libraries that want a path.
    pub fn path(&mut self, name: &str) -> Result<PathBuf, OutputError> {
        let inside = is_inside(Path::new(name)) && name != marker::NAME;
        let Some(staging) = self.staging.as_ref().filter(|_| inside) else {
            return Err(OutputError::Name { name: name.to_owned() });
        };
        self.refuse(name)?;
        let path = staging.path().join(name);
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(|source| self.refused("make the folder of", name, source))?;
        }
        if !self.names.iter().any(|other| other == name) {
            self.names.push(name.to_owned());
        }
        Ok(path)
    }

    /// Writes a whole file.
    pub fn write(&mut self, name: &str, content: impl AsRef<[u8]>) -> Result<(), OutputError> {
        let path = self.path(name)?;
        fs::write(path, content).map_err(|source| self.refused("write", name, source))
    }

    /// Writes columns of numbers with nine significant digits; `columns` are (name with unit, values) of one length.
    pub fn csv(&mut self, name: &str, columns: &[Numbers]) -> Result<(), OutputError> {
        self.csv_with_words(name, columns, &[])
    }

    /// As [`Self::csv`], with columns of words behind those of numbers.
    pub fn csv_with_words(&mut self, name: &str, columns: &[Numbers], words: &[Words]) -> Result<(), OutputError> {
        let rows = csv_text::check(name, columns, words)?;
        let mut file = self.create(name)?;
        csv_text::write(&mut file, rows, columns, words).map_err(|source| self.refused("write", name, source))
    }

    /// Lets `work` write files into the folder that it is given. All of them are results.
    ///
    /// # Errors
    /// Those of `work`, and of names that may not be written.
    pub fn fill<E: From<OutputError>>(&mut self, work: impl FnOnce(&Path) -> Result<(), E>) -> Result<(), E> {
        let Some(staging) = self.staging.as_ref().map(|staging| staging.path().to_path_buf()) else {
            return Ok(());
        };
        work(&staging)?;
        let listed = |source| self.refused("read", "", source);
        let mut names = Vec::new();
        files_below(&staging, "", &mut names).map_err(listed)?;
        names.sort();
        for name in names {
            self.path(&name)?;
        }
        Ok(())
    }

    /// Writes one line per record, with the field names of `T` as header.
    pub fn csv_records<T: Serialize>(
        &mut self,
        name: &str,
        records: impl IntoIterator<Item = T>,
    ) -> Result<(), OutputError> {
        let mut writer = csv::Writer::from_writer(self.create(name)?);
        for record in records {
            writer.serialize(record).map_err(|error| OutputError::Format {
                name: name.to_owned(),
                reason: error.to_string(),
            })?;
        }
        writer.flush().map_err(|source| self.refused("write", name, source))
    }

    /// Writes indented JSON with a final line end.
    pub fn json(&mut self, name: &str, value: &impl Serialize) -> Result<(), OutputError> {
        self.write(name, indented(name, value)?)
    }

    /// Writes a summary as JSON, behind what every summary says of itself: `schema`, `command`, `version`, `inputs` with
    /// SHA-256, and the `seed` of everything random.
    pub fn summary(&mut self, name: &str, seed: Option<u64>, content: &impl Serialize) -> Result<(), OutputError> {
        self.summary = indented(name, &Stamped::new(&self.origin, &self.inputs, seed, content))?;
        let text = self.summary.clone();
        self.write(name, text)
    }

    /// The text of the last summary that was written.
    pub fn summary_text(&self) -> &str {
        &self.summary
    }

    /// Writes the page as `report.html`.
    pub fn page(&mut self, page: &Page) -> Result<(), OutputError> {
        self.write("report.html", page.render())
    }

    /// Moves everything into place, removes what an earlier run wrote and this one did not, and returns the destination.
    ///
    /// # Errors
    /// The system refused a rename; what was not moved is removed.
    pub fn commit(mut self) -> Result<PathBuf, OutputError> {
        // Held to the end: a signal waits for a commit.
        let mut folders = interrupt::staged();
        let Some(staging) = self.staging.take() else {
            return Ok(self.destination.clone());
        };
        let written = |name: &String| (name.clone(), digest(&staging.path().join(name)));
        let after = Marker {
            command: self.origin.command.clone(),
            version: self.origin.version.clone(),
            files: self.names.iter().map(written).collect(),
            ledgers: self.before.ledgers.clone(),
        };
        if self.existed {
            self.replace(staging.path(), &after)?;
        } else {
            let refused = |source| self.refused("write", "", source);
            fs::write(staging.path().join(marker::NAME), after.text()).map_err(refused)?;
            open_to_others(staging.path()).map_err(refused)?;
            move_into_place(staging.path(), &self.destination).map_err(refused)?;
        }
        interrupt::forget(&mut folders, staging.path());
        Ok(self.destination.clone())
    }

    /// Moves the files into a folder that exists. A process that is killed meanwhile leaves a marker that lists old and new
    /// files, so that the next run may replace both.
    fn replace(&self, staging: &Path, after: &Marker) -> Result<(), OutputError> {
        let stale = self.before.files.keys().filter(|name| !self.names.contains(name));
        let both: BTreeMap<_, _> = (self.before.files.keys())
            .chain(&self.names)
            .map(|name| (name.clone(), None))
            .collect();
        self.mark(&Marker {
            files: both,
            ..after.clone()
        })?;
        for name in stale {
            let path = self.destination.join(name);
            match fs::remove_file(&path) {
                Err(source) if source.kind() != io::ErrorKind::NotFound => {
                    return Err(self.refused("remove the earlier result", name, source));
                }
                _ => {}
            }
            // Folders that are empty now; others stay.
            let folders = Path::new(name)
                .ancestors()
                .skip(1)
                .filter(|folder| !folder.as_os_str().is_empty());
            for folder in folders {
                let _ = fs::remove_dir(self.destination.join(folder));
            }
        }
        for name in &self.names {
            let target = self.destination.join(name);
            move_into_place(&staging.join(name), &target).map_err(|source| self.refused("write", name, source))?;
        }
        self.mark(after)
    }

    /// Writes the marker into the folder, whole or not at all.
    fn mark(&self, marker: &Marker) -> Result<(), OutputError> {
        let refused = |source| self.refused("write", marker::NAME, source);
        let mut file = (tempfile::Builder::new().prefix(PARTIAL))
            .tempfile_in(&self.destination)
            .map_err(refused)?;
        file.write_all(marker.text().as_bytes()).map_err(refused)?;
        open_to_others(file.path()).map_err(refused)?;
        file.persist(self.destination.join(marker::NAME))
            .map(drop)
            .map_err(|error| refused(error.error))
    }

    fn refused(&self, action: &'static str, name: &str, source: io::Error) -> OutputError {
        let path = match name {
            "" => self.destination.clone(),
            name => self.destination.join(name),
        };
        OutputError::Io { action, path, source }
    }
}

/// The names of all files below `folder`, each behind `prefix`.
fn files_below(folder: &Path, prefix: &str, names: &mut Vec<String>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
        if entry.file_type()?.is_dir() {
            files_below(&entry.path(), &format!("{name}/"), names)?;
        } else {
            names.push(name);
        }
    }
    Ok(())
}

/// What the marker of an existing folder says, if its files may be replaced.
fn owned(destination: &Path, command: &str, force: bool, inputs: &[PathBuf]) -> Result<Marker, OutputError> {
    let marker = Marker::read(destination);
    if marker.is_none() && !force {
        let mut found: Vec<String> = fs::read_dir(destination)
            .map_err(|source| OutputError::Io {
                action: "read this folder",
                path: destination.to_path_buf(),
                source,
            })?
            .flatten()
            .map(|entry| entry.file_name().to_string_lossy().into_owned())
            .filter(|name| !name.starts_with(PARTIAL))
            .collect();
        found.sort();
        if let Some(found) = found.into_iter().next() {
            return Err(OutputError::Foreign {
                path: destination.to_path_buf(),
                found,
            });
        }
    }
    let marker = marker.unwrap_or_default();
    if !force && !marker.files.is_empty() && marker.command != command {
        return Err(OutputError::OtherCommand {
            path: destination.to_path_buf(),
            command: marker.command,
        });
    }
    for name in marker.files.keys() {
        let path = destination.join(name);
        if fs::canonicalize(&path).is_ok_and(|target| inputs.contains(&target)) {
            return Err(OutputError::Input { path });
        }
        if !force && marker.was_changed(destination, name) {
            return Err(OutputError::Changed { path });
        }
    }
    Ok(marker)
}

impl Drop for OutputDirectory {
    fn drop(&mut self) {
        if let Some(staging) = self.staging.take() {
            let mut folders = interrupt::staged();
            interrupt::forget(&mut folders, staging.path());
        }
    }
}

/// Indented JSON with a final line end, for the file `name`.
fn indented(name: &str, value: &impl Serialize) -> Result<String, OutputError> {
    let text = serde_json::to_string_pretty(value).map_err(|error| OutputError::Format {
        name: name.to_owned(),
        reason: error.to_string(),
    })?;
    Ok(text + "\n")
}

/// The nearest folder above `path` that exists.
fn folder_above(path: &Path) -> Result<PathBuf, OutputError> {
    let mut not_a_folder = path.to_path_buf();
    for folder in path.ancestors().skip(1) {
        let folder = if folder.as_os_str().is_empty() {
            Path::new(".")
        } else {
            folder
        };
        match fs::metadata(folder) {
            Ok(found) if found.is_dir() => return Ok(folder.to_path_buf()),
            // A link to nothing is in the way, as a file is.
            Err(error) if is_absent(&error) && !folder.is_symlink() => {}
            Err(source) if !is_absent(&source) => {
                return Err(OutputError::Io {
                    action: "look into",
                    path: folder.to_path_buf(),
                    source,
                });
            }
            _ => {
                not_a_folder = folder.to_path_buf();
                break;
            }
        }
    }
    Err(OutputError::NotAFolder { path: not_a_folder })
}

/// Whether a path is not there: neither itself nor perhaps the folders above it.
fn is_absent(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory)
}

/// Moves what was staged to where it shall be, whose folder is made if it is missing.
fn move_into_place(staged: &Path, target: &Path) -> io::Result<()> {
    if let Some(folder) = target.parent() {
        fs::create_dir_all(folder)?;
    }
    fs::rename(staged, target)
}

/// A temporary file or folder is private to its owner; results have the permissions that they would have had otherwise.
#[cfg(unix)]
fn open_to_others(staged: &Path) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    // The umask cannot be read without setting it; a folder just made shows it.
    let place = match staged.parent() {
        Some(parent) if !staged.is_dir() => parent,
        _ => staged,
    };
    let probe = (tempfile::Builder::new().prefix(PARTIAL))
        .permissions(fs::Permissions::from_mode(0o777))
        .tempdir_in(place)?;
    let mode = fs::metadata(probe.path())?.permissions().mode();
    let mode = if staged.is_dir() { mode & 0o777 } else { mode & 0o666 };
    fs::set_permissions(staged, fs::Permissions::from_mode(mode))
}

#[cfg(not(unix))]
fn open_to_others(_staged: &Path) -> io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests;
