//! A Linux CAN interface such as `vcan0` or `can0`, through SocketCAN.
//!
//! Three facts of SocketCAN determine this file. A slow reader loses frames *silently*, so the receive buffer is enlarged and the
//! kernel's drop counter (`SO_RXQ_OVFL`) is read with every frame. A full transmit queue is `ENOBUFS`, a hard error in most
//! libraries; here the sender waits, and a frame that still does not fit is counted as lost. A socket does not receive its own
//! frames but those of every other socket of the machine, so that two nodes in one process work like two processes.

use std::io::IoSliceMut;
use std::os::fd::{AsFd, AsRawFd};
use std::time::{Duration, Instant};

use nix::errno::Errno;
use nix::poll::{PollFd, PollFlags, PollTimeout, poll};
use nix::sys::socket::{ControlMessageOwned, MsgFlags, recvmsg, setsockopt, sockopt};
use socketcan::{CanFrame, CanSocket, EmbeddedFrame, Socket};

use super::{Bus, BusCounters, BusError};
use crate::Frame;
use crate::frame::{extended, standard};

/// Size of the receive buffer that is asked for, bytes: some 10,000 frames. Without the right to exceed it the kernel gives
/// `rmem_max`.
const RECEIVE_BUFFER: usize = 8 << 20;
/// Longest wait for a full transmit queue before a frame counts as lost.
const PATIENCE: Duration = Duration::from_millis(100);
const BACK_OFF: Duration = Duration::from_micros(100);

/// `struct can_frame` and the flags of its identifier (linux/can.h).
const CAN_FRAME_BYTES: usize = 16;
const EXTENDED_FLAG: u32 = 0x8000_0000;
const REMOTE_FLAG: u32 = 0x4000_0000;
const ERROR_FLAG: u32 = 0x2000_0000;

/// A raw CAN socket on one interface.
#[derive(Debug)]
pub struct SocketCan {
    socket: CanSocket,
    name: String,
    control: Vec<u8>,
    counters: BusCounters,
}

impl SocketCan {
    /// Opens an interface.
    ///
    /// # Errors
    /// There is no such interface, it is down or not CAN, or the kernel has no CAN. The message names the commands that help.
    pub fn open(interface: &str) -> Result<Self, BusError> {
        let bus = format!("socketcan:{interface}");
        let refused = |reason: String| BusError::Open {
            bus: bus.clone(),
            reason,
        };
        let socket = CanSocket::open(interface).map_err(|error| refused(advice(interface, &error)))?;
        if interface_is_down(interface) {
            return Err(refused(format!(
                "the interface is down: sudo ip link set {interface} up{}",
                for_real(interface)
            )));
        }
        let io = |source| BusError::Io {
            bus: bus.clone(),
            action: "setting up",
            source,
        };
        socket.set_nonblocking(true).map_err(io)?;
        // The full size is forced if that is allowed; otherwise the system grants less. Losses are counted either way.
        if setsockopt(&socket, sockopt::RcvBufForce, &RECEIVE_BUFFER).is_err() {
            let _ = setsockopt(&socket, sockopt::RcvBuf, &RECEIVE_BUFFER);
        }
        let _ = setsockopt(&socket, sockopt::RxqOvfl, &1);
        Ok(Self {
            socket,
            name: bus,
            control: nix::cmsg_space!(u32),
            counters: BusCounters::default(),
        })
    }

    fn io(&self, action: &'static str, errno: Errno) -> BusError {
        BusError::Io {
            bus: self.name.clone(),
            action,
            source: errno.into(),
        }
    }

    fn ready(&self, wait: Duration, events: PollFlags) -> Result<bool, BusError> {
        // Rounded up, so that a wait below a millisecond does not become a busy loop.
        let millis = wait.as_micros().div_ceil(1000);
        let timeout = PollTimeout::try_from(millis).unwrap_or(PollTimeout::MAX);
        match poll(&mut [PollFd::new(self.socket.as_fd(), events)], timeout) {
            Ok(ready) => Ok(ready > 0),
            Err(Errno::EINTR) => Ok(false),
            Err(errno) => Err(self.io("waiting for frames", errno)),
        }
    }

    /// Sends a frame, and waits at most so long for a full queue. Returns whether it was sent.
    fn write(&mut self, frame: &Frame, patience: Duration) -> Result<bool, BusError> {
        let whole = if frame.is_remote() {
            CanFrame::new_remote(frame.id(), frame.dlc())
        } else {
            CanFrame::new(frame.id(), frame.data())
        };
        let Some(whole) = whole else { return Ok(true) };
        let started = Instant::now();
        loop {
            let Err(error) = self.socket.write_frame(&whole) else {
                self.counters.sent += 1;
                return Ok(true);
            };
            match error.raw_os_error().map(Errno::from_raw) {
                Some(Errno::ENOBUFS | Errno::EAGAIN) if started.elapsed() < patience => {
                    self.counters.back_offs += 1;
                    std::thread::sleep(BACK_OFF);
                }
                Some(Errno::ENOBUFS | Errno::EAGAIN) => {
                    self.counters.send_lost += 1;
                    return Ok(false);
                }
                Some(Errno::EINTR) => {}
                _ => {
                    return Err(BusError::Io {
                        bus: self.name.clone(),
                        action: "sending",
                        source: error,
                    });
                }
            }
        }
    }

    /// A frame that has already arrived, if there is one.
    fn try_receive(&mut self) -> Result<Option<Frame>, BusError> {
        loop {
            let mut bytes = [0u8; CAN_FRAME_BYTES];
            let mut parts = [IoSliceMut::new(&mut bytes)];
            let descriptor = self.socket.as_raw_fd();
            let (length, dropped) =
                match recvmsg::<()>(descriptor, &mut parts, Some(&mut self.control), MsgFlags::MSG_DONTWAIT) {
                    Ok(message) => {
                        let dropped = message.cmsgs().ok().and_then(|mut controls| {
                            controls.find_map(|control| match control {
                                ControlMessageOwned::RxqOvfl(count) => Some(count),
                                _ => None,
                            })
                        });
                        (message.bytes, dropped)
                    }
                    Err(Errno::EAGAIN) => return Ok(None),
                    Err(Errno::EINTR) => continue,
                    Err(errno) => return Err(self.io("receiving", errno)),
                };
            if let Some(count) = dropped {
                self.counters.receive_lost = u64::from(count);
            }
            match (length == CAN_FRAME_BYTES).then(|| parse(&bytes)).flatten() {
                Some(frame) => {
                    self.counters.received += 1;
                    return Ok(Some(frame));
                }
                None => self.counters.unreadable += 1,
            }
        }
    }
}

impl Bus for SocketCan {
    fn send(&mut self, frame: &Frame) -> Result<(), BusError> {
        self.write(frame, PATIENCE).map(drop)
    }

    fn offer(&mut self, frame: &Frame) -> Result<bool, BusError> {
        self.write(frame, Duration::ZERO)
    }

    fn receive(&mut self, wait: Duration) -> Result<Option<Frame>, BusError> {
        if let Some(frame) = self.try_receive()? {
            return Ok(Some(frame));
        }
        if wait.is_zero() || !self.ready(wait, PollFlags::POLLIN)? {
            return Ok(None);
        }
        self.try_receive()
    }

    fn counters(&self) -> BusCounters {
        self.counters
    }
}

/// Reads a `struct can_frame`; `None` for a bus error frame or an impossible length.
fn parse(bytes: &[u8; CAN_FRAME_BYTES]) -> Option<Frame> {
    let [a, b, c, d, length, _, _, _, data @ ..] = bytes;
    let word = u32::from_ne_bytes([*a, *b, *c, *d]);
    let id: embedded_can::Id = if word & EXTENDED_FLAG != 0 {
        extended(word).into()
    } else {
        standard((word & 0x7FF) as u16).into()
    };
    match word {
        _ if word & ERROR_FLAG != 0 => None,
        _ if word & REMOTE_FLAG != 0 => Frame::remote(id, usize::from(*length)),
        _ => Frame::new(id, data.get(..usize::from(*length))?),
    }
}

/// Whether the interface lacks the flag IFF_UP in sysfs; `false` if sysfs cannot be read.
fn interface_is_down(interface: &str) -> bool {
    std::fs::read_to_string(format!("/sys/class/net/{interface}/flags"))
        .ok()
        .and_then(|text| u32::from_str_radix(text.trim().trim_start_matches("0x"), 16).ok())
        .is_some_and(|flags| flags & 1 == 0)
}

fn for_real(interface: &str) -> &'static str {
    if interface.starts_with("vcan") {
        ""
    } else {
        " type can bitrate 500000"
    }
}

/// What to do about an interface that does not open.
fn advice(interface: &str, error: &std::io::Error) -> String {
    let errno = error.raw_os_error().map(Errno::from_raw);
    let has_can = std::path::Path::new("/proc/net/can").exists();
    match errno {
        Some(Errno::EAFNOSUPPORT | Errno::EPROTONOSUPPORT) => no_can(),
        Some(Errno::ENODEV | Errno::ENXIO) if !has_can => format!("there is no such interface, and {}", no_can()),
        Some(Errno::ENODEV | Errno::ENXIO) if interface.starts_with("vcan") => format!(
            "there is no such interface: sudo modprobe vcan; sudo ip link add dev {interface} type vcan; \
             sudo ip link set {interface} up"
        ),
        Some(Errno::ENODEV | Errno::ENXIO) => format!(
            "there is no such interface: plug in the adapter (`ip link show type can` lists interfaces), then \
             sudo ip link set {interface} up type can bitrate 500000"
        ),
        Some(Errno::EPERM | Errno::EACCES) => "not permitted: run as a user who may open raw CAN sockets".into(),
        _ => format!("cannot be opened: {error}; is it a CAN interface?"),
    }
}

fn no_can() -> String {
    "this kernel has no CAN: sudo modprobe can-raw vcan, then sudo ip link add dev vcan0 type vcan; sudo ip link set vcan0 up; \
     where the kernel has no such modules, run the command under tests/harness/with-vcan.sh (User-Mode Linux)"
        .into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_interface_says_what_to_do() {
        let text = SocketCan::open("vcan97").unwrap_err().to_string();
        assert!(
            text.starts_with("socketcan:vcan97: ") && text.contains("ip link"),
            "{text}"
        );
        assert_eq!(text.lines().count(), 1);
    }

    #[test]
    fn kernel_frames_are_read() {
        let mut bytes = [0u8; CAN_FRAME_BYTES];
        bytes[..4].copy_from_slice(&(0x1FFF_01E0u32 | EXTENDED_FLAG).to_ne_bytes());
        bytes[4] = 2;
        bytes[8..10].copy_from_slice(&[7, 8]);
        let frame = parse(&bytes).unwrap();
        assert!(frame.is_extended() && frame.raw_id() == 0x1FFF_01E0 && frame.data() == [7, 8]);
        bytes[4] = 9;
        assert_eq!(parse(&bytes), None, "longer than a classic frame");
        bytes[..5].copy_from_slice(&[0, 0, 0, 0, 3]);
        bytes[..4].copy_from_slice(&(0x123 | REMOTE_FLAG).to_ne_bytes());
        assert!(parse(&bytes).unwrap().is_remote());
        bytes[..4].copy_from_slice(&ERROR_FLAG.to_ne_bytes());
        assert_eq!(parse(&bytes), None);
    }
}
