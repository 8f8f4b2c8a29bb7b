//! Check of one reading by itself: is it present, finite, in range, and not faster than the hardware can move?
//!
//! A single bad sample is replaced by the last good one. A counter goes up by 4 with each bad sample and down by 1 with each good
//! one. At 12 the reading is faulty, which takes three bad samples in a row, and at 0 it is believed again.

use oleo_interface::{Gauge, StrutPressures};

use super::limits::{DISPLACEMENT, Limits, PRESSURE};
use super::verdict::Verdicts;
use crate::failsafe::FaultCode;
use crate::reading::Reading;

const UP: u8 = 4;
const LIMIT: u8 = 12;

/// State of the check. It starts as faulty: a sensor is believed after it has delivered twelve good samples. The last good value
/// is kept by the caller.
#[derive(Clone, Copy, Debug)]
pub struct ReadingCheck {
    bad: u8,
    faulty: bool,
    cause: FaultCode,
    /// Ticks since the last good sample.
    age: u8,
}

impl Default for ReadingCheck {
    fn default() -> Self {
        Self {
            bad: LIMIT,
            faulty: true,
            cause: FaultCode::SensorRange,
            age: u8::MAX,
        }
    }
}

/// Whether a reading is good by itself, if the last sample was.
fn is_ordinary(reading: Reading, last: f32, limits: &Limits) -> bool {
    // Nothing compares with NaN, so no invalid reading passes.
    let value = reading.value_or_nan();
    (value - last).abs() <= limits.step && limits.hold(value)
}

impl ReadingCheck {
    /// One tick; returns what is wrong if the reading is to be replaced, and [`FaultCode::None`] if it may be used. `last` is the
    /// last good value.
    fn step(&mut self, last: &mut f32, reading: Reading, message_lost: bool, limits: &Limits) -> FaultCode {
        let value = reading.value_or_nan();
        let change = (value - *last).abs();
        let in_range = limits.hold(value);
        if in_range && (change <= limits.step || self.reaches(change, limits)) {
            *last = value;
            self.age = 0;
            self.bad = self.bad.saturating_sub(1);
            if self.bad == 0 {
                self.faulty = false;
            }
        } else {
            self.age = self.age.saturating_add(1);
            // The node has already waited before it called a message lost.
            self.bad = if message_lost {
                LIMIT
            } else {
                self.bad.saturating_add(UP).min(LIMIT)
            };
            if self.bad == LIMIT {
                self.faulty = true;
                self.cause = if message_lost {
                    FaultCode::MessageLost
                } else if in_range {
                    FaultCode::SensorRate
                } else {
                    FaultCode::SensorRange
                };
            }
        }
        if self.faulty { self.cause } else { FaultCode::None }
    }

    /// Whether a value may have changed so much: the longer ago the last good sample, the further it may have gone.
    fn reaches(&self, change: f32, limits: &Limits) -> bool {
        self.age == u8::MAX || change <= limits.step * (f32::from(self.age) + 1.0)
    }
}

/// The checks of the five readings of a strut.
#[derive(Clone, Copy, Debug, Default)]
pub struct StrutReadings {
    displacement: ReadingCheck,
    pressure: StrutPressures<ReadingCheck>,
    /// Whether nothing was wrong with any of the readings lately.
    calm: bool,
    /// What is wrong; nothing while all are calm.
    verdicts: Verdicts,
}

impl StrutReadings {
    /// What the last tick has found.
    pub fn verdicts(&self) -> Verdicts {
        self.verdicts
    }

    /// One tick: takes the good readings over into the last good displacement, m, and pressures, Pa. Returns whether nothing was
    /// wrong with any of them lately. `lost` says whether the displacement's and the pressures' message are lost.
    #[inline(always)]
    pub fn step(
        &mut self,
        (displacement, last_displacement_m): (Reading, &mut f32),
        (pressure, last_pressure): (&StrutPressures<Reading>, &mut StrutPressures<Gauge<f32>>),
        lost: impl FnOnce() -> (bool, bool),
    ) -> bool {
        // Most ticks end here: nothing was wrong lately, so all last samples were good, and nothing is wrong now.
        if self.calm
            && is_ordinary(displacement, *last_displacement_m, &DISPLACEMENT)
            && is_ordinary(pressure.p1, last_pressure.p1.pa(), &PRESSURE)
            && is_ordinary(pressure.p2, last_pressure.p2.pa(), &PRESSURE)
            && is_ordinary(pressure.p3, last_pressure.p3.pa(), &PRESSURE)
            && is_ordinary(pressure.p4, last_pressure.p4.pa(), &PRESSURE)
        {
            *last_displacement_m = displacement.value_or_nan();
            *last_pressure = pressure.map(|reading| Gauge(reading.value_or_nan()));
            return true;
        }
        self.doubt((displacement, last_displacement_m), (pressure, last_pressure), lost());
        self.calm
    }

    /// The whole checks, for readings of which one was wrong lately or may be wrong now.
    #[inline(never)]
    fn doubt(
        &mut self,
        (displacement, last_displacement_m): (Reading, &mut f32),
        (pressure, last_pressure): (&StrutPressures<Reading>, &mut StrutPressures<Gauge<f32>>),
        lost: (bool, bool),
    ) {
        let cause = (self.displacement).step(last_displacement_m, displacement, lost.0, &DISPLACEMENT);
        let (checks, last) = (&mut self.pressure, last_pressure);
        let one = |check: &mut ReadingCheck, Gauge(last): &mut Gauge<f32>, reading| {
            check.step(last, reading, lost.1, &PRESSURE)
        };
        let causes = [
            one(&mut checks.p1, &mut last.p1, pressure.p1),
            one(&mut checks.p2, &mut last.p2, pressure.p2),
            one(&mut checks.p3, &mut last.p3, pressure.p3),
            one(&mut checks.p4, &mut last.p4, pressure.p4),
        ];
        self.verdicts = Verdicts::of(cause, causes);
        let bad = checks.p1.bad | checks.p2.bad | checks.p3.bad | checks.p4.bad;
        self.calm = self.displacement.bad | bad == 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: Limits = Limits {
        least: -1.0,
        most: 1.0,
        step: 0.1,
    };

    fn healthy() -> (ReadingCheck, f32) {
        let (mut check, mut last) = (ReadingCheck::default(), 0.0);
        for _ in 0..LIMIT {
            check.step(&mut last, Reading::new(0.5), false, &LIMITS);
        }
        (check, last)
    }

    #[test]
    fn believed_after_twelve() {
        let (mut check, mut last) = (ReadingCheck::default(), 0.0);
        for n in 1..=LIMIT {
            let fault = check.step(&mut last, Reading::new(0.5), false, &LIMITS);
            assert_eq!(fault == FaultCode::None, n == LIMIT, "sample {n}");
        }
    }

    #[test]
    fn third_bad_sample_in_a_row_and_the_value_is_held() {
        for (bad, cause) in [
            (Reading::INVALID, FaultCode::SensorRange),
            (Reading::new(f32::NAN), FaultCode::SensorRange),
            (Reading::new(1.01), FaultCode::SensorRange),
            (Reading::new(-0.9), FaultCode::SensorRate),
        ] {
            let (mut check, mut last) = healthy();
            assert!(!is_ordinary(bad, last, &LIMITS));
            assert_eq!(check.step(&mut last, bad, false, &LIMITS), FaultCode::None);
            assert_eq!(check.step(&mut last, bad, false, &LIMITS), FaultCode::None);
            assert_eq!(check.step(&mut last, bad, false, &LIMITS), cause);
            assert_eq!(last, 0.5);
        }
    }

    #[test]
    fn a_lost_message_is_a_fault_at_once() {
        let (mut check, mut last) = healthy();
        let fault = check.step(&mut last, Reading::INVALID, true, &LIMITS);
        assert_eq!(fault, FaultCode::MessageLost);
    }

    #[test]
    fn a_real_jump_is_accepted_in_time() {
        let (mut check, mut last) = healthy();
        let mut n = 0;
        while last != -0.5 {
            check.step(&mut last, Reading::new(-0.5), false, &LIMITS);
            n += 1;
        }
        assert_eq!(n, 10); // 1.0 at 0.1 a tick
    }

    /// The short way and the whole check agree on every reading of a strut.
    #[test]
    fn the_short_way_decides_as_the_whole_check() {
        let mut checks = StrutReadings::default();
        let mut whole = checks;
        let (mut last, mut last_whole) = ((0.0, StrutPressures::default()), (0.0, StrutPressures::default()));
        let mut random = 1_u32;
        for _ in 0..20_000 {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let pressure = |shift: u32| match random >> shift & 0x3FF {
                0 => Reading::INVALID,
                1 => Reading::new(36.0e6),
                2 => Reading::new(-5.0e6),
                n => Reading::new(1.0e4 * n as f32),
            };
            let reading = StrutPressures::from_array([pressure(4), pressure(9), pressure(14), pressure(19)]);
            let displacement = Reading::new((random >> 22) as f32 * 3.0e-4 - 0.01);
            checks.step((displacement, &mut last.0), (&reading, &mut last.1), || (false, false));
            whole.doubt(
                (displacement, &mut last_whole.0),
                (&reading, &mut last_whole.1),
                (false, false),
            );
            assert_eq!(
                (checks.verdicts, checks.calm, last),
                (whole.verdicts, whole.calm, last_whole)
            );
        }
    }

    /// A strut whose five readings have been good for long, at a displacement and under one pressure.
    fn calm(displacement_m: f32, pressure_pa: f32) -> (StrutReadings, f32, StrutPressures<Gauge<f32>>) {
        let (mut checks, mut x, mut p) = (StrutReadings::default(), 0.0, StrutPressures::default());
        let pressure = StrutPressures::splat(Reading::new(pressure_pa));
        for _ in 0..=LIMIT {
            checks.step((Reading::new(displacement_m), &mut x), (&pressure, &mut p), || {
                (false, false)
            });
        }
        assert!(checks.calm);
        (checks, x, p)
    }

    /// No way of writing a jump makes it ordinary.
    #[test]
    fn a_jump_is_not_taken_over() {
        for (from_m, to_m) in [
            (0.1, -0.1),
            (0.1, 0.0),
            (0.0, 0.1),
            (-0.1, 0.1),
            (-0.1, 0.0),
            (0.1, 0.14),
        ] {
            let (mut checks, mut x, mut p) = calm(from_m, 2.0e6);
            let pressure = StrutPressures::splat(Reading::new(2.0e6));
            let good = checks.step((Reading::new(to_m), &mut x), (&pressure, &mut p), || (false, false));
            assert_eq!((good, x), (false, from_m), "{from_m} to {to_m}");
        }
    }

    /// One wrong reading, and any two, keep the strut from being calm, and are told; twelve good samples end it.
    #[test]
    fn each_reading_and_each_pair_is_told() {
        for wrong in (1_u8..32).filter(|wrong| wrong.count_ones() <= 2) {
            let (mut checks, mut x, mut p) = calm(0.01, 2.0e6);
            let mut verdicts = Verdicts::GOOD;
            for good in [false, true] {
                for sample in 1..=2 * LIMIT {
                    let is_wrong = |n: u8| !good && wrong >> n & 1 == 1;
                    let value = |n: u8, value: f32| {
                        if is_wrong(n) {
                            Reading::INVALID
                        } else {
                            Reading::new(value)
                        }
                    };
                    let pressure = StrutPressures::from_array([1, 2, 3, 4].map(|n| value(n, 2.0e6)));
                    let displacement = (value(0, 0.01), &mut x);
                    let calm = checks.step(displacement, (&pressure, &mut p), || (false, false));
                    verdicts = checks.verdicts();
                    let told = if good { sample < LIMIT } else { sample >= 3 };
                    assert_eq!(verdicts != Verdicts::GOOD, told, "{wrong:05b} sample {sample}");
                    assert_eq!(calm, good && sample >= LIMIT, "{wrong:05b} sample {sample}");
                    assert_eq!(u32::from(verdicts.count()), if told { wrong.count_ones() } else { 0 });
                }
            }
            assert_eq!(verdicts, Verdicts::GOOD);
        }
    }
}
