//! Readings that may be used, and the values that replace those that may not.

use oleo_interface::{Absolute, Corner, Corners, Gauge, StrutPressures};

use super::limits::DISPLACEMENT;
use super::verdict::{Place, Verdicts};
use crate::failsafe::{FaultCode, Health};
use crate::reading::Inputs;
use crate::sensor_message::MessageSet;

/// Readings that may be used, measured or replaced: always finite and within their range.
/// See [`State`](super::State) for an example.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Trusted {
    /// Strut displacement from the static position, m, compression positive, -0.25 to 0.25.
    pub displacement_m: Corners<f32>,
    /// Pressures p1 to p4 of each strut, Pa, -4.9e6 to 35e6.
    pub pressure: Corners<StrutPressures<Gauge<f32>>>,
    /// What p1 of each strut shows in the mean beyond what its other pressures say, Pa: an offset of the sensor.
    pub p1_offset_pa: Corners<f32>,
    /// How much further the first gas is compressed on the right than on the left, m of stroke, mean of the axles, from displacements
    /// and p4.
    pub load_to_right_m: f32,
    /// Gas pressure of each strut at its static position, Pa, learnt at start-up.
    pub charge: Corners<Absolute<f32>>,
    /// Health of the readings, for the mode machine.
    pub health: Health,
    /// Number of readings that were replaced, 0 to 20.
    pub invalid_readings: u8,
}

impl Default for Trusted {
    fn default() -> Self {
        Self::INITIAL
    }
}

impl Trusted {
    pub(super) const INITIAL: Self = Self {
        displacement_m: Corners::splat(0.0),
        pressure: Corners::splat(StrutPressures::splat(Gauge(0.0))),
        p1_offset_pa: Corners::splat(0.0),
        load_to_right_m: 0.0,
        charge: Corners::splat(Absolute(0.0)),
        health: Health::GOOD,
        invalid_readings: 0,
    };

    /// Sums up the verdicts for the mode machine.
    pub(super) fn judge(&mut self, verdicts: &Corners<Verdicts>, inputs: &Inputs) {
        self.health.affected = verdicts.map(|verdict| verdict != Verdicts::GOOD);
        self.invalid_readings = Verdicts::count(verdicts.as_array());
        let mut cause = Verdicts::gravest(verdicts.as_array());
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
        self.pressure = measured.pressure;
        self.p1_offset_pa = measured.p1_offset_pa;
        self.load_to_right_m = measured.load_to_right_m;
        for corner in Corner::ALL {
            let verdict = verdicts[corner];
            if !verdict.pressures_are_good() {
                replace_wrong(&mut self.pressure[corner], verdict);
                if !verdict.is_good(Place::P1) {
                    // What stands for it does not have its offset.
                    self.p1_offset_pa[corner] = 0.0;
                }
            }
        }
    }
}

/// Replaces the last good pressures of a strut where the present ones were found wrong.
#[inline(never)]
fn replace_wrong(pressure: &mut StrutPressures<Gauge<f32>>, verdict: Verdicts) {
    let good = |place| verdict.is_good(place);
    if !good(Place::P1) {
        if good(Place::P2) {
            pressure.p1 = pressure.p2;
        } else if good(Place::P3) {
            pressure.p1 = pressure.p3;
        }
    }
    if !good(Place::P2) {
        pressure.p2 = pressure.p1;
    }
    if !good(Place::P3) {
        pressure.p3 = pressure.p1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use oleo_interface::{Axle, PressurePoint, Side};

    const PLACES: [Place; 4] = [Place::P1, Place::P2, Place::P3, Place::P4];

    /// The corners of a rigid body that has moved up, pitched and rolled, m.
    fn rigid(heave: f32, pitch: f32, roll: f32) -> Corners<f32> {
        Corners::from_fn(|corner| {
            let fore = if corner.axle() == Axle::Front { 1.4 } else { -1.4 };
            let left = if corner.side() == Side::Left { 0.5 } else { -0.5 };
            heave + pitch * fore + roll * left
        })
    }

    fn blamed(corner: Corner, places: &[Place]) -> Corners<Verdicts> {
        let mut verdicts = Corners::splat(Verdicts::GOOD);
        for place in places {
            verdicts[corner].blame(*place, FaultCode::SensorRange);
        }
        verdicts
    }

    #[test]
    fn a_missing_displacement_follows_from_a_rigid_body() {
        for (heave, pitch, roll) in [(0.01, 0.02, -0.03), (-0.02, 0.0, 0.04), (0.0, -0.03, 0.01)] {
            let truth = rigid(heave, pitch, roll);
            for missing in Corner::ALL {
                let mut measured = Trusted {
                    displacement_m: truth,
                    ..Trusted::default()
                };
                measured.displacement_m[missing] = 0.2;
                let mut trusted = Trusted::default();
                trusted.substitute(&measured, &blamed(missing, &[Place::DISPLACEMENT]));
                for (corner, x) in trusted.displacement_m.iter() {
                    assert!((x - truth[corner]).abs() < 1e-6, "{missing:?}: {trusted:?}");
                }
            }
        }
    }

    #[test]
    fn what_replaces_a_displacement_is_in_range_and_two_missing_ones_are_kept() {
        let mut measured = Trusted {
            displacement_m: Corners::from_array([0.0, 0.2, 0.2, -0.2]),
            ..Trusted::default()
        };
        let mut trusted = Trusted::default();
        trusted.substitute(&measured, &blamed(Corner::FrontLeft, &[Place::DISPLACEMENT]));
        assert_eq!(trusted.displacement_m[Corner::FrontLeft], DISPLACEMENT.most);
        measured.displacement_m = Corners::from_array([0.2, -0.2, -0.2, 0.0]);
        trusted.substitute(&measured, &blamed(Corner::RearRight, &[Place::DISPLACEMENT]));
        assert_eq!(trusted.displacement_m[Corner::RearRight], DISPLACEMENT.least);
        let mut two = blamed(Corner::FrontLeft, &[Place::DISPLACEMENT]);
        two[Corner::RearLeft] = two[Corner::FrontLeft];
        trusted.substitute(&measured, &two);
        assert_eq!(trusted.displacement_m, measured.displacement_m);
    }

    /// p1 to p3 are equal at rest, so one that is measured stands for those that are not. p4 has no replacement.
    #[test]
    fn missing_pressures_follow_from_the_strut_s_others() {
        let last = StrutPressures::from_array([1.0e6, 2.0e6, 3.0e6, 4.0e6]).map(Gauge);
        for missing in 0..16_u8 {
            let is_missing = |n: usize| missing >> n & 1 == 1;
            let mut verdicts = Corners::splat(Verdicts::GOOD);
            for (_, place) in PLACES.into_iter().enumerate().filter(|(n, _)| is_missing(*n)) {
                verdicts[Corner::RearLeft].blame(place, FaultCode::SensorRate);
            }
            let measured = Trusted {
                pressure: Corners::splat(last),
                p1_offset_pa: Corners::splat(0.3e6),
                ..Trusted::default()
            };
            let mut trusted = Trusted::default();
            trusted.substitute(&measured, &verdicts);
            // What stands for p1 has no offset of its sensor.
            let offset_pa = if is_missing(0) { 0.0 } else { 0.3e6 };
            assert_eq!(trusted.p1_offset_pa[Corner::RearLeft], offset_pa, "{missing:04b}");
            assert_eq!(trusted.p1_offset_pa[Corner::FrontLeft], 0.3e6);
            // The first of p1, p2, p3 that is measured; the last good p1 if none is.
            let stand_in = (0..3).find(|n| !is_missing(*n)).unwrap_or(0);
            for (n, point) in PressurePoint::ALL.into_iter().enumerate() {
                let from = if is_missing(n) && n < 3 { stand_in } else { n };
                let expected = last[PressurePoint::ALL[from]];
                assert_eq!(
                    trusted.pressure[Corner::RearLeft][point],
                    expected,
                    "{missing:04b} {point:?}"
                );
                assert_eq!(trusted.pressure[Corner::FrontLeft][point], last[point]);
            }
        }
    }

    #[test]
    fn the_gravest_cause_is_told_and_the_corners_that_it_concerns() {
        let mut verdicts = blamed(Corner::FrontRight, &[Place::P1, Place::P4]);
        verdicts[Corner::RearLeft].blame(Place::DISPLACEMENT, FaultCode::MessageLost);
        let judged = |inputs: &Inputs| {
            let mut trusted = Trusted::default();
            trusted.judge(&verdicts, inputs);
            (
                trusted.health.cause,
                trusted.health.affected.into_array(),
                trusted.invalid_readings,
            )
        };
        let mut inputs = Inputs::default();
        let two = [false, true, true, false];
        assert_eq!(judged(&inputs), (FaultCode::MessageLost, two, 3));
        inputs.lost_messages = MessageSet::ALL;
        assert_eq!(judged(&inputs), (FaultCode::BusSilent, two, 3));
        inputs.foreign_sender = true;
        assert_eq!(judged(&inputs), (FaultCode::ForeignSender, [true; 4], 3));
        inputs.solenoid_failed = true;
        assert_eq!(judged(&inputs), (FaultCode::Solenoid, [true; 4], 3));
    }
}
