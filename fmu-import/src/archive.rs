//! The file of an FMU, unpacked.

use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use tempfile::TempDir;
use zip::ZipArchive;

use crate::complaint::Complaint;
use crate::description::{Description, FmiVersion};

/// Most bytes of all files of an FMU together. Archives of a few kilobytes can hold terabytes of zeros.
const MOST_BYTES: u64 = 4 << 30;
/// Most files of an FMU.
const MOST_FILES: usize = 100_000;

/// An FMU that is unpacked in a folder of its own, which is removed with it.
#[derive(Debug)]
pub struct Fmu {
    /// The file, as it was named.
    pub path: PathBuf,
    /// What it says of itself.
    pub description: Description,
    /// Its shared library for this platform.
    pub(crate) library: PathBuf,
    folder: TempDir,
}

impl Fmu {
    /// Unpacks a file and reads its description.
    ///
    /// # Errors
    /// The file is no FMU for co-simulation, or none for this platform; each in one line that begins with the file.
    pub fn open(path: &Path) -> Result<Self, Complaint> {
        let of_file = |what: &dyn std::fmt::Display| Complaint::new(format!("{}: {what}", path.display()));
        let file = File::open(path).map_err(|error| of_file(&format!("cannot be read: {error}; check the path")))?;
        let folder = TempDir::with_prefix("oleo-fmu-").map_err(|error| {
            of_file(&format!(
                "cannot be unpacked: {error}; make room in the folder of temporary files"
            ))
        })?;
        unpack(file, folder.path()).map_err(|what| of_file(&what))?;
        let text = std::fs::read_to_string(folder.path().join("modelDescription.xml"))
            .map_err(|_| of_file(&"holds no modelDescription.xml; give an FMU"))?;
        let description = Description::read(&text).map_err(|what| of_file(&what))?;
        let library = library(folder.path(), &description).map_err(|what| of_file(&what))?;
        Ok(Self {
            path: path.to_path_buf(),
            description,
            library,
            folder,
        })
    }

    /// The folder in which it is unpacked.
    #[must_use]
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }
}

fn unpack(file: File, folder: &Path) -> Result<(), String> {
    let broken = |error: &dyn std::fmt::Display| format!("is no FMU, which is a zip file: {error}; export it again");
    let mut archive = ZipArchive::new(file).map_err(|error| broken(&error))?;
    if archive.len() > MOST_FILES {
        return Err(format!("holds more than {MOST_FILES} files; give an FMU"));
    }
    let mut room = MOST_BYTES;
    for index in 0..archive.len() {
        let mut entry = archive.by_index(index).map_err(|error| broken(&error))?;
        // A name that leads out of the folder is no mistake.
        let Some(name) = entry.enclosed_name() else {
            return Err(format!(
                "holds a file with the name {:?}, which leads out of it; do not trust it",
                entry.name()
            ));
        };
        let there = folder.join(name);
        if entry.is_dir() {
            std::fs::create_dir_all(&there).map_err(|error| error.to_string())?;
            continue;
        }
        if let Some(parent) = there.parent() {
            std::fs::create_dir_all(parent).map_err(|error| error.to_string())?;
        }
        let mut out = File::create(&there).map_err(|error| error.to_string())?;
        let written = std::io::copy(&mut entry.by_ref().take(room + 1), &mut out).map_err(|error| broken(&error))?;
        room = room.checked_sub(written).ok_or_else(|| {
            let most = MOST_BYTES >> 30;
            format!("holds more than {most} GiB; give an FMU")
        })?;
    }
    Ok(())
}

/// The library of this platform.
fn library(folder: &Path, description: &Description) -> Result<PathBuf, String> {
    let platform = platform(description.version);
    let binaries = folder.join("binaries");
    let path = (binaries.join(&platform)).join(format!("{}{}", description.identifier, std::env::consts::DLL_SUFFIX));
    if path.is_file() {
        return Ok(path);
    }
    let entries = std::fs::read_dir(&binaries).into_iter().flatten().flatten();
    let mut there: Vec<String> = entries.map(|e| e.file_name().to_string_lossy().into_owned()).collect();
    there.sort();
    Err(match there.is_empty() {
        true => format!("holds no library, and {platform} is needed; export it with binaries"),
        false => format!(
            "holds libraries for {}, and {platform} is needed; export it for this platform",
            there.join(", ")
        ),
    })
}

/// The folder of the libraries of this platform.
fn platform(version: FmiVersion) -> String {
    use std::env::consts::{ARCH, OS};
    let system = if OS == "macos" { "darwin" } else { OS };
    match (version, ARCH) {
        (FmiVersion::Two, "x86_64" | "aarch64") if system == "darwin" => "darwin64".to_owned(),
        (FmiVersion::Two, "x86_64") => format!("{}64", system.trim_end_matches("dows")),
        _ => format!("{ARCH}-{system}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write as _;
    use zip::write::{SimpleFileOptions, ZipWriter};

    const DESCRIPTION: &str = r#"<fmiModelDescription fmiVersion="2.0" modelName="m" guid="g"><CoSimulation modelIdentifier="m"/></fmiModelDescription>"#;

    fn said(files: &[(&str, &str)]) -> String {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.fmu");
        let mut archive = ZipWriter::new(File::create(&path).expect("a file"));
        for (name, text) in files {
            archive.start_file(*name, SimpleFileOptions::DEFAULT).expect("an entry");
            archive.write_all(text.as_bytes()).expect("written");
        }
        archive.finish().expect("an archive");
        let said = Fmu::open(&path).map_or_else(|complaint| complaint.to_string(), |_| String::new());
        assert!(
            said.is_empty() || said.starts_with(&path.display().to_string()),
            "{said}"
        );
        assert!(!said.contains('\n'));
        said
    }

    #[test]
    fn what_is_no_fmu_of_this_platform_is_refused() {
        let here = format!(
            "binaries/{}/m{}",
            platform(FmiVersion::Two),
            std::env::consts::DLL_SUFFIX
        );
        let description = ("modelDescription.xml", DESCRIPTION);
        assert_eq!(said(&[description, (&here, "a library")]), "");
        assert!(said(&[description]).contains("holds no library"));
        assert!(said(&[description, ("binaries/amiga/m.so", "x")]).contains("holds libraries for amiga"));
        assert!(said(&[("other.xml", "x")]).contains("holds no modelDescription.xml"));
        assert!(said(&[("../../out.txt", "x")]).contains("leads out of it"));
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.fmu");
        let open = || Fmu::open(&path).expect_err("refused").to_string();
        assert!(open().contains("check the path"));
        std::fs::write(&path, "no zip").expect("written");
        assert!(open().contains("which is a zip file"));
    }
}
