//! A folder of results is whole or absent. Files are staged in a hidden folder on the same file system and renamed
//! into place at [`OutputDirectory::commit`]; an error, a panic or Ctrl-C before that leaves the destination as it was.
//!
//! A destination that does not exist is staged beside itself and appears with one rename. One that exists is staged inside
//! itself (its parent may be another file system, or read-only) and its files are replaced one by one, each by one rename;
//! other files in it are left alone.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Component, Path, PathBuf};

use serde::Serialize;
use tempfile::TempDir;

use crate::{Page, interrupt};

/// Why results could not be written. Each message is one line: what, where, what to do.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// `--out` names something that is not a folder.
    #[error("{}: is not a folder; name another output folder", path.display())]
    NotAFolder {
        /// The path as the user gave it.
        path: PathBuf,
    },
    /// The folder that would hold the destination is missing.
    #[error("{}: the folder {} does not exist; create it first", path.display(), parent.display())]
    NoParent {
        /// The output folder as the user gave it.
        path: PathBuf,
        /// The parent folder that does not exist.
        parent: PathBuf,
    },
    /// The operating system refused an operation on a file.
    #[error("{}: cannot {action}: {source}; check permissions and free space", path.display())]
    Io {
        /// The operation that was attempted, such as "write".
        action: &'static str,
        /// The file of the operation.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
    /// A result would replace what it was made from.
    #[error("{}: is an input of this command, and the result would replace it; name another output", path.display())]
    Input {
        /// The input file that would be replaced.
        path: PathBuf,
    },
    /// A name that would leave the folder.
    #[error("{name}: not a name inside the output folder")]
    Name {
        /// The file name that was refused.
        name: String,
    },
    /// A value that has no CSV or JSON form.
    #[error("{name}: {reason}")]
    Format {
        /// The file that cannot be written.
        name: String,
        /// Why it cannot be written.
        reason: String,
    },
}

/// Results being written; see the module. Dropped without [`commit`](Self::commit) nothing remains.
#[derive(Debug)]
pub struct OutputDirectory {
    destination: PathBuf,
    existed: bool,
    staging: Option<TempDir>,
    names: Vec<PathBuf>,
    /// Files that the command reads, as the system knows them.
    inputs: Vec<PathBuf>,
}

impl OutputDirectory {
    /// Checks at once that `destination` can be written, so that a long run does not end in a refusal.
    ///
    /// # Errors
    /// Parent missing, destination not a folder, no permission.
    pub fn stage(destination: impl AsRef<Path>) -> Result<Self, OutputError> {
        interrupt::install();
        let destination = destination.as_ref().to_path_buf();
        let existed = match fs::metadata(&destination) {
            Ok(found) if !found.is_dir() => return Err(OutputError::NotAFolder { path: destination }),
            Ok(_) => true,
            Err(error) if error.kind() == io::ErrorKind::NotFound => false,
            Err(source) => {
                return Err(OutputError::Io {
                    action: "write here",
                    path: destination,
                    source,
                });
            }
        };
        let stage_in = if existed {
            destination.clone()
        } else {
            parent_of(&destination)?
        };
        let mut folders = interrupt::staged();
        let staging = tempfile::Builder::new()
            .prefix(".oleo-partial-")
            .tempdir_in(&stage_in)
            .map_err(|source| OutputError::Io {
                action: "write here",
                path: destination.clone(),
                source,
            })?;
        folders.push(staging.path().to_path_buf());
        Ok(Self {
            destination,
            existed,
            staging: Some(staging),
            names: Vec::new(),
            inputs: Vec::new(),
        })
    }

    /// Refuses from now on to write over a file that the command reads. Names of files that do not exist are no inputs.
    pub fn keep<P: AsRef<Path>>(&mut self, inputs: impl IntoIterator<Item = P>) {
        let known = inputs.into_iter().filter_map(|input| fs::canonicalize(input).ok());
        self.inputs.extend(known);
    }

    /// Says before the work whether `name` will be refused because it is an input.
    ///
    /// # Errors
    /// [`OutputError::Input`].
    pub fn refuse_input(&self, name: &str) -> Result<(), OutputError> {
        let path = self.destination.join(name);
        match fs::canonicalize(&path) {
            Ok(target) if self.inputs.contains(&target) => Err(OutputError::Input { path }),
            _ => Ok(()),
        }
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
        let relative = Path::new(name);
        let inside = relative.components().all(|part| matches!(part, Component::Normal(_)));
        let Some(staging) = self.staging.as_ref().filter(|_| inside && !name.is_empty()) else {
            return Err(OutputError::Name { name: name.to_owned() });
        };
        self.refuse_input(name)?;
        let path = staging.path().join(relative);
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(|source| self.refused("make the folder of", name, source))?;
        }
        if !self.names.iter().any(|other| other == relative) {
            self.names.push(relative.to_path_buf());
        }
        Ok(path)
    }

    /// Writes a whole file.
    pub fn write(&mut self, name: &str, content: impl AsRef<[u8]>) -> Result<(), OutputError> {
        let path = self.path(name)?;
        fs::write(path, content).map_err(|source| self.refused("write", name, source))
    }

    /// Writes columns of numbers; `columns` are (name with unit, values) of one length.
    pub fn csv(&mut self, name: &str, columns: &[(&str, &[f64])]) -> Result<(), OutputError> {
        let rows = columns.first().map_or(0, |column| column.1.len());
        if let Some(odd) = columns.iter().find(|column| column.1.len() != rows) {
            let reason = format!("column {} has {} rows where others have {rows}", odd.0, odd.1.len());
            return Err(OutputError::Format {
                name: name.to_owned(),
                reason,
            });
        }
        let mut file = self.create(name)?;
        let mut write = || -> io::Result<()> {
            let header: Vec<&str> = columns.iter().map(|column| column.0).collect();
            writeln!(file, "{}", header.join(","))?;
            for row in 0..rows {
                for (index, column) in columns.iter().enumerate() {
                    let comma = if index == 0 { "" } else { "," };
                    // `{}` is the shortest text that reads back as the same bits.
                    write!(file, "{comma}{}", column.1[row])?;
                }
                writeln!(file)?;
            }
            file.flush()
        };
        write().map_err(|source| self.refused("write", name, source))
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
        let mut text = serde_json::to_string_pretty(value).map_err(|error| OutputError::Format {
            name: name.to_owned(),
            reason: error.to_string(),
        })?;
        text.push('\n');
        self.write(name, text)
    }

    /// Writes the page as `report.html`.
    pub fn page(&mut self, page: &Page) -> Result<(), OutputError> {
        self.write("report.html", page.render())
    }

    /// Moves everything into place and returns the destination.
    ///
    /// # Errors
    /// The system refused a rename; what was not moved is removed.
    pub fn commit(mut self) -> Result<PathBuf, OutputError> {
        let mut folders = interrupt::staged();
        let Some(staging) = self.staging.take() else {
            return Ok(self.destination.clone());
        };
        let refused = |path: &Path, source| OutputError::Io {
            action: "write",
            path: path.to_path_buf(),
            source,
        };
        if self.existed {
            for name in &self.names {
                let target = self.destination.join(name);
                if let Some(folder) = target.parent() {
                    fs::create_dir_all(folder).map_err(|source| refused(folder, source))?;
                }
                fs::rename(staging.path().join(name), &target).map_err(|source| refused(&target, source))?;
            }
        } else {
            open_to_others(staging.path()).map_err(|source| refused(&self.destination, source))?;
            fs::rename(staging.path(), &self.destination).map_err(|source| refused(&self.destination, source))?;
        }
        interrupt::forget(&mut folders, staging.path());
        Ok(self.destination.clone())
    }

    fn refused(&self, action: &'static str, name: &str, source: io::Error) -> OutputError {
        OutputError::Io {
            action,
            path: self.destination.join(name),
            source,
        }
    }
}

impl Drop for OutputDirectory {
    fn drop(&mut self) {
        if let Some(staging) = self.staging.take() {
            let mut folders = interrupt::staged();
            interrupt::forget(&mut folders, staging.path());
        }
    }
}

/// The existing folder that holds `path`.
fn parent_of(path: &Path) -> Result<PathBuf, OutputError> {
    let parent = match path.parent() {
        Some(parent) if parent.as_os_str().is_empty() => PathBuf::from("."),
        Some(parent) => parent.to_path_buf(),
        None => {
            return Err(OutputError::NotAFolder {
                path: path.to_path_buf(),
            });
        }
    };
    match fs::metadata(&parent) {
        Ok(found) if found.is_dir() => Ok(parent),
        Ok(_) => Err(OutputError::NotAFolder { path: parent }),
        Err(_) => Err(OutputError::NoParent {
            path: path.to_path_buf(),
            parent,
        }),
    }
}

/// A temporary folder is private to its owner; a folder of results has the permissions `mkdir` would give.
#[cfg(unix)]
fn open_to_others(staging: &Path) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    // The umask cannot be read without setting it; a folder just made shows it.
    let probe = staging.join(".probe");
    fs::create_dir(&probe)?;
    let mode = fs::metadata(&probe)?.permissions().mode() & 0o777;
    fs::remove_dir(&probe)?;
    fs::set_permissions(staging, fs::Permissions::from_mode(mode))
}

#[cfg(not(unix))]
fn open_to_others(_staging: &Path) -> io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entries(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .expect("a folder")
            .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn nothing_is_seen_before_commit_and_all_of_it_after() {
        let parent = tempfile::tempdir().expect("a folder");
        let destination = parent.path().join("out");
        let mut out = OutputDirectory::stage(&destination).expect("writable");
        out.csv("a.csv", &[("time_s", &[0.0, 0.1]), ("force_N", &[1.0, -2.5e-7])])
            .expect("written");
        out.write("runs/01.txt", "x").expect("written");
        assert!(!destination.exists());
        out.commit().expect("moved");
        assert_eq!(entries(&destination), ["a.csv", "runs"]);
        assert_eq!(entries(parent.path()), ["out"]);
        let text = fs::read_to_string(destination.join("a.csv")).expect("a file");
        assert_eq!(text, "time_s,force_N\n0,1\n0.1,-0.00000025\n");
    }

    #[test]
    fn an_input_is_not_replaced_by_whatever_name_it_is_reached() {
        let parent = tempfile::tempdir().expect("a folder");
        let folder = parent.path().join("campaign");
        fs::create_dir(&folder).expect("made");
        fs::write(folder.join("model.toml"), "mine").expect("written");
        let mut out = OutputDirectory::stage(folder.join("..").join("campaign")).expect("writable");
        out.keep([folder.join("model.toml"), folder.join("absent.csv")]);
        assert!(matches!(out.refuse_input("model.toml"), Err(OutputError::Input { .. })));
        let error = out.write("model.toml", "theirs").expect_err("an input").to_string();
        assert!(
            error.contains("is an input of this command") && error.lines().count() == 1,
            "{error}"
        );
        out.write("report.json", "{}").expect("no input");
        out.commit().expect("moved");
        assert_eq!(entries(&folder), ["model.toml", "report.json"]);
        assert_eq!(fs::read_to_string(folder.join("model.toml")).expect("a file"), "mine");
    }

    #[test]
    fn dropped_without_commit_nothing_remains() {
        let parent = tempfile::tempdir().expect("a folder");
        for destination in [parent.path().join("new"), parent.path().to_path_buf()] {
            let mut out = OutputDirectory::stage(&destination).expect("writable");
            out.write("a.txt", "x").expect("written");
            drop(out);
            assert!(entries(parent.path()).is_empty());
        }
        assert!(
            !interrupt::staged()
                .iter()
                .any(|folder| folder.starts_with(parent.path()))
        );
    }

    #[test]
    fn an_existing_folder_keeps_its_other_files() {
        let destination = tempfile::tempdir().expect("a folder");
        fs::write(destination.path().join("notes.txt"), "mine").expect("written");
        fs::write(destination.path().join("a.txt"), "old").expect("written");
        let mut out = OutputDirectory::stage(destination.path()).expect("writable");
        out.write("a.txt", "new").expect("written");
        out.write("runs/b.txt", "new").expect("written");
        assert_eq!(
            fs::read_to_string(destination.path().join("a.txt")).expect("a file"),
            "old"
        );
        out.commit().expect("moved");
        assert_eq!(entries(destination.path()), ["a.txt", "notes.txt", "runs"]);
        assert_eq!(
            fs::read_to_string(destination.path().join("a.txt")).expect("a file"),
            "new"
        );
    }

    #[test]
    fn refusals_are_one_line_that_names_the_place() {
        let parent = tempfile::tempdir().expect("a folder");
        let file = parent.path().join("file");
        fs::write(&file, "").expect("written");
        let inside = |path: &Path| OutputDirectory::stage(path).expect_err("refused").to_string();
        for (path, part) in [
            (file.clone(), "not a folder"),
            (parent.path().join("no/out"), "create it first"),
        ] {
            let message = inside(&path);
            assert!(
                message.contains(part) && message.starts_with(&path.display().to_string()),
                "{message}"
            );
            assert!(!message.contains('\n'));
        }
        let mut out = OutputDirectory::stage(parent.path().join("out")).expect("writable");
        for name in ["../x", "/x", ""] {
            assert!(matches!(out.write(name, "x"), Err(OutputError::Name { .. })), "{name}");
        }
        assert!(out.csv("a.csv", &[("a", &[1.0]), ("b", &[])]).is_err());
    }

    #[test]
    fn records_and_json() {
        #[derive(Serialize)]
        struct Row {
            corner: u8,
            force_n: f64,
        }
        let parent = tempfile::tempdir().expect("a folder");
        let mut out = OutputDirectory::stage(parent.path().join("out")).expect("writable");
        out.csv_records(
            "rows.csv",
            [Row {
                corner: 0,
                force_n: 0.1 + 0.2,
            }],
        )
        .expect("written");
        out.json(
            "summary.json",
            &Row {
                corner: 1,
                force_n: 2.0,
            },
        )
        .expect("written");
        let destination = out.commit().expect("moved");
        let text = fs::read_to_string(destination.join("rows.csv")).expect("a file");
        assert_eq!(text, "corner,force_n\n0,0.30000000000000004\n");
        assert!(
            fs::read_to_string(destination.join("summary.json"))
                .expect("a file")
                .ends_with("}\n")
        );
    }
}
