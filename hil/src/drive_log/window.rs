//! The samples of a drive that are not complete yet.
//!
//! ```text
//!     complete, given on  |  one frame or another may still come  |  latest tick
//!   ----------------------+----------------------+----------------+
//!                         |<-------- REACH ----->|<--- SETTLED -->|
//!                                                ^ frames up to here are at their final ticks
//! ```
//!
//! A drive of any length needs the memory of these samples only. A displacement message is never further behind the latest one than
//! `ticks` accepts, and no other frame is much further from a displacement message beside it, so that nothing can come for what was given on.

use std::collections::VecDeque;
use std::ops::ControlFlow;

use oleo_controller::can::{CommandMessage, DisplacementMessage, PressureMessage};
use oleo_interface::{Axle, Corner, Side};

use super::content::{DrivePart, DriveSink, LogAccount, LoggedSample};
use super::heard::{COMMAND_AT, DISPLACEMENT, HeardFrame, MESSAGES_OF_A_SAMPLE, UNIT};
use super::queue::{MOST_MOVED_TICKS, Queue};
use super::ticks::{Anchor, MOST_BEHIND_TICKS};
use crate::imu::{RATE_STEP_RAD_S, SPECIFIC_FORCE_STEP_M_S2, decode_axes};

/// Most ticks from a displacement message to another frame that it places. What is further outside a drive does not belong to it.
pub const MOST_OUTSIDE_TICKS: i64 = 20;
/// Ticks behind the latest one after which a frame's tick is settled by the neighbours that came until then: 20 s.
const SETTLED: i64 = 4096;
/// Ticks behind these for which a frame can still be settled, because another one was put further ahead and is in front of it.
const REACH: i64 = MOST_BEHIND_TICKS + 2 * (MOST_OUTSIDE_TICKS + MOST_MOVED_TICKS);
/// Most frames of a message that wait. In proper order they are as many as [`SETTLED`] and a few.
const MOST_WAITING: usize = 1 << 14;

/// What came for one tick.
#[derive(Clone, Copy, Default)]
struct Row {
    sample: LoggedSample,
    has: [bool; MESSAGES_OF_A_SAMPLE],
}

/// The end of a drive that is under way.
pub struct Window {
    rows: VecDeque<Row>,
    /// Tick of the first row.
    first: i64,
    /// Whether rows before the first were given on.
    is_begun: bool,
    messages: [OfMessage; MESSAGES_OF_A_SAMPLE],
}

/// What is known of the frames of one message.
struct OfMessage {
    queue: Queue,
    /// Latest tick for which there was a frame.
    latest: i64,
    /// Number of rows without a frame, up to the last that was given on.
    gap: u64,
}

impl Window {
    /// A drive that begins with this message.
    pub fn begin(anchor: &Anchor, sink: &mut DriveSink) -> ControlFlow<(), Self> {
        if sink(DrivePart::Begins(anchor.frame.time_us as f64 * 1e-6)).is_break() {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(Self {
            rows: VecDeque::from([Row::default()]),
            first: anchor.tick,
            is_begun: false,
            messages: std::array::from_fn(|_| OfMessage {
                queue: Queue::default(),
                latest: i64::MIN,
                gap: 0,
            }),
        })
    }

    /// The latest tick.
    fn last(&self) -> i64 {
        self.first + self.rows.len() as i64 - 1
    }

    /// A displacement message. What has become complete by it goes to `sink`.
    pub fn anchor(&mut self, anchor: &Anchor, account: &mut LogAccount, sink: &mut DriveSink) -> ControlFlow<()> {
        while anchor.tick < self.first && !self.is_begun {
            self.rows.push_front(Row::default());
            self.first -= 1;
        }
        while anchor.tick > self.last() {
            self.rows.push_back(Row::default());
        }
        self.enter(&anchor.frame, anchor.tick, account);
        let settled = self.last() - SETTLED;
        for message in 0..MESSAGES_OF_A_SAMPLE {
            while self.messages[message]
                .queue
                .first_tick()
                .is_some_and(|tick| tick <= settled)
            {
                self.settle(message, account);
            }
        }
        while self.first < settled - REACH {
            self.give_on(account, sink)?;
        }
        ControlFlow::Continue(())
    }

    /// A frame of another message, with the tick that its neighbours give it.
    pub fn place(&mut self, frame: HeardFrame, tick: Option<i64>, account: &mut LogAccount) {
        let queue = &mut self.messages[frame.message].queue;
        queue.push(frame, tick);
        if queue.len() > MOST_WAITING {
            self.settle(frame.message, account);
        }
    }

    /// The end of the drive: all samples go to `sink`.
    pub fn end(mut self, account: &mut LogAccount, sink: &mut DriveSink) -> ControlFlow<()> {
        for message in 0..MESSAGES_OF_A_SAMPLE {
            while self.messages[message].queue.len() > 0 {
                self.settle(message, account);
            }
        }
        while !self.rows.is_empty() {
            self.give_on(account, sink)?;
        }
        ControlFlow::Continue(())
    }

    /// Enters the first frame of a message that waits.
    fn settle(&mut self, message: usize, account: &mut LogAccount) {
        if let Some(placed) = self.messages[message].queue.settle() {
            self.enter(&placed.frame, placed.tick, account);
        }
    }

    /// Enters a frame into the sample of its tick, or counts it.
    fn enter(&mut self, frame: &HeardFrame, tick: i64, account: &mut LogAccount) {
        let message = &mut account.messages[frame.message];
        let place = usize::try_from(tick - self.first).ok();
        let Some(row) = place.and_then(|k| self.rows.get_mut(k)) else {
            message.out_of_sequence += 1;
            return;
        };
        let latest = &mut self.messages[frame.message].latest;
        message.late += u64::from(tick < *latest);
        *latest = tick.max(*latest);
        if std::mem::replace(&mut row.has[frame.message], true) {
            message.repeated += 1;
        } else if !row.sample.enter(frame) {
            message.corrupted += 1;
        }
    }

    /// Gives the first sample on.
    fn give_on(&mut self, account: &mut LogAccount, sink: &mut DriveSink) -> ControlFlow<()> {
        let Some(row) = self.rows.pop_front() else {
            return ControlFlow::Continue(());
        };
        self.first += 1;
        self.is_begun = true;
        for ((of_message, has), entry) in self.messages.iter_mut().zip(row.has).zip(&mut account.messages) {
            of_message.gap = if has { 0 } else { of_message.gap + 1 };
            entry.longest_gap_ticks = entry.longest_gap_ticks.max(of_message.gap);
            entry.lost += u64::from(!has);
        }
        sink(DrivePart::Sample(&row.sample))
    }

    /// Number of frames and samples that are held.
    #[cfg(test)]
    pub fn held(&self) -> usize {
        self.rows.len() + self.messages.iter().map(|message| message.queue.len()).sum::<usize>()
    }
}

impl LoggedSample {
    /// Enters the content of a frame; false if the content cannot be.
    fn enter(&mut self, frame: &HeardFrame) -> bool {
        let data = &frame.data;
        match frame.message {
            COMMAND_AT => match CommandMessage::decode(data) {
                Some(message) => self.command = Some(message.command),
                None => return false,
            },
            message if DISPLACEMENT.contains(&message) => {
                let content = DisplacementMessage::decode(data);
                let axle = Axle::ALL[message - DISPLACEMENT.start];
                self.displacement_m[axle.corner(Side::Left)] = content.left;
                self.displacement_m[axle.corner(Side::Right)] = content.right;
            }
            message if message == UNIT.start => {
                self.inertial.specific_force_m_s2 = decode_axes(data, SPECIFIC_FORCE_STEP_M_S2);
            }
            message if UNIT.contains(&message) => self.inertial.rate_rad_s = decode_axes(data, RATE_STEP_RAD_S),
            message => self.pressure_pa[Corner::ALL[message]] = PressureMessage::decode(data).pressure,
        }
        true
    }
}
