//! Limits how often a bypass valve may move.
//!
//! A valve that takes 40 to 90 ms gains nothing from signals that change faster, and it wears. After each change a bypass
//! valve rests for 100 ms. A closing that safety requires does not come through here: the mode machine acts on the
//! command itself.

use oleo_interface::{Corner, Corners, StrutValves, Valve};

use crate::timing::ticks;
use crate::valves::{BYPASS_BITS, ValveCommand};

/// Shortest time between two changes of one valve, ticks.
const BYPASS_DWELL_TICKS: u32 = ticks(100) as u32;

/// The valves that rest: 1 and 2 of every strut.
const BYPASS_VALVES: [Valve; 2] = [Valve::Bypass1, Valve::Bypass2];

/// State of the eight bypass signals.
#[derive(Clone, Copy, Debug, Default)]
pub struct Dwell {
    open: ValveCommand,
    /// Number of ticks so far. It wraps after 248 days; a valve that last moved exactly then rests once more.
    now: u32,
    /// Value of `now` at the last change of each valve.
    changed_at: Corners<StrutValves<u32>>,
}

impl Dwell {
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
        for corner in Corner::ALL {
            for valve in BYPASS_VALVES {
                let open = wanted.is_open(corner, valve);
                let changed_at = &mut self.changed_at[corner][valve];
                let rested = self.now.wrapping_sub(*changed_at) >= BYPASS_DWELL_TICKS;
                if open != self.open.is_open(corner, valve) && (rested || (at_once && !open)) {
                    self.open = self.open.with(corner, valve, open);
                    *changed_at = self.now;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BYPASS: ValveCommand = ValveCommand::from_word(BYPASS_BITS);

    #[test]
    fn a_chattering_signal_moves_the_valve_at_most_every_twenty_ticks() {
        let mut dwell = Dwell::default();
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
    fn each_valve_rests_for_itself() {
        let mut dwell = Dwell::default();
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
