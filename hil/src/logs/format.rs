//! Which format a log has, and the reader for it.

use std::fs::File;
use std::io::{BufRead, BufReader, Cursor, Read};
use std::path::Path;

use flate2::read::MultiGzDecoder;

use super::asc::Asc;
use super::blf::{self, Blf};
use super::candump::Candump;
use super::error::LogError;
#[cfg(feature = "logs")]
use super::mf4::Mf4;
use super::source::FrameSource;
use super::text::Lines;
#[cfg(not(feature = "logs"))]
use super::without_mf4::Mf4;

/// Bytes that are read from a file at once.
const READ_AHEAD: usize = 1 << 20;
/// Bytes by which a format is recognised.
const HEAD: u64 = 512;

/// A format of logs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Text of `candump -L`.
    Candump,
    /// Vector ASC.
    Asc,
    /// Vector BLF.
    Blf,
    /// ASAM MDF 4.
    Mf4,
}

impl Format {
    /// Ends of the names of logs, in lower case; all but MDF 4, which is not read from front to back, may be followed by `.gz`.
    pub const ENDS: [(&'static str, Self); 4] = [
        (".log", Self::Candump),
        (".asc", Self::Asc),
        (".blf", Self::Blf),
        (".mf4", Self::Mf4),
    ];

    /// The format that the end of a file's name stands for.
    #[must_use]
    pub fn of_name(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_string_lossy().to_ascii_lowercase();
        let (name, is_packed) = match name.strip_suffix(".gz") {
            Some(name) => (name, true),
            None => (name.as_str(), false),
        };
        let (_, format) = Self::ENDS.into_iter().find(|(end, _)| name.ends_with(end))?;
        (!is_packed || format != Self::Mf4).then_some(format)
    }

    /// The format of the text that a file begins with.
    fn of_text(head: &[u8]) -> Self {
        let text = String::from_utf8_lossy(head).to_ascii_lowercase();
        let first = text.lines().map(str::trim).find(|line| !line.is_empty()).unwrap_or("");
        let begins = ["date ", "base ", "//", "begin triggerblock"];
        if begins.iter().any(|begin| first.starts_with(begin)) {
            Self::Asc
        } else {
            Self::Candump
        }
    }
}

/// Opens a log. Its content decides on the format, and the end of its name where a text can be either.
///
/// # Errors
/// The file cannot be read, or has a format that is not read.
pub fn open(path: &Path) -> Result<Box<dyn FrameSource>, LogError> {
    let unreadable = |error| LogError::unreadable(path, &error);
    let mut file = BufReader::with_capacity(READ_AHEAD, File::open(path).map_err(unreadable)?);
    let head = file.fill_buf().map_err(unreadable)?;
    if is_mdf(head) {
        return Ok(Box::new(Mf4::open(path)?));
    }
    let source: Box<dyn Read> = if head.starts_with(&[0x1F, 0x8B]) {
        Box::new(MultiGzDecoder::new(file))
    } else {
        Box::new(file)
    };
    stream(source, Format::of_name(path), path)
}

/// Opens a log in memory.
///
/// # Errors
/// A format that is not read, or a damaged head.
pub fn in_memory(bytes: &[u8]) -> Result<Box<dyn FrameSource>, LogError> {
    let path = Path::new("log");
    if is_mdf(bytes) {
        return Ok(Box::new(Mf4::in_memory(bytes.to_vec(), path)?));
    }
    stream(Box::new(Cursor::new(bytes.to_vec())), None, path)
}

/// A log that is read from front to back.
fn stream(source: Box<dyn Read>, named: Option<Format>, path: &Path) -> Result<Box<dyn FrameSource>, LogError> {
    let mut source = BufReader::with_capacity(READ_AHEAD, source);
    let mut head = Vec::new();
    let unreadable = |error| LogError::unreadable(path, &error);
    Read::take(&mut source, HEAD)
        .read_to_end(&mut head)
        .map_err(unreadable)?;
    refuse_foreign(&head).map_err(|what| LogError::new(path, what))?;
    let is_blf = head.starts_with(blf::SIGNATURE);
    let format = match Format::of_text(&head) {
        Format::Candump if named == Some(Format::Asc) => Format::Asc,
        format => format,
    };
    let whole = Cursor::new(head).chain(source);
    if is_blf {
        return Ok(Box::new(Blf::new(Box::new(whole), path.to_path_buf())));
    }
    let lines = Lines::new(Box::new(whole));
    Ok(match format {
        Format::Asc => Box::new(Asc::new(lines, path.to_path_buf())),
        _ => Box::new(Candump::new(lines, path.to_path_buf())),
    })
}

fn is_mdf(head: &[u8]) -> bool {
    head.starts_with(b"MDF ") || head.starts_with(b"UnFinMF ")
}

/// Formats that people have too, with the way to one that is read.
fn refuse_foreign(head: &[u8]) -> Result<(), &'static str> {
    if is_mdf(head) {
        return Err("is an MDF 4 log that is packed once more; unpack it with gunzip");
    }
    if head.starts_with(b"PK\x03\x04") {
        return Err("is a ZIP archive; unpack it and give the logs inside");
    }
    Ok(())
}
