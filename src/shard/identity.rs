//! What two shards have in common if they are of one study: its command with all options, the version of the program, and the files
//! that it read.

use std::path::PathBuf;

use oleo_report::digest;
use serde::{Deserialize, Serialize};

use super::study::About;
use crate::failure::Failure;
use crate::results::VERSION;

/// Which study.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// The command without its options.
    pub command: String,
    /// Its arguments in one form ([`super::arguments`]), from the name of the command on.
    pub arguments: Vec<String>,
    /// Version of the program.
    pub version: String,
    /// Files that it read.
    pub inputs: Vec<Input>,
}

/// A file that a study read.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Input {
    /// Its path as it was given.
    pub path: PathBuf,
    /// SHA-256, hexadecimal.
    pub sha256: String,
}

impl Identity {
    /// Of a study with these arguments, with the files as they are now.
    pub fn of(about: &About, arguments: Vec<String>) -> Result<Self, Failure> {
        let input = |path: &PathBuf| match digest::of_file(path) {
            Some(sha256) => Ok(Input {
                path: path.clone(),
                sha256,
            }),
            None => Err(Failure::new(format!(
                "{}: cannot be read as a file; shards need inputs that every machine can read again",
                path.display()
            ))),
        };
        Ok(Self {
            command: about.command.clone(),
            arguments,
            version: VERSION.to_owned(),
            inputs: about.inputs.iter().map(input).collect::<Result<_, _>>()?,
        })
    }

    /// A short text that differs wherever identities differ.
    pub fn token(&self) -> String {
        let text = serde_json::to_string(self).unwrap_or_default();
        digest::of_bytes(text.as_bytes()).chars().take(12).collect()
    }

    /// What another study has that this one has not, in words that follow the name of its shard; `None` if they are the same.
    pub fn difference(&self, other: &Self) -> Option<String> {
        if self.command != other.command {
            return Some(format!("is of {}, and not of {}", other.command, self.command));
        }
        if self.version != other.version {
            return Some(format!(
                "was written by oleo {}, and not by {}",
                other.version, self.version
            ));
        }
        let lacks = |a: &Vec<String>, b: &Vec<String>| a.iter().find(|word| !b.contains(word)).cloned();
        match (
            lacks(&self.arguments, &other.arguments),
            lacks(&other.arguments, &self.arguments),
        ) {
            (None, None) if self.arguments == other.arguments => {}
            (None, None) => return Some("has its operands in another order".to_owned()),
            (Some(own), None) => return Some(format!("is of a study without {own}")),
            (None, Some(theirs)) => return Some(format!("is of a study with {theirs}")),
            (Some(own), Some(theirs)) => return Some(format!("is of a study with {theirs}, and not with {own}")),
        }
        let changed = other.inputs.iter().find(|input| !self.inputs.contains(input));
        match changed {
            Some(input) => Some(format!("read another {}", input.path.display())),
            None if self.inputs != other.inputs => Some("read other files".to_owned()),
            None => None,
        }
    }

    /// Refuses shards that this program, or the files as they are now, would not give again.
    pub fn check_here(&self) -> Result<(), Failure> {
        if self.version != VERSION {
            return Err(Failure::new(format!(
                "the shards were written by oleo {}, and this is {VERSION}; merge them with the program that wrote them",
                self.version
            )));
        }
        for Input { path, sha256 } in &self.inputs {
            let problem = match digest::of_file(path) {
                Some(now) if now == *sha256 => continue,
                Some(_) => "is not as the shards read it; put the file back",
                None => "was read by the shards and is not here; merge in the folder in which they ran",
            };
            return Err(Failure::new(format!("{}: {problem}", path.display())));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn identity(change: impl FnOnce(&mut Identity)) -> Identity {
        let mut identity = Identity {
            command: "oleo study robust".into(),
            arguments: ["study", "robust", "--first=0", "--vehicles=24"]
                .map(str::to_owned)
                .into(),
            version: "1".into(),
            inputs: vec![Input {
                path: "vehicle.toml".into(),
                sha256: "0".into(),
            }],
        };
        change(&mut identity);
        identity
    }

    #[test]
    fn a_difference_is_said_in_words() {
        let own = identity(|_| {});
        assert_eq!(own.difference(&own), None);
        type Change = fn(&mut Identity);
        let cases: [(Change, &str); 6] = [
            (|i| i.version = "2".into(), "written by oleo 2, and not by 1"),
            (|i| i.command = "oleo study sweep".into(), "is of oleo study sweep"),
            (
                |i| i.arguments[2] = "--first=5".into(),
                "with --first=5, and not with --first=0",
            ),
            (|i| i.arguments.push("--check".into()), "a study with --check"),
            (|i| i.inputs[0].sha256 = "1".into(), "read another vehicle.toml"),
            (|i| i.inputs.clear(), "read other files"),
        ];
        for (change, expected) in cases {
            let other = identity(change);
            let said = own.difference(&other).expect("a difference");
            assert!(said.contains(expected), "{said}");
            assert_ne!(own.token(), other.token());
        }
    }
}
