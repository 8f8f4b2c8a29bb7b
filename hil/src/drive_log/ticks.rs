//! The tick of every displacement message, and with it the drives of a log.

use oleo_controller::can::DisplacementMessage;
use oleo_interface::tick::TICK_US;

use super::content::LogAccount;
use super::heard::{DISPLACEMENT, Heard};

/// A frame may be this many ticks away from where the time of its line puts it.
const MOST_AWAY_TICKS: i64 = 20;
/// Silence that ends a drive, us. `PlantTick` wraps every 1.28 s, so the tick after a longer silence is not known.
const LONGEST_SILENCE_US: i64 = 1_000_000;
/// Number of displacement messages in sequence that begin a drive. A single one that does not fit is an accident.
const FRAMES_TO_BEGIN: usize = 6;
/// Most ticks from one of these messages to the next.
const MOST_APART_TICKS: i64 = 8;

/// A displacement message with its tick.
#[derive(Clone, Copy, Debug)]
pub struct Anchor {
    /// Position among the heard frames.
    pub at: usize,
    /// Time of its line, us.
    pub time_us: i64,
    /// Tick, counted on over the wraps of `PlantTick`.
    pub tick: i64,
}

/// The displacement messages of one drive in the order of the log; at least [`FRAMES_TO_BEGIN`].
pub type Run = Vec<Anchor>;

/// Sorts the displacement messages into drives.
pub fn runs(heard: &Heard, account: &mut LogAccount) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    // The latest tick of the drive, and messages that may begin another.
    let mut latest: Option<Anchor> = None;
    let mut beginning: Run = Vec::new();
    let mut dropped = 0;
    for (at, frame) in heard.iter().enumerate() {
        if !DISPLACEMENT.contains(&frame.message) {
            continue;
        }
        let low = i64::from(DisplacementMessage::decode(&frame.data).plant_tick);
        let time_us = frame.time_us.min(i64::MAX as u64) as i64;
        let frame = Anchor { at, time_us, tick: low };
        if let (Some(last), Some(run)) = (&mut latest, runs.last_mut())
            && let Some(anchor) = continued(last, frame)
        {
            run.push(anchor);
            if anchor.tick > last.tick {
                *last = anchor;
                dropped += std::mem::take(&mut beginning).len();
            }
            continue;
        }
        let next = beginning.last().and_then(|last| {
            let apart = signed_low_byte(low - last.tick);
            let silent = (time_us.saturating_sub(last.time_us)).abs() > LONGEST_SILENCE_US;
            ((0..=MOST_APART_TICKS).contains(&apart) && !silent).then_some(Anchor {
                tick: last.tick + apart,
                ..frame
            })
        });
        if next.is_none() {
            dropped += std::mem::take(&mut beginning).len();
        }
        beginning.push(next.unwrap_or(frame));
        if beginning.len() >= FRAMES_TO_BEGIN {
            latest = beginning.last().copied();
            runs.push(std::mem::take(&mut beginning));
        }
    }
    dropped += beginning.len();
    account.messages[DISPLACEMENT.start].out_of_sequence += dropped as u64;
    runs
}

/// The message as one of the same drive, if its tick and its time agree.
fn continued(last: &Anchor, frame: Anchor) -> Option<Anchor> {
    let passed_us = frame.time_us.saturating_sub(last.time_us);
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
