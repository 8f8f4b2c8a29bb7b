//! Measures the age of the readings that arrive over the bus.
//!
//! A frame that is right may still be old: a gateway holds frames back, or somebody plays a recording. Counters do not show
//! that, because old frames are in sequence too. So each command carries a number, the *challenge*, that looks drawn at random,
//! and the displacement messages carry the last challenge that their sender has heard. What was sent in tick `k` is answered in
//! tick `k + 1`; where both ways together take `d` ticks longer, the answer is `1 + d` ticks old. That needs no common clock, and
//! no trust in the sender's. A recording answers challenges of its own time: one of 256 fits by chance, sixteen in a row do not.
//!
//! | what is required of the messages of a tick | what it finds |
//! |---|---|
//! | the answer is 1 to 3 ticks old | readings, or commands on their way to the sensors, that are more than 2 ticks late; a recording |
//! | the plant's tick advances with the message's counter | a sender whose sampling has stopped |
//! | front and rear agree on the plant's tick to 2 ticks | two senders with different pasts |
//! | the counters of the pressure messages are in step with those of the displacements to 2 ticks | one message that is late |
//!
//! A pressure message has no room for an answer: one that is late by a multiple of 16 ticks, while all others are not, looks fresh.
//! The challenges follow from each other by a public rule. They find what is old, not who sends it.

use oleo_interface::Axles;

use crate::can::DisplacementMessage;

/// Number of ticks by which both ways together may be late.
const MOST_LATE_TICKS: u8 = 2;
/// Number of challenges to which an answer is accepted.
const CHALLENGES: usize = 1 + MOST_LATE_TICKS as usize;

/// What the challenges begin with: the bits of the golden ratio.
const SEED: u32 = 0x9E37_79B9;

/// The counter in the header of a frame.
#[inline]
pub fn counter(data: &[u8; crate::can::FRAME_BYTES]) -> u8 {
    let [_, header, ..] = *data;
    header & COUNTER_MASK
}

const COUNTER_MASK: u8 = 0x0F;

/// Tick and counter of the last displacement message of an axle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Seen {
    plant_tick: u8,
    counter: u8,
}

/// What is known of the time at the other end of the bus.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Freshness {
    /// State of the generator of challenges; 0 before the first one, and never again.
    random: u32,
    /// The last challenges, the youngest first. Before the first one, 0 stands for "nothing heard yet".
    challenges: [u8; CHALLENGES],
    /// Number of the present tick, modulo 256.
    now: u8,
    seen: Axles<Option<Seen>>,
    /// The plant's counter less our tick, modulo 16, of the last fresh displacement message.
    counter_ahead: Option<u8>,
}

impl Freshness {
    pub const INITIAL: Self = Self {
        random: 0,
        challenges: [0; CHALLENGES],
        now: 0,
        seen: Axles::splat(None),
        counter_ahead: None,
    };

    /// The next challenge, which ends a tick.
    #[inline]
    pub fn challenge(&mut self) -> u8 {
        self.now = self.now.wrapping_add(1);
        // Xorshift (Marsaglia 2003), of which the highest byte is sent. Three instructions; a crate of generators would
        // bring none that is as small and free of panics.
        if self.random == 0 {
            self.random = SEED;
        }
        self.random ^= self.random << 13;
        self.random ^= self.random >> 17;
        self.random ^= self.random << 5;
        let [.., challenge] = self.random.to_le_bytes();
        let [first, second, _] = self.challenges;
        self.challenges = [challenge, first, second];
        challenge
    }

    /// Whether the displacement messages of a tick, with their counters, are fresh.
    #[inline]
    pub fn displacements(&mut self, messages: Axles<Option<(DisplacementMessage, u8)>>) -> Axles<bool> {
        let ours = (messages.zip(self.seen)).map(|(message, seen)| {
            message.is_some_and(|(message, counter)| self.is_recent(&message) && advances(seen, &message, counter))
        });
        let Axles { front, rear } = messages;
        let agree = match (front, rear) {
            (Some((front, _)), Some((rear, _))) => distance(front.plant_tick, rear.plant_tick) <= MOST_LATE_TICKS,
            _ => true,
        };
        let fresh = ours.map(|fresh| fresh && agree);
        for (axle, seen) in self.seen.iter_mut() {
            let Some((message, counter)) = messages[axle] else {
                continue;
            };
            *seen = Some(Seen {
                plant_tick: message.plant_tick,
                counter,
            });
            if fresh[axle] {
                self.counter_ahead = Some(counter.wrapping_sub(self.now) & COUNTER_MASK);
            }
        }
        fresh
    }

    /// Whether a pressure message with this counter is in step with the displacements.
    #[inline]
    pub fn is_in_step(&self, counter: u8) -> bool {
        let Some(ahead) = self.counter_ahead else { return false };
        let late = self.now.wrapping_add(ahead).wrapping_sub(counter) & COUNTER_MASK;
        late <= MOST_LATE_TICKS || late >= 16 - MOST_LATE_TICKS
    }

    #[inline]
    fn is_recent(&self, message: &DisplacementMessage) -> bool {
        self.challenges.contains(&message.answer)
    }
}

/// Whether the plant's tick has advanced as often as the counter has.
#[inline]
fn advances(seen: Option<Seen>, message: &DisplacementMessage, counter: u8) -> bool {
    seen.is_none_or(|seen| {
        let ticks = message.plant_tick.wrapping_sub(seen.plant_tick);
        ticks & COUNTER_MASK == counter.wrapping_sub(seen.counter) & COUNTER_MASK
    })
}

/// Number of ticks between two, in whichever order.
#[inline]
fn distance(a: u8, b: u8) -> u8 {
    a.wrapping_sub(b).min(b.wrapping_sub(a))
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::reading::Reading;

    fn message(plant_tick: u8, answer: u8) -> DisplacementMessage {
        DisplacementMessage {
            plant_tick,
            answer,
            left: Reading::INVALID,
            right: Reading::INVALID,
        }
    }

    /// The challenge that was sent last.
    fn last(freshness: &Freshness) -> u8 {
        freshness.challenges[0]
    }

    /// Both displacement messages of plant tick `n` with their answer. Then comes the next challenge.
    fn step(freshness: &mut Freshness, n: u8, answer: u8) -> Axles<bool> {
        let both = Some((message(n, answer), n & COUNTER_MASK));
        let fresh = freshness.displacements(Axles::splat(both));
        freshness.challenge();
        fresh
    }

    #[test]
    fn two_ticks_late_is_fresh_and_three_is_not() {
        for late in 0..600_usize {
            let (mut freshness, mut challenges) = (Freshness::INITIAL, std::vec![]);
            let mut fresh = 0;
            for n in 0..4000_usize {
                challenges.push(last(&freshness));
                let answer = n.checked_sub(late).map_or(0, |then| challenges[then]);
                fresh += u32::from(step(&mut freshness, n as u8, answer).front);
            }
            match late {
                0..=2 => assert_eq!(fresh, 4000),
                // By chance three of 256 fit.
                _ => assert!((20..80).contains(&fresh), "{late} late: {fresh} fresh"),
            }
        }
    }

    #[test]
    fn senders_with_different_pasts_are_both_doubted() {
        let mut freshness = Freshness::INITIAL;
        let answer = last(&freshness);
        step(&mut freshness, 5, answer);
        let both = Axles::new(
            Some((message(6, last(&freshness)), 6)),
            Some((message(9, last(&freshness)), 9)),
        );
        assert_eq!(freshness.displacements(both), Axles::splat(false));
    }

    #[test]
    fn sampling_that_has_stopped_is_found_behind_a_counter_that_runs() {
        let mut freshness = Freshness::INITIAL;
        step(&mut freshness, 5, 0);
        let stopped = message(5, last(&freshness));
        let fresh = freshness.displacements(Axles::new(Some((stopped, 6)), None));
        assert!(!fresh.front);
    }

    #[test]
    fn a_pressure_message_out_of_step_is_found() {
        let mut freshness = Freshness::INITIAL;
        assert!(!freshness.is_in_step(0), "nothing to compare with");
        freshness.displacements(Axles::new(Some((message(14, 0), 14)), None));
        for late in 0..16_u8 {
            let counter = 14_u8.wrapping_sub(late) & COUNTER_MASK;
            assert_eq!(freshness.is_in_step(counter), late <= 2 || late >= 14, "{late}");
        }
        // Without displacements the time goes on.
        freshness.challenge();
        assert!(freshness.is_in_step(15) && !freshness.is_in_step(11));
    }

    /// The first outputs of the generator from the seed of its paper (Marsaglia, Xorshift RNGs, 2003).
    #[test]
    fn challenges_are_the_highest_bytes_of_xorshift() {
        let mut freshness = Freshness {
            random: 2_463_534_242,
            ..Freshness::INITIAL
        };
        for published in [
            723_471_715_u32,
            2_497_366_906,
            2_064_144_800,
            2_008_045_182,
            3_532_304_609,
        ] {
            assert_eq!(u32::from(freshness.challenge()), published >> 24);
        }
    }
}
