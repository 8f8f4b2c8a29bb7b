//! Detects a valve 3 that does not close: behind a closed valve nothing changes p4.
//!
//! Oil that is trapped has nowhere to go, so p4 stays where it was but for the gas' temperature and the sensor's noise. A valve that
//! is stuck open, or that has been opened by somebody else, lets p4 follow p3. In windows of 0.5 s, of which each begins when the
//! valve has been closed for 0.3 s at least, the span of p4 is compared with the span of p3. If it is more than 0.15 MPa and more
//! than a third of it in two windows in a row, the valve is called stuck; a window in which p3 moves by 0.5 MPa and p4 by less than
//! a tenth of that clears it. The verdict is about the corner, so it blames p4, which the other checks would believe.
//!
//! The mode that follows keeps the valve closed, and so keeps the fault visible.

use oleo_interface::{Gauge, StrutPressures};

use super::span::Span;
use super::turn::turns;
use super::verdict::{Place, Verdicts};
use crate::failsafe::FaultCode;

const WINDOW_TURNS: u8 = turns(500);
/// Time after which a valve that was told to close is closed (40 to 90 ms) and the pressures have settled.
const CLOSED_TURNS: u8 = turns(300);
const WINDOWS: u8 = 2;
const MOVED_PA: f32 = 0.15e6;
const MOVED_SHARE: f32 = 1.0 / 3.0;
const SHAKEN_PA: f32 = 0.5e6;
const STILL_SHARE: f32 = 0.1;

/// State of the check for one strut.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TrappedOil {
    closed: u8,
    turns: u8,
    p3: Span,
    p4: Span,
    wrong_windows: u8,
    flagged: bool,
}

impl TrappedOil {
    /// The first turn begins a window: the valve has not been closed for long enough in it.
    pub const INITIAL: Self = Self {
        closed: 0,
        turns: 0,
        p3: Span::INITIAL,
        p4: Span::INITIAL,
        wrong_windows: 0,
        flagged: false,
    };

    /// One turn; `commanded_closed` says whether valve 3 was told to be closed in the last tick. An opening between two turns is
    /// not seen: it is shorter than any valve takes to open.
    pub fn step(&mut self, pressure: &StrutPressures<Gauge<f32>>, commanded_closed: bool, verdict: &mut Verdicts) {
        let healthy = verdict.is_good(Place::P3) && verdict.is_good(Place::P4);
        self.closed = if commanded_closed {
            self.closed.saturating_add(1)
        } else {
            0
        };
        if !healthy || self.closed < CLOSED_TURNS {
            self.begin_window();
        } else {
            self.p3.add(pressure.p3.pa());
            self.p4.add(pressure.p4.pa());
            self.turns = self.turns.saturating_add(1);
            if self.turns >= WINDOW_TURNS {
                self.end_of_window();
                self.begin_window();
            }
        }
        if self.flagged {
            verdict.blame(Place::P4, FaultCode::ValveStuck);
        }
    }

    fn begin_window(&mut self) {
        self.turns = 0;
        self.p3 = Span::EMPTY;
        self.p4 = Span::EMPTY;
    }

    fn end_of_window(&mut self) {
        let (p3, p4) = (self.p3.width(), self.p4.width());
        if p4 > MOVED_PA && p4 > MOVED_SHARE * p3 {
            self.wrong_windows = self.wrong_windows.saturating_add(1);
            self.flagged |= self.wrong_windows >= WINDOWS;
        } else {
            self.wrong_windows = 0;
            if p3 > SHAKEN_PA && p4 < STILL_SHARE * p3 {
                self.flagged = false;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::turn::TURN_S;
    use super::*;

    /// First turn in which the valve is called stuck, where p3 swings by 0.5 MPa at 1.3 Hz and p4 by a share of that.
    fn found(check: &mut TrappedOil, share: f32, closed: bool) -> Option<u16> {
        (0..1000).find(|turn| {
            let swing = 0.5e6 * libm::sinf(2.0 * core::f32::consts::PI * 1.3 * f32::from(*turn) * TURN_S);
            let pressure = StrutPressures {
                p4: Gauge(2.0e6 + share * swing),
                ..StrutPressures::splat(Gauge(2.0e6 + swing))
            };
            let mut verdict = Verdicts::GOOD;
            check.step(&pressure, closed, &mut verdict);
            Verdicts::gravest(&[verdict]) == FaultCode::ValveStuck
        })
    }

    #[test]
    fn p4_that_follows_through_a_closed_valve() {
        let two_windows = Some(u16::from(CLOSED_TURNS + 2 * WINDOW_TURNS - 2));
        assert_eq!(found(&mut { TrappedOil::INITIAL }, 1.0, true), two_windows);
        assert_eq!(found(&mut { TrappedOil::INITIAL }, 0.5, true), two_windows);
        assert_eq!(found(&mut { TrappedOil::INITIAL }, 0.05, true), None, "trapped");
        assert_eq!(found(&mut { TrappedOil::INITIAL }, 1.0, false), None, "open");
    }

    #[test]
    fn stays_until_it_is_seen_to_be_closed() {
        let mut check = TrappedOil::INITIAL;
        assert!(found(&mut check, 1.0, true).is_some());
        assert_eq!(found(&mut check, 1.0, false), Some(0), "an open valve shows nothing");
        for _ in 0..2 {
            found(&mut check, 0.02, true);
        }
        let mut verdict = Verdicts::GOOD;
        for turn in 0..CLOSED_TURNS + 2 * WINDOW_TURNS {
            let swing = 0.5e6 * libm::sinf(0.16 * f32::from(turn));
            let pressure = StrutPressures {
                p4: Gauge(2.0e6),
                ..StrutPressures::splat(Gauge(2.0e6 + swing))
            };
            verdict = Verdicts::GOOD;
            check.step(&pressure, true, &mut verdict);
        }
        assert_eq!(verdict, Verdicts::GOOD);
    }

    /// One whole window with spans of p3 and p4 behind a valve that has been closed for long; returns what is said after it.
    fn window(check: &mut TrappedOil, p3_pa: f32, p4_pa: f32) -> bool {
        let mut verdict = Verdicts::GOOD;
        for turn in 0..WINDOW_TURNS {
            verdict = Verdicts::GOOD;
            let share = f32::from(turn) / f32::from(WINDOW_TURNS - 1);
            let pressure = StrutPressures {
                p3: Gauge(2.0e6 + share * p3_pa),
                p4: Gauge(3.0e6 - share * p4_pa),
                ..StrutPressures::splat(Gauge(2.0e6))
            };
            check.step(&pressure, true, &mut verdict);
        }
        Verdicts::gravest(&[verdict]) == FaultCode::ValveStuck
    }

    /// A check whose valve has been closed for long enough, at the beginning of a window.
    fn closed() -> TrappedOil {
        let mut check = TrappedOil::INITIAL;
        for _ in 1..CLOSED_TURNS {
            check.step(&StrutPressures::splat(Gauge(2.0e6)), true, &mut Verdicts::default());
        }
        check
    }

    /// 0.15 MPa and a third of p3, in two windows in a row.
    #[test]
    fn p4_must_move_far_enough_and_as_a_share_of_p3() {
        for (p3_pa, p4_pa, is_stuck) in [
            (0.1e6, 0.16e6, true),
            (0.1e6, 0.14e6, false),
            (1.0e6, 0.35e6, true),
            (1.0e6, 0.32e6, false),
            (0.0, 0.0, false),
        ] {
            let mut check = closed();
            assert!(!window(&mut check, p3_pa, p4_pa), "one window is not enough");
            assert_eq!(window(&mut check, p3_pa, p4_pa), is_stuck, "{p3_pa} and {p4_pa} Pa");
        }
        let mut check = closed();
        for _ in 0..5 {
            assert!(
                !window(&mut check, 1.0e6, 1.0e6) && !window(&mut check, 1.0e6, 0.0),
                "not in a row"
            );
        }
    }

    /// 0.5 MPa of p3 and less than a tenth of it in p4, in one window.
    #[test]
    fn a_shaken_strut_whose_p4_stays_clears_the_verdict() {
        for (p3_pa, p4_pa, cleared) in [
            (0.55e6, 0.05e6, true),
            (0.45e6, 0.01e6, false),
            (1.0e6, 0.12e6, false),
            (1.0e6, 0.09e6, true),
        ] {
            let mut check = closed();
            window(&mut check, 1.0e6, 1.0e6);
            assert!(window(&mut check, 1.0e6, 1.0e6));
            assert_eq!(!window(&mut check, p3_pa, p4_pa), cleared, "{p3_pa} and {p4_pa} Pa");
        }
    }

    #[test]
    fn a_wrong_pressure_or_an_open_valve_ends_the_window() {
        let apart = StrutPressures {
            p4: Gauge(4.0e6),
            ..StrutPressures::splat(Gauge(5.0e6))
        };
        for (place, counts) in [(Place::P3, false), (Place::P4, false), (Place::P1, true)] {
            let mut check = closed();
            let mut verdict = Verdicts::GOOD;
            check.step(&StrutPressures::splat(Gauge(2.0e6)), true, &mut verdict);
            verdict.blame(place, FaultCode::SensorRange);
            check.step(&apart, true, &mut verdict);
            assert_eq!(check.turns, if counts { 2 } else { 0 }, "{place:?}");
        }
        let mut check = closed();
        check.step(&apart, true, &mut Verdicts::default());
        assert_eq!(check.turns, 1);
        check.step(&apart, false, &mut Verdicts::default());
        for turn in 1..CLOSED_TURNS {
            check.step(&apart, true, &mut Verdicts::default());
            assert_eq!(
                (check.turns, check.p4.width() < 0.0),
                (0, true),
                "turn {turn}: it must settle again"
            );
        }
    }
}
