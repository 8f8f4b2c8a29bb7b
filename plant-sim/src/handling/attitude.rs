//! Attitude of the body: a unit quaternion, which is valid for any angle and is integrated without trigonometry.

use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// Attitude of the body in the world: `w + x i + y j + z k`, of length 1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Attitude {
    w: f64,
    v: Vector3<f64>,
}

impl Attitude {
    pub(super) fn level() -> Self {
        Self {
            w: 1.0,
            v: Vector3::zeros(),
        }
    }

    /// Turned by `rate` (rad/s, body axes) for `duration_s`: the Cayley form `q (1, rate t / 2)`, normalised; second order.
    pub(super) fn turned(&self, rate: Vector3<f64>, duration_s: f64) -> Self {
        let half = rate * (0.5 * duration_s);
        let w = self.w - self.v.dot(&half);
        let v = self.v + half * self.w + self.v.cross(&half);
        let scale = 1.0 / (w * w + v.dot(&v)).sqrt();
        Self {
            w: w * scale,
            v: v * scale,
        }
    }

    /// Turns body into world axes.
    pub(super) fn matrix(&self) -> Matrix3<f64> {
        let (w, x, y, z) = (self.w, self.v.x, self.v.y, self.v.z);
        Matrix3::new(
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * y - w * z),
            2.0 * (x * z + w * y),
            2.0 * (x * y + w * z),
            1.0 - 2.0 * (x * x + z * z),
            2.0 * (y * z - w * x),
            2.0 * (x * z - w * y),
            2.0 * (y * z + w * x),
            1.0 - 2.0 * (x * x + y * y),
        )
    }
}

/// Yaw, pitch (nose down positive) and roll (left side up positive) of an attitude matrix, rad; roll within +-pi.
pub(super) fn yaw_pitch_roll(attitude: &Matrix3<f64>) -> (f64, f64, f64) {
    (
        libm::atan2(attitude[(1, 0)], attitude[(0, 0)]),
        -libm::asin(attitude[(2, 0)].clamp(-1.0, 1.0)),
        libm::atan2(attitude[(2, 1)], attitude[(2, 2)]),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_about_one_axis_add_up_beyond_a_right_angle() {
        for (axis, angle_of) in [(0usize, 2usize), (2, 0)] {
            let mut rate = Vector3::zeros();
            rate[axis] = 2.0;
            let mut attitude = Attitude::level();
            for _ in 0..1000 {
                attitude = attitude.turned(rate, 0.001);
            }
            let (yaw, pitch, roll) = yaw_pitch_roll(&attitude.matrix());
            assert!(([yaw, pitch, roll][angle_of] - 2.0).abs() < 1e-6 && pitch.abs() < 1e-9);
        }
    }

    #[test]
    fn mirrored_rates_give_mirrored_bits() {
        let mut one = Attitude::level();
        let mut other = Attitude::level();
        for i in 0..500 {
            let t = f64::from(i) * 0.013;
            let rate = Vector3::new(libm::sin(3.0 * t), libm::cos(t), libm::sin(t));
            one = one.turned(rate, 0.01);
            other = other.turned(Vector3::new(-rate.x, rate.y, -rate.z), 0.01);
        }
        let (yaw, pitch, roll) = yaw_pitch_roll(&one.matrix());
        assert_eq!(yaw_pitch_roll(&other.matrix()), (-yaw, pitch, -roll));
    }
}
