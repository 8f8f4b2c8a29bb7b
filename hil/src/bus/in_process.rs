//! A bus of two queues in memory. It is the default, and the reference for all others.
//!
//! It keeps the order of frames, loses none while its queues have room, and costs some 30 ns a frame. Both ends may be used in one
//! thread, in turns, or in two.

use std::time::Duration;

use crossbeam_channel::{Receiver, RecvTimeoutError, Sender, TryRecvError, TrySendError, bounded};

use super::{Bus, BusCounters, BusError};
use crate::Frame;

/// Number of frames that a queue holds: those of 20 ticks, which is more than any fault scenario delays.
const QUEUE_FRAMES: usize = 256;

/// One of the two ends of a bus in memory.
#[derive(Debug)]
pub struct InProcess {
    to_other: Sender<Frame>,
    from_other: Receiver<Frame>,
    counters: BusCounters,
}

/// The two ends of a new bus in memory.
pub fn in_process_pair() -> (InProcess, InProcess) {
    let (to_b, from_a) = bounded(QUEUE_FRAMES);
    let (to_a, from_b) = bounded(QUEUE_FRAMES);
    let end = |to_other, from_other| InProcess {
        to_other,
        from_other,
        counters: BusCounters::default(),
    };
    (end(to_b, from_b), end(to_a, from_a))
}

const NAME: &str = "inproc";

impl Bus for InProcess {
    fn send(&mut self, frame: &Frame) -> Result<(), BusError> {
        match self.to_other.try_send(*frame) {
            Ok(()) => self.counters.sent += 1,
            Err(TrySendError::Full(_)) => self.counters.send_lost += 1,
            Err(TrySendError::Disconnected(_)) => return Err(BusError::Closed { bus: NAME.into() }),
        }
        Ok(())
    }

    fn receive(&mut self, wait: Duration) -> Result<Option<Frame>, BusError> {
        let closed = || BusError::Closed { bus: NAME.into() };
        let frame = match self.from_other.try_recv() {
            Ok(frame) => frame,
            Err(TryRecvError::Disconnected) => return Err(closed()),
            Err(TryRecvError::Empty) if wait.is_zero() => return Ok(None),
            Err(TryRecvError::Empty) => match self.from_other.recv_timeout(wait) {
                Ok(frame) => frame,
                Err(RecvTimeoutError::Timeout) => return Ok(None),
                Err(RecvTimeoutError::Disconnected) => return Err(closed()),
            },
        };
        self.counters.received += 1;
        Ok(Some(frame))
    }

    fn counters(&self) -> BusCounters {
        self.counters
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::standard;

    #[test]
    fn order_is_kept_and_a_full_queue_is_counted() {
        let (mut a, mut b) = in_process_pair();
        for i in 0..QUEUE_FRAMES as u16 + 3 {
            a.send(&Frame::whole(standard(i), [i as u8; 8])).unwrap();
        }
        assert_eq!(a.counters().send_lost, 3);
        for i in 0..QUEUE_FRAMES as u16 {
            assert_eq!(b.receive(Duration::ZERO).unwrap().unwrap().raw_id(), u32::from(i));
        }
        assert_eq!(b.receive(Duration::ZERO).unwrap(), None);
        assert_eq!(
            a.receive(Duration::ZERO).unwrap(),
            None,
            "a sender does not hear itself"
        );
    }

    #[test]
    fn the_other_end_gone_is_told() {
        let (mut a, b) = in_process_pair();
        drop(b);
        assert!(matches!(
            a.send(&Frame::whole(standard(1), [0; 8])),
            Err(BusError::Closed { .. })
        ));
        assert!(matches!(
            a.receive(Duration::from_secs(9)),
            Err(BusError::Closed { .. })
        ));
    }
}
