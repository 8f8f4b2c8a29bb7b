//! Detects a valve 3 and a valve 1 that do not close: what they shut off then moves as if they were open.
//!
//! *Valve 3.* Oil that is trapped has nowhere to go, so p4 stays where it was but for the gas' temperature and the sensor's noise. A
//! valve that is stuck open, or that has been opened by somebody else, lets p4 follow p3.
//!
//! *Valve 1.* All oil that changes p2 has gone through damper 1 or past it. The pack takes 0.3 MPa in jounce and 0.6 MPa in rebound
//! where the strut moves at 0.1 m/s, and the open bypass 0.01 MPa (`oleo rig damping`). So p1 - p2 swings as a rule about as far as p2
//! changes from one look to the next, and by a tenth of that where the oil goes past the pack. At the speeds of wheels on very rough
//! roads both come closer to each other, hence the many windows. A pack that leaks as much as an open valve is found as well.
//!
//! Spans are compared in windows of 0.5 s, each of which begins when the valve has been closed for 0.3 s at least:
//!
//! | valve | moves if it is open | against | wrong window | windows until it is stuck | right window |
//! |---|---|---|---|---|---|
//! | 3 | p4 | p3 | over 0.15 MPa and a third of p3 | 2 | p3 over 0.5 MPa, and less than a tenth of it |
//! | 1 | change of p2 in 40 ms | p1 - p2 | over 0.4 MPa and five times p1 - p2 | 6 | p1 - p2 over 0.2 MPa, and less than twice it |
//!
//! A right window clears what was counted and said. Another says nothing. The verdict is about the corner. It blames p4 or p2, which
//! the other checks would believe. The mode that follows keeps the valve closed, and so keeps the fault visible.
//!
//! The two valves take the turns of a corner in turns, so that each is looked at every 40 ms.

use oleo_interface::{Gauge, StrutPressures, StrutValves, Valve};

use super::span::Span;
use super::turn::turns;
use super::verdict::{Place, Verdicts};
use crate::failsafe::FaultCode;

/// Looks from the first to the last of a window.
const WINDOW_LOOKS: u8 = turns(500) / 2;
/// Looks after which a valve that was told to close is closed (40 to 90 ms) and the pressures have settled. An opening between two
/// looks is not seen: it is shorter than any valve takes to open.
const CLOSED_LOOKS: u8 = turns(320) / 2;

/// What is a wrong and what is a right window.
struct Criterion {
    /// Span of what moves if the valve is open above which a window may be wrong, Pa.
    moved_pa: f32,
    /// The same as a share of the span against which it is held.
    moved_share: f32,
    /// Span against which it is held above which a window may be right, Pa.
    shaken_pa: f32,
    /// The share of it below which the valve is closed.
    still_share: f32,
    /// Number of wrong windows until the valve is stuck.
    windows: u8,
}

const SPRING: Criterion = Criterion {
    moved_pa: 0.15e6,
    moved_share: 1.0 / 3.0,
    shaken_pa: 0.5e6,
    still_share: 0.1,
    windows: 2,
};
const BYPASS_1: Criterion = Criterion {
    moved_pa: 0.4e6,
    moved_share: 5.0,
    shaken_pa: 0.2e6,
    still_share: 2.0,
    windows: 6,
};

/// State of the check for one strut.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ClosedValves {
    spring: ClosedValve,
    bypass_1: ClosedValve,
    /// p2 at the last look at valve 1.
    p2: Gauge<f32>,
}

impl ClosedValves {
    /// The first looks begin a window: no valve has been closed for long enough in them.
    pub const INITIAL: Self = Self {
        spring: ClosedValve::INITIAL,
        bypass_1: ClosedValve::INITIAL,
        p2: Gauge(0.0),
    };

    /// One turn, which is that of valve 1 or of valve 3; `open` says which valves were told to be open in the last tick.
    pub fn step(
        &mut self,
        of_bypass: bool,
        pressure: &StrutPressures<Gauge<f32>>,
        open: StrutValves<bool>,
        verdict: &mut Verdicts,
    ) {
        let StrutPressures { p1, p2, p3, p4 } = *pressure;
        if of_bypass {
            let observed = !open[Valve::Bypass1] && verdict.is_good(Place::P1) && verdict.is_good(Place::P2);
            self.bypass_1.step(&BYPASS_1, p2 - self.p2, p1 - p2, observed);
            self.p2 = p2;
        } else {
            let observed = !open[Valve::Spring] && verdict.is_good(Place::P3) && verdict.is_good(Place::P4);
            self.spring.step(&SPRING, p4.pa(), p3.pa(), observed);
        }
        if self.spring.stuck {
            verdict.blame(Place::P4, FaultCode::ValveStuck);
        }
        if self.bypass_1.stuck {
            verdict.blame(Place::P2, FaultCode::ValveStuck);
        }
    }
}

/// The same for one valve.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct ClosedValve {
    /// Looks since the valve was told to close and its pressures are good, less those of windows that are over.
    looks: u8,
    moved: Span,
    against: Span,
    wrong_windows: u8,
    stuck: bool,
}

impl ClosedValve {
    const INITIAL: Self = Self {
        looks: 0,
        moved: Span::INITIAL,
        against: Span::INITIAL,
        wrong_windows: 0,
        stuck: false,
    };

    /// One look at what moves if the valve is open, and at what it is held against, Pa. `observed` says whether the valve was told to
    /// be closed and the pressures are good.
    #[inline(never)]
    fn step(&mut self, criterion: &Criterion, moved_pa: f32, against_pa: f32, observed: bool) {
        if !observed {
            self.looks = 0;
            return;
        }
        self.looks = self.looks.wrapping_add(1);
        if self.looks > CLOSED_LOOKS {
            self.moved.add(moved_pa);
            self.against.add(against_pa);
            if self.looks < CLOSED_LOOKS + WINDOW_LOOKS {
                return;
            }
            self.end_of_window(criterion);
            self.looks = CLOSED_LOOKS;
        }
        // The next window begins with this look.
        self.moved = Span::at(moved_pa);
        self.against = Span::at(against_pa);
    }

    fn end_of_window(&mut self, c: &Criterion) {
        let (moved, against) = (self.moved.width(), self.against.width());
        if moved > c.moved_pa && moved > c.moved_share * against {
            self.wrong_windows = self.wrong_windows.saturating_add(1);
            self.stuck |= self.wrong_windows >= c.windows;
        } else if against > c.shaken_pa && moved < c.still_share * against {
            self.wrong_windows = 0;
            self.stuck = false;
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::super::turn::TURN_S;
    use super::*;
    use core::f32::consts::TAU;

    const CLOSED: StrutValves<bool> = StrutValves::new(false, false, false);
    const OPEN: StrutValves<bool> = StrutValves::new(true, true, true);
    const NEVER: u16 = 2000;

    /// Turns until something is blamed, and what, where the pressures are a function of time and the valves have been told to be open or closed.
    fn found(
        check: &mut ClosedValves,
        open: StrutValves<bool>,
        pressures: impl Fn(f32) -> StrutPressures<f32>,
    ) -> (u16, Option<Place>) {
        for turn in 0..NEVER {
            let mut verdict = Verdicts::GOOD;
            check.step(
                turn % 2 == 1,
                &pressures(f32::from(turn) * TURN_S).map(Gauge),
                open,
                &mut verdict,
            );
            if let Some(place) = [Place::P1, Place::P2, Place::P3, Place::P4]
                .into_iter()
                .find(|p| !verdict.is_good(*p))
            {
                assert_eq!(Verdicts::gravest(&[verdict]), FaultCode::ValveStuck);
                return (turn, Some(place));
            }
        }
        (NEVER, None)
    }

    /// p3 swings by 0.5 MPa at 1.3 Hz, and p4 by a share of that.
    fn behind_valve_3(share: f32) -> impl Fn(f32) -> StrutPressures<f32> {
        move |time_s| {
            let swing = 0.5e6 * libm::sinf(TAU * 1.3 * time_s);
            StrutPressures {
                p3: 2.0e6 + swing,
                p4: 2.0e6 + share * swing,
                ..StrutPressures::splat(2.0e6)
            }
        }
    }

    /// p2 swings by 0.6 MPa at 2.5 Hz, for which oil flows that takes a share of what the pack of the report takes: 3 MPa for each
    /// m/s in jounce and 6 in rebound, on 0.1 l of gas at 2 MPa.
    fn before_gas_1(share: f32) -> impl Fn(f32) -> StrutPressures<f32> {
        move |time_s| {
            let (amplitude, rate) = (0.6e6, TAU * 2.5);
            let phase = rate * time_s;
            let p2 = 2.0e6 + amplitude * libm::sinf(phase);
            let flow_m3_s = amplitude * rate * libm::cosf(phase) * 1.0e-4 / 2.1e6;
            let speed_m_s = flow_m3_s / 1.963_495_4e-3;
            let drop = share * speed_m_s * if speed_m_s > 0.0 { 3.0e6 } else { 6.0e6 };
            StrutPressures {
                p1: p2 + drop,
                p2,
                p3: 2.0e6,
                p4: 2.0e6,
            }
        }
    }

    /// The turn of the last look of a number of windows, where the valve is closed from the first look on.
    fn last_turn(windows: u8) -> u16 {
        2 * u16::from(CLOSED_LOOKS + windows * WINDOW_LOOKS - 1)
    }

    #[test]
    fn p4_that_follows_p3_through_a_closed_valve_3() {
        for share in [1.0, 0.5] {
            let (turn, place) = found(&mut { ClosedValves::INITIAL }, CLOSED, behind_valve_3(share));
            assert_eq!(place, Some(Place::P4));
            assert_eq!(turn, last_turn(2));
        }
        for (share, open) in [(0.05, CLOSED), (1.0, OPEN)] {
            let (_, place) = found(&mut { ClosedValves::INITIAL }, open, behind_valve_3(share));
            assert_eq!(place, None, "{share}");
        }
    }

    #[test]
    fn oil_that_reaches_gas_1_without_a_drop_past_a_closed_valve_1() {
        for share in [0.0, 0.04] {
            let (turn, place) = found(&mut { ClosedValves::INITIAL }, CLOSED, before_gas_1(share));
            assert_eq!(place, Some(Place::P2));
            assert_eq!(turn, last_turn(6) + 1);
        }
        for (share, open) in [(0.5, CLOSED), (1.0, CLOSED), (0.0, OPEN)] {
            let (_, place) = found(&mut { ClosedValves::INITIAL }, open, before_gas_1(share));
            assert_eq!(place, None, "{share}");
        }
    }

    #[test]
    fn a_fault_stays_until_the_valve_is_seen_to_be_closed() {
        let mut check = ClosedValves::INITIAL;
        assert_eq!(found(&mut check, CLOSED, before_gas_1(0.0)).1, Some(Place::P2));
        assert_eq!(
            found(&mut check, OPEN, before_gas_1(0.0)).0,
            0,
            "an open valve shows nothing"
        );
        let still = |_: f32| StrutPressures::splat(2.0e6);
        for _ in 0..20 {
            assert_eq!(found(&mut check, CLOSED, still).0, 0, "nor does a strut at rest");
        }
        for turn in 0..u16::from(2 * (CLOSED_LOOKS + 2 * WINDOW_LOOKS)) {
            let pressure = before_gas_1(1.0)(f32::from(turn) * TURN_S);
            check.step(turn % 2 == 1, &pressure.map(Gauge), CLOSED, &mut Verdicts::default());
        }
        assert_eq!(found(&mut check, CLOSED, before_gas_1(1.0)).1, None);
    }

    /// A check whose valve has been closed for long enough: its next look is the second of a window whose first was 0.
    fn closed() -> ClosedValve {
        let mut check = ClosedValve::INITIAL;
        for _ in 0..CLOSED_LOOKS {
            check.step(&SPRING, 0.0, 0.0, true);
        }
        check
    }

    /// The rest of a window with spans, Pa, that begins and ends at 0; returns what is said after it.
    fn window(check: &mut ClosedValve, criterion: &Criterion, against_pa: f32, moved_pa: f32) -> bool {
        for look in 1..=WINDOW_LOOKS {
            let up = if look < WINDOW_LOOKS { f32::from(look % 2) } else { 0.0 };
            check.step(criterion, -up * moved_pa, up * against_pa, true);
        }
        assert_eq!(check.looks, CLOSED_LOOKS);
        check.stuck
    }

    #[test]
    fn it_must_move_far_enough_and_as_a_share_in_enough_windows() {
        for (criterion, against_pa, moved_pa, is_stuck) in [
            (&SPRING, 0.1e6, 0.16e6, true),
            (&SPRING, 0.1e6, 0.14e6, false),
            (&SPRING, 1.0e6, 0.35e6, true),
            (&SPRING, 1.0e6, 0.32e6, false),
            (&SPRING, 0.0, 0.0, false),
            (&BYPASS_1, 0.05e6, 0.42e6, true),
            (&BYPASS_1, 0.05e6, 0.38e6, false),
            (&BYPASS_1, 0.2e6, 1.05e6, true),
            (&BYPASS_1, 0.2e6, 0.95e6, false),
        ] {
            let mut check = closed();
            for _ in 1..criterion.windows {
                assert!(!window(&mut check, criterion, against_pa, moved_pa), "not enough");
            }
            let said = window(&mut check, criterion, against_pa, moved_pa);
            assert_eq!(said, is_stuck, "{against_pa} and {moved_pa} Pa");
        }
    }

    #[test]
    fn a_right_window_clears_what_was_counted_and_said() {
        for (criterion, against_pa, moved_pa, clears) in [
            (&SPRING, 0.55e6, 0.05e6, true),
            (&SPRING, 0.45e6, 0.01e6, false),
            (&SPRING, 1.0e6, 0.12e6, false),
            (&SPRING, 1.0e6, 0.09e6, true),
            (&BYPASS_1, 0.22e6, 0.1e6, true),
            (&BYPASS_1, 0.18e6, 0.1e6, false),
            (&BYPASS_1, 0.5e6, 1.05e6, false),
            (&BYPASS_1, 0.5e6, 0.95e6, true),
        ] {
            let mut check = closed();
            let wrong = |check: &mut ClosedValve| window(check, criterion, 0.01e6, 1.0e6);
            for _ in 1..criterion.windows {
                wrong(&mut check);
            }
            window(&mut check, criterion, against_pa, moved_pa);
            assert_eq!(wrong(&mut check), !clears, "counted: {against_pa} and {moved_pa} Pa");
            assert!((0..criterion.windows).any(|_| wrong(&mut check)), "found once more");
            let said = window(&mut check, criterion, against_pa, moved_pa);
            assert_eq!(said, !clears, "said: {against_pa} and {moved_pa} Pa");
        }
    }

    #[test]
    fn a_wrong_pressure_or_an_open_valve_ends_the_window() {
        let [none, one, two] = [0, CLOSED_LOOKS + 1, CLOSED_LOOKS + 2];
        for (place, open, looks) in [
            (Some(Place::P1), CLOSED, (none, two)),
            (Some(Place::P2), CLOSED, (none, two)),
            (Some(Place::P3), CLOSED, (two, none)),
            (Some(Place::P4), CLOSED, (two, none)),
            (Some(Place::DISPLACEMENT), CLOSED, (two, two)),
            (None, StrutValves::new(true, false, false), (none, two)),
            (None, StrutValves::new(false, true, false), (two, two)),
            (None, StrutValves::new(false, false, true), (two, none)),
        ] {
            let mut check = ClosedValves {
                spring: closed(),
                bypass_1: closed(),
                ..ClosedValves::INITIAL
            };
            let at_rest = StrutPressures::splat(Gauge(2.0e6));
            let mut look = |open, place: Option<Place>| {
                for of_bypass in [false, true] {
                    let mut verdict = Verdicts::GOOD;
                    if let Some(place) = place {
                        verdict.blame(place, FaultCode::SensorRange);
                    }
                    check.step(of_bypass, &at_rest, open, &mut verdict);
                }
                (check.bypass_1.looks, check.spring.looks)
            };
            assert_eq!(look(CLOSED, None), (one, one));
            assert_eq!(look(open, place), looks, "{place:?} {open:?}");
        }
    }

    /// What was before the valve had settled is in no window.
    #[test]
    fn a_valve_that_closes_again_must_settle_again() {
        let mut check = closed();
        check.step(&SPRING, 4.0e6, 5.0e6, false);
        for look in 1..CLOSED_LOOKS {
            check.step(&SPRING, 4.0e6, 5.0e6, true);
            assert_eq!(check.looks, look);
        }
        check.step(&SPRING, 0.0, 0.0, true);
        assert!(!window(&mut check, &SPRING, 1.0e6, 0.0));
        assert_eq!(check.wrong_windows, 0);
        assert_eq!((check.moved.width(), check.against.width()), (0.0, 0.0));
    }
}
