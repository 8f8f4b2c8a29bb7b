//! How often a bypass valve may move.
//!
//! A valve that takes 40 to 90 ms gains nothing from signals that change faster, and wears. After each change a bypass valve rests for
//! 100 ms. A closing that safety wants does not come through here: the mode machine acts on the command itself.

use crate::timing::ticks;
use crate::valves::CORNERS;

/// Shortest time between two changes of one valve.
pub const BYPASS_DWELL_TICKS: u8 = ticks(100) as u8;

/// State of the bypass signals of the four corners (valves 1 and 2 go together).
#[derive(Clone, Copy, Debug, Default)]
pub struct Dwell {
    open: [bool; CORNERS],
    since: [u8; CORNERS],
}

impl Dwell {
    /// One tick; `at_once` lets a closing pass without rest.
    pub fn step(&mut self, wanted: [bool; CORNERS], at_once: bool) -> [bool; CORNERS] {
        for ((open, since), wanted) in self.open.iter_mut().zip(&mut self.since).zip(wanted) {
            *since = since.saturating_add(1);
            if wanted != *open && (*since >= BYPASS_DWELL_TICKS || (at_once && !wanted)) {
                *open = wanted;
                *since = 0;
            }
        }
        self.open
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chattering_wish_moves_the_valve_at_most_every_twenty_ticks() {
        let mut dwell = Dwell::default();
        let (mut changes, mut before) = (0, false);
        for n in 0..400 {
            let [open, ..] = dwell.step([n % 2 == 0; 4], false);
            changes += i32::from(core::mem::replace(&mut before, open) != open);
        }
        assert!(changes <= 20, "{changes}");
        dwell.step([true; 4], false);
        for _ in 0..BYPASS_DWELL_TICKS {
            dwell.step([true; 4], false);
        }
        assert_eq!(dwell.step([false; 4], true), [false; 4]);
    }
}
