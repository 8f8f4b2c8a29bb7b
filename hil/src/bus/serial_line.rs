//! CAN over a serial line with the [`slcan`](super::slcan) protocol: an adapter at `/dev/ttyACM0`, a pseudo-terminal
//! of an emulated board, or a TCP port.
//!
//! A device is put into raw mode and told to open its channel at 500 kbit/s (`C`, `S6`, `O`). Two `oleo` nodes may also
//! talk directly over such a line; each ignores the other's adapter commands.

use std::fs::OpenOptions;
use std::net::TcpStream;
use std::os::fd::{AsFd, OwnedFd};
use std::os::unix::fs::OpenOptionsExt;
use std::time::{Duration, Instant};

use nix::errno::Errno;
use nix::fcntl::OFlag;
use nix::poll::{PollFd, PollFlags, PollTimeout, poll};
use nix::sys::termios::{self, BaudRate, SetArg};

use super::slcan::{Decoder, encode};
use super::{Bus, BusCounters, BusError};
use crate::Frame;

/// Rate of the line. Seven frames each 5 ms are 0.3 Mbit/s of text. USB adapters ignore the rate, a UART needs it.
const BAUD: BaudRate = BaudRate::B1000000;
/// Longest wait for a full line before a frame counts as lost.
const PATIENCE: Duration = Duration::from_millis(100);
const OPEN_CHANNEL: &[u8] = b"\rC\rS6\rO\r";
const CLOSE_CHANNEL: &[u8] = b"C\r";

/// A serial line with an adapter or another node at its end.
#[derive(Debug)]
pub struct SerialLine {
    line: OwnedFd,
    name: String,
    decoder: Decoder,
    bytes: [u8; 512],
    next: usize,
    filled: usize,
    counters: BusCounters,
}

impl SerialLine {
    /// Opens a device or pseudo-terminal by its path, or `tcp:HOST:PORT`.
    ///
    /// # Errors
    /// No such device or port, or no right to use it.
    pub fn open(path: &str) -> Result<Self, BusError> {
        let bus = format!("slcan:{path}");
        let refused = |reason: String| BusError::Open {
            bus: bus.clone(),
            reason,
        };
        let line: OwnedFd = if let Some(address) = path.strip_prefix("tcp:") {
            let stream = TcpStream::connect(address)
                .map_err(|e| refused(format!("cannot connect: {e}; is the other end listening at {address}?")))?;
            // Frames are small and the other end waits for them, so they are not collected.
            let _ = stream.set_nodelay(true);
            stream.set_nonblocking(true).map_err(|e| refused(e.to_string()))?;
            stream.into()
        } else {
            let flags = (OFlag::O_NOCTTY | OFlag::O_NONBLOCK).bits();
            let file = OpenOptions::new()
                .read(true)
                .write(true)
                .custom_flags(flags)
                .open(path)
                .map_err(|e| {
                    refused(format!(
                        "cannot open the serial device: {e}; check its name and your membership of group dialout"
                    ))
                })?;
            let mut settings = termios::tcgetattr(&file).map_err(|_| {
                refused("is not a serial device: give a tty, a pseudo-terminal or tcp:HOST:PORT".into())
            })?;
            termios::cfmakeraw(&mut settings);
            // A pseudo-terminal has no rate, and some adapters refuse one they do not need.
            let _ = termios::cfsetspeed(&mut settings, BAUD);
            termios::tcsetattr(&file, SetArg::TCSANOW, &settings)
                .map_err(|e| refused(format!("cannot set the line to raw mode: {e}")))?;
            file.into()
        };
        let mut opened = Self::over(line, bus);
        opened.write(OPEN_CHANNEL)?;
        Ok(opened)
    }

    /// Over a line that is open already and does not block, with the name by which errors speak of it. The other end is told
    /// nothing.
    pub(crate) fn over(line: OwnedFd, name: String) -> Self {
        Self {
            line,
            name,
            decoder: Decoder::default(),
            bytes: [0; 512],
            next: 0,
            filled: 0,
            counters: BusCounters::default(),
        }
    }

    fn io(&self, action: &'static str, errno: Errno) -> BusError {
        match errno {
            Errno::EIO | Errno::EPIPE | Errno::ECONNRESET => BusError::Closed { bus: self.name.clone() },
            _ => BusError::Io {
                bus: self.name.clone(),
                action,
                source: errno.into(),
            },
        }
    }

    fn ready(&self, wait: Duration, events: PollFlags) -> Result<bool, BusError> {
        let millis = wait.as_micros().div_ceil(1000);
        let timeout = PollTimeout::try_from(millis).unwrap_or(PollTimeout::MAX);
        match poll(&mut [PollFd::new(self.line.as_fd(), events)], timeout) {
            Ok(ready) => Ok(ready > 0),
            Err(Errno::EINTR) => Ok(false),
            Err(errno) => Err(self.io("waiting", errno)),
        }
    }

    /// Writes a whole line or nothing of it. Returns `false` if there was no room for too long.
    fn write(&mut self, text: &[u8]) -> Result<bool, BusError> {
        let started = Instant::now();
        let mut rest = text;
        while !rest.is_empty() {
            match nix::unistd::write(&self.line, rest) {
                Ok(written) => rest = rest.get(written..).unwrap_or(&[]),
                Err(Errno::EINTR) => {}
                Err(Errno::EAGAIN) => {
                    self.counters.back_offs += 1;
                    if started.elapsed() > PATIENCE && rest.len() == text.len() {
                        return Ok(false);
                    }
                    // Half a line is useless, so a line that was begun is finished, unless the other end is gone.
                    if started.elapsed() > 50 * PATIENCE {
                        return Err(BusError::Closed { bus: self.name.clone() });
                    }
                    self.ready(PATIENCE, PollFlags::POLLOUT)?;
                }
                Err(errno) => return Err(self.io("sending", errno)),
            }
        }
        Ok(true)
    }

    /// A frame from what has been read. When that is used up, it reads once more.
    fn try_receive(&mut self) -> Result<Option<Frame>, BusError> {
        loop {
            while self.next < self.filled {
                let byte = self.bytes.get(self.next).copied().unwrap_or(b'\r');
                self.next += 1;
                if let Some(frame) = self.decoder.push(byte) {
                    self.counters.received += 1;
                    return Ok(Some(frame));
                }
            }
            match nix::unistd::read(&self.line, &mut self.bytes) {
                Ok(0) => return Err(BusError::Closed { bus: self.name.clone() }),
                Ok(count) => (self.next, self.filled) = (0, count),
                Err(Errno::EAGAIN) => return Ok(None),
                Err(Errno::EINTR) => {}
                Err(errno) => return Err(self.io("receiving", errno)),
            }
        }
    }
}

impl Bus for SerialLine {
    fn send(&mut self, frame: &Frame) -> Result<(), BusError> {
        if self.write(encode(frame).as_bytes())? {
            self.counters.sent += 1;
        } else {
            self.counters.send_lost += 1;
        }
        Ok(())
    }

    fn offer(&mut self, frame: &Frame) -> Result<bool, BusError> {
        // A line that has begun is finished, so all that can be asked is whether the other end takes bytes at all.
        if self.ready(Duration::ZERO, PollFlags::POLLOUT)? {
            self.send(frame).map(|()| true)
        } else {
            self.counters.send_lost += 1;
            Ok(false)
        }
    }

    fn receive(&mut self, wait: Duration) -> Result<Option<Frame>, BusError> {
        let deadline = Instant::now() + wait;
        loop {
            if let Some(frame) = self.try_receive()? {
                return Ok(Some(frame));
            }
            // What came may be only part of a line.
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() || !self.ready(left, PollFlags::POLLIN)? {
                return Ok(None);
            }
        }
    }

    fn counters(&self) -> BusCounters {
        BusCounters {
            unreadable: self.decoder.unreadable(),
            ..self.counters
        }
    }
}

impl Drop for SerialLine {
    fn drop(&mut self) {
        let _ = nix::unistd::write(&self.line, CLOSE_CHANNEL);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::standard;
    use std::io::{Read, Write};
    use std::net::TcpListener;

    #[test]
    fn frames_go_both_ways_over_tcp_in_any_pieces() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap();
        let mut bus = SerialLine::open(&format!("tcp:{address}")).unwrap();
        let (mut adapter, _) = listener.accept().unwrap();
        let frame = Frame::whole(standard(0x0A0), [1, 2, 3, 4, 5, 6, 7, 8]);
        bus.send(&frame).unwrap();
        let mut seen = vec![0; OPEN_CHANNEL.len() + 22];
        adapter.read_exact(&mut seen).unwrap();
        assert!(seen.ends_with(b"t0A080102030405060708\r"));
        adapter.write_all(b"z\rt0A0801020304").unwrap();
        assert_eq!(bus.receive(Duration::from_millis(5)).unwrap(), None);
        adapter.write_all(b"05060708\r").unwrap();
        assert_eq!(bus.receive(Duration::from_secs(5)).unwrap(), Some(frame));
        drop(adapter);
        let gone = (0..100).find_map(|_| bus.receive(Duration::from_millis(50)).err());
        assert!(matches!(gone, Some(BusError::Closed { .. })));
    }

    #[test]
    fn two_nodes_over_a_pseudo_terminal() {
        let pty = nix::pty::openpty(None, None).unwrap();
        let path = nix::unistd::ttyname(&pty.slave).unwrap();
        let mut bus = SerialLine::open(path.to_str().unwrap()).unwrap();
        let frame = Frame::whole(standard(0x115), [9; 8]);
        nix::unistd::write(&pty.master, encode(&frame).as_bytes()).unwrap();
        assert_eq!(bus.receive(Duration::from_secs(5)).unwrap(), Some(frame));
    }

    #[test]
    fn what_cannot_be_opened_says_so() {
        for path in ["/nonexistent/tty", "/dev/null", "tcp:127.0.0.1:1"] {
            let text = SerialLine::open(path).unwrap_err().to_string();
            assert!(text.starts_with("slcan:") && text.lines().count() == 1, "{text}");
        }
    }
}
