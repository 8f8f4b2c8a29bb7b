//! What a strut and its wheel will do in the next 160 ms, for each level of damping that it may be given now.
//!
//! A corner goes on alone: the body over a strut is the mass that the strut carries, the wheel is [`super::wheel`]'s, and the strut's
//! force comes from [`super::strut_force`] and its stops. Valves act with their delay, those that are moving already, too.
//! What the corners make of the body together is for the strategy to sum up, because that differs for every combination of levels, and
//! the forces of a strut do not, to the first order.

use super::strut_force::{Bypass, Gases, StrutForce};
use super::wheel::{Acting, Wheel};
use crate::estimate::GRAVITY_M_S2;
use crate::filter::at_least;

/// Step of the forecast, s: two ticks.
pub(crate) const STEP_S: f32 = 0.01;
/// Number of steps.
pub(crate) const STEPS: usize = 16;
/// Steps after its signal from which a valve counts as open, and as closed: its first movement is after 20 and its last after some
/// 60 ms, and a bypass that has begun to open lets the oil pass already.
const DELAY: Delay = Delay { opening: 3, closing: 5 };
/// Steps at whose ends no level can differ from another.
pub(crate) const COMMON: usize = 3;
/// Levels of damping with soft springs, from low to high.
pub(crate) const LEVELS: [Bypass; 3] = [[true, true], [false, true], [false, false]];
/// Compression and extension at which the strut meets its stops, m: the strut preset's.
const STOPS_M: (f32, f32) = (0.08, 0.14);
/// Stiffness of a stop, N/m, and its progression, N/m3: the strut preset's.
const STOP: (f32, f32) = (2.0e5, 1.0e8);

/// Steps until a valve acts.
struct Delay {
    opening: i16,
    closing: i16,
}

/// A corner at present.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner {
    /// Strut and wheel.
    pub wheel: Wheel,
    /// Pressures of the strut's gases.
    pub gases: Gases,
    /// Static load of the strut, N.
    pub load_n: f32,
    /// Velocity of the body over the strut, m/s.
    pub body_m_s: f32,
    /// Level of damping before the last change, and from then on: places in [`LEVELS`].
    pub levels: [usize; 2],
    /// Steps since that change.
    pub since: i16,
    /// Speed of the road under the wheel in each step to come, m/s, up positive; zero where it is not known.
    pub road_m_s: [f32; STEPS],
}

/// Force of a strut on the body beyond its static load in each step to come, N.
pub(crate) type Course = [f32; STEPS];

impl Corner {
    /// The course of the force with each level from now on. Where the valves may not move (not `free`), it is the same with all.
    pub fn courses(&self, strut: &StrutForce, free: bool) -> [Course; LEVELS.len()] {
        let [_, present] = self.levels;
        let mut courses = [self.course(strut); LEVELS.len()];
        if free {
            for (level, course) in courses.iter_mut().enumerate().filter(|(level, _)| *level != present) {
                let mut changed = *self;
                changed.levels = [present, level];
                changed.since = 0;
                *course = changed.course(strut);
            }
        }
        courses
    }

    fn course(&self, strut: &StrutForce) -> Course {
        let (mut corner, mut course) = (*self, [0.0; STEPS]);
        for (step, force_n) in (0..).zip(&mut course) {
            *force_n = corner.advance(strut, step);
        }
        course
    }

    /// Which bypass valves let oil pass in a step.
    fn open(&self, step: i16) -> Bypass {
        let [before, after] = self
            .levels
            .map(|level| LEVELS.get(level).copied().unwrap_or([true, true]));
        let mut open = after;
        for (after, before) in open.iter_mut().zip(before) {
            let delay = if *after { DELAY.opening } else { DELAY.closing };
            if step + self.since < delay {
                *after = before;
            }
        }
        open
    }

    /// One step; returns the force on the body beyond the static load, N.
    fn advance(&mut self, strut: &StrutForce, step: i16) -> f32 {
        let open = self.open(step);
        let oil_n = strut.step(&mut self.gases, self.wheel.strut_m_s, open, STEP_S);
        let force_n = oil_n + stop_n(self.wheel.strut_m) - self.load_n;
        let acting = Acting {
            strut_n: force_n,
            load_n: self.load_n,
            body_m_s2: GRAVITY_M_S2 * force_n / at_least(self.load_n, 1.0),
            body_m_s: self.body_m_s,
            road_m_s: self.road_m_s.get(step.unsigned_abs() as usize).copied().unwrap_or(0.0),
        };
        self.wheel.advance(&acting, STEP_S);
        self.body_m_s += STEP_S * acting.body_m_s2;
        force_n
    }
}

/// Force of the stops at a compression, N, compression positive: `k s + b s^3` of what goes beyond the clearance.
pub(crate) fn stop_n(strut_m: f32) -> f32 {
    let ((bump_m, rebound_m), (stiffness, progression)) = (STOPS_M, STOP);
    let beyond = at_least(strut_m - bump_m, 0.0) - at_least(-strut_m - rebound_m, 0.0);
    beyond * (stiffness + progression * beyond * beyond)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vehicle::VehicleDescription;
    use oleo_interface::{Absolute, Gauge, StrutPressures};

    const AREA_M2: f32 = 1.963_495_4e-3;

    fn at_rest() -> Corner {
        Corner {
            wheel: Wheel::INITIAL,
            gases: Gases::measured(&StrutPressures::splat(Gauge(2.0e6)), Absolute(2.101_325e6)),
            load_n: 2.0e6 * AREA_M2,
            body_m_s: 0.0,
            levels: [1, 1],
            since: 100,
            road_m_s: [0.0; STEPS],
        }
    }

    fn strut() -> StrutForce {
        StrutForce::new(&VehicleDescription::default())
    }

    #[test]
    fn at_rest_nothing_will_move_whatever_the_level() {
        for course in at_rest().courses(&strut(), true) {
            assert!(course.into_iter().all(|force_n| force_n.abs() < 1.0), "{course:?}");
        }
    }

    /// An opening acts after 30 ms, a closing after 50 ms; before that, and where the valves may not move, all levels are alike.
    #[test]
    fn valves_act_after_their_delay() {
        let mut corner = at_rest();
        corner.wheel.strut_m_s = 0.5;
        let [low, firm, high] = corner.courses(&strut(), true);
        let differs = |course: Course| course.into_iter().zip(firm).position(|(a, b)| a != b);
        assert_eq!((differs(low), differs(high)), (Some(3), Some(5)));
        assert_eq!(corner.courses(&strut(), false), [firm; 3]);
        // The wheel has bounced by then: high damping pulls against the extension, and low damping hardly does.
        assert!(
            high[5] < firm[5] - 1.0e3 && low[3] < firm[3],
            "{high:?} {firm:?} {low:?}"
        );
    }

    /// Valves that were told to close 40 ms ago act in the second step.
    #[test]
    fn valves_that_move_already_act_sooner() {
        let mut corner = at_rest();
        corner.wheel.strut_m_s = 0.5;
        let settled = corner.courses(&strut(), false)[0];
        (corner.levels, corner.since) = ([1, 2], 4);
        let moving = corner.courses(&strut(), false)[0];
        assert_eq!(settled.into_iter().zip(moving).position(|(a, b)| a != b), Some(1));
    }

    /// A step of road of 20 mm within the first step lifts the wheel, and the strut pushes the body up within 50 ms.
    #[test]
    fn a_road_that_is_known_is_felt() {
        let mut corner = at_rest();
        corner.road_m_s[0] = 0.02 / STEP_S;
        let [low, ..] = corner.courses(&strut(), true);
        assert!(low[0].abs() < 1.0 && low[5] > 150.0, "{low:?}");
    }

    /// A strut that rests 10 mm beyond its clearance pushes with its stop alone: 2,100 N by hand, in which the 400 kg of the body that it
    /// carries get 52 mm/s in 10 ms. On the other side 20 mm pull with 4,800 N.
    #[test]
    fn stops_push_the_body() {
        for (strut_m, stop_n) in [(0.09, 2_100.0), (-0.16, -4_800.0)] {
            let mut corner = at_rest();
            (corner.wheel.strut_m, corner.body_m_s) = (strut_m, 0.3);
            let force_n = corner.advance(&strut(), 0);
            assert!((force_n - stop_n).abs() < 1.0, "{force_n} N");
            let expected = 0.3 + 0.01 * stop_n / (corner.load_n / GRAVITY_M_S2);
            assert!((corner.body_m_s - expected).abs() < 1e-4, "{} m/s", corner.body_m_s);
        }
    }

    /// By hand: 10 mm beyond 80 mm is 2,000 N and 100 N; 20 mm beyond 140 mm of rebound 4,000 N and 800 N.
    #[test]
    fn stops_are_those_of_the_strut() {
        assert_eq!((stop_n(0.08), stop_n(-0.14)), (0.0, 0.0));
        assert!((stop_n(0.09) - 2_100.0).abs() < 1.0 && (stop_n(-0.16) + 4_800.0).abs() < 1.0);
    }
}
