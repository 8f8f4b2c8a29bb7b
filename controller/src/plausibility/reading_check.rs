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

/// State of the check. It starts as faulty: a sensor is believed after it has delivered twelve good samples.
#[derive(Clone, Copy, Debug)]
pub struct ReadingCheck {
    last: f32,
    bad: u8,
    faulty: bool,
    cause: FaultCode,
    /// Ticks since the last good sample.
    age: u8,
}

impl Default for ReadingCheck {
    fn default() -> Self {
        Self {
            last: 0.0,
            bad: LIMIT,
            faulty: true,
            cause: FaultCode::SensorRange,
            age: u8::MAX,
        }
    }
}

impl ReadingCheck {
    /// The last good value.
    pub fn value(&self) -> f32 {
        self.last
    }

    /// Whether nothing was wrong with the reading lately.
    fn is_calm(&self) -> bool {
        self.bad == 0
    }

    /// Whether a reading is good by itself; only while the check is calm, so that the last sample was good.
    fn is_ordinary(&self, reading: Reading, limits: &Limits) -> bool {
        // Nothing compares with NaN, so no invalid reading passes.
        let value = reading.value_or_nan();
        (value - self.last).abs() <= limits.step && value >= limits.least && value <= limits.most
    }

    /// One tick; returns what is wrong if the reading is to be replaced, and [`FaultCode::None`] if it may be used.
    fn step(&mut self, reading: Reading, message_lost: bool, limits: &Limits) -> FaultCode {
        let in_range = reading.value().filter(|&v| v >= limits.least && v <= limits.most);
        // The longer ago the last good sample, the further the value may have gone.
        let reach = limits.step * (f32::from(self.age) + 1.0);
        match in_range {
            Some(value) if (value - self.last).abs() <= reach || self.age == u8::MAX => {
                self.last = value;
                self.age = 0;
                self.bad = self.bad.saturating_sub(1);
                if self.bad == 0 {
                    self.faulty = false;
                }
            }
            other => {
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
                    } else if other.is_some() {
                        FaultCode::SensorRate
                    } else {
                        FaultCode::SensorRange
                    };
                }
            }
        }
        if self.faulty { self.cause } else { FaultCode::None }
    }
}

/// The checks of the five readings of a strut.
#[derive(Clone, Copy, Debug, Default)]
pub struct StrutReadings {
    displacement: ReadingCheck,
    pressure: StrutPressures<ReadingCheck>,
    /// Whether all five checks are calm.
    calm: bool,
    /// What is wrong; nothing while all are calm.
    verdicts: Verdicts,
}

impl StrutReadings {
    /// Whether nothing was wrong with any of the readings lately.
    pub fn is_calm(&self) -> bool {
        self.calm
    }

    /// What the last tick has found.
    pub fn verdicts(&self) -> &Verdicts {
        &self.verdicts
    }

    /// One tick of a strut: returns the last good displacement, m, and pressures, Pa. `lost` says whether the displacement's
    /// and the pressures' message are lost.
    pub fn step(
        &mut self,
        displacement: Reading,
        pressure: &StrutPressures<Reading>,
        lost: impl FnOnce() -> (bool, bool),
    ) -> (f32, StrutPressures<Gauge<f32>>) {
        let last = &self.pressure;
        // Most ticks end here: nothing was wrong lately, and nothing is wrong now.
        if self.calm
            && self.displacement.is_ordinary(displacement, &DISPLACEMENT)
            && last.p1.is_ordinary(pressure.p1, &PRESSURE)
            && last.p2.is_ordinary(pressure.p2, &PRESSURE)
            && last.p3.is_ordinary(pressure.p3, &PRESSURE)
            && last.p4.is_ordinary(pressure.p4, &PRESSURE)
        {
            self.displacement.last = displacement.value_or_nan();
            self.pressure.p1.last = pressure.p1.value_or_nan();
            self.pressure.p2.last = pressure.p2.value_or_nan();
            self.pressure.p3.last = pressure.p3.value_or_nan();
            self.pressure.p4.last = pressure.p4.value_or_nan();
        } else {
            self.doubt(displacement, pressure, lost());
        }
        (
            self.displacement.value(),
            self.pressure.each_ref().map(|check| Gauge(check.value())),
        )
    }

    /// The whole checks, for readings of which one was wrong lately or may be wrong now.
    #[inline(never)]
    fn doubt(&mut self, displacement: Reading, pressure: &StrutPressures<Reading>, lost: (bool, bool)) {
        self.verdicts.displacement = self.displacement.step(displacement, lost.0, &DISPLACEMENT);
        self.calm = self.displacement.is_calm();
        let checks = self.pressure.each_mut().zip(self.verdicts.pressure.each_mut());
        for ((check, verdict), reading) in checks.zip(*pressure).into_array() {
            *verdict = check.step(reading, lost.1, &PRESSURE);
            self.calm &= check.is_calm();
        }
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

    fn healthy() -> ReadingCheck {
        let mut check = ReadingCheck::default();
        for _ in 0..LIMIT {
            check.step(Reading::new(0.5), false, &LIMITS);
        }
        check
    }

    #[test]
    fn believed_after_twelve() {
        let mut check = ReadingCheck::default();
        for n in 1..=LIMIT {
            let fault = check.step(Reading::new(0.5), false, &LIMITS);
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
            let mut check = healthy();
            assert_eq!(check.step(bad, false, &LIMITS), FaultCode::None);
            assert_eq!(check.step(bad, false, &LIMITS), FaultCode::None);
            assert_eq!(check.step(bad, false, &LIMITS), cause);
            assert_eq!(check.value(), 0.5);
        }
    }

    #[test]
    fn a_lost_message_is_a_fault_at_once() {
        assert_eq!(healthy().step(Reading::INVALID, true, &LIMITS), FaultCode::MessageLost);
    }

    #[test]
    fn a_real_jump_is_accepted_in_time() {
        let mut check = healthy();
        let mut n = 0;
        while check.value() != -0.5 {
            check.step(Reading::new(-0.5), false, &LIMITS);
            n += 1;
        }
        assert_eq!(n, 10); // 1.0 at 0.1 a tick
    }
}
