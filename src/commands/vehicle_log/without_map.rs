//! Stands for the reader of other CAN databases in a program that was built without it.

use std::path::Path;

use oleo_diagnose::vehicle::Resolution;
use oleo_hil::logs::HOW_TO_BUILD;
use oleo_interface::Corners;

use super::content::PartSink;
use crate::failure::Failure;

/// The signals that are taken of a log, of which there are none.
pub enum ByMap {}

impl ByMap {
    /// Refuses a database.
    pub fn of(dbc: &Path, _: &Path) -> Result<Self, Failure> {
        Err(Failure::new(format!(
            "{}: this oleo was built without the reader of CAN databases; {HOW_TO_BUILD}",
            dbc.display()
        )))
    }

    pub fn stream(&self, _: &Path, _: &mut PartSink) -> Result<String, Failure> {
        match *self {}
    }

    pub fn resolution(&self) -> Corners<Resolution> {
        match *self {}
    }
}
