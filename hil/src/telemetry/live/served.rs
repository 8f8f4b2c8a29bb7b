//! What the server has done for viewers, in numbers and in words.

use std::fmt;

/// What the server has done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Served {
    /// Number of viewers that were connected.
    pub viewers: u64,
    /// Number of ticks that were sent, over all viewers.
    pub sent: u64,
    /// Number of ticks that were left out, over all viewers, because a viewer was too slow.
    pub dropped: u64,
}

impl fmt::Display for Served {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { viewers, sent, dropped } = self;
        let plural = if *viewers == 1 { "" } else { "s" };
        write!(
            out,
            "{viewers} viewer{plural}, {sent} ticks sent, {dropped} left out because a viewer was too slow"
        )
    }
}
