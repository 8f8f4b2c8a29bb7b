//! Lines of a text of any length in constant memory.

use std::borrow::Cow;
use std::io::{BufRead, Read};

/// Longest line that is read as a whole, bytes; what is longer becomes several lines. A CAN FD frame in ASC has 350.
const LONGEST_LINE: u64 = 4096;

/// Lines of a log.
pub struct Lines {
    source: Box<dyn BufRead>,
    line: Vec<u8>,
}

impl Lines {
    /// The lines of a text.
    pub fn new(source: Box<dyn BufRead>) -> Self {
        Self {
            source,
            line: Vec::new(),
        }
    }

    /// The next line; `None` at the end. Bytes that are not UTF-8, as in names written in another code page, are replaced.
    pub fn next(&mut self) -> std::io::Result<Option<Cow<'_, str>>> {
        self.line.clear();
        let mut part = Read::take(&mut self.source, LONGEST_LINE);
        if part.read_until(b'\n', &mut self.line)? == 0 {
            return Ok(None);
        }
        // Most lines are ASCII, which this sees eight bytes at a time.
        Ok(Some(match std::str::from_utf8(&self.line) {
            Ok(line) => Cow::Borrowed(line),
            Err(_) => String::from_utf8_lossy(&self.line),
        }))
    }
}
