//! Something that carries CAN frames between two nodes.
//!
//! Nodes know the [`Bus`] trait and nothing else, so the same plant and the same controller run over memory, a kernel
//! socket or a serial line. Decorators wrap any bus and are buses themselves:
//!
//! ```text
//!   plant  -> FaultInjector -> Trace -> InProcess | SocketCan | SerialLine  <- controller
//! ```
//!
//! The injector is nearest to the plant: it acts on what the plant sends and on what it receives, so the trace (and any
//! other listener) sees the wire. Frames of [`crate::sync`], which keep two nodes in step and would not exist in a
//! vehicle, pass through both untouched.

mod address;
mod faults;
mod in_process;
mod serial_line;
mod slcan;
mod socket_can;
mod trace;

use std::time::Duration;

pub use address::{AddressError, BusAddress};
pub use faults::{Disturbance, FaultInjector, Injection, InjectionCounts, Target};
pub use in_process::{InProcess, in_process_pair};
pub use serial_line::SerialLine;
pub use slcan::{Decoder as SlcanDecoder, encode as slcan_encode};
pub use socket_can::SocketCan;
pub use trace::{Direction, Trace, TraceEntry};

use crate::Frame;

/// What a bus could not do. One line: what, where, what to do.
#[derive(Debug, thiserror::Error)]
pub enum BusError {
    /// The bus does not exist or may not be used.
    #[error("{bus}: {reason}")]
    Open {
        /// Address as given.
        bus: String,
        /// What is wrong, and what to do.
        reason: String,
    },
    /// It worked once and does not any more.
    #[error("{bus}: {action} failed: {source}; check the cable or interface and start again")]
    Io {
        /// Address.
        bus: String,
        /// What was attempted.
        action: &'static str,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The other end is gone for good.
    #[error("{bus}: the other end has closed the connection")]
    Closed {
        /// Address.
        bus: String,
    },
}

/// What a bus saw since it was opened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BusCounters {
    /// Frames handed over by this end.
    pub sent: u64,
    /// Frames given to this end.
    pub received: u64,
    /// Frames this end wanted to send and could not (queue full after back-off).
    pub send_lost: u64,
    /// Frames the kernel or the queue threw away before this end read them.
    pub receive_lost: u64,
    /// Times a full queue made a sender wait.
    pub back_offs: u64,
    /// What was received and is no classic frame (bus error frames, unreadable lines).
    pub unreadable: u64,
}

/// One end of a CAN bus.
pub trait Bus: Send {
    /// A new tick begins. Only decorators care.
    fn begin_tick(&mut self, _tick: u32) {}

    /// Queues a frame for sending. A full queue is waited for briefly and then counted as lost, never an error.
    ///
    /// # Errors
    /// The bus is gone.
    fn send(&mut self, frame: &Frame) -> Result<(), BusError>;

    /// The next frame, waiting for it at most `wait` (zero: not at all).
    ///
    /// # Errors
    /// The bus is gone.
    fn receive(&mut self, wait: Duration) -> Result<Option<Frame>, BusError>;

    /// Counters since the start.
    fn counters(&self) -> BusCounters;
}

impl<B: Bus + ?Sized> Bus for Box<B> {
    fn begin_tick(&mut self, tick: u32) {
        (**self).begin_tick(tick);
    }

    fn send(&mut self, frame: &Frame) -> Result<(), BusError> {
        (**self).send(frame)
    }

    fn receive(&mut self, wait: Duration) -> Result<Option<Frame>, BusError> {
        (**self).receive(wait)
    }

    fn counters(&self) -> BusCounters {
        (**self).counters()
    }
}
