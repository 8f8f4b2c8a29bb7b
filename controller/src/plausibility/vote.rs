//! The pressures of one strut against each other.
//!
//! At rest p1 = p2 = p3, and = p4 behind an open valve 3: dampers and orifices take pressure only from moving oil. In motion the *means* over
//! a second still agree but for the asymmetry of the damper packs (rebound takes about twice jounce: estimated 0.4 MPa at 0.5 m/s).
//! So lagged pressures are compared, and the one that is more than 1 MPa off two that agree is wrong. An offset of
//! `d` is seen after `tau ln(d / (d - 1 MPa))` and 40 ticks of confirmation: 1.1 s for 1.7 MPa, 0.5 s for 4 MPa.
//! Smaller offsets are not seen by this check.

use super::{Verdicts, blame};
use crate::configuration::Configuration;
use crate::failsafe::FaultCode;

const DISAGREE_PA: f32 = 1.0e6;
const CONFIRM_TICKS: u8 = 40;

/// State for one strut.
#[derive(Clone, Copy, Debug, Default)]
pub struct Vote {
    lagged: [f32; 4],
    outvoted: [u8; 4],
    flagged: [bool; 4],
    started: bool,
}

impl Vote {
    /// One tick. `p4_follows`: valve 3 has been open for long enough.
    pub fn step(&mut self, c: &Configuration, pressure: &[f32; 4], p4_follows: bool, verdict: &mut Verdicts) {
        let healthy = verdict.pressure.iter().all(|&fault| fault == FaultCode::None);
        if !healthy {
            // Held values are no witnesses; begin again when all four speak. A verdict already reached stands.
            self.started = false;
        } else {
            if !self.started {
                self.started = true;
                self.lagged = *pressure;
            }
            for (lagged, &p) in self.lagged.iter_mut().zip(pressure) {
                c.vote.step(lagged, p);
            }
        }
        let [p1, p2, p3, p4] = self.lagged;
        let apart = |a: f32, b: f32| (a - b).abs() > DISAGREE_PA;
        let (d12, d13, d23) = (apart(p1, p2), apart(p1, p3), apart(p2, p3));
        let wrong = [
            d12 && d13 && !d23,
            d12 && d23 && !d13,
            d13 && d23 && !d12,
            p4_follows && apart(p4, p3) && !(d13 && d23),
        ];
        for (((count, flagged), wrong), fault) in self
            .outvoted
            .iter_mut()
            .zip(&mut self.flagged)
            .zip(wrong)
            .zip(&mut verdict.pressure)
        {
            if healthy {
                *count = if wrong {
                    count.saturating_add(1).min(CONFIRM_TICKS)
                } else {
                    count.saturating_sub(1)
                };
                if *count == CONFIRM_TICKS {
                    *flagged = true;
                } else if *count == 0 {
                    *flagged = false;
                }
            }
            if *flagged {
                blame(fault, FaultCode::SensorVote);
            }
        }
    }
}
