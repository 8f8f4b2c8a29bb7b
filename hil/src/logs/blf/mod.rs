//! Vector BLF logs, the binary files that CANoe, CANalyzer, CANape and many loggers write.
//!
//! ```text
//!   file head "LOGG", 144 bytes: program, sizes, dates of the first and the last object
//!   object "LOBJ" type 10, a container --inflate--> objects, of which the last may go on in the next container
//!   object "LOBJ" type 10, a container --inflate-->  |  type 1, 86: classic CAN      type 100, 101: CAN FD
//!   ...                                              |  type 2, 73, 104: error frames    others: no frame of CAN
//! ```
//!
//! Vector does not publish the format. What is read here is what python-can, Wireshark and the header `binlog_objects.h` of Vector's library
//! say of it. Times start at zero with the measurement, in steps of 10 us or 1 ns.
//!
//! The crate `ablf` 0.2 reads neither CAN FD nor the old classic frames, and panics on a damaged container; `blf_asc` 0.2 takes a file
//! that was cut off for a whole one, and counts nothing of what it leaves out.

mod containers;
pub(in crate::logs) mod object;

use std::io::Read;
use std::path::PathBuf;

use self::containers::{Containers, Fault};
use self::object::Event;
pub use self::object::SIGNATURE;
use super::account::Account;
use super::error::LogError;
use super::frame::{Entry, FrameKind};
use super::source::{FrameSource, Sink};

/// The frames of a BLF log.
pub struct Blf {
    containers: Containers,
    path: PathBuf,
}

impl Blf {
    /// A log that is read from its begin. `path` is the name that appears in errors.
    pub fn new(source: Box<dyn Read>, path: PathBuf) -> Self {
        Self {
            containers: Containers::new(source),
            path,
        }
    }
}

impl FrameSource for Blf {
    fn read(&mut self, sink: &mut Sink) -> Result<Account, LogError> {
        let Self { containers, path } = self;
        let mut account = Account::default();
        let mut frames: u64 = 0;
        // Name of the bus of the frame before.
        let (mut bus_number, mut bus) = (1, "1".to_owned());
        let refused = |fault: Fault, frames: u64| match fault {
            Fault::Io(error) => LogError::unreadable(path, &error),
            Fault::CutOff { container } => LogError::new(
                path,
                format!(
                    "is cut off in its container at byte {container}, after {frames} whole frames; copy it again from the logger, or \
                     keep what is whole with `head -c {container} IN.blf > WHOLE.blf`"
                ),
            ),
            Fault::Damaged { container, what } => LogError::new(
                path,
                format!(
                    "{what} in its container at byte {container}, after {frames} whole frames; copy it again from the logger"
                ),
            ),
        };
        while let Some(object) = containers.next().map_err(|fault| refused(fault, frames))? {
            account.entries += 1;
            match object::event(object) {
                Event::Frame {
                    time_us,
                    channel,
                    frame,
                } => {
                    account.remote_frames += u64::from(matches!(frame.kind, FrameKind::Remote(_)));
                    frames += 1;
                    if channel != bus_number {
                        bus_number = channel;
                        bus = channel.to_string();
                    }
                    let entry = Entry {
                        time_us,
                        bus: &bus,
                        frame,
                    };
                    if sink(entry).is_break() {
                        return Ok(account);
                    }
                }
                Event::Error => account.error_frames += 1,
                Event::Other => account.without_frame += 1,
                Event::Unreadable => account.unreadable += 1,
            }
        }
        // An object that goes on in a container that is not there, as the last line of a text that was cut off.
        if containers.ends_within_an_object() {
            account.entries += 1;
            account.unreadable += 1;
        }
        Ok(account)
    }
}

#[cfg(test)]
mod tests;
