//! What parent and child say to each other, and how it is framed: the length in eight bytes, then the message as postcard writes it.

use std::io::{Read, Write};
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::description::{FmiVersion, NumberKind};

/// A variable as the library knows it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct VariableId {
    /// Its value reference.
    pub reference: u32,
    /// Its type.
    pub kind: NumberKind,
}

/// The first message: which library to load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Opening {
    /// Version of FMI.
    pub version: FmiVersion,
    /// Path of the shared library.
    pub library: PathBuf,
    /// Name of the instance.
    pub name: String,
    /// By which the library knows its description.
    pub token: String,
    /// Folder of the resources.
    pub resources: PathBuf,
    /// File that the time reached is written into.
    pub clock: PathBuf,
    /// Most memory of the child, bytes.
    pub memory: u64,
}

/// A variable that is driven during a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Driven {
    /// Which one.
    pub variable: VariableId,
    /// Its value during each step.
    pub during: Vec<f64>,
    /// Its value at each time, with which outputs that follow at once are read; the same as during the step before if empty.
    pub at: Vec<f64>,
}

/// One simulation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Times at which steps begin and end, s; strictly increasing, at least one.
    pub times_s: Vec<f64>,
    /// Values that are set before the initialization.
    pub starts: Vec<(VariableId, f64)>,
    /// What is driven.
    pub driven: Vec<Driven>,
    /// What is read at each time.
    pub outputs: Vec<VariableId>,
}

/// The child's answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Answer {
    /// The library is loaded.
    Opened,
    /// One series for each output of a run.
    Outputs(Vec<Vec<f64>>),
    /// The FMU cannot be simulated so, in words.
    Refused(String),
}

/// Longest message, bytes: what a broken child says must not fill the memory.
const LONGEST: u64 = 8 << 30;

/// Writes a message.
pub fn write<M: Serialize>(to: &mut impl Write, message: &M) -> std::io::Result<()> {
    let bytes = postcard::to_allocvec(message).map_err(std::io::Error::other)?;
    to.write_all(&(bytes.len() as u64).to_le_bytes())?;
    to.write_all(&bytes)?;
    to.flush()
}

/// Reads a message.
pub fn read<M: for<'de> Deserialize<'de>>(from: &mut impl Read) -> std::io::Result<M> {
    let mut length = [0; 8];
    from.read_exact(&mut length)?;
    let length = u64::from_le_bytes(length);
    if length > LONGEST {
        return Err(std::io::Error::other("the message is too long"));
    }
    let mut bytes = Vec::new();
    from.take(length).read_to_end(&mut bytes)?;
    postcard::from_bytes(&bytes).map_err(std::io::Error::other)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_read_back_to_the_bit() {
        let answers = [
            Answer::Opened,
            Answer::Outputs(vec![vec![0.1, -0.0, f64::MIN_POSITIVE], vec![]]),
            Answer::Refused("no".to_owned()),
        ];
        let mut pipe = Vec::new();
        answers
            .iter()
            .for_each(|answer| write(&mut pipe, answer).expect("written"));
        let mut pipe = &pipe[..];
        for answer in &answers {
            assert_eq!(read::<Answer>(&mut pipe).ok().as_ref(), Some(answer));
        }
        assert!(read::<Answer>(&mut pipe).is_err());
        assert!(read::<Answer>(&mut &[0xFF; 20][..]).is_err());
    }
}
