//! Logs of CAN buses as people have them: the frames of a file, whatever its format, one after the other.
//!
//! ```text
//!   FILE --format--> lines or records --candump, asc, blf, mf4--> Entry (time, bus, frame) --> drive_log, signal_log, conversion
//! ```
//!
//! A reader knows nothing of what a frame means. It needs constant memory, passes over what is no frame and counts it.
//!
//! | file | what it holds |
//! |---|---|
//! | `frame` | a frame with up to 64 bytes, its time and its bus |
//! | `account` | what else was in a log |
//! | `source` | what every reader does |
//! | `format` | which format a file has, and its reader |
//! | `text` | lines in constant memory |
//! | `hex` | bytes as digits |
//! | `candump` | text of `candump -L`, read and written |
//! | `asc`, `asc_writer` | Vector ASC, read and written |
//! | `blf`, `blf_writer` | Vector BLF, read and written |
//! | `mf4_writer` | ASAM MDF 4, written |
//! | `bus_numbers` | numbers of buses that have names |
//! | `mf4` | ASAM MDF 4 with logged frames (feature `logs`) |
//! | `without_mf4` | says how to come by that reader |

mod account;
mod asc;
mod asc_writer;
mod blf;
mod blf_writer;
mod bus_numbers;
pub mod candump;
mod error;
mod format;
mod frame;
mod hex;
#[cfg(feature = "logs")]
mod mf4;
mod mf4_writer;
mod source;
mod text;
#[cfg(not(feature = "logs"))]
mod without_mf4;

pub use account::Account;
pub use asc_writer::AscWriter;
pub use blf_writer::BlfWriter;
pub use error::LogError;
pub use format::{Format, in_memory, open};
pub use frame::{Entry, FrameKind, LoggedFrame, MOST_BYTES, Payload, identifier};
pub use mf4_writer::Mf4Writer;
pub use source::{FrameSource, Sink};

/// How to come by a program with the feature `logs`.
pub const HOW_TO_BUILD: &str = "build it with `cargo install --path . --features logs`, or run it with `cargo run --release --features logs -- ...`";
