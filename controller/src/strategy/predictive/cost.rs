//! What a combination of levels costs: the accelerations that the forces of its forecasts make at the seats.

use oleo_interface::Corners;

use crate::filter::LowPass;
use crate::strategy::parts::forecast::{COMMON, Course, LEVELS, STEP_S, STEPS};

/// Frequency below which accelerations are felt less, Hz.
pub(super) const SLOW_HZ: f32 = 4.0;
/// Part of the accelerations below it that is not felt.
const NOT_FELT: f32 = 0.8;

/// Heave, roll and pitch.
pub(super) type Motions = [f32; 3];

/// What is felt, and what velocities cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cost {
    slow: LowPass,
    velocity_cost_per_s: f32,
}

impl Cost {
    /// With the cost of the velocities at the end of a forecast, 1/s.
    pub fn new(velocity_cost_per_s: f32) -> Self {
        Self {
            slow: LowPass::sampled(STEP_S, 1.0 / (2.0 * core::f32::consts::PI * SLOW_HZ)),
            velocity_cost_per_s,
        }
    }

    /// `J` of the levels of both axles, from the velocities and the lagged accelerations at the seats now.
    pub fn of(&self, sums: &Sums, front: [u8; 2], rear: [u8; 2], mut velocity: Motions, mut slow: Motions) -> f32 {
        let [fronts, rears] = &sums.axles;
        let (Some(front), Some(rear)) = (of_levels(fronts, front), of_levels(rears, rear)) else {
            return f32::MAX;
        };
        let mut cost = 0.0;
        for (step, (front, rear)) in front.iter().zip(rear).enumerate() {
            let states = velocity.iter_mut().zip(&mut slow);
            for ((front, rear), (velocity, slow)) in front.iter().zip(rear).zip(states) {
                let acceleration = front + rear;
                *velocity += STEP_S * acceleration;
                let felt = acceleration - NOT_FELT * self.slow.step(slow, acceleration);
                if step >= COMMON {
                    cost += STEP_S * felt * felt;
                }
            }
        }
        cost + self.velocity_cost_per_s * velocity.into_iter().map(|v| v * v).sum::<f32>()
    }
}

/// Accelerations at the seats that the two struts of each axle make together, for each combination of their levels.
pub(super) struct Sums {
    pub axles: [[[[Motions; STEPS]; LEVELS.len()]; LEVELS.len()]; 2],
}

impl Sums {
    pub fn of(courses: &Corners<[Course; LEVELS.len()]>, levers: &Corners<Motions>, per_mass: f32) -> Self {
        let ([fl, fr, rl, rr], [to_fl, to_fr, to_rl, to_rr]) = (courses.each_ref().into_array(), levers.into_array());
        Self {
            axles: [
                axle_sums((fl, fr), (to_fl, to_fr), per_mass),
                axle_sums((rl, rr), (to_rl, to_rr), per_mass),
            ],
        }
    }
}

/// What the struts of an axle make of the body, for each pair of their levels.
fn axle_sums(
    (left, right): (&[Course; LEVELS.len()], &[Course; LEVELS.len()]),
    (to_left, to_right): (Motions, Motions),
    per_mass: f32,
) -> [[[Motions; STEPS]; LEVELS.len()]; LEVELS.len()] {
    let mut sums = [[[[0.0; 3]; STEPS]; LEVELS.len()]; LEVELS.len()];
    for (left, sums) in left.iter().zip(&mut sums) {
        for (right, sums) in right.iter().zip(sums) {
            for ((left_n, right_n), motions) in left.iter().zip(right).zip(sums) {
                for ((motion, to_left), to_right) in motions.iter_mut().zip(to_left).zip(to_right) {
                    *motion = per_mass * (to_left * left_n + to_right * right_n);
                }
            }
        }
    }
    sums
}

/// The sums of two levels.
pub(super) fn of_levels<T>(sums: &[[T; LEVELS.len()]; LEVELS.len()], [left, right]: [u8; 2]) -> Option<&T> {
    sums.get(usize::from(left))?.get(usize::from(right))
}
