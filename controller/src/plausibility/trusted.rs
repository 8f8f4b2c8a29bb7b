//! Readings that may be used, and the values that replace those that may not.

use oleo_interface::{Absolute, Corners, Gauge, StrutPressures};

use super::limits::DISPLACEMENT;
use super::verdict::{Place, Verdicts};
use crate::failsafe::{FaultCode, Health};
use crate::reading::Inputs;
use crate::sensor_message::MessageSet;

/// Readings that may be used, measured or replaced: always finite and within their range.
/// See [`State`](super::State) for an example.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Trusted {
    /// Strut displacement from the static position, m, compression positive, -0.25 to 0.25.
    pub displacement_m: Corners<f32>,
    /// Pressures p1 to p4 of each strut, Pa, -4.9e6 to 35e6.
    pub pressure: Corners<StrutPressures<Gauge<f32>>>,
    /// Gas pressure of each strut at its static position, Pa, learnt at start-up.
    pub charge: Corners<Absolute<f32>>,
    /// Health of the readings, for the mode machine.
    pub health: Health,
    /// Number of readings that were replaced, 0 to 20.
    pub invalid_readings: u8,
}

impl Trusted {
    /// Sums up the verdicts for the mode machine.
    pub(super) fn judge(&mut self, verdicts: &Corners<Verdicts>, inputs: &Inputs) {
        self.health = Health::default();
        self.invalid_readings = 0;
        let mut cause = FaultCode::None;
        for (corner, verdict) in verdicts.iter().filter(|(_, verdict)| **verdict != Verdicts::GOOD) {
            self.health.affected[corner] = true;
            self.invalid_readings = self.invalid_readings.saturating_add(verdict.count());
            cause = cause.max(verdict.gravest());
        }
        if inputs.lost_messages == MessageSet::ALL {
            cause = FaultCode::BusSilent;
        }
        if inputs.foreign_sender {
            // The valves may be somebody else's by now.
            self.health.affected = Corners::splat(true);
            cause = FaultCode::ForeignSender;
        }
        if inputs.solenoid_failed {
            cause = FaultCode::Solenoid;
        }
        self.health.cause = cause;
    }

    /// Takes over the last good readings, and replaces those that were found wrong.
    pub(super) fn substitute(&mut self, measured: &Self, verdicts: &Corners<Verdicts>) {
        let good = verdicts.map(|verdict| verdict.is_good(Place::DISPLACEMENT));
        let [fl, fr, rl, rr] = measured.displacement_m.into_array();
        // The body is rigid: left and right differ equally at both axles.
        let within = |x: f32| x.clamp(DISPLACEMENT.least, DISPLACEMENT.most);
        self.displacement_m = Corners::from_array(match good.into_array() {
            [false, true, true, true] => [within(fr + rl - rr), fr, rl, rr],
            [true, false, true, true] => [fl, within(fl + rr - rl), rl, rr],
            [true, true, false, true] => [fl, fr, within(rr + fl - fr), rr],
            [true, true, true, false] => [fl, fr, rl, within(rl + fr - fl)],
            _ => [fl, fr, rl, rr],
        });
        let pressures = self.pressure.each_mut().zip(measured.pressure.each_ref());
        for ((pressure, measured), verdict) in pressures.zip(*verdicts).into_array() {
            *pressure = *measured;
            if verdict.pressures_are_good() {
                continue;
            }
            let good = |place| verdict.is_good(place);
            pressure.p1 = if good(Place::P1) {
                measured.p1
            } else if good(Place::P2) {
                measured.p2
            } else if good(Place::P3) {
                measured.p3
            } else {
                measured.p1
            };
            if !good(Place::P2) {
                pressure.p2 = pressure.p1;
            }
            if !good(Place::P3) {
                pressure.p3 = pressure.p1;
            }
        }
    }
}
