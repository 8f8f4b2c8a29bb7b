//! The frames of one message that wait until their tick is settled by their counter.
//!
//! What a counter means for the tick is what it means for most of the frames before and after it: that stays the same while the sender
//! counts on in every tick. A frame is moved to the tick that its counter says, by up to half of the counter's period.

use std::collections::VecDeque;

use super::heard::HeardFrame;

/// Frames before and after a frame that tell how its counter goes with the tick.
const NEIGHBOURS: usize = 8;
/// Period of the counter, ticks.
const COUNTER_PERIOD: i64 = 16;
/// Most ticks by which a frame is moved.
pub const MOST_MOVED_TICKS: i64 = COUNTER_PERIOD / 2;
/// The tick of a frame that cannot be placed.
const NOWHERE: i64 = i64::MIN / 2;

/// A frame with the tick at which it was measured or, for a command, which it echoes.
#[derive(Clone, Copy, Debug)]
pub struct Placed {
    /// The frame.
    pub frame: HeardFrame,
    /// The tick.
    pub tick: i64,
}

impl Placed {
    /// What the counter lacks of the tick.
    fn offset(&self) -> i64 {
        (self.tick - self.frame.counter()).rem_euclid(COUNTER_PERIOD)
    }
}

/// Frames in the order of the log.
#[derive(Default)]
pub struct Queue {
    waiting: VecDeque<Placed>,
    /// Offsets of the last frames that were settled, as they were placed at first.
    before: VecDeque<i64>,
}

impl Queue {
    /// Appends a frame that its neighbours in the log put at a tick; `None` if they do not.
    pub fn push(&mut self, frame: HeardFrame, tick: Option<i64>) {
        let tick = tick.unwrap_or(NOWHERE);
        self.waiting.push_back(Placed { frame, tick });
    }

    /// The tick of the first frame that waits.
    pub fn first_tick(&self) -> Option<i64> {
        self.waiting.front().map(|placed| placed.tick)
    }

    /// Number of frames that wait.
    pub fn len(&self) -> usize {
        self.waiting.len()
    }

    /// Takes the first frame, at the tick that its counter says.
    pub fn settle(&mut self) -> Option<Placed> {
        let mut placed = self.waiting.pop_front()?;
        let offset = placed.offset();
        let behind = self.waiting.iter().take(NEIGHBOURS).map(Placed::offset);
        let mut votes = [0_usize; COUNTER_PERIOD as usize];
        for offset in self.before.iter().copied().chain([offset]).chain(behind) {
            votes[offset as usize] += 1;
        }
        let voters: usize = votes.iter().sum();
        if let Some((usual, count)) = (0..).zip(votes).max_by_key(|(_, count)| *count)
            && 2 * count > voters
            && placed.tick != NOWHERE
        {
            placed.tick += (usual - offset + MOST_MOVED_TICKS).rem_euclid(COUNTER_PERIOD) - MOST_MOVED_TICKS;
        }
        self.before.push_back(offset);
        if self.before.len() > NEIGHBOURS {
            self.before.pop_front();
        }
        Some(placed)
    }
}
