//! A run as messages for viewers such as Foxglove and PlotJuggler: in an MCAP file afterwards, or live while it is under way.
//!
//! ```text
//!   recording, trace --rows--> a row of values for each tick --topic--> JSON messages of each topic --mcap_file--> FILE.mcap
//!   columns of a drive --series--> rows ---------------------------------^                     `-----live-------> viewers
//! ```
//!
//! | file | what it holds |
//! |---|---|
//! | `topic` | which topic a column belongs to, its schema and its messages |
//! | `rows` | the rows of a run of the loop, while it is under way or afterwards |
//! | `series` | columns that are complete, as rows |
//! | `mcap_file` | an MCAP file (feature `mcap`) |
//! | `live` | a server for viewers on this machine (feature `mcap`) |
//! | `without` | says how to come by both |
//!
//! Names and units are those of the CSV files, and so are the numbers, to the last digit. The time of a message is the simulated one.

#[cfg(feature = "mcap")]
mod live;
#[cfg(feature = "mcap")]
mod mcap_file;
mod rows;
mod series;
mod topic;
#[cfg(not(feature = "mcap"))]
mod without;

#[cfg(feature = "mcap")]
pub use live::{Live, LiveError, Served};
#[cfg(feature = "mcap")]
pub use mcap_file::McapFile;
pub use rows::Rows;
pub use series::{Series, nanoseconds, write_series};
pub use topic::{Column, Kind, Topic, Value};
#[cfg(not(feature = "mcap"))]
pub use without::{Live, LiveError, McapFile, Served};

/// How to come by a program with the feature `mcap`.
pub const HOW_TO_BUILD: &str = "build it with `cargo install --path . --features mcap`, or run it with `cargo run --release --features mcap -- ...`";

/// Whether this program writes MCAP and serves viewers.
pub const IS_BUILT: bool = cfg!(feature = "mcap");
