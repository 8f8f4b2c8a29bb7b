//! A wait that ends, however many frames come during it.

use std::time::{Duration, Instant};

/// Number of frames that are waited for without a look at the clock: those of a tick and one more. So an undisturbed tick reads no clock.
const FREE: u32 = 8;
/// Most frames that are taken in one wait without a duration, which drains a queue: more than any queue holds.
const MOST_DRAINED: u32 = 4096;

/// The time that is left for a frame that may be followed by others.
#[derive(Debug)]
pub struct Deadline {
    wait: Duration,
    frames: u32,
    ends: Option<Instant>,
}

impl Deadline {
    /// A wait that ends after `wait`, counted from the frame from which on the clock is read. A wait of 0 drains what is there.
    pub fn new(wait: Duration) -> Self {
        Self {
            wait,
            frames: 0,
            ends: None,
        }
    }

    /// How long the next frame may be waited for; `None` if the time is over.
    pub fn left(&mut self) -> Option<Duration> {
        self.frames += 1;
        if self.wait.is_zero() {
            return (self.frames <= MOST_DRAINED).then_some(Duration::ZERO);
        }
        if self.frames <= FREE {
            return Some(self.wait);
        }
        let now = Instant::now();
        let ends = *self.ends.get_or_insert(now + self.wait);
        (now < ends).then(|| ends - now)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_although_frames_keep_coming() {
        let mut deadline = Deadline::new(Duration::from_millis(20));
        let started = Instant::now();
        while deadline.left().is_some() {
            std::thread::sleep(Duration::from_millis(1));
            assert!(started.elapsed() < Duration::from_secs(20), "hangs");
        }
        let mut drained = Deadline::new(Duration::ZERO);
        assert_eq!((0..10_000).filter(|_| drained.left().is_some()).count(), 4096);
    }
}
