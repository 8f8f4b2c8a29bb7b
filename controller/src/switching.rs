//! Limits how often a valve may switch, whatever the inputs are.
//!
//! The last stage of a tick. What comes here is permitted, but a fault that comes and goes, or an attack, can permit and forbid
//! it in turns. A closing always passes, because safety may require it. So only openings can be limited: a valve opens only if
//! the ninth switching before is at least 199 ticks ago. Then **no valve switches more than ten times in any second**, which is
//! 200 ticks, because any eleven switchings take longer:
//!
//! - If the last of them is an opening, the second was 199 ticks before it, and the first at least 200.
//! - If the last is a closing, the tenth is an opening. The first was 199 ticks before that, and the closing comes at least one
//!   tick after it.

use crate::timing::ticks;
use crate::valves::{VALVES, ValveCommand, bits};

/// Most switchings of a valve within a second.
const MOST_A_SECOND: usize = 10;
/// Number of ticks before an opening in which at most all but two of them may lie: the opening and a closing after it.
const SPAN_TICKS: u32 = ticks(1_000) as u32 - 1;

/// Positions of the twelve valves, and when they switched.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SwitchingLimit {
    command: ValveCommand,
    /// Number of ticks so far. It wraps after 248 days; a valve that last moved exactly then may have to wait a second.
    now: u32,
    /// Of each valve, in the order of the bits of the command.
    history: [History; VALVES],
}

/// Times of the last switchings of a valve.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct History {
    /// Numbers of the ticks, plus [`SPAN_TICKS`]: what has never moved, at 0, did so long enough before the first tick.
    times: [u32; MOST_A_SECOND - 1],
    /// Place of the oldest time.
    oldest: u8,
}

impl History {
    const INITIAL: Self = Self {
        times: [0; MOST_A_SECOND - 1],
        oldest: 0,
    };

    /// Records a switching of the valve at time `now`, unless it is an opening that comes too soon; returns whether the valve may move.
    fn add(&mut self, now: u32, opens: bool) -> bool {
        // There always is a place; without one, a valve would only close.
        let Some(oldest) = self.times.get_mut(usize::from(self.oldest)) else {
            return !opens;
        };
        if opens && now.wrapping_sub(*oldest) < SPAN_TICKS {
            return false;
        }
        *oldest = now;
        self.oldest = if self.oldest < MOST_A_SECOND as u8 - 2 {
            self.oldest + 1
        } else {
            0
        };
        true
    }
}

impl SwitchingLimit {
    /// All valves are closed, and none has moved.
    pub const INITIAL: Self = Self {
        command: ValveCommand::SAFE,
        now: 0,
        history: [History::INITIAL; VALVES],
    };

    /// What the last tick returned.
    pub fn command(&self) -> ValveCommand {
        self.command
    }

    /// One tick: returns `permitted` without the openings that come too soon.
    pub fn step(&mut self, permitted: ValveCommand) -> ValveCommand {
        self.now = self.now.wrapping_add(1);
        if permitted != self.command {
            self.change(permitted);
        }
        self.command
    }

    /// Called in ticks in which some valve is to be elsewhere; most ticks have none.
    #[inline(never)]
    fn change(&mut self, permitted: ValveCommand) {
        let now = self.now.wrapping_add(SPAN_TICKS);
        for (place, bit) in bits(permitted.word() ^ self.command.word()) {
            let opens = permitted.word() & bit != 0;
            let moves = (self.history.get_mut(place)).map_or(!opens, |history| history.add(now, opens));
            if moves {
                self.command = ValveCommand::from_word(self.command.word() ^ bit);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec;

    #[test]
    fn an_opening_waits_for_199_ticks_after_the_ninth_switching_before() {
        for (ticks, opens) in [(SPAN_TICKS - 1, false), (SPAN_TICKS, true)] {
            let mut history = History::INITIAL;
            assert!((0..9).all(|n| history.add(1_000 + n, n % 2 == 0)));
            assert_eq!(history.add(1_000 + ticks, true), opens, "{ticks} ticks");
        }
    }

    /// Most switchings of any valve within a second.
    fn most_a_second(words: &[u16]) -> usize {
        (0..12)
            .map(|bit| {
                let mut before = 0;
                let edges: Vec<usize> = (0..words.len())
                    .filter(|&tick| core::mem::replace(&mut before, words[tick] >> bit & 1) != words[tick] >> bit & 1)
                    .collect();
                let within = |first: usize| {
                    edges[first..]
                        .iter()
                        .take_while(|&&tick| tick < edges[first] + 200)
                        .count()
                };
                (0..edges.len()).map(within).max().unwrap_or(0)
            })
            .max()
            .unwrap_or(0)
    }

    fn limited(wanted: impl IntoIterator<Item = u16>) -> Vec<u16> {
        let mut limit = SwitchingLimit::INITIAL;
        wanted
            .into_iter()
            .map(|word| limit.step(ValveCommand::from_word(word)).word())
            .collect()
    }

    #[test]
    fn what_switches_seldom_passes_unchanged() {
        let slow: Vec<u16> = (0..2000)
            .map(|tick| if tick / 23 % 2 == 0 { 0xFFF } else { 0x0F0 })
            .collect();
        assert_eq!(limited(slow.iter().copied()), slow);
    }

    #[test]
    fn what_switches_always_has_its_ten_and_no_more() {
        let words = limited((0..2000).map(|tick| if tick % 2 == 0 { 0xFFF } else { 0 }));
        assert_eq!(most_a_second(&words), 10);
        assert_eq!(
            words.iter().filter(|&&word| word == 0xFFF).count(),
            50,
            "five openings a second"
        );
    }

    #[test]
    fn the_tests_own_counting_finds_eleven() {
        let words: Vec<u16> = (0..400).map(|tick| u16::from(tick / 19 % 2 == 1)).collect();
        assert_eq!(most_a_second(&words), 11);
    }

    proptest! {
        #[test]
        fn no_valve_switches_more_than_ten_times_a_second(
            runs in prop::collection::vec((any::<u16>(), 1usize..60), 1..200))
        {
            let wanted: Vec<u16> =
                runs.iter().flat_map(|&(word, ticks)| std::iter::repeat_n(word & 0xFFF, ticks)).collect();
            let words = limited(wanted.iter().copied());
            prop_assert!(most_a_second(&words) <= 10);
            prop_assert!(words.iter().zip(&wanted).all(|(is, wanted)| is & !wanted == 0), "a closing was delayed");
        }
    }
}
