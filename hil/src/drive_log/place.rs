//! The tick of every pressure message and command, and the samples of a drive.

use oleo_controller::can::{CommandMessage, DisplacementMessage, PressureMessage};
use oleo_interface::tick::TICK_US;
use oleo_interface::{Axle, Corner, Side};

use super::content::{LogAccount, LoggedDrive, LoggedSample};
use super::heard::{COMMAND_AT, DISPLACEMENT, Heard, HeardFrame, MESSAGES_OF_A_SAMPLE};
use super::ticks::{Run, signed_low_byte};

/// Frames before and after a frame that tell how its counter goes with the tick.
const NEIGHBOURS: usize = 8;
/// Period of the counter, ticks.
const COUNTER_PERIOD: i64 = 16;
/// A frame this far outside a drive does not belong to it, ticks.
const MOST_OUTSIDE_TICKS: i64 = 20;

/// A frame with the tick at which it was measured or, for a command, which it echoes.
#[derive(Clone, Copy, Debug)]
struct Placed {
    at: usize,
    tick: i64,
}

/// The samples of every drive.
pub fn drives(heard: &Heard, runs: &[Run], account: &mut LogAccount) -> Vec<LoggedDrive> {
    (runs.iter().enumerate())
        .map(|(k, run)| {
            let before = k.checked_sub(1).and_then(|k| runs.get(k)).map(|run| last_at(run) + 1);
            let after = runs.get(k + 1).map(first_at);
            drive(heard, run, Share { before, after }, account)
        })
        .collect()
}

/// The frames of the log that may belong to a drive. Of those between two drives, pressures belong to the later one and commands to
/// the earlier one.
#[derive(Clone, Copy, Debug)]
struct Share {
    /// First frame after the drive before, if there is one.
    before: Option<usize>,
    /// First displacement message of the drive after, if there is one.
    after: Option<usize>,
}

fn first_at(run: &Run) -> usize {
    run.iter().map(|a| a.at).min().unwrap_or(0)
}

fn last_at(run: &Run) -> usize {
    run.iter().map(|a| a.at).max().unwrap_or(0)
}

fn drive(heard: &Heard, run: &Run, share: Share, account: &mut LogAccount) -> LoggedDrive {
    let (first, last) = run.iter().fold((i64::MAX, i64::MIN), |(low, high), anchor| {
        (low.min(anchor.tick), high.max(anchor.tick))
    });
    let count = (last - first + 1) as usize;
    let mut samples = vec![LoggedSample::default(); count];
    let mut has = vec![[false; MESSAGES_OF_A_SAMPLE]; count];
    for (message, mut placed) in coarsely_placed(heard, run, share).into_iter().enumerate() {
        if !DISPLACEMENT.contains(&message) {
            correct_by_counter(heard, &mut placed);
        }
        let entry = &mut account.messages[message];
        let mut latest = i64::MIN;
        for Placed { at, tick } in placed {
            let Some(sample) = usize::try_from(tick - first).ok().filter(|k| *k < count) else {
                entry.out_of_sequence += 1;
                continue;
            };
            entry.late += u64::from(tick < latest);
            latest = latest.max(tick);
            if std::mem::replace(&mut has[sample][message], true) {
                entry.repeated += 1;
            } else if !enter(&heard[at], &mut samples[sample]) {
                entry.corrupted += 1;
            }
        }
        let (mut gap, mut longest) = (0, 0);
        for has in &has {
            gap = if has[message] { 0 } else { gap + 1 };
            longest = longest.max(gap);
            entry.lost += u64::from(!has[message]);
        }
        entry.longest_gap_ticks = entry.longest_gap_ticks.max(longest);
    }
    LoggedDrive {
        begins_s: run.first().map_or(0.0, |anchor| anchor.time_us as f64 * 1e-6),
        samples,
    }
}

/// Every frame at the tick that its neighbours in the log give it, message by message.
fn coarsely_placed(heard: &Heard, run: &Run, share: Share) -> [Vec<Placed>; MESSAGES_OF_A_SAMPLE] {
    let mut placed: [Vec<Placed>; MESSAGES_OF_A_SAMPLE] = std::array::from_fn(|_| Vec::new());
    for anchor in run {
        placed[heard[anchor.at].message].push(Placed {
            at: anchor.at,
            tick: anchor.tick,
        });
    }
    // The displacement messages lie in the order of the log, so that one walk along both finds the neighbours.
    let mut next = 0;
    let own = share.before.unwrap_or(0)..share.after.unwrap_or(heard.len());
    for (at, frame) in heard.iter().enumerate().take(own.end).skip(own.start) {
        while run.get(next).is_some_and(|anchor| anchor.at < at) {
            next += 1;
        }
        let time_us = frame.time_us.min(i64::MAX as u64) as i64;
        let ticks_from = |other_us: i64| (time_us.saturating_sub(other_us) as f64 / f64::from(TICK_US)).round() as i64;
        let before = next.checked_sub(1).and_then(|k| run.get(k));
        let of_another_drive = match frame.message {
            COMMAND_AT => before.is_none() && share.before.is_some(),
            _ => run.get(next).is_none() && share.after.is_some(),
        };
        if of_another_drive {
            continue;
        }
        let tick = match frame.message {
            COMMAND_AT => {
                // A command answers what came before it.
                let Some(near) = before.or(run.first()) else { continue };
                CommandMessage::decode(&frame.data)
                    .map(|command| signed_low_byte(i64::from(command.echo_tick) - near.tick))
                    .filter(|away| away.abs() <= MOST_OUTSIDE_TICKS)
                    .map(|away| near.tick + away)
            }
            message if DISPLACEMENT.contains(&message) => continue,
            // Pressures go before the displacements of their tick.
            _ => match (run.get(next), before) {
                (Some(after), _) => Some(after.tick + ticks_from(after.time_us).clamp(-MOST_OUTSIDE_TICKS, 0)),
                (None, Some(before)) => Some(before.tick + ticks_from(before.time_us).max(1)),
                (None, None) => None,
            },
        };
        // What cannot be placed is counted as outside the drive.
        placed[frame.message].push(Placed {
            at,
            tick: tick.unwrap_or(i64::MIN / 2),
        });
    }
    placed
}

/// Moves each frame to the tick that its counter says, by up to half of the counter's period. What a counter means for the tick is
/// what it means for most of the neighbours: it stays the same while the sender counts on in every tick.
fn correct_by_counter(heard: &Heard, placed: &mut [Placed]) {
    let offsets: Vec<i64> = (placed.iter())
        .map(|p| (p.tick - heard[p.at].counter()).rem_euclid(COUNTER_PERIOD))
        .collect();
    for (k, p) in placed.iter_mut().enumerate() {
        let around = &offsets[k.saturating_sub(NEIGHBOURS)..(k + NEIGHBOURS + 1).min(offsets.len())];
        let mut votes = [0_usize; COUNTER_PERIOD as usize];
        for offset in around {
            votes[*offset as usize] += 1;
        }
        let Some((usual, count)) = (0..).zip(votes).max_by_key(|(_, count)| *count) else {
            continue;
        };
        if 2 * count > around.len() && p.tick > i64::MIN / 4 {
            let away = (usual - offsets[k] + COUNTER_PERIOD / 2).rem_euclid(COUNTER_PERIOD) - COUNTER_PERIOD / 2;
            p.tick += away;
        }
    }
}

/// Enters the content of a frame into the sample of its tick; false if the content cannot be.
fn enter(frame: &HeardFrame, sample: &mut LoggedSample) -> bool {
    let data = &frame.data;
    match frame.message {
        COMMAND_AT => match CommandMessage::decode(data) {
            Some(message) => sample.command = Some(message.command),
            None => return false,
        },
        message if DISPLACEMENT.contains(&message) => {
            let content = DisplacementMessage::decode(data);
            let axle = Axle::ALL[message - DISPLACEMENT.start];
            sample.displacement_m[axle.corner(Side::Left)] = content.left;
            sample.displacement_m[axle.corner(Side::Right)] = content.right;
        }
        message => sample.pressure_pa[Corner::ALL[message]] = PressureMessage::decode(data).pressure,
    }
    true
}
