//! Stands for the writer of Parquet in a program that was built without it.

use std::io::{self, Write};
use std::marker::PhantomData;
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

/// A file, of which there are none.
pub struct ParquetRows<W>(std::convert::Infallible, PhantomData<W>);

impl<W: Write + Send> ParquetRows<W> {
    /// Is never called.
    pub fn begin(_: W, _: &str, _: &[String]) -> io::Result<Self> {
        Err(io::ErrorKind::Unsupported.into())
    }

    /// Is never called.
    pub fn row(&mut self, _: &[f64]) -> io::Result<()> {
        match self.0 {}
    }

    /// Is never called.
    pub fn finish(self) -> io::Result<()> {
        match self.0 {}
    }
}
