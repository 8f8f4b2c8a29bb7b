//! The tick of every pressure message, of every command, and of what an inertial unit says.

use std::collections::VecDeque;
use std::ops::ControlFlow;

use oleo_controller::can::CommandMessage;
use oleo_interface::tick::TICK_US;

use super::content::{DriveSink, LogAccount};
use super::heard::{COMMAND_AT, HeardFrame, UNIT};
use super::ticks::{Anchor, Sorted, signed_low_byte};
use super::window::{MOST_OUTSIDE_TICKS, Window};

/// Most frames that wait for a displacement message: those of more than a minute.
const MOST_WAITING: usize = 1 << 16;

/// Puts the frames of a log at their ticks, drive after drive.
#[derive(Default)]
pub struct Places {
    /// Pressure messages, and before the first drive commands, that wait for the displacement message behind them.
    waiting: VecDeque<HeardFrame>,
    drive: Option<Drive>,
}

/// The drive that is under way.
struct Drive {
    /// Its last displacement message in the order of the log.
    before: Anchor,
    window: Window,
}

impl Places {
    /// Takes the next frame of a drive. What is complete goes to `sink`.
    pub fn take(&mut self, frame: Sorted, account: &mut LogAccount, sink: &mut DriveSink) -> ControlFlow<()> {
        match (frame, &mut self.drive) {
            (Sorted::Begins, drive) => {
                if let Some(drive) = drive.take() {
                    drive.window.end(account, sink)?;
                }
            }
            (Sorted::Anchor(anchor), _) => self.anchor(anchor, account, sink)?,
            (Sorted::Other(frame), Some(drive)) if frame.message == COMMAND_AT => {
                drive.window.place(frame, echoed(&frame, &drive.before), account);
            }
            (Sorted::Other(frame), Some(drive)) if UNIT.contains(&frame.message) => {
                drive.window.place(frame, Some(behind(&frame, &drive.before)), account);
            }
            (Sorted::Other(frame), _) => {
                self.waiting.push_back(frame);
                if self.waiting.len() > MOST_WAITING
                    && let Some(frame) = self.waiting.pop_front()
                {
                    account.messages[frame.message].out_of_sequence += 1;
                }
            }
        }
        ControlFlow::Continue(())
    }

    fn anchor(&mut self, anchor: Anchor, account: &mut LogAccount, sink: &mut DriveSink) -> ControlFlow<()> {
        let drive = match &mut self.drive {
            Some(drive) => drive,
            none => {
                let window = Window::begin(&anchor, sink)?;
                none.insert(Drive { before: anchor, window })
            }
        };
        for frame in self.waiting.drain(..) {
            let tick = match frame.message {
                COMMAND_AT => echoed(&frame, &anchor),
                // What waits here was logged before the first displacements, and belongs to a tick before them.
                message if UNIT.contains(&message) => None,
                // Pressures go before the displacements of their tick.
                _ => Some(anchor.tick + ticks_between(&anchor, &frame).clamp(-MOST_OUTSIDE_TICKS, 0)),
            };
            drive.window.place(frame, tick, account);
        }
        drive.before = anchor;
        drive.window.anchor(&anchor, account, sink)
    }

    /// The end of the log. Pressures behind the last displacement message are placed by it.
    pub fn end(self, account: &mut LogAccount, sink: &mut DriveSink) -> ControlFlow<()> {
        let Some(mut drive) = self.drive else {
            return ControlFlow::Continue(());
        };
        for frame in self.waiting {
            let tick = drive.before.tick + ticks_between(&drive.before, &frame).max(1);
            drive.window.place(frame, Some(tick), account);
        }
        drive.window.end(account, sink)
    }

    /// Number of frames and samples that are held.
    #[cfg(test)]
    pub fn held(&self) -> usize {
        self.waiting.len() + self.drive.as_ref().map_or(0, |drive| drive.window.held())
    }
}

/// Ticks from a displacement message to a frame, by their times.
fn ticks_between(anchor: &Anchor, frame: &HeardFrame) -> i64 {
    let passed_us = frame.time_us.saturating_sub(anchor.frame.time_us);
    (passed_us as f64 / f64::from(TICK_US)).round() as i64
}

/// The tick of a frame that is sent behind the displacements of its tick.
fn behind(frame: &HeardFrame, near: &Anchor) -> i64 {
    near.tick + ticks_between(near, frame).clamp(0, MOST_OUTSIDE_TICKS)
}

/// The tick that a command echoes. A command answers what came before it.
fn echoed(frame: &HeardFrame, near: &Anchor) -> Option<i64> {
    CommandMessage::decode(&frame.data)
        .map(|command| signed_low_byte(i64::from(command.echo_tick) - near.tick))
        .filter(|away| away.abs() <= MOST_OUTSIDE_TICKS)
        .map(|away| near.tick + away)
}
