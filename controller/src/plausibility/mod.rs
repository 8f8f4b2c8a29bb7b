//! Which readings may be used, and what stands in for those that may not.
//!
//! A wrong number is worse than none, since it opens valves. Each reading passes, in this order, the checks below; what fails is
//! replaced and its corner is reported *affected*, which the mode machine turns into permission.
//!
//! | check | what it sees | detected within (ticks) | file |
//! |---|---|---|---|
//! | range, NaN, flagged invalid | broken wire, dead sensor | 3 | `reading_check` |
//! | rate | spikes, bit errors before protection | 3 | `reading_check` |
//! | stuck | frozen value while the strut moves | 200 | `stuck` |
//! | vote | one pressure off by over 1 MPa | about 2 s / offset (MPa) | `vote` |
//! | oil balance | displacement against gas volumes, off by over 40 mm | 600 | `oil_balance` |
//! | link (from the node) | late or untrusted message | at once | `reading_check` |
//!
//! Substitutes: while a check makes up its mind, the last good value. After that: a displacement from the other three (the body is
//! rigid, the axles assumed unmoved); p1 from p2 or p3 (equal at rest); p2, p3 from p1; p4 keeps its last value, and the
//! mode machine forbids spring switching anyway.

mod oil_balance;
mod reading_check;
mod stuck;
mod vote;

use crate::configuration::Configuration;
use crate::failsafe::{FaultCode, Health};
use crate::reading::{Inputs, MessageSet};
use crate::valves::CORNERS;
pub use oil_balance::ATMOSPHERE_PA;
use oil_balance::OilBalance;
use reading_check::{Limits, ReadingCheck};
use stuck::Stuck;
use vote::Vote;

/// All six sensor messages.
const ALL_MESSAGES: MessageSet = 0x3F;

/// Struts have 120 mm of jounce and 180 mm of rebound travel; 6 m/s is three times the design speed (report: 2 m/s).
const DISPLACEMENT: Limits = Limits {
    least: -0.25,
    most: 0.25,
    step: 0.03,
};
/// To 1.75 times the pressure at full bump (report: 20 MPa). Downwards a fast rebound brings p1 to vacuum (-0.1 MPa gauge) and a
/// sensor's offset a little below; nothing is gained by a bound near that, so the limit is just above the dead signal's -5 MPa.
/// Wheel impacts through closed bypass valves change p1 by 10 MPa in a tick: only garbage is faster than 20.
const PRESSURE: Limits = Limits {
    least: -4.9e6,
    most: 35.0e6,
    step: 20.0e6,
};

/// Readings that may be used: measured or substituted, always finite and within range.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Trusted {
    /// Displacements, m, compression positive.
    pub displacement_m: [f32; CORNERS],
    /// Gauge pressures p1 to p4, Pa.
    pub pressure_pa: [[f32; 4]; CORNERS],
    /// Absolute gas charge pressure at static position, Pa, learnt at start-up.
    pub charge_pa: [f32; CORNERS],
    /// For the mode machine.
    pub health: Health,
    /// Number of readings that were replaced.
    pub invalid_readings: u8,
}

/// Memory of all checks.
#[derive(Clone, Copy, Debug, Default)]
pub struct State {
    displacement: [ReadingCheck; CORNERS],
    pressure: [[ReadingCheck; 4]; CORNERS],
    stuck: Stuck,
    vote: [Vote; CORNERS],
    oil: [OilBalance; CORNERS],
}

/// What the checks must know of the commands: p4 follows only through an open valve 3.
#[derive(Clone, Copy, Debug, Default)]
pub struct Context {
    /// Valve 3 has been open for long enough that p4 follows.
    pub spring_settled_open: [bool; CORNERS],
    /// The vehicle has not been in `Normal` yet: gas charges are being learnt.
    pub learning: bool,
}

impl State {
    /// One tick.
    pub fn step(&mut self, c: &Configuration, inputs: &Inputs, context: &Context) -> Trusted {
        let lost = inputs.lost_messages;
        let mut trusted = Trusted::default();
        let mut verdicts = [Verdicts::default(); CORNERS];

        for (corner, (((check, reading), value), verdict)) in self
            .displacement
            .iter_mut()
            .zip(inputs.displacement)
            .zip(&mut trusted.displacement_m)
            .zip(&mut verdicts)
            .enumerate()
        {
            let message_lost = lost & (1 << (CORNERS + corner / 2)) != 0;
            verdict.displacement = check.step(reading, message_lost, &DISPLACEMENT);
            *value = check.value();
        }
        for (corner, (((checks, readings), values), verdict)) in self
            .pressure
            .iter_mut()
            .zip(inputs.pressure)
            .zip(&mut trusted.pressure_pa)
            .zip(&mut verdicts)
            .enumerate()
        {
            let message_lost = lost & (1 << corner) != 0;
            for (((check, reading), value), fault) in
                checks.iter_mut().zip(readings).zip(values).zip(&mut verdict.pressure)
            {
                *fault = check.step(reading, message_lost, &PRESSURE);
                *value = check.value();
            }
        }

        self.stuck.step(&trusted, context, &mut verdicts);
        for ((((vote, oil), pressure), x), ((verdict, charge), settled)) in self
            .vote
            .iter_mut()
            .zip(&mut self.oil)
            .zip(&trusted.pressure_pa)
            .zip(trusted.displacement_m)
            .zip(
                verdicts
                    .iter_mut()
                    .zip(&mut trusted.charge_pa)
                    .zip(context.spring_settled_open),
            )
        {
            vote.step(c, pressure, settled, verdict);
            *charge = oil.step(c, x, pressure, context.learning, verdict);
        }

        trusted.judge(&verdicts, inputs);
        // Nothing to replace is the usual tick, and a good reading is in range already.
        if trusted.invalid_readings > 0 {
            trusted.substitute(&verdicts);
        }
        trusted
    }
}

/// What is wrong with each reading of a corner.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Verdicts {
    displacement: FaultCode,
    pressure: [FaultCode; 4],
}

impl Verdicts {
    fn all(&self) -> impl Iterator<Item = FaultCode> {
        core::iter::once(self.displacement).chain(self.pressure)
    }
}

/// The first finding stands.
fn blame(verdict: &mut FaultCode, cause: FaultCode) {
    if *verdict == FaultCode::None {
        *verdict = cause;
    }
}

impl Trusted {
    fn judge(&mut self, verdicts: &[Verdicts; CORNERS], inputs: &Inputs) {
        let mut cause = FaultCode::None;
        for (affected, verdict) in self.health.affected.iter_mut().zip(verdicts) {
            if *verdict == Verdicts::default() {
                continue;
            }
            for fault in verdict.all().filter(|&fault| fault != FaultCode::None) {
                *affected = true;
                self.invalid_readings = self.invalid_readings.saturating_add(1);
                cause = cause.max(fault);
            }
        }
        if inputs.lost_messages & ALL_MESSAGES == ALL_MESSAGES {
            cause = FaultCode::BusSilent;
        }
        if inputs.solenoid_failed {
            cause = FaultCode::Solenoid;
        }
        self.health.cause = cause;
    }

    fn substitute(&mut self, verdicts: &[Verdicts; CORNERS]) {
        let good = verdicts.each_ref().map(|v| v.displacement == FaultCode::None);
        let [fl, fr, rl, rr] = self.displacement_m;
        // Rigid body: the two axles' left-right differences are equal.
        self.displacement_m = match good {
            [false, true, true, true] => [fr + rl - rr, fr, rl, rr],
            [true, false, true, true] => [fl, fl + rr - rl, rl, rr],
            [true, true, false, true] => [fl, fr, rr + fl - fr, rr],
            [true, true, true, false] => [fl, fr, rl, rl + fr - fl],
            _ => self.displacement_m,
        }
        .map(|x| x.clamp(DISPLACEMENT.least, DISPLACEMENT.most));
        for (pressure, verdict) in self.pressure_pa.iter_mut().zip(verdicts) {
            let [g1, g2, g3, _] = verdict.pressure.map(|fault| fault == FaultCode::None);
            let [p1, p2, p3, p4] = *pressure;
            let main = if g1 {
                p1
            } else if g2 {
                p2
            } else if g3 {
                p3
            } else {
                p1
            };
            *pressure = [main, if g2 { p2 } else { main }, if g3 { p3 } else { main }, p4];
        }
    }
}
