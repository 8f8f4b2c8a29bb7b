//! Limits how often a bypass valve may move.
//!
//! A valve that takes 40 to 90 ms gains nothing from signals that change faster, and it wears. After each change a bypass
//! valve rests for 100 ms. A closing that safety requires does not come through here: the mode machine acts on the
//! command itself.

use crate::timing::ticks;
use crate::valves::{BYPASS_BITS, VALVES, ValveCommand, bits};

/// Shortest time between two changes of one valve, ticks.
const BYPASS_DWELL_TICKS: u32 = ticks(100) as u32;

/// State of the eight bypass signals.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Dwell {
    open: ValveCommand,
    /// Number of ticks so far. It wraps after 248 days; a valve that last moved exactly then rests once more.
    now: u32,
    /// Value of `now` at the last change of each valve, in the order of the bits of the command.
    changed_at: [u32; VALVES],
}

impl Dwell {
    pub const INITIAL: Self = Self {
        open: ValveCommand::SAFE,
        now: 0,
        changed_at: [0; VALVES],
    };

    /// One tick: takes over the bypass signals of `wanted` whose valves have rested, and returns all of them. The spring
    /// valves are closed in what it returns. `at_once` lets a closing pass without rest.
    pub fn step(&mut self, wanted: ValveCommand, at_once: bool) -> ValveCommand {
        self.now = self.now.wrapping_add(1);
        if (wanted.word() ^ self.open.word()) & BYPASS_BITS != 0 {
            self.change(wanted, at_once);
        }
        self.open
    }

    /// Called in ticks in which some bypass valve is wanted elsewhere; most ticks have none.
    #[inline(never)]
    fn change(&mut self, wanted: ValveCommand, at_once: bool) {
        for (place, bit) in bits((wanted.word() ^ self.open.word()) & BYPASS_BITS) {
            let Some(changed_at) = self.changed_at.get_mut(place) else {
                continue;
            };
            let rested = self.now.wrapping_sub(*changed_at) >= BYPASS_DWELL_TICKS;
            if rested || (at_once && wanted.word() & bit == 0) {
                *changed_at = self.now;
                self.open = ValveCommand::from_word(self.open.word() ^ bit);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use oleo_interface::{Corner, Valve};

    const BYPASS: ValveCommand = ValveCommand::from_word(BYPASS_BITS);

    #[test]
    fn a_chattering_signal_moves_the_valve_at_most_every_twenty_ticks() {
        let mut dwell = Dwell::INITIAL;
        let (mut changes, mut before) = (0, ValveCommand::SAFE);
        for n in 0..400 {
            let wanted = if n % 2 == 0 { BYPASS } else { ValveCommand::SAFE };
            let open = dwell.step(wanted, false);
            changes += i32::from(core::mem::replace(&mut before, open) != open);
        }
        // Every 100 ms would be 20; what is wanted every second tick is met one tick later.
        assert!((18..=20).contains(&changes), "{changes}");
        for _ in 0..=2 * BYPASS_DWELL_TICKS {
            dwell.step(BYPASS, false);
        }
        assert_eq!(dwell.step(ValveCommand::SAFE, true), ValveCommand::SAFE);
        assert_eq!(
            dwell.step(BYPASS, true),
            ValveCommand::SAFE,
            "only a closing passes at once"
        );
        dwell.step(ValveCommand::SAFE, false);
        for _ in 3..BYPASS_DWELL_TICKS {
            assert_eq!(dwell.step(BYPASS, false), ValveCommand::SAFE);
        }
        assert_eq!(dwell.step(BYPASS, false), BYPASS);
        assert_eq!(
            dwell.step(ValveCommand::SAFE, true),
            ValveCommand::SAFE,
            "it need not rest for that"
        );
    }

    #[test]
    fn a_valve_that_has_rested_stays_where_it_is_wanted_while_another_moves() {
        let mut dwell = Dwell::INITIAL;
        let one = ValveCommand::SAFE.with(Corner::FrontRight, Valve::Bypass1, true);
        let two = one.with(Corner::RearLeft, Valve::Bypass2, true);
        for _ in 0..3 * BYPASS_DWELL_TICKS {
            dwell.step(one, false);
        }
        assert_eq!(dwell.step(two, false), two);
    }

    #[test]
    fn each_valve_rests_for_itself() {
        let mut dwell = Dwell::INITIAL;
        let one = ValveCommand::SAFE.with(Corner::RearLeft, Valve::Bypass1, true);
        let two = one.with(Corner::RearLeft, Valve::Bypass2, true);
        for _ in 0..BYPASS_DWELL_TICKS {
            dwell.step(one, false);
        }
        // Valve 1 has just moved and must rest; valve 2 has not.
        assert_eq!(dwell.step(two, false), two);
        assert_eq!(dwell.step(ValveCommand::SAFE, false), two);
        for _ in 3..BYPASS_DWELL_TICKS {
            assert_eq!(dwell.step(ValveCommand::SAFE, false), two);
        }
        assert_eq!(
            dwell.step(ValveCommand::SAFE, false),
            one.with(Corner::RearLeft, Valve::Bypass1, false)
                .with(Corner::RearLeft, Valve::Bypass2, true)
        );
        assert_eq!(dwell.step(ValveCommand::SAFE, false), ValveCommand::SAFE);
        // The spring valves are not decided here.
        assert_eq!(
            dwell.step(ValveCommand::from_word(!BYPASS_BITS), true),
            ValveCommand::SAFE
        );
    }
}
