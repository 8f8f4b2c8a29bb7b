//! What somebody on the bus can do who has listened: say again what was said, or forge what comes next.
//!
//! The CRC of the end-to-end protection has public numbers, so that anybody can compute it: it finds errors and no attackers.

use std::collections::VecDeque;

use oleo_controller::can::{FRAME_BYTES, MESSAGES, Protector};

use crate::Frame;
use crate::frame::standard;

/// What an attacker has listened to.
#[derive(Debug, Default)]
pub(super) struct Recorder {
    /// Frames of the last ticks, with their ticks.
    heard: VecDeque<(u32, Frame)>,
}

impl Recorder {
    /// Keeps a frame, and gives the one that was heard under the same identifier `age` ticks before.
    pub fn replay(&mut self, tick: u32, age: u16, frame: &Frame) -> Option<Frame> {
        while self
            .heard
            .front()
            .is_some_and(|(then, _)| then.saturating_add(u32::from(age)) < tick)
        {
            self.heard.pop_front();
        }
        self.heard.push_back((tick, *frame));
        let wanted = tick.checked_sub(u32::from(age))?;
        let same = |(then, old): &&(u32, Frame)| *then == wanted && old.standard_id() == frame.standard_id();
        self.heard.iter().find(same).map(|(_, old)| *old)
    }

    /// The first content that was heard under the frame's identifier, protected as the frame's successor; `None` for the first one.
    pub fn forge(&mut self, tick: u32, frame: &Frame) -> Option<Frame> {
        let id = frame.standard_id()?;
        let Some((_, first)) = self.heard.iter().find(|(_, heard)| heard.standard_id() == Some(id)) else {
            self.heard.push_back((tick, *frame));
            return None;
        };
        let contract = MESSAGES.iter().find(|message| message.id == id)?;
        let counter = |data: &[u8]| data.get(1).map(|header| header & 0x0F);
        let ahead = (counter(frame.data())? + 1) & 0x0F;
        let mut data = <[u8; FRAME_BYTES]>::try_from(first.data()).ok()?;
        let mut protector = Protector::new(contract);
        // The sender's counter begins anywhere; one of sixteen frames has the wanted one.
        for _ in 0..16 {
            protector.protect(&mut data);
            if counter(&data) == Some(ahead) {
                break;
            }
        }
        Some(Frame::whole(standard(id), data))
    }
}
