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

/// Writes columns of the same length. `program` is named in the file.
pub fn write<W: Write + Send>(out: W, program: &str, columns: &[(String, Vec<f64>)]) -> io::Result<()> {
    let failed = |error: ParquetError| match error {
        ParquetError::External(inner) => match inner.downcast::<io::Error>() {
            Ok(error) => *error,
            Err(other) => io::Error::other(other),
        },
        other => io::Error::other(other),
    };
    encode(out, program, columns).map_err(failed)
}

fn encode<W: Write + Send>(out: W, program: &str, columns: &[(String, Vec<f64>)]) -> Result<(), ParquetError> {
    let field = |(name, _): &(String, Vec<f64>)| {
        let column = Type::primitive_type_builder(name, Physical::DOUBLE);
        column.with_repetition(Repetition::REQUIRED).build().map(Arc::new)
    };
    let fields = columns.iter().map(field).collect::<Result<Vec<_>, _>>()?;
    let schema = Type::group_type_builder("oleo").with_fields(fields).build()?;
    let properties = WriterProperties::builder()
        .set_created_by(program.to_owned())
        .set_compression(Compression::SNAPPY)
        .build();
    let mut file = SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties))?;
    let rows = columns.first().map_or(0, |(_, values)| values.len());
    for begin in (0..rows).step_by(ROWS_OF_A_GROUP) {
        let mut group = file.next_row_group()?;
        for (_, values) in columns {
            let part: Vec<f64> = (values.iter().skip(begin).take(ROWS_OF_A_GROUP))
                .map(|value| rounded(*value))
                .collect();
            let Some(mut column) = group.next_column()? else { break };
            column.typed::<DoubleType>().write_batch(&part, None, None)?;
            column.close()?;
        }
        group.close()?;
    }
    file.close()?;
    Ok(())
}
