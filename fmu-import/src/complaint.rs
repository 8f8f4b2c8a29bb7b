//! What is wrong, where, and what to do, in one line.

use std::fmt::Display;

/// A complaint.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Complaint(String);

impl Complaint {
    /// A complaint in one line: some libraries draw pictures of the place in their messages.
    pub fn new(what: impl Display) -> Self {
        let text = what.to_string();
        Self(text.split_whitespace().collect::<Vec<_>>().join(" "))
    }
}
