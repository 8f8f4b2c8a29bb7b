//! A server for viewers on this machine, by the Foxglove WebSocket protocol.
//!
//! ```text
//!   loop --rows, bounded--> hub (JSON) --messages, bounded--> a thread for each viewer --> Foxglove, PlotJuggler
//! ```
//!
//! The loop never waits for a viewer: where a queue is full, the tick is left out for the viewer and counted. Commands and results of the
//! run are those of a run without viewers. A run in lockstep would be over before anybody has looked, so it is held back to real time
//! between ticks, which changes nothing in it.
//!
//! | file | what it holds |
//! |---|---|
//! | `protocol` | the texts and bytes of the protocol |
//! | `served` | what the server has done |
//! | `server` | the hub, and the viewers that come |
//! | `viewer` | one connection |

mod protocol;
mod served;
mod server;
mod viewer;

use std::io;
use std::time::{Duration, Instant};

use super::rows::{Rows, TICK_NS};
use crate::run::{Outcome, Underway};
pub use served::Served;
use server::Server;

/// Why viewers cannot be served.
#[derive(Debug, thiserror::Error)]
#[error("--live: cannot listen on port {port} of this machine: {source}; name another with --live PORT")]
pub struct LiveError {
    port: u16,
    source: io::Error,
}

/// A run that viewers follow.
pub struct Live {
    rows: Rows,
    server: Server,
    /// Start of a run that is held back.
    paced: Option<Instant>,
}

impl Live {
    /// Begins to listen on 127.0.0.1; port 0 is any that is free. With `hold_back` the run is not faster than real time.
    ///
    /// # Errors
    /// The port is taken.
    pub fn begin(port: u16, name: &str, rows: Rows, hold_back: bool) -> Result<Self, LiveError> {
        let server = Server::begin(port, name, rows.columns()).map_err(|source| LiveError { port, source })?;
        let paced = hold_back.then(Instant::now);
        Ok(Self { rows, server, paced })
    }

    /// The address that viewers are given.
    pub fn address(&self) -> String {
        format!("ws://{}", self.server.address())
    }

    /// Sends what has been driven since the last call.
    pub fn watch(&mut self, run: Underway) {
        // The last tick is not complete yet in real time.
        while let Some((tick, row)) = self.rows.next(run.recording, run.trace, 1) {
            self.server.offer(Rows::time_ns(tick), row);
        }
        if let Some(begun) = self.paced {
            let due = begun + Duration::from_nanos(u64::from(run.ticks) * TICK_NS);
            std::thread::sleep(due.saturating_duration_since(Instant::now()));
        }
    }

    /// Sends the rest, and parts from the viewers.
    pub fn finish(mut self, outcome: &Outcome) -> Served {
        let plant = &outcome.plant;
        while let Some((tick, row)) = self.rows.next(&plant.recording, &plant.trace, 0) {
            self.server.offer(Rows::time_ns(tick), row);
        }
        self.server.finish()
    }
}

#[cfg(test)]
mod tests;
