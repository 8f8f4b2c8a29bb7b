//! How a run ended.

/// How a run ended, in a word and a colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// All checks are met; shown in green.
    Pass,
    /// The result needs the reader's attention; shown in amber.
    Attention,
    /// A check failed; shown in red.
    Fail,
}
