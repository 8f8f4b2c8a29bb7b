//! The motion of a strut against the motion of its gas: within half a second both must be the same.
//!
//! `oil_balance` compares means over a second, and so finds offsets. What it does not see is a displacement that moves wrongly: one
//! that is frozen but for its noise, that has the wrong sign or gain, or that comes from another strut. All of these leave a
//! residual that swings as much as the gas says that the strut moves.
//!
//! In windows of 0.5 s the span (largest less smallest value) of the residual is compared with the span of the displacement `x_g`
//! that follows from the gas, isothermal as everywhere here. Gas that has no time to exchange heat raises its pressure 1.4 times
//! as much and more, so that `x_g` is up to 1.4 times the displacement and the residual of a good strut a third of it. A frozen
//! displacement shows a share of 1, a reversed one 1.7, a gain of 3 more than 1.1. Above 0.93 in four windows in a row, in each of
//! which the gas says at least 25 mm, the displacement is called wrong; below 0.6 in one it is believed again. On a smooth road
//! nothing moves, and nothing can be concluded. False alarms and detection times: `docs/safety.md`.

use super::span::Span;
use super::turn::turns;
use super::verdict::{Place, Verdicts};
use crate::failsafe::FaultCode;

const WINDOW_TURNS: u8 = turns(500);
/// Number of windows that must agree.
const WINDOWS: u8 = 4;
/// Least span of the displacement that follows from the gas, m.
const MOVING_M: f32 = 0.025;
/// Share of it above which the residual calls the displacement wrong, and below which it calls it right.
const WRONG_SHARE: f32 = 0.93;
const RIGHT_SHARE: f32 = 0.6;

/// State of the comparison for one strut.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct OilMotion {
    turns: u8,
    residual: Span,
    from_gas: Span,
    wrong_windows: u8,
    flagged: bool,
}

impl OilMotion {
    /// The first turn begins a window: no reading is believed in it.
    pub const INITIAL: Self = Self {
        turns: 0,
        residual: Span::INITIAL,
        from_gas: Span::INITIAL,
        wrong_windows: 0,
        flagged: false,
    };

    /// One turn with a displacement and what it says beyond the gas, m, if both are measured.
    pub fn step(&mut self, measured: Option<(f32, f32)>, verdict: &mut Verdicts) {
        match measured {
            Some((displacement_m, residual_m)) => {
                self.residual.add(residual_m);
                self.from_gas.add(displacement_m - residual_m);
                self.turns = self.turns.saturating_add(1);
                if self.turns >= WINDOW_TURNS {
                    self.end_of_window();
                }
            }
            // A window with a gap says nothing.
            None => self.begin_window(),
        }
        if self.flagged {
            verdict.blame(Place::DISPLACEMENT, FaultCode::OilBalance);
        }
    }

    fn begin_window(&mut self) {
        self.turns = 0;
        self.residual = Span::EMPTY;
        self.from_gas = Span::EMPTY;
    }

    fn end_of_window(&mut self) {
        let (residual, moved) = (self.residual.width(), self.from_gas.width());
        self.begin_window();
        if moved < MOVING_M {
            return;
        }
        if residual > WRONG_SHARE * moved {
            self.wrong_windows = self.wrong_windows.saturating_add(1);
            self.flagged |= self.wrong_windows >= WINDOWS;
        } else {
            self.wrong_windows = 0;
            self.flagged &= residual >= RIGHT_SHARE * moved;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::turn::TURN_S;
    use super::*;

    /// Turn in which a reading that is `says` of the true displacement is called wrong, at 1.3 Hz and 20 mm either way. The gas says
    /// 1.4 times the truth, as it does where it has no time to exchange heat.
    fn found(says: impl Fn(f32) -> f32) -> Option<u16> {
        let mut motion = OilMotion::INITIAL;
        (0..1000).find(|turn| {
            let true_m = 0.02 * libm::sinf(2.0 * core::f32::consts::PI * 1.3 * f32::from(*turn) * TURN_S);
            let reading = says(true_m);
            let mut verdict = Verdicts::GOOD;
            motion.step(Some((reading, reading - 1.4 * true_m)), &mut verdict);
            verdict != Verdicts::GOOD
        })
    }

    #[test]
    fn gas_without_heat_exchange_is_no_fault_and_frozen_and_reversed_readings_are() {
        assert_eq!(found(|x| x), None);
        assert_eq!(found(|x| 1.4 * x), None);
        let four_windows = Some(4 * u16::from(WINDOW_TURNS) - 1);
        assert_eq!(found(|_| 0.01), four_windows);
        assert_eq!(found(|x| -x), four_windows);
        assert_eq!(found(|x| 3.0 * x), four_windows);
    }

    #[test]
    fn a_verdict_needs_motion_and_its_end_too() {
        let mut motion = OilMotion::INITIAL;
        let mut window = |residual_m: f32, moved_m: f32| {
            let mut verdict = Verdicts::GOOD;
            for turn in 0..WINDOW_TURNS {
                let up = f32::from(turn % 2);
                motion.step(Some((up * (moved_m + residual_m), up * residual_m)), &mut verdict);
            }
            // The verdict as it stands after the window.
            verdict = Verdicts::GOOD;
            motion.step(None, &mut verdict);
            verdict != Verdicts::GOOD
        };
        assert!((0..10).all(|_| !window(0.02, 0.02)), "too little motion");
        let verdicts: [bool; 4] = core::array::from_fn(|_| window(0.03, 0.03));
        assert_eq!(verdicts, [false, false, false, true]);
        assert!(
            (0..10).all(|_| window(0.0, 0.02)),
            "too little motion to see that it is right"
        );
        assert!(!window(0.0, 0.03));
    }

    #[test]
    fn a_verdict_ends_where_the_residual_is_a_small_share() {
        for (share, ends) in [(0.55, true), (0.65, false)] {
            let mut motion = OilMotion::INITIAL;
            let mut window = |residual_m: f32, moved_m: f32| {
                for turn in 0..WINDOW_TURNS {
                    let up = f32::from(turn % 2);
                    let measured = (up * (moved_m + residual_m), up * residual_m);
                    motion.step(Some(measured), &mut Verdicts::default());
                }
                motion.flagged
            };
            assert_eq!((0..4).map(|_| window(0.05, 0.05)).last(), Some(true));
            assert_eq!(!window(share * 0.05, 0.05), ends, "{share}");
        }
    }
}
