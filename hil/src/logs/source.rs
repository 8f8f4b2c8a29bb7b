//! What a reader of a log does, whatever its format.

use std::ops::ControlFlow;

use super::account::Account;
use super::error::LogError;
use super::frame::Entry;

/// Takes the frames of a log, and may end the reading.
pub type Sink<'a> = dyn FnMut(Entry<'_>) -> ControlFlow<()> + 'a;

/// A log of which the frames can be read once.
pub trait FrameSource {
    /// Gives all frames in the order of the log to `sink`, one at a time, so that a log of any length needs no more memory than a
    /// short one. What is no frame is counted and passed over.
    ///
    /// # Errors
    /// The file cannot be read on.
    fn read(&mut self, sink: &mut Sink) -> Result<Account, LogError>;
}
