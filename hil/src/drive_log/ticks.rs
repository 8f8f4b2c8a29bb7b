//! The tick of every displacement message, and with it the drives of a log.

use oleo_controller::can::DisplacementMessage;
use oleo_interface::tick::TICK_US;

use super::content::LogAccount;
use super::heard::{DISPLACEMENT, HeardFrame};

/// A frame may be this many ticks away from where the time of its line puts it.
const MOST_AWAY_TICKS: i64 = 20;
/// Silence that ends a drive, us. `PlantTick` wraps every 1.28 s, so the tick after a longer silence is not known.
const LONGEST_SILENCE_US: i64 = 1_000_000;
/// Most ticks by which a displacement message is behind the latest of its drive: the silence, and what a frame may be away.
pub const MOST_BEHIND_TICKS: i64 = LONGEST_SILENCE_US / TICK_US as i64 + MOST_AWAY_TICKS;
/// Number of displacement messages in sequence that begin a drive. A single one that does not fit is an accident.
const FRAMES_TO_BEGIN: usize = 6;
/// Most ticks from one of these messages to the next.
const MOST_APART_TICKS: i64 = 8;
/// Most frames that wait for such a sequence to become complete. Usually that takes three ticks.
const MOST_UNDECIDED: usize = 1 << 16;

/// A displacement message with its tick.
#[derive(Clone, Copy, Debug)]
pub struct Anchor {
    /// The message.
    pub frame: HeardFrame,
    /// Tick, counted on over the wraps of `PlantTick`.
    pub tick: i64,
}

/// A frame that belongs to a drive, in the order of the log.
#[derive(Clone, Copy, Debug)]
pub enum Sorted {
    /// A drive begins with the message that follows.
    Begins,
    /// A displacement message of the drive.
    Anchor(Anchor),
    /// A pressure message, a command, or a message of an inertial unit.
    Other(HeardFrame),
}

/// A frame that came since a displacement message that may begin another drive.
enum Undecided {
    /// One of the messages that may begin a drive.
    Beginning(Anchor),
    /// A displacement message of the drive before.
    Before(Anchor),
    Other(HeardFrame),
}

/// Sorts the frames of a log into drives.
#[derive(Default)]
pub struct Ticks {
    /// The message with the latest tick of the drive.
    latest: Option<Anchor>,
    /// Displacement messages that may begin another drive.
    beginning: Vec<Anchor>,
    /// All frames since the first of them.
    undecided: Vec<Undecided>,
}

impl Ticks {
    /// Takes the next frame of the log, and appends the frames whose drive is known now to `out`.
    pub fn take(&mut self, frame: HeardFrame, account: &mut LogAccount, out: &mut Vec<Sorted>) {
        if !DISPLACEMENT.contains(&frame.message) {
            if self.beginning.is_empty() {
                out.push(Sorted::Other(frame));
                return;
            }
            self.undecided.push(Undecided::Other(frame));
            if self.undecided.len() > MOST_UNDECIDED {
                self.none_begins(account, out);
            }
            return;
        }
        let low = i64::from(DisplacementMessage::decode(&frame.data).plant_tick);
        let frame = Anchor { frame, tick: low };
        if let Some(last) = &mut self.latest
            && let Some(anchor) = continued(last, frame)
        {
            if anchor.tick > last.tick {
                *last = anchor;
                self.none_begins(account, out);
                out.push(Sorted::Anchor(anchor));
            } else if self.beginning.is_empty() {
                out.push(Sorted::Anchor(anchor));
            } else {
                self.undecided.push(Undecided::Before(anchor));
            }
            return;
        }
        let next = self.beginning.last().and_then(|last| {
            let apart = signed_low_byte(low - last.tick);
            let silent = frame.frame.time_us.saturating_sub(last.frame.time_us).abs() > LONGEST_SILENCE_US;
            ((0..=MOST_APART_TICKS).contains(&apart) && !silent).then_some(Anchor {
                tick: last.tick + apart,
                ..frame
            })
        });
        if next.is_none() {
            self.none_begins(account, out);
        }
        let anchor = next.unwrap_or(frame);
        self.beginning.push(anchor);
        self.undecided.push(Undecided::Beginning(anchor));
        if self.beginning.len() >= FRAMES_TO_BEGIN {
            self.begin(out);
        }
    }

    /// The end of the log.
    pub fn end(&mut self, account: &mut LogAccount, out: &mut Vec<Sorted>) {
        self.none_begins(account, out);
    }

    /// What may have begun a drive did not: its displacement messages are of no drive, all else is of the drive before.
    fn none_begins(&mut self, account: &mut LogAccount, out: &mut Vec<Sorted>) {
        account.messages[DISPLACEMENT.start].out_of_sequence += self.beginning.len() as u64;
        self.beginning.clear();
        out.extend(self.undecided.drain(..).filter_map(|frame| match frame {
            Undecided::Beginning(_) => None,
            Undecided::Before(anchor) => Some(Sorted::Anchor(anchor)),
            Undecided::Other(frame) => Some(Sorted::Other(frame)),
        }));
    }

    /// A drive begins. Late displacement messages of the drive before are put before its first.
    fn begin(&mut self, out: &mut Vec<Sorted>) {
        self.latest = self.beginning.last().copied();
        self.beginning.clear();
        let before = |frame: &Undecided| match frame {
            Undecided::Before(anchor) => Some(Sorted::Anchor(*anchor)),
            _ => None,
        };
        out.extend(self.undecided.iter().filter_map(before));
        out.push(Sorted::Begins);
        out.extend(self.undecided.drain(..).filter_map(|frame| match frame {
            Undecided::Beginning(anchor) => Some(Sorted::Anchor(anchor)),
            Undecided::Before(_) => None,
            Undecided::Other(frame) => Some(Sorted::Other(frame)),
        }));
    }

    /// Number of frames that are held.
    #[cfg(test)]
    pub fn held(&self) -> usize {
        self.undecided.len()
    }
}

/// The message as one of the same drive, if its tick and its time agree.
fn continued(last: &Anchor, frame: Anchor) -> Option<Anchor> {
    let passed_us = frame.frame.time_us.saturating_sub(last.frame.time_us);
    if passed_us.abs() > LONGEST_SILENCE_US {
        return None;
    }
    let expected = last.tick + (passed_us as f64 / f64::from(TICK_US)).round() as i64;
    let away = signed_low_byte(frame.tick - expected);
    // A log whose times are useless (all the same) still has its order.
    let in_order = (0..=MOST_APART_TICKS).contains(&signed_low_byte(frame.tick - last.tick));
    let tick = if away.abs() <= MOST_AWAY_TICKS {
        expected + away
    } else if in_order && passed_us.abs() < i64::from(TICK_US) {
        last.tick + signed_low_byte(frame.tick - last.tick)
    } else {
        return None;
    };
    Some(Anchor { tick, ..frame })
}

/// The number from -128 to 127 that differs by a multiple of 256.
pub fn signed_low_byte(difference: i64) -> i64 {
    (difference + 128).rem_euclid(256) - 128
}
