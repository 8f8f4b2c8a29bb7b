//! Buses that carry CAN frames between two nodes.
//!
//! Nodes know only the trait [`Bus`], so that the same plant and the same controller run over memory, a kernel socket or a serial
//! line. Decorators wrap any bus and are buses themselves:
//!
//! ```text
//!   plant  -> FaultInjector -> Trace -> InProcess | SocketCan | SerialLine  <- controller
//! ```
//!
//! The injector is next to the plant and acts on what the plant sends and receives. So the trace, like any other listener, sees what is on
//! the wire. Frames of [`crate::sync`], which keep two nodes in step and would not exist in a vehicle, pass through both unchanged.

mod address;
mod compared;
mod faults;
mod in_process;
mod recorder;
mod serial_line;
mod slcan;
mod socket_can;
mod trace;

use std::time::Duration;

pub use address::{AddressError, BusAddress};
pub use compared::Compared;
pub use faults::{Disturbance, FaultInjector, Injection, InjectionCounts, Target};
pub use in_process::{InProcess, in_process_pair};
pub use serial_line::SerialLine;
pub use slcan::{Decoder as SlcanDecoder, encode as slcan_encode};
pub use socket_can::SocketCan;
pub use trace::{Direction, Trace, TraceEntry};

use crate::Frame;

/// What a bus could not do, in one line: what, where, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum BusError {
    /// The bus does not exist or may not be used.
    #[error("{bus}: {reason}")]
    Open {
        /// Address of the bus, as given.
        bus: String,
        /// What is wrong, and what to do.
        reason: String,
    },
    /// The bus worked before and fails now.
    #[error("{bus}: {action} failed: {source}; check the cable or interface and start again")]
    Io {
        /// Address of the bus.
        bus: String,
        /// What was attempted, such as "sending".
        action: &'static str,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// The controller at the other end does not decide as the one in this process.
    #[error("tick {tick}: the controller under test sent {sent}, the same controller in this process {expected}")]
    Differs {
        /// Number of the tick.
        tick: u32,
        /// The frame that came, as a line of slcan.
        sent: String,
        /// The frame that should have come.
        expected: String,
    },
    /// The other end is gone for good.
    #[error("{bus}: the other end has closed the connection")]
    Closed {
        /// Address of the bus.
        bus: String,
    },
}

/// What a bus saw since it was opened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BusCounters {
    /// Number of frames that this end has sent.
    pub sent: u64,
    /// Number of frames that this end has received.
    pub received: u64,
    /// Number of frames that this end could not send, because the queue was still full after a wait.
    pub send_lost: u64,
    /// Number of frames that the kernel or the queue dropped before this end read them.
    pub receive_lost: u64,
    /// Number of waits for a full queue.
    pub back_offs: u64,
    /// Number of things received that are no classic frame, such as bus error frames and unreadable lines.
    pub unreadable: u64,
}

/// One end of a CAN bus.
pub trait Bus: Send {
    /// Says that a tick begins. Only decorators use it.
    fn begin_tick(&mut self, _tick: u32) {}

    /// Queues a frame for sending. If the queue is full, it waits briefly and then counts the frame as lost; that is no error.
    ///
    /// # Errors
    /// The bus fails or is closed.
    fn send(&mut self, frame: &Frame) -> Result<(), BusError>;

    /// Sends a frame if there is room for it at once, and says whether there was. For frames that may be left out, and for which nothing may
    /// wait.
    ///
    /// # Errors
    /// The bus fails or is closed.
    fn offer(&mut self, frame: &Frame) -> Result<bool, BusError> {
        self.send(frame).map(|()| true)
    }

    /// The next frame, or `None` if none comes within `wait`.
    ///
    /// # Errors
    /// The bus fails or is closed.
    fn receive(&mut self, wait: Duration) -> Result<Option<Frame>, BusError>;

    /// Counters since the start.
    fn counters(&self) -> BusCounters;
}

impl<B: Bus + ?Sized> Bus for &mut B {
    fn begin_tick(&mut self, tick: u32) {
        (**self).begin_tick(tick);
    }

    fn send(&mut self, frame: &Frame) -> Result<(), BusError> {
        (**self).send(frame)
    }

    fn offer(&mut self, frame: &Frame) -> Result<bool, BusError> {
        (**self).offer(frame)
    }

    fn receive(&mut self, wait: Duration) -> Result<Option<Frame>, BusError> {
        (**self).receive(wait)
    }

    fn counters(&self) -> BusCounters {
        (**self).counters()
    }
}

impl<B: Bus + ?Sized> Bus for Box<B> {
    fn begin_tick(&mut self, tick: u32) {
        (**self).begin_tick(tick);
    }

    fn send(&mut self, frame: &Frame) -> Result<(), BusError> {
        (**self).send(frame)
    }

    fn offer(&mut self, frame: &Frame) -> Result<bool, BusError> {
        (**self).offer(frame)
    }

    fn receive(&mut self, wait: Duration) -> Result<Option<Frame>, BusError> {
        (**self).receive(wait)
    }

    fn counters(&self) -> BusCounters {
        (**self).counters()
    }
}
