//! Displacement against the gas volumes: the oil that the piston has displaced must be in the accumulators.
//!
//! With `S = V1 / p2 + V2 / p4` (absolute pressures), gas volumes `V1` and `V2` at static position and charge pressure `k`,
//! isothermal gas and incompressible oil (report, "based on isothermal compression") give
//!
//! ```text
//!   A x = V1 + V2 - k S
//! ```
//!
//! which holds for any valve position and any load, also with oil trapped behind valve 3. The charge pressure `k` is not
//! configured. It is learnt from the same equation while the controller starts, and then follows the gas temperature slowly
//! (60 s). The residual, lagged by 1 s, is expected to stay within 25 mm (gas that is 30 K warmer: 10 % of 0.255 m). At 40 mm for
//! 0.2 s the displacement reading is called wrong (until it is below 25 mm again; the charge is not learnt meanwhile), and so it is if the charge is outside 0.75 to 1.3 of what it was at the start,
//! or outside 0.3 to 15 MPa, which no suspension has.

use oleo_interface::{Absolute, Gauge, StrutPressures};

use super::oil_motion::OilMotion;
use super::turn::{TURN_S, turns};
use super::verdict::{Place, Verdicts};
use crate::failsafe::FaultCode;
use crate::filter::{LowPass, at_least};
use crate::vehicle::VehicleDescription;

const WRONG_M: f32 = 0.04;
/// Residual below which a displacement that was called wrong is believed again.
const RIGHT_M: f32 = 0.025;
const CONFIRM_TURNS: u8 = turns(200);
const CHARGE_PA: (f32, f32) = (0.3e6, 15.0e6);
/// Smallest and largest share of the charge at the start. Gas that is 30 K warmer gives 1.1; the rest is leakage, or a sensor that
/// drifts more slowly than the charge is learnt.
const DRIFT: (f32, f32) = (0.75, 1.3);
/// Lowest pressure that is counted with, Pa absolute. It keeps the quotient finite where an accumulator is empty.
const LEAST_PA: f32 = 2.0e4;

/// Dimensions and filters of the balance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    piston_area_m2: f32,
    per_piston_area: f32,
    gas_volume_1_m3: f32,
    gas_volume_2_m3: f32,
    residual: LowPass,
    charge_start: LowPass,
    charge_drift: LowPass,
}

impl Parameters {
    /// From a description that has been checked.
    pub fn new(vehicle: &VehicleDescription) -> Self {
        Self {
            piston_area_m2: vehicle.piston_area_m2,
            per_piston_area: 1.0 / vehicle.piston_area_m2,
            gas_volume_1_m3: vehicle.gas_volume_1_m3,
            gas_volume_2_m3: vehicle.gas_volume_2_m3,
            residual: LowPass::sampled(TURN_S, 1.0),
            charge_start: LowPass::sampled(TURN_S, 0.05),
            charge_drift: LowPass::sampled(TURN_S, 60.0),
        }
    }
}

/// State of the balance of one strut.
#[derive(Clone, Copy, Debug, Default)]
pub struct OilBalance {
    charge_pa: f32,
    /// Charge that was learnt while the controller started.
    charge_at_start_pa: f32,
    residual_m: f32,
    motion: OilMotion,
    wrong: u8,
    flagged: bool,
    started: bool,
}

impl OilBalance {
    /// One turn; returns the charge pressure as learnt so far.
    pub fn step(
        &mut self,
        c: &Parameters,
        displacement_m: f32,
        pressure: &StrutPressures<Gauge<f32>>,
        learning: bool,
        verdict: &mut Verdicts,
    ) -> Absolute<f32> {
        let mut motion = None;
        let measured = [Place::DISPLACEMENT, Place::P2, Place::P4].map(|place| verdict.is_good(place)) == [true; 3];
        if measured {
            let (v1, v2) = (c.gas_volume_1_m3, c.gas_volume_2_m3);
            let least = |p: Gauge<f32>| at_least(p.absolute().pa(), LEAST_PA);
            let s = v1 / least(pressure.p2) + v2 / least(pressure.p4);
            let now_pa = (v1 + v2 - c.piston_area_m2 * displacement_m) / s;
            if !self.started {
                self.started = true;
                self.charge_pa = now_pa;
            }
            let residual = (self.charge_pa - now_pa) * s * c.per_piston_area;
            motion = Some((displacement_m, residual));
            if learning {
                c.charge_start.step(&mut self.charge_pa, now_pa);
                self.charge_at_start_pa = self.charge_pa;
                self.residual_m = 0.0;
            } else {
                // What a wrong reading says about the charge must not be learnt, or the fault would explain itself away.
                if !self.flagged {
                    c.charge_drift.step(&mut self.charge_pa, now_pa);
                }
                c.residual.step(&mut self.residual_m, residual);
            }
            let drifted = self.charge_pa < DRIFT.0 * self.charge_at_start_pa
                || self.charge_pa > DRIFT.1 * self.charge_at_start_pa;
            let wrong = self.residual_m.abs() > WRONG_M
                || drifted
                || self.charge_pa < CHARGE_PA.0
                || self.charge_pa > CHARGE_PA.1;
            self.wrong = if wrong {
                self.wrong.saturating_add(1).min(CONFIRM_TURNS)
            } else if !self.flagged || self.residual_m.abs() < RIGHT_M {
                self.wrong.saturating_sub(1)
            } else {
                self.wrong
            };
            if self.wrong == CONFIRM_TURNS {
                self.flagged = true;
            } else if self.wrong == 0 {
                self.flagged = false;
            }
        }
        if self.flagged {
            verdict.blame(Place::DISPLACEMENT, FaultCode::OilBalance);
        }
        self.motion.step(motion, verdict);
        Absolute(self.charge_pa)
    }
}
