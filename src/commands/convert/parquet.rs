//! Columns as Parquet, for pandas, DuckDB and Spark.
//!
//! Each column is one of required doubles with the nine digits of a CSV file, and NaN for what is missing, as there.

use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;

use oleo_report::rounded;
use parquet::basic::{Compression, Repetition, Type as Physical};
use parquet::data_type::DoubleType;
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use crate::failure::Failure;

/// Rows of a group: those of a minute and a half, by which readers skip what they do not need.
const ROWS_OF_A_GROUP: usize = 1 << 17;

/// Whether this program writes Parquet, which it does.
#[allow(clippy::unnecessary_wraps, reason = "one without the feature refuses")]
pub fn is_built(_: &Path) -> Result<(), Failure> {
    Ok(())
}

/// A file that is written row by row. Held are the rows of one group.
pub struct ParquetRows<W: Write + Send> {
    file: SerializedFileWriter<W>,
    group: Vec<Vec<f64>>,
}

impl<W: Write + Send> ParquetRows<W> {
    /// Begins a file. `program` is named in it.
    pub fn begin(out: W, program: &str, names: &[String]) -> io::Result<Self> {
        let file = created(out, program, names).map_err(failed)?;
        let group = vec![Vec::with_capacity(ROWS_OF_A_GROUP); names.len()];
        Ok(Self { file, group })
    }

    /// Writes a row, with a value for each column.
    pub fn row(&mut self, values: &[f64]) -> io::Result<()> {
        for (column, value) in self.group.iter_mut().zip(values) {
            column.push(rounded(*value));
        }
        match self.group.first().map_or(0, Vec::len) {
            ROWS_OF_A_GROUP => self.write_group().map_err(failed),
            _ => Ok(()),
        }
    }

    /// Writes what is held, and the index of the file.
    pub fn finish(mut self) -> io::Result<()> {
        if self.group.first().is_some_and(|column| !column.is_empty()) {
            self.write_group().map_err(failed)?;
        }
        self.file.close().map(|_| ()).map_err(failed)
    }

    fn write_group(&mut self) -> Result<(), ParquetError> {
        let mut group = self.file.next_row_group()?;
        for values in &mut self.group {
            let Some(mut column) = group.next_column()? else { break };
            column.typed::<DoubleType>().write_batch(values, None, None)?;
            column.close()?;
            values.clear();
        }
        group.close()?;
        Ok(())
    }
}

fn created<W: Write + Send>(out: W, program: &str, names: &[String]) -> Result<SerializedFileWriter<W>, ParquetError> {
    let field = |name: &String| {
        let column = Type::primitive_type_builder(name, Physical::DOUBLE);
        column.with_repetition(Repetition::REQUIRED).build().map(Arc::new)
    };
    let fields = names.iter().map(field).collect::<Result<Vec<_>, _>>()?;
    let schema = Type::group_type_builder("oleo").with_fields(fields).build()?;
    let properties = WriterProperties::builder()
        .set_created_by(program.to_owned())
        .set_compression(Compression::SNAPPY)
        .build();
    SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties))
}

/// What the disk has refused, as it says it.
fn failed(error: ParquetError) -> io::Error {
    match error {
        ParquetError::External(inner) => match inner.downcast::<io::Error>() {
            Ok(error) => *error,
            Err(other) => io::Error::other(other),
        },
        other => io::Error::other(other),
    }
}
