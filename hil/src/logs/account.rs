//! What was read of a log besides frames with data.

/// Number of the entries of a log, by what they are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Account {
    /// Number of entries: lines of a text, records of a binary file.
    pub entries: u64,
    /// Number of entries that the format does not know, such as a last line that was cut off.
    pub unreadable: u64,
    /// Number of error frames.
    pub error_frames: u64,
    /// Number of remote frames.
    pub remote_frames: u64,
    /// Number of entries that carry no frame by design: head, comments, statistics, requests to transmit.
    pub without_frame: u64,
}
