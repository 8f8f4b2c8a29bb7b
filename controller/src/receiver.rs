//! The receiver of one message: its content in this tick, its age, and whether it may be used.
//!
//! A sender sends one frame a tick. More than one means that somebody else sends under its identifier, and no check value says
//! which of them is right. So the frames of a tick are judged together: only a tick that brought what one sender sends brings
//! new data, and any other counts as wrong. A frame that was held up by the bus arrives together with the next one; so just after
//! a tick without a frame one more is accepted. Each tick that brings one frame as it should takes such an allowance back: a frame
//! that was lost long ago does not come any more, and somebody else's must not pass for it.

use crate::can::{CheckStatus, Contract, FRAME_BYTES, Period, Sequence, StateMachine};

/// What a tick's frames say together.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Gathered {
    frames: u8,
    worst: Period,
    /// The youngest frame that passed its check.
    data: Option<[u8; FRAME_BYTES]>,
}

impl Gathered {
    const NOTHING: Self = Self {
        frames: 0,
        worst: Period::Ok,
        data: None,
    };
}

/// What is known of one message. Its contract is the caller's, and the same in every call.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
// Whole words, which a small image clears and copies without a call.
#[repr(align(4))]
pub struct Receiver {
    sequence: Sequence,
    trust: StateMachine,
    trusted: bool,
    gathered: Gathered,
    /// Ticks for which the last new data are still remembered: all of them in their tick, 0 if there were none.
    memory: u8,
    /// Number of ticks without a frame for which a late one may still come.
    owed: u8,
}

impl Receiver {
    /// Has received nothing: the message is lost until its first usable frame.
    pub const INITIAL: Self = Self {
        sequence: Sequence::INITIAL,
        trust: StateMachine::new(),
        trusted: false,
        gathered: Gathered::NOTHING,
        memory: 0,
        owed: 0,
    };

    /// Takes a frame of this tick.
    pub fn receive(&mut self, contract: &Contract, data: &[u8; FRAME_BYTES]) -> CheckStatus {
        let status = self.sequence.check(contract, data);
        let gathered = &mut self.gathered;
        gathered.frames = gathered.frames.saturating_add(1);
        let period = match status {
            CheckStatus::Ok | CheckStatus::OkSomeLost => {
                gathered.data = Some(*data);
                Period::Ok
            }
            // In sequence again, but not yet for long enough to be used.
            CheckStatus::Sync => Period::Ok,
            CheckStatus::Repeated => Period::Repeated,
            CheckStatus::Initial | CheckStatus::WrongSequence => Period::WrongSequence,
            CheckStatus::WrongCrc => Period::Error,
        };
        if period > gathered.worst {
            gathered.worst = period;
        }
        status
    }

    /// Notes that the message or its sender is not to be trusted in this tick, for a reason that its frames do not show.
    pub fn distrust(&mut self) {
        self.gathered.worst = Period::Error;
    }

    /// What the message says in this tick, as far as its own frames tell.
    pub fn candidate(&self) -> Option<&[u8; FRAME_BYTES]> {
        if self.is_crowded() || self.gathered.worst == Period::Error {
            return None;
        }
        self.gathered.data.as_ref()
    }

    /// Ends the tick; returns the new data if there is any and the message is trusted.
    pub fn end_of_tick(&mut self, contract: &Contract) -> Option<[u8; FRAME_BYTES]> {
        let crowded = self.is_crowded();
        let Gathered { frames, worst, data } = core::mem::replace(&mut self.gathered, Gathered::NOTHING);
        let period = if crowded {
            Period::Error
        } else if frames == 0 && worst == Period::Ok {
            Period::NoNewData
        } else {
            worst
        };
        self.owed = match frames {
            0 => self.owed.saturating_add(1).min(contract.timeout_ticks),
            1 => self.owed.saturating_sub(1),
            more => self.owed.saturating_sub(more - 1),
        };
        if frames == 0 {
            self.sequence.no_new_data();
        }
        self.trusted = self.trust.step(period);
        let data = data.filter(|_| self.trusted && period != Period::Error);
        self.memory = if data.is_some() {
            u8::MAX
        } else {
            self.memory.saturating_sub(1)
        };
        data
    }

    /// Whether the last data of the message must not be used any more.
    pub fn is_lost(&self, contract: &Contract) -> bool {
        !self.trusted || self.age() >= contract.timeout_ticks
    }

    /// Number of ticks since the last new data; it saturates.
    pub fn age(&self) -> u8 {
        u8::MAX - self.memory
    }

    /// Whether more frames came than one sender sends.
    fn is_crowded(&self) -> bool {
        self.gathered.frames > self.owed.saturating_add(1)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::can::{PRESSURE, Protector};
    use crate::sensor_message::SensorMessage;
    use std::vec::Vec;

    const MESSAGE: Contract = PRESSURE.as_array()[0];

    /// A frame of another length is checked as if it were this one.
    #[test]
    fn a_frame_full_of_ones_has_a_wrong_crc_under_every_identifier() {
        for message in SensorMessage::ALL {
            let mut receiver = Receiver::INITIAL;
            assert_eq!(
                receiver.receive(message.contract(), &[0xFF; FRAME_BYTES]),
                CheckStatus::WrongCrc,
                "{message:?}"
            );
        }
    }

    fn sealed(count: usize) -> Vec<[u8; FRAME_BYTES]> {
        let mut protector = Protector::new(&MESSAGE);
        (0..count)
            .map(|n| {
                let mut data = [0, 0, n as u8, 0, 0, 0, 0, 0];
                protector.protect(&mut data);
                data
            })
            .collect()
    }

    /// A receiver that has had 32 good ticks, and the frames that follow.
    fn settled() -> (Receiver, Vec<[u8; FRAME_BYTES]>) {
        let (mut receiver, mut frames) = (Receiver::INITIAL, sealed(100));
        let rest = frames.split_off(32);
        for (n, frame) in frames.iter().enumerate() {
            receiver.receive(&MESSAGE, frame);
            assert_eq!(
                receiver.end_of_tick(&MESSAGE).is_some(),
                n > 0,
                "the first one is only compared with"
            );
        }
        (receiver, rest)
    }

    #[test]
    fn two_senders_are_never_believed_and_soon_not_trusted() {
        let (mut receiver, frames) = settled();
        for n in 0..3 {
            // One counter ahead of the right one, as an attacker would: the right frame is then called repeated.
            receiver.receive(&MESSAGE, &frames[n]);
            receiver.receive(&MESSAGE, &frames[n + 1]);
            assert_eq!(receiver.candidate(), None);
            assert_eq!(receiver.end_of_tick(&MESSAGE), None);
            assert_eq!(receiver.is_lost(&MESSAGE), n == 2, "tick {n}");
        }
    }

    #[test]
    fn a_late_frame_may_come_with_the_next_but_not_twice() {
        let (mut receiver, frames) = settled();
        assert_eq!(receiver.end_of_tick(&MESSAGE), None);
        receiver.receive(&MESSAGE, &frames[0]);
        receiver.receive(&MESSAGE, &frames[1]);
        assert_eq!(receiver.end_of_tick(&MESSAGE), Some(frames[1]), "the younger one");
        receiver.receive(&MESSAGE, &frames[2]);
        receiver.receive(&MESSAGE, &frames[3]);
        assert_eq!(receiver.end_of_tick(&MESSAGE), None, "nothing was late");
    }

    #[test]
    fn a_frame_that_was_lost_is_no_allowance_for_somebody_else_s() {
        for lost in 1..=2 {
            let (mut receiver, frames) = settled();
            let mut frames = frames[lost..].iter();
            for _ in 0..lost {
                assert_eq!(receiver.end_of_tick(&MESSAGE), None);
            }
            for _ in 0..lost {
                receiver.receive(&MESSAGE, frames.next().unwrap());
                assert!(receiver.end_of_tick(&MESSAGE).is_some());
            }
            receiver.receive(&MESSAGE, frames.next().unwrap());
            receiver.receive(&MESSAGE, frames.next().unwrap());
            assert_eq!(receiver.end_of_tick(&MESSAGE), None, "{lost} lost");
        }
    }

    /// After a tick without a frame two may come. What the graver one says counts for both.
    #[test]
    fn the_worst_frame_of_a_tick_decides() {
        for wrong_first in [false, true] {
            let (mut receiver, frames) = settled();
            receiver.end_of_tick(&MESSAGE);
            let mut wrong = frames[1];
            wrong[5] ^= 1;
            for wrong_now in [wrong_first, !wrong_first] {
                receiver.receive(&MESSAGE, if wrong_now { &wrong } else { &frames[1] });
            }
            assert_eq!(receiver.candidate(), None);
            assert_eq!(receiver.end_of_tick(&MESSAGE), None);
            // A repeated frame is no reason against the one that it repeats.
            receiver.receive(&MESSAGE, &frames[2]);
            assert_eq!(receiver.candidate(), Some(&frames[2]));
            assert_eq!(receiver.end_of_tick(&MESSAGE), Some(frames[2]));
            receiver.end_of_tick(&MESSAGE);
            receiver.receive(&MESSAGE, &frames[4]);
            receiver.receive(&MESSAGE, &frames[4]);
            assert_eq!(receiver.end_of_tick(&MESSAGE), Some(frames[4]));
        }
    }

    #[test]
    fn distrust_without_a_frame_is_a_wrong_tick_and_not_an_empty_one() {
        let (mut receiver, _) = settled();
        for n in 1..=3 {
            receiver.distrust();
            assert_eq!(receiver.end_of_tick(&MESSAGE), None);
            assert_eq!((receiver.is_lost(&MESSAGE), receiver.age()), (n == 3, n));
        }
    }

    #[test]
    fn a_frame_after_silence_continues_the_sequence() {
        // Up to three silent ticks: the counter is so many further, and the frame is used at once.
        for silent in 0..=3 {
            let (mut receiver, frames) = settled();
            for n in 1..=silent {
                receiver.end_of_tick(&MESSAGE);
                assert_eq!(usize::from(receiver.age()), n);
            }
            receiver.receive(&MESSAGE, &frames[silent]);
            assert_eq!(receiver.end_of_tick(&MESSAGE), Some(frames[silent]), "{silent} silent");
            assert_eq!((receiver.age(), receiver.is_lost(&MESSAGE)), (0, false));
        }
        // Without silence as many lost ones are a wrong sequence from the third on.
        for lost in 0..5 {
            let (mut receiver, frames) = settled();
            receiver.receive(&MESSAGE, &frames[lost]);
            assert_eq!(receiver.end_of_tick(&MESSAGE).is_some(), lost < 3, "{lost} lost");
        }
    }

    #[test]
    fn silence_is_bridged_for_three_ticks() {
        let (mut receiver, frames) = settled();
        let lost: Vec<bool> = (0..5)
            .map(|_| {
                receiver.end_of_tick(&MESSAGE);
                receiver.is_lost(&MESSAGE)
            })
            .collect();
        assert_eq!(lost, [false, false, false, true, true]);
        assert!(frames.len() > 60);
    }

    #[test]
    fn distrust_counts_as_a_wrong_tick() {
        let (mut receiver, frames) = settled();
        for frame in &frames[..3] {
            receiver.receive(&MESSAGE, frame);
            receiver.distrust();
            assert_eq!(receiver.end_of_tick(&MESSAGE), None);
        }
        assert!(receiver.is_lost(&MESSAGE));
        for (n, frame) in frames[3..19].iter().enumerate() {
            receiver.receive(&MESSAGE, frame);
            assert_eq!(
                receiver.end_of_tick(&MESSAGE).is_some(),
                n == 15,
                "trusted again after sixteen clean ticks"
            );
        }
    }

    /// Three late frames may come in three ticks.
    #[test]
    fn late_frames_may_come_one_after_the_other() {
        let (mut receiver, frames) = settled();
        for _ in 0..3 {
            receiver.end_of_tick(&MESSAGE);
        }
        for late in frames[..6].chunks(2) {
            receiver.receive(&MESSAGE, &late[0]);
            receiver.receive(&MESSAGE, &late[1]);
            assert_eq!(receiver.end_of_tick(&MESSAGE), Some(late[1]));
        }
        receiver.receive(&MESSAGE, &frames[6]);
        receiver.receive(&MESSAGE, &frames[7]);
        assert_eq!(receiver.end_of_tick(&MESSAGE), None);
    }
}
