//! Why results could not be written.

use std::io;
use std::path::PathBuf;

/// Why results could not be written. Each message is one line: what, where, what to do.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// `--out` names something that is not a folder.
    #[error("{}: is not a folder; name another output folder", path.display())]
    NotAFolder {
        /// The path as the user gave it.
        path: PathBuf,
    },
    /// `--out` names a folder where a file is wanted.
    #[error("{}: is a folder; name a file to write, such as sim.csv", path.display())]
    AFolder {
        /// The path as the user gave it.
        path: PathBuf,
    },
    /// `--out` names the root of the file system.
    #[error("{}: is the root of the file system; name a folder below it", path.display())]
    Root {
        /// The path as the user gave it.
        path: PathBuf,
    },
    /// The destination holds files, and nothing says that they are results.
    #[error(
        "{}: has files that oleo did not write, such as {found}; name another output folder, or add --force to write among them",
        path.display()
    )]
    Foreign {
        /// The output folder as the user gave it.
        path: PathBuf,
        /// One of the files.
        found: String,
    },
    /// The destination holds results of another command.
    #[error("{}: has results of {command}; name another output folder, or add --force to replace them", path.display())]
    OtherCommand {
        /// The output folder as the user gave it.
        path: PathBuf,
        /// The command that wrote them.
        command: String,
    },
    /// A result was edited, and the new one would replace it.
    #[error(
        "{}: is not as oleo wrote it, and the new results would replace it; keep a copy, then add --force",
        path.display()
    )]
    Changed {
        /// The file that was edited.
        path: PathBuf,
    },
    /// A result has the name of a file that is not one.
    #[error("{}: is there already, and oleo did not write it; name another output, or add --force to replace it", path.display())]
    NotOurs {
        /// The file that would be replaced.
        path: PathBuf,
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
