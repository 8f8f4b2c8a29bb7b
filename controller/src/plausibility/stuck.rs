//! Detects readings that do not change although they must.
//!
//! A stuck sensor stays in range and never jumps; only its neighbours show that it is stuck. In windows of 0.48 s the span
//! (largest less smallest value) of every reading is compared with the spans of those that must move with it. On a smooth road
//! nothing moves, and nothing can be concluded.
//!
//! - A displacement is stuck if its span is below 0.03 mm and either the strut's own p1 spans 0.3 MPa (in the stiff setting
//!   0.03 mm are about 1 kPa), or p1 spans 50 kPa while two other struts span 5 mm. A strut that its seals hold fast shows
//!   neither.
//! - p1, p2 or p3 is stuck if it spans one step (5 kPa) or less while the strut's displacement spans 5 mm (about 40 kPa in the
//!   soft setting).
//! - p4 is stuck by the same rule with 20 mm, but only if valve 3 was open during the whole window: behind a closed valve its
//!   pressure is trapped.
//!
//! A stuck reading is found within two windows and a round of turns, which are less than 200 ticks. A window in which the reading
//! moves clears the verdict.

use oleo_interface::{Gauge, PressurePoint, StrutPressures};

use super::span::Span;
use super::turn::turns;
use super::verdict::{Place, Verdicts};
use crate::failsafe::FaultCode;

/// Turns of a window. All corners' windows begin in the same round of turns.
pub const WINDOW_TURNS: u8 = turns(480);

const DISPLACEMENT_STILL_M: f32 = 3.0e-5;
const DISPLACEMENT_MOVING_M: f32 = 5.0e-3;
const DISPLACEMENT_MOVING_FOR_P4_M: f32 = 20.0e-3;
const PRESSURE_STILL_PA: f32 = 5.5e3;
const PRESSURE_MOVING_PA: f32 = 5.0e4;
const PRESSURE_MOVING_ALONE_PA: f32 = 3.0e5;

/// Window and verdicts of one strut.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Stuck {
    displacement: Span,
    pressure: StrutPressures<Span>,
    spring_open: bool,
    moved: bool,
    displacement_stuck: bool,
    pressure_stuck: StrutPressures<bool>,
    /// Whether any reading is stuck, so that most turns need not look at each.
    any: bool,
}

impl Stuck {
    /// The first turn begins a window.
    pub const INITIAL: Self = Self {
        displacement: Span::INITIAL,
        pressure: StrutPressures::splat(Span::INITIAL),
        spring_open: false,
        moved: false,
        displacement_stuck: false,
        pressure_stuck: StrutPressures::splat(false),
        any: false,
    };

    /// One turn. `spring_settled_open` says whether valve 3 has been open for so long that p4 follows p1.
    pub fn step(
        &mut self,
        displacement_m: f32,
        pressure: &StrutPressures<Gauge<f32>>,
        spring_settled_open: bool,
        verdict: &mut Verdicts,
    ) {
        // A value that replaces a reading (at first, zero) does not move with the strut. It must not count, or a parked
        // vehicle would be called broken.
        if *verdict == Verdicts::GOOD {
            self.displacement.add(displacement_m);
            for (span, pressure) in self.pressure.each_mut().zip(*pressure).into_array() {
                span.add(pressure.pa());
            }
        } else {
            self.add_good(displacement_m, pressure, *verdict);
        }
        self.spring_open &= spring_settled_open;
        if self.any {
            if self.displacement_stuck {
                verdict.blame(Place::DISPLACEMENT, FaultCode::SensorStuck);
            }
            for (point, stuck) in self.pressure_stuck.iter() {
                if *stuck {
                    verdict.blame(Place::of(point), FaultCode::SensorStuck);
                }
            }
        }
    }

    /// Takes those values in that are not wrong.
    fn add_good(&mut self, displacement_m: f32, pressure: &StrutPressures<Gauge<f32>>, verdict: Verdicts) {
        if verdict.is_good(Place::DISPLACEMENT) {
            self.displacement.add(displacement_m);
        }
        for point in PressurePoint::ALL {
            if verdict.is_good(Place::of(point)) {
                self.pressure[point].add(pressure[point].pa());
            }
        }
    }

    /// Ends the window, after its last turn: from now on [`Stuck::has_moved`] is about it.
    pub fn end_window(&mut self) {
        self.moved = self.displacement.width() >= DISPLACEMENT_MOVING_M;
    }

    /// Whether the strut moved in its last window.
    pub fn has_moved(&self) -> bool {
        self.moved
    }

    /// Judges the window that has ended, when those of all corners have, and begins the next. `moving` is the number of struts that
    /// have moved.
    pub fn begin_window(&mut self, moving: usize) {
        let (x_width, p1_width) = (self.displacement.width(), self.pressure.p1.width());
        if x_width > DISPLACEMENT_STILL_M {
            self.displacement_stuck = false;
        } else if p1_width >= PRESSURE_MOVING_ALONE_PA || (moving >= 2 && p1_width >= PRESSURE_MOVING_PA) {
            self.displacement_stuck = true;
        }
        let must_move = StrutPressures {
            p4: x_width >= DISPLACEMENT_MOVING_FOR_P4_M && self.spring_open,
            ..StrutPressures::splat(self.moved)
        };
        for point in PressurePoint::ALL {
            if self.pressure[point].width() > PRESSURE_STILL_PA {
                self.pressure_stuck[point] = false;
            } else if must_move[point] {
                self.pressure_stuck[point] = true;
            }
        }
        self.any = self.displacement_stuck || self.pressure_stuck != StrutPressures::splat(false);
        self.displacement = Span::EMPTY;
        self.pressure = StrutPressures::splat(Span::EMPTY);
        self.spring_open = true;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A check whose first window has begun.
    fn begun() -> Stuck {
        let mut stuck = Stuck::INITIAL;
        stuck.begin_window(0);
        stuck
    }

    #[test]
    fn a_parked_vehicle_that_is_switched_on_is_not_stuck() {
        let mut stuck = begun();
        for turn in 0..3 * WINDOW_TURNS {
            if turn % WINDOW_TURNS == 0 {
                stuck.begin_window(0);
            }
            let believed = turn >= 4;
            let mut verdict = Verdicts::GOOD;
            let mut pressure = StrutPressures::default();
            if believed {
                pressure = StrutPressures::splat(Gauge(2.0e6));
            } else {
                verdict.blame(Place::DISPLACEMENT, FaultCode::SensorRange);
                for point in PressurePoint::ALL {
                    verdict.blame(Place::of(point), FaultCode::SensorRange);
                }
            }
            stuck.step(0.0, &pressure, false, &mut verdict);
            let healthy = verdict == Verdicts::GOOD;
            assert_eq!(healthy, believed, "turn {turn}");
            stuck.end_window();
        }
    }

    /// Spans of the readings of a window.
    #[derive(Clone, Copy)]
    struct Window {
        x_m: f32,
        pressure_pa: StrutPressures<f32>,
        open: bool,
        moving: usize,
    }

    /// A window in which everything moves, with an open valve 3 and two other struts that move.
    const MOVING: Window = Window {
        x_m: 0.03,
        pressure_pa: StrutPressures {
            p1: 1.0e5,
            p2: 1.0e5,
            p3: 1.0e5,
            p4: 1.0e5,
        },
        open: true,
        moving: 3,
    };

    /// Drives a window, and returns what the first turn of the next one says of it.
    fn after(stuck: &mut Stuck, window: Window) -> Verdicts {
        for turn in 0..WINDOW_TURNS {
            let share = f32::from(turn) / f32::from(WINDOW_TURNS - 1);
            let pressure = window.pressure_pa.map(|span| Gauge(2.0e6 + span * share));
            // The valve closes for one turn only.
            let open = window.open || turn != WINDOW_TURNS / 2;
            stuck.step(window.x_m * share, &pressure, open, &mut Verdicts::default());
        }
        stuck.end_window();
        stuck.begin_window(window.moving);
        let mut verdict = Verdicts::GOOD;
        let pressure = window.pressure_pa.map(|_| Gauge(2.0e6));
        stuck.clone().step(0.0, &pressure, window.open, &mut verdict);
        verdict
    }

    fn only(place: Place) -> Verdicts {
        let mut verdict = Verdicts::GOOD;
        verdict.blame(place, FaultCode::SensorStuck);
        verdict
    }

    #[test]
    fn a_displacement_is_stuck_where_its_own_pressure_or_two_others_say_so() {
        for (x_m, p1_pa, moving, is_stuck) in [
            (2.0e-5, 3.1e5, 0, true),
            (2.0e-5, 2.9e5, 0, false),
            (2.0e-5, 2.9e5, 1, false),
            (2.0e-5, 2.9e5, 2, true),
            (2.0e-5, 0.6e5, 2, true),
            (2.0e-5, 0.4e5, 3, false),
            (4.0e-5, 3.1e5, 3, false),
            (0.0, 0.0, 3, false),
        ] {
            let window = Window {
                x_m,
                pressure_pa: StrutPressures {
                    p1: p1_pa,
                    ..MOVING.pressure_pa
                },
                moving,
                ..MOVING
            };
            let mut stuck = begun();
            let expected = if is_stuck {
                only(Place::DISPLACEMENT)
            } else {
                Verdicts::GOOD
            };
            assert_eq!(
                after(&mut stuck, window),
                expected,
                "{x_m} m, {p1_pa} Pa, {moving} moving"
            );
            assert!(!stuck.has_moved());
            if is_stuck {
                let still = Window {
                    x_m: 0.0,
                    pressure_pa: StrutPressures::splat(0.0),
                    ..MOVING
                };
                assert_eq!(after(&mut stuck, still), expected, "a parked vehicle tells nothing");
                assert_eq!(after(&mut stuck, MOVING), Verdicts::GOOD, "it moves again");
            }
        }
    }

    #[test]
    fn a_pressure_is_stuck_while_its_strut_moves() {
        for point in PressurePoint::ALL {
            // 5 mm are enough for p1 to p3, 20 mm for p4.
            let enough_m = if point == PressurePoint::P4 { 0.02 } else { 0.005 };
            for (x_m, span_pa, is_stuck) in [
                (1.05 * enough_m, 5.0e3, true),
                (0.95 * enough_m, 5.0e3, false),
                (1.05 * enough_m, 6.0e3, false),
                (0.03, 0.0, true),
            ] {
                let mut window = Window { x_m, ..MOVING };
                window.pressure_pa[point] = span_pa;
                let mut stuck = begun();
                let expected = if is_stuck {
                    only(Place::of(point))
                } else {
                    Verdicts::GOOD
                };
                assert_eq!(after(&mut stuck, window), expected, "{point:?}: {x_m} m, {span_pa} Pa");
                assert_eq!(stuck.has_moved(), x_m >= 0.005);
                let mut still = Window {
                    x_m: 0.0,
                    moving: 0,
                    ..MOVING
                };
                still.pressure_pa = StrutPressures::splat(0.0);
                assert_eq!(after(&mut stuck, still), expected, "a parked vehicle tells nothing");
                assert_eq!(after(&mut stuck, MOVING), Verdicts::GOOD, "it moves again");
            }
        }
    }

    #[test]
    fn p4_behind_a_valve_that_was_closed_for_a_moment_is_not_stuck() {
        let mut window = Window { open: false, ..MOVING };
        window.pressure_pa.p4 = 0.0;
        let mut stuck = begun();
        assert_eq!(after(&mut stuck, window), Verdicts::GOOD);
        window.open = true;
        assert_eq!(after(&mut stuck, window), only(Place::P4));
    }

    /// The value that replaces a wrong reading neither moves with the strut nor must it.
    #[test]
    fn a_reading_that_is_wrong_otherwise_is_not_looked_at() {
        let mut stuck = begun();
        for turn in 0..WINDOW_TURNS {
            let share = f32::from(turn) / f32::from(WINDOW_TURNS - 1);
            let mut verdict = Verdicts::GOOD;
            verdict.blame(Place::P2, FaultCode::SensorRange);
            let pressure = StrutPressures {
                p2: Gauge(9.0e6 * share),
                ..StrutPressures::splat(Gauge(2.0e6))
            };
            stuck.step(0.03 * share, &pressure, true, &mut verdict);
        }
        assert!(stuck.pressure.p2.width() < 0.0, "nothing was taken in");
        assert!(stuck.displacement.width() > 0.02 && stuck.pressure.p1.width() == 0.0);
    }
}
