//! Whether a message may be trusted, from the outcomes of its last periods: the state machine of AUTOSAR's end-to-end protection.
//!
//! The check of a single frame says whether that frame is right. It does not say whether its sender is alone on the bus, or
//! whether the connection is good enough to steer by. The state machine counts right and wrong periods in a window:
//!
//! ```text
//!            not an error              MinOk right periods, at most MaxError wrong ones
//!   NoData ---------------> Init ---------------------------------------------------------> Valid
//!                             |                                                             |   ^
//!                             | more than MaxError wrong ones      fewer right or more wrong |   | MinOk right periods,
//!                             +----------------> Invalid <----------------------------------+   | at most MaxError wrong
//!                                                   +-------------------------------------------+
//! ```
//!
//! Source (*recalled*): AUTOSAR FO R20-11, "E2E Protocol Specification" (document 849), section on the E2E state machine
//! (`E2E_SMCheck`, `E2E_SMAddStatus`), with a window size for each state. Two differences: the window is emptied when the first
//! frame comes, and it counts as full of right periods when `Valid` is first reached. A sender that has just begun has no past,
//! and would otherwise be distrusted for it.
//!
//! | | Init | Valid | Invalid |
//! |---|---|---|---|
//! | `WindowSize`, periods | 2 | 16 | 16 |
//! | `MinOkState` | 1 | 8 | 12 |
//! | `MaxErrorState` | 0 | 2 | 0 |
//!
//! So trust ends in the third wrong period out of sixteen, or when half of the periods bring nothing right. It returns after
//! sixteen periods without a wrong one.

/// Outcome of one period of a message (`E2E_PCheckStatusType`). The graver one is the greater.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Period {
    /// One right frame in sequence.
    Ok,
    /// No frame was received in this tick.
    NoNewData,
    /// A frame that was there before.
    Repeated,
    /// A frame that is the first, or out of sequence.
    WrongSequence,
    /// A wrong check value, more frames than a sender sends, or content that is too old or contradicts itself.
    Error,
}

/// State of the machine (`E2E_SMStateType`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
enum Trust {
    #[default]
    NoData,
    Init,
    Valid,
    Invalid,
}

/// The part of the history that a state looks at, and what it asks for.
struct Window {
    /// One bit for each period of the window.
    periods: u16,
    min_ok: u32,
    max_error: u32,
}

const INIT: Window = Window {
    periods: 0b11,
    min_ok: 1,
    max_error: 0,
};
const VALID: Window = Window {
    periods: u16::MAX,
    min_ok: 8,
    max_error: 2,
};
const INVALID: Window = Window {
    periods: u16::MAX,
    min_ok: 12,
    max_error: 0,
};

/// The machine of one message. It starts without data.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StateMachine {
    trust: Trust,
    /// Right and wrong periods, the youngest in the lowest bit.
    ok: u16,
    error: u16,
}

impl StateMachine {
    /// A state machine that has seen no period yet.
    pub const fn new() -> Self {
        Self {
            trust: Trust::NoData,
            ok: 0,
            error: 0,
        }
    }

    /// Ends a period; returns whether the message may be trusted.
    pub fn step(&mut self, period: Period) -> bool {
        self.ok = self.ok << 1 | u16::from(period == Period::Ok);
        self.error = self.error << 1 | u16::from(period == Period::Error);
        // Most periods end here: nothing but right periods in the whole window.
        if self.trust == Trust::Valid && self.ok == u16::MAX {
            return true;
        }
        self.trust = self.next(period);
        self.trust == Trust::Valid
    }

    #[inline(never)]
    fn next(&mut self, period: Period) -> Trust {
        match self.trust {
            Trust::NoData if matches!(period, Period::Error | Period::NoNewData) => Trust::NoData,
            Trust::NoData => {
                // A sender that has just begun has no past to be judged by.
                (self.ok, self.error) = (0, 0);
                Trust::Init
            }
            Trust::Init if self.has_too_many_errors(&INIT) => Trust::Invalid,
            Trust::Init if self.has_enough(&INIT) => {
                self.ok = u16::MAX;
                Trust::Valid
            }
            Trust::Init => Trust::Init,
            Trust::Valid if self.has_enough(&VALID) => Trust::Valid,
            Trust::Invalid if self.has_enough(&INVALID) => Trust::Valid,
            Trust::Valid | Trust::Invalid => Trust::Invalid,
        }
    }

    fn has_too_many_errors(&self, window: &Window) -> bool {
        (self.error & window.periods).count_ones() > window.max_error
    }

    fn has_enough(&self, window: &Window) -> bool {
        (self.ok & window.periods).count_ones() >= window.min_ok && !self.has_too_many_errors(window)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec::Vec;

    /// What the machine says after each period. The letters are the initials of the outcomes.
    fn trusted(periods: &str) -> Vec<bool> {
        let mut machine = StateMachine::new();
        periods
            .chars()
            .map(|letter| {
                machine.step(match letter {
                    'o' => Period::Ok,
                    'n' => Period::NoNewData,
                    'r' => Period::Repeated,
                    'w' => Period::WrongSequence,
                    'e' => Period::Error,
                    other => panic!("no such outcome: {other}"),
                })
            })
            .collect()
    }

    fn last(periods: &str) -> bool {
        trusted(periods).last().copied().unwrap_or(false)
    }

    /// The machine as the specification writes it: an array of outcomes, counted anew in each period.
    fn by_the_book(periods: &[Period]) -> Vec<bool> {
        let mut state = Trust::NoData;
        let mut window: Vec<Period> = Vec::new();
        let mut said = Vec::new();
        for period in periods {
            window.push(*period);
            let counted = |size: usize| {
                let recent = &window[window.len().saturating_sub(size)..];
                let count = |wanted| recent.iter().filter(|period| **period == wanted).count();
                (count(Period::Ok), count(Period::Error))
            };
            let (init, long) = (counted(2), counted(16));
            state = match state {
                Trust::NoData if *period == Period::Error || *period == Period::NoNewData => Trust::NoData,
                Trust::NoData => {
                    window.clear();
                    Trust::Init
                }
                Trust::Init if init.1 > 0 => Trust::Invalid,
                Trust::Init if init.0 >= 1 => {
                    window = std::vec![Period::Ok; 16];
                    Trust::Valid
                }
                Trust::Init => Trust::Init,
                Trust::Valid if long.0 >= 8 && long.1 <= 2 => Trust::Valid,
                Trust::Invalid if long.0 >= 12 && long.1 == 0 => Trust::Valid,
                Trust::Valid | Trust::Invalid => Trust::Invalid,
            };
            said.push(state == Trust::Valid);
        }
        said
    }

    #[test]
    fn trusts_the_first_right_frame_after_the_initial_one() {
        assert_eq!(trusted("nnewooo"), [false, false, false, false, true, true, true]);
    }

    #[test]
    fn the_third_wrong_period_of_sixteen_ends_trust() {
        assert!(last("wooooeoooooooe"));
        assert!(!last("wooooeoooooooeoe"));
        assert!(last("wooooeooooooooooooooooeoe"), "the first is forgotten");
    }

    #[test]
    fn half_of_the_periods_must_be_right() {
        assert!(last("wonononononononononono"));
        assert!(!last("wonnonnonnonnonnonnonnonn"));
        assert!(!last("worwrwrwrwrwrwrwr"));
    }

    #[test]
    fn sixteen_periods_without_a_wrong_one_bring_trust_back() {
        let lost = "woeee";
        let clean = |n: usize| last(&(std::string::String::from(lost) + &"o".repeat(n)));
        assert!(!clean(15));
        assert!(clean(16));
        assert!(!last("woeeeoooooooooooooooe"));
    }

    #[test]
    fn the_same_as_by_the_book() {
        // The generator of `freshness`: this crate needs none from outside.
        let mut random = 0x2545_F491_u32;
        for _ in 0..2_000 {
            let wrong_of_8 = random % 5;
            let periods: Vec<Period> = (0..80)
                .map(|_| {
                    random ^= random << 13;
                    random ^= random >> 17;
                    random ^= random << 5;
                    if random % 8 >= wrong_of_8 {
                        return Period::Ok;
                    }
                    [
                        Period::NoNewData,
                        Period::Repeated,
                        Period::WrongSequence,
                        Period::Error,
                    ][random as usize >> 8 & 3]
                })
                .collect();
            let mut machine = StateMachine::new();
            let said: Vec<bool> = periods.iter().map(|period| machine.step(*period)).collect();
            assert_eq!(said, by_the_book(&periods), "{periods:?}");
        }
    }
}
