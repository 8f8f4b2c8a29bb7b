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

use super::verdict::{Verdicts, blame};
use crate::failsafe::FaultCode;
use crate::timing::ticks;

const WINDOW_TICKS: u16 = ticks(500);
/// Time after which a valve that was told to close is closed (40 to 90 ms) and the pressures have settled.
const CLOSED_TICKS: u16 = ticks(300);
const WINDOWS: u8 = 2;
const MOVED_PA: f32 = 0.15e6;
const MOVED_SHARE: f32 = 1.0 / 3.0;
const SHAKEN_PA: f32 = 0.5e6;
const STILL_SHARE: f32 = 0.1;

/// State of the check for one strut.
#[derive(Clone, Copy, Debug, Default)]
pub struct TrappedOil {
    closed: u16,
    ticks: u16,
    p3: (f32, f32),
    p4: (f32, f32),
    wrong_windows: u8,
    flagged: bool,
}

impl TrappedOil {
    /// One tick; `commanded_closed` says whether valve 3 was told to be closed in the last tick.
    pub fn step(&mut self, pressure: &StrutPressures<Gauge<f32>>, commanded_closed: bool, verdict: &mut Verdicts) {
        let healthy = verdict.pressure.p3 == FaultCode::None && verdict.pressure.p4 == FaultCode::None;
        self.closed = if commanded_closed {
            self.closed.saturating_add(1)
        } else {
            0
        };
        if !healthy || self.closed < CLOSED_TICKS {
            self.ticks = 0;
        } else {
            let (p3, p4) = (pressure.p3.pa(), pressure.p4.pa());
            if self.ticks == 0 {
                (self.p3, self.p4) = ((p3, p3), (p4, p4));
            }
            widen(&mut self.p3, p3);
            widen(&mut self.p4, p4);
            self.ticks = self.ticks.saturating_add(1);
            if self.ticks >= WINDOW_TICKS {
                self.ticks = 0;
                self.end_of_window();
            }
        }
        if self.flagged {
            blame(&mut verdict.pressure.p4, FaultCode::ValveStuck);
        }
    }

    fn end_of_window(&mut self) {
        let (p3, p4) = (self.p3.1 - self.p3.0, self.p4.1 - self.p4.0);
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

/// Makes a range from its smallest to its largest value hold another value.
fn widen(range: &mut (f32, f32), value: f32) {
    if value < range.0 {
        range.0 = value;
    }
    if value > range.1 {
        range.1 = value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use oleo_interface::tick::TICK_S_F32;

    /// First tick in which the valve is called stuck, where p3 swings by 0.5 MPa at 1.3 Hz and p4 by a share of that.
    fn found(check: &mut TrappedOil, share: f32, closed: bool) -> Option<u16> {
        (0..1000).find(|tick| {
            let swing = 0.5e6 * libm::sinf(2.0 * core::f32::consts::PI * 1.3 * f32::from(*tick) * TICK_S_F32);
            let pressure = StrutPressures {
                p4: Gauge(2.0e6 + share * swing),
                ..StrutPressures::splat(Gauge(2.0e6 + swing))
            };
            let mut verdict = Verdicts::default();
            check.step(&pressure, closed, &mut verdict);
            verdict.pressure.p4 == FaultCode::ValveStuck
        })
    }

    #[test]
    fn p4_that_follows_through_a_closed_valve() {
        let two_windows = Some(CLOSED_TICKS + 2 * WINDOW_TICKS - 2);
        assert_eq!(found(&mut TrappedOil::default(), 1.0, true), two_windows);
        assert_eq!(found(&mut TrappedOil::default(), 0.5, true), two_windows);
        assert_eq!(found(&mut TrappedOil::default(), 0.05, true), None, "trapped");
        assert_eq!(found(&mut TrappedOil::default(), 1.0, false), None, "open");
    }

    #[test]
    fn stays_until_it_is_seen_to_be_closed() {
        let mut check = TrappedOil::default();
        assert!(found(&mut check, 1.0, true).is_some());
        assert_eq!(found(&mut check, 1.0, false), Some(0), "an open valve shows nothing");
        for _ in 0..2 {
            found(&mut check, 0.02, true);
        }
        let mut verdict = Verdicts::default();
        for _ in 0..CLOSED_TICKS + 2 * WINDOW_TICKS {
            let swing = 0.5e6 * libm::sinf(0.04 * f32::from(check.ticks));
            let pressure = StrutPressures {
                p4: Gauge(2.0e6),
                ..StrutPressures::splat(Gauge(2.0e6 + swing))
            };
            verdict = Verdicts::default();
            check.step(&pressure, true, &mut verdict);
        }
        assert_eq!(verdict.pressure.p4, FaultCode::None);
    }
}
