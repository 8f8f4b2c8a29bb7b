//! Detects readings that do not change although they must.
//!
//! A stuck sensor stays in range and never jumps; only its neighbours show that it is stuck. In windows of 0.5 s the span
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
//! A stuck reading is found within two windows, which are 200 ticks. A window in which the reading moves clears the verdict.

use oleo_interface::{Corners, PressurePoint, StrutPressures};

use super::trusted::Trusted;
use super::verdict::{Verdicts, blame};
use crate::failsafe::FaultCode;
use crate::timing::ticks;

const WINDOW_TICKS: u16 = ticks(500);

const DISPLACEMENT_STILL_M: f32 = 3.0e-5;
const DISPLACEMENT_MOVING_M: f32 = 5.0e-3;
const DISPLACEMENT_MOVING_FOR_P4_M: f32 = 20.0e-3;
const PRESSURE_STILL_PA: f32 = 5.5e3;
const PRESSURE_MOVING_PA: f32 = 5.0e4;
const PRESSURE_MOVING_ALONE_PA: f32 = 3.0e5;

#[derive(Clone, Copy, Debug)]
struct Span {
    least: f32,
    most: f32,
}

impl Span {
    const EMPTY: Self = Self {
        least: f32::MAX,
        most: f32::MIN,
    };

    fn add(&mut self, value: f32) {
        if value < self.least {
            self.least = value;
        }
        if value > self.most {
            self.most = value;
        }
    }

    fn width(&self) -> f32 {
        self.most - self.least
    }
}

#[derive(Clone, Copy, Debug)]
struct CornerWindow {
    displacement: Span,
    pressure: StrutPressures<Span>,
    spring_open: bool,
    displacement_stuck: bool,
    pressure_stuck: StrutPressures<bool>,
}

/// Windows of all corners; they end in the same tick.
#[derive(Clone, Copy, Debug)]
pub struct Stuck {
    ticks: u16,
    corners: Corners<CornerWindow>,
    /// Whether any reading of any corner is stuck, so that most ticks need not look at each.
    any: bool,
}

impl Default for Stuck {
    fn default() -> Self {
        let corner = CornerWindow {
            displacement: Span::EMPTY,
            pressure: StrutPressures::splat(Span::EMPTY),
            spring_open: true,
            displacement_stuck: false,
            pressure_stuck: StrutPressures::splat(false),
        };
        Self {
            ticks: 0,
            corners: Corners::splat(corner),
            any: false,
        }
    }
}

impl Stuck {
    /// One tick. `spring_settled_open` says where valve 3 has been open for so long that p4 follows p1.
    pub fn step(&mut self, trusted: &Trusted, spring_settled_open: Corners<bool>, verdicts: &mut Corners<Verdicts>) {
        for (corner, window) in self.corners.iter_mut() {
            let verdict = &verdicts[corner];
            // A value that replaces a reading (at first, zero) does not move with the strut. It must not count, or a parked
            // vehicle would be called broken.
            if verdict.displacement == FaultCode::None {
                window.displacement.add(trusted.displacement_m[corner]);
            }
            for point in PressurePoint::ALL {
                if verdict.pressure[point] == FaultCode::None {
                    window.pressure[point].add(trusted.pressure[corner][point].pa());
                }
            }
            window.spring_open &= spring_settled_open[corner];
        }
        self.ticks = self.ticks.saturating_add(1);
        if self.ticks >= WINDOW_TICKS {
            self.ticks = 0;
            self.end_of_window();
        }
        if !self.any {
            return;
        }
        for (corner, window) in self.corners.iter() {
            let verdict = &mut verdicts[corner];
            if window.displacement_stuck {
                blame(&mut verdict.displacement, FaultCode::SensorStuck);
            }
            for (point, stuck) in window.pressure_stuck.iter() {
                if *stuck {
                    blame(&mut verdict.pressure[point], FaultCode::SensorStuck);
                }
            }
        }
    }

    fn end_of_window(&mut self) {
        let moving = self
            .corners
            .values()
            .filter(|window| window.displacement.width() >= DISPLACEMENT_MOVING_M)
            .count();
        for window in self.corners.values_mut() {
            let x_width = window.displacement.width();
            let p1_width = window.pressure.p1.width();
            if x_width > DISPLACEMENT_STILL_M {
                window.displacement_stuck = false;
            } else if p1_width >= PRESSURE_MOVING_ALONE_PA || (moving >= 2 && p1_width >= PRESSURE_MOVING_PA) {
                window.displacement_stuck = true;
            }
            let must_move = StrutPressures {
                p4: x_width >= DISPLACEMENT_MOVING_FOR_P4_M && window.spring_open,
                ..StrutPressures::splat(x_width >= DISPLACEMENT_MOVING_M)
            };
            for (point, must_move) in must_move.iter() {
                if window.pressure[point].width() > PRESSURE_STILL_PA {
                    window.pressure_stuck[point] = false;
                } else if *must_move {
                    window.pressure_stuck[point] = true;
                }
            }
            window.displacement = Span::EMPTY;
            window.pressure = StrutPressures::splat(Span::EMPTY);
            window.spring_open = true;
        }
        let nothing = StrutPressures::splat(false);
        self.any = (self.corners.values()).any(|window| window.displacement_stuck || window.pressure_stuck != nothing);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use oleo_interface::Gauge;

    #[test]
    fn a_parked_vehicle_that_is_switched_on_is_not_stuck() {
        let mut stuck = Stuck::default();
        for tick in 0..3 * WINDOW_TICKS {
            let believed = tick >= 16;
            let mut trusted = Trusted::default();
            let mut verdicts = Corners::<Verdicts>::default();
            if believed {
                trusted.pressure = Corners::splat(StrutPressures::splat(Gauge(2.0e6)));
            } else {
                verdicts = Corners::splat(Verdicts {
                    displacement: FaultCode::SensorRange,
                    pressure: StrutPressures::splat(FaultCode::SensorRange),
                });
            }
            stuck.step(&trusted, Corners::splat(false), &mut verdicts);
            let healthy = verdicts
                .values()
                .flat_map(Verdicts::all)
                .all(|fault| fault == FaultCode::None);
            assert_eq!(healthy, believed, "tick {tick}");
        }
    }
}
