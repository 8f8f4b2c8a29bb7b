//! What every work does.

use crate::failure::Failure;

/// Work that is ready to be done.
pub trait Work {
    /// Does it, and tells the number of operations.
    fn run(&mut self) -> Result<u64, Failure>;

    /// Digest of what was computed.
    fn outcome(&self) -> Result<String, Failure>;
}
