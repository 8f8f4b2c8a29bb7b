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

const _: () = assert!(
    DISPLACEMENT.least == -DISPLACEMENT.most,
    "the short way looks at the magnitude of a displacement only"
);

/// State of the check. The last good value is kept by the caller.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ReadingCheck {
    bad: u8,
    /// What is wrong, from the third bad sample in a row to the last one that is forgotten.
    cause: FaultCode,
    /// Ticks since the last good sample.
    age: u8,
}

impl ReadingCheck {
    const INITIAL: Self = Self {
        bad: 0,
        cause: FaultCode::None,
        age: 0,
    };

    /// Before the first sample. It is faulty: a sensor is believed after it has delivered twelve good samples.
    fn begin(&mut self) {
        self.bad = LIMIT;
        self.cause = FaultCode::SensorRange;
        self.age = u8::MAX;
    }

    /// One tick; returns what is wrong if the reading is to be replaced, and [`FaultCode::None`] if it may be used. `last` is the
    /// last good value.
    fn step(&mut self, last: &mut f32, reading: Reading, message_lost: bool, limits: &Limits) -> FaultCode {
        // Nothing compares with NaN, so no invalid reading passes.
        let value = reading.value_or_nan();
        let change = (value - *last).abs();
        let in_range = limits.hold(value);
        if in_range && (change <= limits.step || self.reaches(change, limits)) {
            *last = value;
            self.age = 0;
            self.bad = self.bad.saturating_sub(1);
            if self.bad == 0 {
                self.cause = FaultCode::None;
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
                self.cause = if message_lost {
                    FaultCode::MessageLost
                } else if in_range {
                    FaultCode::SensorRate
                } else {
                    FaultCode::SensorRange
                };
            }
        }
        self.cause
    }

    /// Whether a value may have changed so much: the longer ago the last good sample, the further it may have gone.
    fn reaches(&self, change: f32, limits: &Limits) -> bool {
        self.age == u8::MAX || change <= limits.step * (f32::from(self.age) + 1.0)
    }
}

/// The short way, on which most ticks end for a strut with whose readings nothing was wrong lately: takes them over into the last
/// good displacement, m, and pressures, Pa, if nothing is wrong now. Returns whether it did so; if not,
/// [`StrutReadings::doubt`] decides.
#[inline(always)]
pub fn take_over(
    (displacement, last_displacement_m): (Reading, &mut f32),
    (pressure, last_pressure): (&StrutPressures<Reading>, &mut StrutPressures<Gauge<f32>>),
) -> bool {
    let displacement_m = displacement.value_or_nan();
    let pressure = pressure.map(|reading| Gauge(reading.value_or_nan()));
    let ordinary = DISPLACEMENT.hold_positive(displacement_m.abs())
        && (displacement_m - *last_displacement_m).abs() <= DISPLACEMENT.step
        && have_ordinary_changes(pressure, *last_pressure)
        && pressure
            .into_array()
            .into_iter()
            .all(|p| PRESSURE.hold_positive(p.pa()));
    if ordinary {
        *last_displacement_m = displacement_m;
        *last_pressure = pressure;
    }
    ordinary
}

/// Whether four pressures have all changed by less than the fastest plausible change, by the sum of the squares: each change is at
/// most its root. Where the strut moves so fast that the sum is larger, the whole check looks at each. A sum with NaN is NaN.
fn have_ordinary_changes(now: StrutPressures<Gauge<f32>>, last: StrutPressures<Gauge<f32>>) -> bool {
    // A tenth below the bound, so that no rounding passes a change that the whole check rejects.
    const MOST: f32 = 0.9 * PRESSURE.step * PRESSURE.step;
    let change = |now: Gauge<f32>, last: Gauge<f32>| now - last;
    let (d1, d2) = (change(now.p1, last.p1), change(now.p2, last.p2));
    let (d3, d4) = (change(now.p3, last.p3), change(now.p4, last.p4));
    d1 * d1 + d2 * d2 + d3 * d3 + d4 * d4 <= MOST
}

/// The checks of the five readings of a strut.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StrutReadings {
    displacement: ReadingCheck,
    pressure: StrutPressures<ReadingCheck>,
    /// What is wrong.
    verdicts: Verdicts,
}

impl StrutReadings {
    /// What [`StrutReadings::begin`] is called on.
    pub const INITIAL: Self = Self {
        displacement: ReadingCheck::INITIAL,
        pressure: StrutPressures::splat(ReadingCheck::INITIAL),
        verdicts: Verdicts::GOOD,
    };

    /// Is called in the first tick, before everything else.
    #[inline(never)]
    pub fn begin(&mut self) {
        self.displacement.begin();
        for check in self.pressure.each_mut().into_array() {
            check.begin();
        }
    }

    /// What the last tick has found.
    pub fn verdicts(&self) -> Verdicts {
        self.verdicts
    }

    /// The whole check, for readings of which one was wrong lately or may be wrong now. Takes the good ones over into the last
    /// good values, and returns whether nothing was wrong with any of them lately. `lost` says whether the displacement's and the
    /// pressures' message are lost.
    pub fn doubt(
        &mut self,
        (displacement, last_displacement_m): (Reading, &mut f32),
        (pressure, last_pressure): (&StrutPressures<Reading>, &mut StrutPressures<Gauge<f32>>),
        lost: (bool, bool),
    ) -> bool {
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
        self.displacement.bad | bad == 0
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

    fn new() -> ReadingCheck {
        let mut check = ReadingCheck::INITIAL;
        check.begin();
        check
    }

    fn healthy() -> (ReadingCheck, f32) {
        let (mut check, mut last) = (new(), 0.0);
        for _ in 0..LIMIT {
            check.step(&mut last, Reading::new(0.5), false, &LIMITS);
        }
        (check, last)
    }

    #[test]
    fn believed_after_twelve() {
        let (mut check, mut last) = (new(), 0.0);
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
        while last != -0.5 && n < 100 {
            check.step(&mut last, Reading::new(-0.5), false, &LIMITS);
            n += 1;
        }
        assert_eq!(n, 10); // 1.0 at 0.1 a tick
    }

    /// A strut, with what its caller keeps.
    #[derive(Clone, Copy, Debug)]
    struct Strut {
        checks: StrutReadings,
        calm: bool,
        x: f32,
        p: StrutPressures<Gauge<f32>>,
    }

    impl Strut {
        fn new() -> Self {
            let mut checks = StrutReadings::INITIAL;
            checks.begin();
            Self {
                checks,
                calm: false,
                x: 0.0,
                p: StrutPressures::default(),
            }
        }

        /// One tick, as the caller does it; returns whether nothing was wrong lately.
        fn step(&mut self, displacement: Reading, pressure: &StrutPressures<Reading>) -> bool {
            let (x, p) = ((displacement, &mut self.x), (pressure, &mut self.p));
            if !(self.calm && take_over(x, p)) {
                self.doubt(displacement, pressure);
            }
            self.calm
        }

        fn doubt(&mut self, displacement: Reading, pressure: &StrutPressures<Reading>) {
            let (x, p) = ((displacement, &mut self.x), (pressure, &mut self.p));
            self.calm = self.checks.doubt(x, p, (false, false));
        }

        /// One whose five readings have been good for long, at a displacement and under one pressure.
        fn calm(displacement_m: f32, pressure_pa: f32) -> Self {
            let mut strut = Self::new();
            let pressure = StrutPressures::splat(Reading::new(pressure_pa));
            let last = (0..=LIMIT)
                .map(|_| strut.step(Reading::new(displacement_m), &pressure))
                .last();
            assert_eq!(last, Some(true));
            strut
        }
    }

    /// The short way and the whole check agree on every reading of a strut.
    #[test]
    fn the_short_way_decides_as_the_whole_check() {
        let (mut strut, mut whole, mut short) = (Strut::new(), Strut::new(), 0);
        let mut random = 1_u32;
        for _ in 0..20_000 {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let pressure = |shift: u32| match random >> shift & 0x3FF {
                0 => Reading::INVALID,
                1 => Reading::new(36.0e6),
                2 => Reading::new(-5.0e6),
                3 => Reading::new(-1.0e5),
                n => Reading::new(2.0e4 * n as f32),
            };
            let reading = StrutPressures::from_array([pressure(4), pressure(9), pressure(14), pressure(19)]);
            let far = if random >> 11 & 0xFF == 0 { 0.2 } else { 0.0 };
            let displacement = Reading::new((random >> 22) as f32 * 4.0e-5 - 0.02 + far);
            let (mut x, mut p) = (strut.x, strut.p);
            short += u32::from(strut.calm && take_over((displacement, &mut x), (&reading, &mut p)));
            strut.step(displacement, &reading);
            whole.doubt(displacement, &reading);
            assert_eq!(
                (strut.checks.verdicts, strut.calm, strut.x, strut.p),
                (whole.checks.verdicts, whole.calm, whole.x, whole.p)
            );
        }
        assert!(short > 1_000, "the short way was taken {short} times");
    }

    /// One change of 20 MPa is accepted by the whole check only, a larger one by neither.
    #[test]
    fn the_short_way_ends_before_the_bound() {
        for (to_pa, whole, short) in [(20.0e6, true, true), (22.0e6, true, false), (22.1e6, false, false)] {
            for point in 0..4 {
                let mut pressure = [Reading::new(2.0e6); 4];
                pressure[point] = Reading::new(to_pa);
                let (pressure, x) = (StrutPressures::from_array(pressure), Reading::new(0.01));
                let mut strut = Strut::calm(0.01, 2.0e6);
                let mut p = strut.p;
                assert_eq!(take_over((x, &mut strut.x), (&pressure, &mut p)), short, "{to_pa} Pa");
                assert_eq!(strut.step(x, &pressure), whole, "{to_pa} Pa");
            }
        }
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
            let mut strut = Strut::calm(from_m, 2.0e6);
            let good = strut.step(Reading::new(to_m), &StrutPressures::splat(Reading::new(2.0e6)));
            assert_eq!((good, strut.x), (false, from_m), "{from_m} to {to_m}");
        }
    }

    /// One wrong reading, and any two, keep the strut from being calm, and are told; twelve good samples end it.
    #[test]
    fn each_reading_and_each_pair_is_told() {
        for wrong in (1_u8..32).filter(|wrong| wrong.count_ones() <= 2) {
            let mut strut = Strut::calm(0.01, 2.0e6);
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
                    let calm = strut.step(value(0, 0.01), &pressure);
                    let verdicts = strut.checks.verdicts();
                    let told = if good { sample < LIMIT } else { sample >= 3 };
                    assert_eq!(verdicts != Verdicts::GOOD, told, "{wrong:05b} sample {sample}");
                    assert_eq!(calm, good && sample >= LIMIT, "{wrong:05b} sample {sample}");
                    assert_eq!(
                        u32::from(Verdicts::count(&[verdicts])),
                        if told { wrong.count_ones() } else { 0 }
                    );
                }
            }
            assert_eq!(strut.checks.verdicts(), Verdicts::GOOD);
        }
    }
}
