//! The file that a tool opens: a zip with the description, the shared library for each platform, and the resources.

use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};

use zip::write::{SimpleFileOptions, ZipWriter};

use crate::complaint::Complaint;
use crate::description::{FmiVersion, description};
use crate::resources::Resources;

/// A shared library of this crate, for one platform.
#[derive(Debug, Clone)]
pub struct SharedLibrary {
    platform: &'static Platform,
    bytes: Vec<u8>,
}

/// How a platform is called, and how its libraries end.
#[derive(Debug, PartialEq)]
struct Platform {
    /// Folder in FMI 2, which knows fewer platforms.
    two: Option<&'static str>,
    /// Folder in FMI 3.
    three: &'static str,
    suffix: &'static str,
}

const LINUX: Platform = Platform {
    two: Some("linux64"),
    three: "x86_64-linux",
    suffix: "so",
};
const LINUX_ARM: Platform = Platform {
    two: None,
    three: "aarch64-linux",
    suffix: "so",
};
const WINDOWS: Platform = Platform {
    two: Some("win64"),
    three: "x86_64-windows",
    suffix: "dll",
};
const MAC: Platform = Platform {
    two: Some("darwin64"),
    three: "x86_64-darwin",
    suffix: "dylib",
};
const MAC_ARM: Platform = Platform {
    two: Some("darwin64"),
    three: "aarch64-darwin",
    suffix: "dylib",
};

impl SharedLibrary {
    /// Reads a shared library and finds out for which platform it is.
    ///
    /// # Errors
    /// The file cannot be read, or is no shared library of a known platform.
    pub fn read(path: &Path) -> Result<Self, Complaint> {
        let bytes = std::fs::read(path).map_err(|error| {
            Complaint::new(format!(
                "{}: cannot be read: {error}; build it with `cargo build --release --features fmu -p oleo -p oleo-fmu`, or name it with --library",
                path.display()
            ))
        })?;
        match platform(&bytes) {
            Some(platform) => Ok(Self { platform, bytes }),
            None => Err(Complaint::new(format!(
                "{}: is no shared library of a platform with 64 bits; give the one that `cargo build --release --features fmu -p oleo -p oleo-fmu` writes",
                path.display()
            ))),
        }
    }

    /// Where the build puts the library of this platform, below the folder of the program: beside it, or among what it was built from.
    pub fn candidates(program_folder: &Path) -> Vec<PathBuf> {
        let name = format!(
            "{}oleo_fmu{}",
            std::env::consts::DLL_PREFIX,
            std::env::consts::DLL_SUFFIX
        );
        vec![program_folder.join(&name), program_folder.join("deps").join(&name)]
    }
}

/// The platform of a shared library, by the head of its file: ELF, Portable Executable or Mach-O.
fn platform(bytes: &[u8]) -> Option<&'static Platform> {
    let machine = |at: usize| Some(u16::from_le_bytes(*bytes.get(at..)?.first_chunk()?));
    let word = |at: usize| Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?));
    match bytes {
        // 64 bits, and the machine behind the type.
        [0x7F, b'E', b'L', b'F', 2, ..] => match machine(18)? {
            62 => Some(&LINUX),
            183 => Some(&LINUX_ARM),
            _ => None,
        },
        [b'M', b'Z', ..] => {
            let head = usize::try_from(word(0x3C)?).ok()?;
            (bytes.get(head..head.checked_add(4)?)? == b"PE\0\0" && machine(head + 4)? == 0x8664).then_some(&WINDOWS)
        }
        [0xCF, 0xFA, 0xED, 0xFE, ..] => match word(4)? {
            0x0100_0007 => Some(&MAC),
            0x0100_000C => Some(&MAC_ARM),
            _ => None,
        },
        _ => None,
    }
}

/// An FMU as bytes, and what is in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Packed {
    /// The file.
    pub bytes: Vec<u8>,
    /// Number of inputs, outputs and parameters.
    pub counts: [usize; 3],
    /// Platforms, by their names in FMI 3.
    pub platforms: Vec<&'static str>,
}

/// Packs an FMU. The same resources and libraries give the same bytes.
///
/// # Errors
/// The resources do not make a model, a platform is unknown to the version or comes twice, or the archive cannot be written.
pub fn pack(resources: &Resources, version: FmiVersion, libraries: &[SharedLibrary]) -> Result<Packed, Complaint> {
    use crate::variable::Role;

    let (definition, _) = resources.build()?;
    let given = definition.variables.iter().filter(|variable| variable.role.is_given());
    if let Some(refused) = given.into_iter().find_map(|variable| variable.refuses(variable.start)) {
        return Err(Complaint::new(refused));
    }
    if definition.terminal.is_some() && version == FmiVersion::Two {
        return Err(Complaint::new(format!(
            "{} exchanges bus operations, which FMI 2.0 has no variables for: write FMI 3.0 with --fmi 3",
            definition.identifier
        )));
    }
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let mut add = |path: &str, bytes: &[u8], mode: u32| {
        let options = SimpleFileOptions::DEFAULT.unix_permissions(mode);
        archive.start_file(path, options).map_err(Complaint::new)?;
        archive.write_all(bytes).map_err(Complaint::new)
    };
    let xml = description(&definition, version).map_err(Complaint::new)?;
    add("modelDescription.xml", &xml, 0o644)?;
    let mut folders: Vec<&str> = Vec::new();
    for SharedLibrary { platform, bytes } in libraries {
        let folder = match version {
            FmiVersion::Two => platform.two,
            FmiVersion::Three => Some(platform.three),
        };
        let Some(folder) = folder else {
            return Err(Complaint::new(format!(
                "FMI 2.0 has no name for the platform {}: write FMI 3.0 with --fmi 3",
                platform.three
            )));
        };
        if folders.contains(&folder) {
            return Err(Complaint::new(format!(
                "two libraries are for {folder}: give one for each platform"
            )));
        }
        folders.push(folder);
        let path = format!("binaries/{folder}/{}.{}", definition.identifier, platform.suffix);
        add(&path, bytes, 0o755)?;
    }
    for (path, text) in definition.terminal.iter().flat_map(|terminal| terminal.files()) {
        add(path, text.as_bytes(), 0o644)?;
    }
    for (name, text) in resources.files()? {
        add(&format!("resources/{name}"), text.as_bytes(), 0o644)?;
    }
    let bytes = archive.finish().map_err(Complaint::new)?.into_inner();
    let count = |of: fn(Role) -> bool| definition.variables.iter().filter(|variable| of(variable.role)).count();
    Ok(Packed {
        bytes,
        counts: [
            count(|role| role == Role::Input),
            count(|role| role == Role::Output),
            count(Role::is_parameter),
        ],
        platforms: libraries.iter().map(|library| library.platform.three).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_head_of_a_library_tells_its_platform() {
        let elf = |machine: u8| [&[0x7F, b'E', b'L', b'F', 2][..], &[0; 13], &[machine, 0]].concat();
        assert_eq!(platform(&elf(62)), Some(&LINUX));
        assert_eq!(platform(&elf(183)), Some(&LINUX_ARM));
        assert_eq!(platform(&elf(40)), None);
        let mut pe = vec![0; 0x50];
        pe[..2].copy_from_slice(b"MZ");
        pe[0x3C] = 0x40;
        pe[0x40..0x46].copy_from_slice(&[b'P', b'E', 0, 0, 0x64, 0x86]);
        assert_eq!(platform(&pe), Some(&WINDOWS));
        assert_eq!(platform(&pe[..0x44]), None);
        assert_eq!(platform(&[0xCF, 0xFA, 0xED, 0xFE, 12, 0, 0, 1]), Some(&MAC_ARM));
        assert_eq!(platform(b"a text"), None);
    }
}
