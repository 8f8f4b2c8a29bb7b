//! Stands for the writer of Parquet in a program that was built without it.

use std::io::{self, Write};
use std::path::Path;

use crate::failure::Failure;

/// Refuses a file.
pub fn is_built(path: &Path) -> Result<(), Failure> {
    Err(Failure::new(format!(
        "{}: this oleo was built without Parquet; build it with `cargo install --path . --features parquet`, or run it with \
         `cargo run --release --features parquet -- ...`",
        path.display()
    )))
}

/// Is never called.
pub fn write<W: Write + Send>(_: W, _: &str, _: &[(String, Vec<f64>)]) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}
