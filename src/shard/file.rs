//! A shard's file: one line of JSON that says what it is, then the lines of the finished runs in order of their text. The same
//! shard is the same file, whatever the machine and the number of threads.

use std::path::Path;

use oleo_report::{OutputFile, digest};
use serde::{Deserialize, Serialize};

use super::identity::Identity;
use super::part::Part;
use crate::failure::Failure;

/// Version of the layout.
const LAYOUT: u32 = 1;

/// The first line.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    oleo_shard: u32,
    /// Which study.
    #[serde(flatten)]
    pub identity: Identity,
    shard: u32,
    of: u32,
    /// Number of cases of the whole study.
    pub cases: usize,
    /// SHA-256 of what follows the first line.
    sha256: String,
}

impl Header {
    /// Which part.
    pub fn part(&self) -> Part {
        Part {
            number: self.shard,
            of: self.of,
        }
    }
}

/// A shard.
pub struct ShardFile {
    pub header: Header,
    /// Lines of finished runs.
    pub lines: String,
}

impl ShardFile {
    /// A part of a study with the finished runs of its ledger.
    pub fn new(identity: Identity, part: Part, cases: usize, ledger: &str) -> Self {
        let mut lines: Vec<&str> = ledger.lines().filter(|line| !line.is_empty()).collect();
        lines.sort_unstable();
        lines.dedup();
        let lines: String = lines.into_iter().flat_map(|line| [line, "\n"]).collect();
        Self {
            header: Header {
                oleo_shard: LAYOUT,
                identity,
                shard: part.number,
                of: part.of,
                cases,
                sha256: digest::of_bytes(lines.as_bytes()),
            },
            lines,
        }
    }

    /// Reads a file; a complaint says what is wrong with it.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let wrong = |what: String| Failure::new(format!("{}: {what}", path.display()));
        let again = "run this shard again";
        let text = std::fs::read_to_string(path).map_err(|error| wrong(format!("cannot be read: {error}; {again}")))?;
        let (first, lines) = text.split_once('\n').unwrap_or((&text, ""));
        let header: Header =
            serde_json::from_str(first).map_err(|_| wrong(format!("is no shard, or a damaged one; {again}")))?;
        if header.oleo_shard != LAYOUT {
            return Err(wrong(format!(
                "has layout {} of shards, and this program reads {LAYOUT}; merge it with the program that wrote it",
                header.oleo_shard
            )));
        }
        if digest::of_bytes(lines.as_bytes()) != header.sha256 {
            return Err(wrong(format!("is not as it was written (its digest differs); {again}")));
        }
        let Part { number, of } = header.part();
        if number == 0 || number > of || of as usize > header.cases {
            return Err(wrong(format!("says that it is part {number}/{of}; {again}")));
        }
        Ok(Self {
            lines: lines.to_owned(),
            header,
        })
    }

    /// Writes the file whole, or not at all.
    pub fn write(&self, path: &Path) -> Result<(), Failure> {
        let first = serde_json::to_string(&self.header)?;
        OutputFile::stage(path, &[], true)?.bytes(format!("{first}\n{}", self.lines).as_bytes())?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn identity() -> Identity {
        Identity {
            command: "oleo study robust".into(),
            arguments: vec!["study".into(), "robust".into()],
            version: "1".into(),
            inputs: vec![],
        }
    }

    #[test]
    fn a_shard_is_the_same_file_in_any_order_of_its_runs_and_a_damaged_one_is_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("shard");
        let part = Part { number: 2, of: 3 };
        ShardFile::new(identity(), part, 9, "b,2\na,1\nb,2\n")
            .write(&path)
            .expect("written");
        let text = std::fs::read_to_string(&path).expect("a file");
        ShardFile::new(identity(), part, 9, "a,1\nb,2\n")
            .write(&path)
            .expect("written");
        assert_eq!(std::fs::read_to_string(&path).expect("a file"), text);
        let read = ShardFile::read(&path).expect("a shard");
        assert_eq!(
            (read.header.part(), read.header.cases, read.lines.as_str()),
            (part, 9, "a,1\nb,2\n")
        );
        assert_eq!(read.header.identity, identity());

        for (damaged, complaint) in [
            (text.replace("a,1", "a,7"), "digest differs"),
            (text[..text.len() - 2].to_owned(), "digest differs"),
            (text[..20].to_owned(), "no shard"),
            (String::new(), "no shard"),
            (text.replace("\"shard\":2", "\"shard\":4"), "part 4/3"),
            (text.replace("\"oleo_shard\":1", "\"oleo_shard\":2"), "layout 2"),
        ] {
            std::fs::write(&path, damaged).expect("written");
            let error = ShardFile::read(&path).err().expect(complaint).to_string();
            assert!(error.contains(complaint), "{error}");
        }
    }
}
