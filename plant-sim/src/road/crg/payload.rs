//! The data part of an OpenCRG file: rows of numbers, text or binary.

use super::super::RoadError;
use super::header::{Format, Header};

/// Characters a record of text holds at most.
const RECORD: usize = 80;

/// Decodes all rows, one number a channel; missing values are NaN.
pub(super) fn decode(bytes: &[u8], header: &Header, path: &str) -> Result<Vec<f64>, RoadError> {
    let data = bytes.get(header.data_start..).unwrap_or_default();
    match header.format {
        Format::Text(width) => text(data, header, width, path),
        Format::Real => binary(data, header, path, |b: [u8; 4]| f64::from(f32::from_be_bytes(b))),
        Format::Double => binary(data, header, path, f64::from_be_bytes),
    }
}

/// Numbers one after the other; the padding of the last record is left.
fn binary<const SIZE: usize>(
    data: &[u8],
    header: &Header,
    path: &str,
    number: fn([u8; SIZE]) -> f64,
) -> Result<Vec<f64>, RoadError> {
    let row = header.channels * SIZE;
    let rows = header.rows.unwrap_or(data.len() / row);
    let needed = rows.saturating_mul(row);
    let Some(data) = data.get(..needed) else {
        let problem = format!(
            "{} bytes of data where {rows} rows of {} numbers need {needed}: the file is cut short or corrupt",
            data.len(),
            header.channels
        );
        return Err(RoadError::payload(path, problem));
    };
    let (numbers, _) = data.as_chunks::<SIZE>();
    Ok(numbers.iter().map(|&bytes| number(bytes)).collect())
}

/// Numbers of fixed width without separators; each row begins a record and goes on in the next.
fn text(data: &[u8], header: &Header, width: usize, path: &str) -> Result<Vec<f64>, RoadError> {
    let a_record = RECORD / width;
    let mut numbers = Vec::new();
    let mut row = 0;
    for (index, record) in data.split(|&byte| byte == b'\n').enumerate() {
        let line = header.data_line + index;
        let record = record.strip_suffix(b"\r").unwrap_or(record);
        if record.trim_ascii().is_empty() {
            continue;
        }
        let here = (header.channels - row).min(a_record);
        if record.len() < (here - 1) * width + 1 {
            let problem = format!(
                "ends after {} characters where {here} numbers of {width} are needed",
                record.len()
            );
            return Err(RoadError::line(path, line, problem));
        }
        for field in record.chunks(width).take(here) {
            numbers.push(value(field).ok_or_else(|| {
                RoadError::line(
                    path,
                    line,
                    format!("'{}' is not a number", String::from_utf8_lossy(field).trim()),
                )
            })?);
        }
        row = (row + here) % header.channels;
    }
    if row != 0 {
        let line = header.data_line + data.split(|&byte| byte == b'\n').count() - 1;
        return Err(RoadError::line(path, line, "the file ends within a row of numbers"));
    }
    if let Some(rows) = header.rows {
        let found = numbers.len() / header.channels;
        if found != rows {
            return Err(RoadError::payload(
                path,
                format!("{found} rows of data where the header announces {rows}"),
            ));
        }
    }
    Ok(numbers)
}

/// A number, or NaN for a placeholder that begins with an asterisk.
fn value(field: &[u8]) -> Option<f64> {
    let text = core::str::from_utf8(field).ok()?.trim();
    if text.starts_with('*') {
        return Some(f64::NAN);
    }
    text.replace(['d', 'D'], "e").parse().ok()
}
