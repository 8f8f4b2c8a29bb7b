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
//! 0.2 s the displacement reading is called wrong (until it is below 25 mm again; the charge is not learnt meanwhile), and so it is
//! if the charge is outside 0.75 to 1.3 of what it was at the start, or outside 0.3 to 15 MPa, which no suspension has.
//!
//! Gas that valve 3 closed off far from its static volume `V2` is not isothermal yet: on the way there, within a stroke of the wheel, it
//! was adiabatic. With `u = k / p4` the equation is wrong by `V2 (u^(1 / 1.4) - u)`, which is at most 0.36 of the oil `V2 (1 - u)` that
//! moved, up to twice the static volume (`u = 2`). So much more than 40 mm is permitted while valve 3 is closed.

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
/// Largest error of the equation from gas that is not isothermal yet, over the stroke whose oil is in the second gas.
const ADIABATIC: f32 = 0.36;
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
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct OilBalance {
    charge_pa: f32,
    /// Charge that was learnt while the controller started.
    charge_at_start_pa: f32,
    residual_m: f32,
    /// Compression of the first gas from the static position, m of stroke.
    carried_m: f32,
    motion: OilMotion,
    wrong: u8,
    flagged: bool,
    started: bool,
}

impl OilBalance {
    pub const INITIAL: Self = Self {
        charge_pa: 0.0,
        charge_at_start_pa: 0.0,
        residual_m: 0.0,
        carried_m: 0.0,
        motion: OilMotion::INITIAL,
        wrong: 0,
        flagged: false,
        started: false,
    };

    /// One turn, with whether valve 3 is commanded open; returns the charge pressure as learnt so far.
    pub fn step(
        &mut self,
        c: &Parameters,
        displacement_m: f32,
        pressure: &StrutPressures<Gauge<f32>>,
        learning: bool,
        open: bool,
        verdict: &mut Verdicts,
    ) -> Absolute<f32> {
        let mut motion = None;
        let measured = [Place::DISPLACEMENT, Place::P2, Place::P4].map(|place| verdict.is_good(place)) == [true; 3];
        if measured {
            let (v1, v2) = (c.gas_volume_1_m3, c.gas_volume_2_m3);
            let least = |p: Gauge<f32>| at_least(p.absolute().pa(), LEAST_PA);
            let behind_valve_3 = v2 / least(pressure.p4);
            let s = v1 / least(pressure.p2) + behind_valve_3;
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
            let in_second_m = (v2 - self.charge_pa * behind_valve_3) * c.per_piston_area;
            self.carried_m = displacement_m - in_second_m;
            let drifted = self.charge_pa < DRIFT.0 * self.charge_at_start_pa
                || self.charge_pa > DRIFT.1 * self.charge_at_start_pa;
            let adiabatic = if open { 0.0 } else { ADIABATIC };
            let permitted_m = WRONG_M + adiabatic * in_second_m.abs();
            let wrong = self.residual_m.abs() > permitted_m
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

    /// How far the first gas is compressed from the static position, m of stroke, from the displacement and p4: what the second
    /// one has taken is not in it. As long as one of these was not measured, the last value.
    pub fn carried_m(&self) -> f32 {
        self.carried_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use oleo_interface::PressurePoint;

    const AREA_M2: f32 = 1.963_495_4e-3;

    /// A strut whose gas has a charge, with oil behind valve 3, at a displacement: pressures from volumes (Boyle).
    fn strut(charge_pa: f32, trapped_m: f32, displacement_m: f32) -> StrutPressures<Gauge<f32>> {
        let gas2 = 4.0e-4 - AREA_M2 * trapped_m;
        let gas1 = 5.0e-4 - AREA_M2 * displacement_m - gas2;
        let p2 = charge_pa * 1.0e-4 / gas1;
        StrutPressures {
            p4: charge_pa * 4.0e-4 / gas2,
            ..StrutPressures::splat(p2)
        }
        .map(|p| Absolute(p).gauge())
    }

    fn parameters() -> Parameters {
        Parameters::new(&VehicleDescription::default())
    }

    /// One turn with a reading that may differ from the truth; returns whether the displacement is called wrong, and the charge.
    fn turn(balance: &mut OilBalance, reading_m: f32, p: &StrutPressures<Gauge<f32>>, learning: bool) -> (bool, f32) {
        turn_at(balance, reading_m, p, learning, false)
    }

    /// The same with valve 3 closed or open.
    fn turn_at(
        balance: &mut OilBalance,
        reading_m: f32,
        p: &StrutPressures<Gauge<f32>>,
        learning: bool,
        closed: bool,
    ) -> (bool, f32) {
        let mut verdict = Verdicts::GOOD;
        let charge = balance.step(&parameters(), reading_m, p, learning, !closed, &mut verdict);
        assert!(verdict.pressures_are_good(), "it is about the displacement");
        (Verdicts::gravest(&[verdict]) == FaultCode::OilBalance, charge.pa())
    }

    /// After a second of learning at rest.
    fn settled(charge_pa: f32) -> OilBalance {
        let mut balance = OilBalance::INITIAL;
        for _ in 0..50 {
            turn(&mut balance, 0.0, &strut(charge_pa, 0.0, 0.0), true);
        }
        balance
    }

    /// Turns until the verdict is as wanted.
    fn turns_until(wanted: bool, mut step: impl FnMut() -> bool) -> Option<u16> {
        (1..1000).find(|_| step() == wanted)
    }

    #[test]
    fn the_first_gas_carries_what_the_second_has_not_taken() {
        for (x, trapped) in [(0.02, 0.0), (0.02, 0.01), (-0.03, 0.005), (0.0, -0.01)] {
            let mut balance = settled(2.4e6);
            turn(&mut balance, x, &strut(2.4e6, trapped, x), false);
            let carried = balance.carried_m();
            assert!(
                (carried - (x - trapped)).abs() < 1e-4,
                "{x} m, {trapped} m: {carried} m"
            );
        }
    }

    #[test]
    fn holds_at_any_displacement_with_any_oil_behind_the_valve() {
        let mut balance = OilBalance::INITIAL;
        for n in 0..2000_u16 {
            let (trapped, x) = (f32::from(n % 7) * 0.005 - 0.015, f32::from(n % 11) * 0.004 - 0.02);
            let (wrong, charge) = turn(&mut balance, x, &strut(2.4e6, trapped, x), n < 50);
            assert!(!wrong, "turn {n}");
            assert!((charge / 2.4e6 - 1.0).abs() < 1e-3, "turn {n}: {charge}");
        }
    }

    /// The wheel drops, the second gas expands without heat to half its pressure, and the valve closes it off: p4 is half of the
    /// charge, and its volume 2^(1 / 1.4) times the static one. The first gas is at its static volume.
    #[test]
    fn gas_that_is_closed_off_before_it_has_warmed_is_no_fault() {
        let adiabatic_m = -4.0e-4 * (libm::powf(2.0, 1.0 / 1.4) - 1.0) / AREA_M2;
        let cold = |charge_pa: f32| StrutPressures {
            p4: Absolute(0.5 * charge_pa).gauge(),
            ..StrutPressures::splat(Absolute(charge_pa).gauge())
        };
        for (closed, offset_m, wrong) in [
            (true, 0.0, false),
            (true, 0.03, false),
            (true, 0.06, true),
            (false, 0.0, true),
        ] {
            let mut balance = settled(2.0e6);
            let found = turns_until(true, || {
                turn_at(&mut balance, adiabatic_m + offset_m, &cold(2.0e6), false, closed).0
            });
            assert_eq!(found.is_some(), wrong, "{closed}, {offset_m} m");
        }
    }

    #[test]
    fn the_charge_is_learnt_quickly_at_first_and_slowly_later() {
        let mut balance = settled(2.0e6);
        // 5 % more: after a time constant 63 % of it are learnt.
        let mut after = |seconds: f32, learning| {
            let turns = (seconds / TURN_S) as u16;
            (0..turns)
                .map(|_| turn(&mut balance, 0.0, &strut(2.1e6, 0.0, 0.0), learning).1)
                .last()
                .unwrap()
        };
        let charge = after(60.0, false);
        assert!((charge - 2.0e6 - 0.632e5).abs() < 2.0e3, "{charge}");
        let charge = after(0.5, true);
        assert!((charge - 2.1e6).abs() < 1.0e2, "{charge}");
    }

    #[test]
    fn an_offset_is_found_in_the_documented_time_and_its_end_too() {
        for (offset_m, found_s) in [
            (0.035, None),
            (-0.035, None),
            (0.05, Some(1.61)),
            (-0.05, Some(1.61)),
            (0.07, Some(0.85)),
        ] {
            let mut balance = settled(2.0e6);
            // The lag of 1 s: ln(d / (d - 40 mm)), and 0.2 s. The charge learns some of it meanwhile.
            let found = turns_until(true, || turn(&mut balance, offset_m, &strut(2.0e6, 0.0, 0.0), false).0);
            match (found, found_s) {
                (None, None) => continue,
                (Some(found), Some(expected)) => {
                    let found = f32::from(found) * TURN_S;
                    assert!(
                        (expected..1.2 * expected + 0.25).contains(&found),
                        "{offset_m} m: {found} s"
                    );
                }
                other => panic!("{offset_m} m: {other:?}"),
            }
            let residual_m = balance.residual_m.abs();
            let charge_pa = balance.charge_pa;
            assert_eq!(
                turn(&mut balance, offset_m, &strut(2.0e6, 0.0, 0.0), false).1,
                charge_pa,
                "not learnt meanwhile"
            );
            // Back below 25 mm, and 0.2 s.
            let back = turns_until(false, || turn(&mut balance, 0.0, &strut(2.0e6, 0.0, 0.0), false).0);
            let back = f32::from(back.unwrap()) * TURN_S;
            let expected = libm::logf(residual_m / RIGHT_M) + 0.2;
            assert!(
                (back - expected).abs() < 0.15,
                "{offset_m} m: back after {back} s, expected {expected} s"
            );
        }
    }

    #[test]
    fn between_both_bounds_a_verdict_stays_as_it_is() {
        let mut balance = settled(2.0e6);
        let step = |balance: &mut OilBalance, offset_m| turn(balance, offset_m, &strut(2.0e6, 0.0, 0.0), false).0;
        assert!(turns_until(true, || step(&mut balance, 0.06)).is_some());
        assert!(
            (0..1000).all(|_| step(&mut balance, 0.032)),
            "above 25 mm it stays wrong"
        );
        assert!((0..1000).any(|_| !step(&mut balance, 0.015)));
    }

    #[test]
    fn a_charge_may_drift_by_a_quarter_and_not_further() {
        for (share, wrong) in [(0.78, false), (0.72, true), (1.27, false), (1.34, true)] {
            let mut balance = settled(2.0e6);
            let turns = 60_000_u16;
            let found = (0..turns).any(|n| {
                let charge = 2.0e6 * (1.0 + (share - 1.0) * f32::from(n) / f32::from(turns));
                turn(&mut balance, 0.0, &strut(charge, 0.0, 0.0), false).0
            });
            assert_eq!(found, wrong, "{share}");
        }
    }

    #[test]
    fn a_charge_that_no_suspension_has_is_wrong_from_the_start() {
        for (charge_pa, wrong) in [(0.25e6, true), (0.35e6, false), (14.5e6, false), (15.5e6, true)] {
            let mut balance = OilBalance::INITIAL;
            let found = turns_until(true, || turn(&mut balance, 0.0, &strut(charge_pa, 0.0, 0.0), true).0);
            assert_eq!(found, wrong.then_some(10), "{charge_pa} Pa");
        }
    }

    #[test]
    fn nothing_is_learnt_from_what_is_not_measured() {
        for place in [Place::DISPLACEMENT, Place::P2, Place::P4] {
            let mut balance = settled(2.0e6);
            let before = balance.charge_pa;
            for _ in 0..500 {
                let mut verdict = Verdicts::GOOD;
                verdict.blame(place, FaultCode::SensorRange);
                let charge = balance.step(&parameters(), 0.1, &strut(3.0e6, 0.0, 0.0), true, false, &mut verdict);
                assert_eq!((charge.pa(), Verdicts::count(&[verdict])), (before, 1));
            }
        }
        // p1 and p3 are not needed.
        let (mut balance, mut verdict) = (settled(2.0e6), Verdicts::GOOD);
        verdict.blame(Place::of(PressurePoint::P1), FaultCode::SensorRange);
        let charge = balance.step(&parameters(), 0.0, &strut(3.0e6, 0.0, 0.0), true, false, &mut verdict);
        assert!(charge.pa() > 2.1e6);
    }
}
