//! Readings that do not change while they must.
//!
//! A frozen sensor stays in range and never jumps. What gives it away is its neighbours: in windows of 0.5 s the span (largest less
//! smallest) of every reading is compared with the spans of those that must move with it. On a smooth road nothing moves
//! and nothing is said.
//!
//! - Displacement: span below 0.03 mm, and either the strut's own p1 spans 0.3 MPa (in the stiff setting 0.03 mm are about
//!   1 kPa), or p1 spans 50 kPa while two other struts span 5 mm. A strut that its seals hold fast shows neither.
//! - p1 to p3: span of one step (5 kPa) or less while the strut's displacement spans 5 mm (about 40 kPa in the soft setting).
//! - p4: the same with 20 mm, and only if valve 3 was open during the whole window; behind a closed valve it is trapped.
//!
//! Two windows, 200 ticks, at the most from freezing to verdict. A window in which the reading moves clears it.

use super::{Context, Trusted, Verdicts, blame};
use crate::failsafe::FaultCode;
use crate::timing::ticks;
use crate::valves::CORNERS;

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
    pressure: [Span; 4],
    spring_open: bool,
    displacement_stuck: bool,
    pressure_stuck: [bool; 4],
}

/// Windows of all corners; they end in the same tick.
#[derive(Clone, Copy, Debug)]
pub struct Stuck {
    ticks: u16,
    corners: [CornerWindow; CORNERS],
    /// Any reading of any corner is found stuck: spares the usual tick the look.
    any: bool,
}

impl Default for Stuck {
    fn default() -> Self {
        let corner = CornerWindow {
            displacement: Span::EMPTY,
            pressure: [Span::EMPTY; 4],
            spring_open: true,
            displacement_stuck: false,
            pressure_stuck: [false; 4],
        };
        Self {
            ticks: 0,
            corners: [corner; CORNERS],
            any: false,
        }
    }
}

impl Stuck {
    /// One tick.
    pub fn step(&mut self, trusted: &Trusted, context: &Context, verdicts: &mut [Verdicts; CORNERS]) {
        for ((((window, x), pressures), open), verdict) in self
            .corners
            .iter_mut()
            .zip(trusted.displacement_m)
            .zip(trusted.pressure_pa)
            .zip(context.spring_settled_open)
            .zip(&*verdicts)
        {
            // What stands in for a reading (at first, zero) does not move with it: a parked vehicle would be called broken.
            if verdict.displacement == FaultCode::None {
                window.displacement.add(x);
            }
            for ((span, pressure), &fault) in window.pressure.iter_mut().zip(pressures).zip(&verdict.pressure) {
                if fault == FaultCode::None {
                    span.add(pressure);
                }
            }
            window.spring_open &= open;
        }
        self.ticks = self.ticks.saturating_add(1);
        if self.ticks >= WINDOW_TICKS {
            self.ticks = 0;
            self.end_of_window();
        }
        if !self.any {
            return;
        }
        for (window, verdict) in self.corners.iter().zip(verdicts) {
            if window.displacement_stuck {
                blame(&mut verdict.displacement, FaultCode::SensorStuck);
            }
            for (&stuck, fault) in window.pressure_stuck.iter().zip(&mut verdict.pressure) {
                if stuck {
                    blame(fault, FaultCode::SensorStuck);
                }
            }
        }
    }

    fn end_of_window(&mut self) {
        let moving = self
            .corners
            .iter()
            .filter(|w| w.displacement.width() >= DISPLACEMENT_MOVING_M)
            .count();
        for window in &mut self.corners {
            let x_width = window.displacement.width();
            let [p1_width, ..] = window.pressure.map(|span| span.width());
            if x_width > DISPLACEMENT_STILL_M {
                window.displacement_stuck = false;
            } else if p1_width >= PRESSURE_MOVING_ALONE_PA || (moving >= 2 && p1_width >= PRESSURE_MOVING_PA) {
                window.displacement_stuck = true;
            }
            let moves_p = x_width >= DISPLACEMENT_MOVING_M;
            let moves_p4 = x_width >= DISPLACEMENT_MOVING_FOR_P4_M && window.spring_open;
            for ((stuck, span), moves) in window
                .pressure_stuck
                .iter_mut()
                .zip(&window.pressure)
                .zip([moves_p, moves_p, moves_p, moves_p4])
            {
                if span.width() > PRESSURE_STILL_PA {
                    *stuck = false;
                } else if moves {
                    *stuck = true;
                }
            }
            window.displacement = Span::EMPTY;
            window.pressure = [Span::EMPTY; 4];
            window.spring_open = true;
        }
        self.any = (self.corners.iter()).any(|w| w.displacement_stuck || w.pressure_stuck.contains(&true));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parked_vehicle_that_is_switched_on_is_not_stuck() {
        let mut stuck = Stuck::default();
        let context = Context::default();
        for tick in 0..3 * WINDOW_TICKS {
            let believed = tick >= 16;
            let mut trusted = Trusted::default();
            let mut verdicts = [Verdicts::default(); CORNERS];
            if believed {
                trusted.pressure_pa = [[2.0e6; 4]; CORNERS];
            } else {
                verdicts = [Verdicts {
                    displacement: FaultCode::SensorRange,
                    pressure: [FaultCode::SensorRange; 4],
                }; CORNERS];
            }
            stuck.step(&trusted, &context, &mut verdicts);
            let healthy = verdicts
                .iter()
                .flat_map(Verdicts::all)
                .all(|fault| fault == FaultCode::None);
            assert_eq!(healthy, believed, "tick {tick}");
        }
    }
}
