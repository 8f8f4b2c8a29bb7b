//! Stands for the writer of MCAP and the server of viewers in a program that was built without them.

use std::io::{self, Seek, Write};
use std::marker::PhantomData;

use super::topic::{Column, Value};
use super::{HOW_TO_BUILD, Rows};
use crate::run::{Outcome, Underway};

/// An MCAP file, of which there are none.
pub struct McapFile<W>(std::convert::Infallible, PhantomData<W>);

impl<W: Write + Seek> McapFile<W> {
    /// Refuses to write.
    ///
    /// # Errors
    /// Always.
    pub fn new(_: W, _: &str) -> io::Result<Self> {
        Err(io::Error::other(format!(
            "this oleo was built without MCAP; {HOW_TO_BUILD}"
        )))
    }

    /// Is never called.
    ///
    /// # Errors
    /// Never.
    pub fn add(&mut self, _: Option<&str>, _: &[Column]) -> io::Result<()> {
        match self.0 {}
    }

    /// Is never called.
    ///
    /// # Errors
    /// Never.
    pub fn row(&mut self, _: usize, _: u64, _: &[Value]) -> io::Result<()> {
        match self.0 {}
    }

    /// Is never called.
    ///
    /// # Errors
    /// Never.
    pub fn finish(self) -> io::Result<()> {
        match self.0 {}
    }
}

/// A server, of which there are none.
pub enum Live {}

/// Why there is none.
#[derive(Debug, thiserror::Error)]
#[error("--live: this oleo was built without a server for viewers; {HOW_TO_BUILD}")]
pub struct LiveError;

/// What a server has done, where there was one.
pub struct Served;

impl std::fmt::Display for Served {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.write_str("nothing")
    }
}

impl Live {
    /// Refuses to serve.
    ///
    /// # Errors
    /// Always.
    pub fn begin(_: u16, _: &str, _: Rows, _: bool) -> Result<Self, LiveError> {
        Err(LiveError)
    }

    /// Is never called.
    pub fn address(&self) -> String {
        match *self {}
    }

    /// Is never called.
    pub fn watch(&mut self, _: Underway) {
        match *self {}
    }

    /// Is never called.
    pub fn finish(self, _: &Outcome) -> Served {
        match self {}
    }
}
