//! Stands for the reader of MDF 4 in a program that was built without it.

use std::path::Path;

use super::HOW_TO_BUILD;
use super::account::Account;
use super::error::LogError;
use super::source::{FrameSource, Sink};

/// The frames of an MF4 file, of which there are none.
pub enum Mf4 {}

impl Mf4 {
    /// Refuses a file.
    ///
    /// # Errors
    /// Always.
    pub fn open(path: &Path) -> Result<Self, LogError> {
        Err(LogError::new(
            path,
            format!("is an MDF 4 log, and this oleo was built without the reader of such logs; {HOW_TO_BUILD}"),
        ))
    }

    /// Refuses a file in memory.
    ///
    /// # Errors
    /// Always.
    pub fn in_memory(_: Vec<u8>, path: &Path) -> Result<Self, LogError> {
        Self::open(path)
    }
}

impl FrameSource for Mf4 {
    fn read(&mut self, _: &mut Sink) -> Result<Account, LogError> {
        match *self {}
    }
}
