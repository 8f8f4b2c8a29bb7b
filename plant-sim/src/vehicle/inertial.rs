//! What an inertial unit reads that is fixed to the body: specific force and angular velocity at its place, in body axes.
//!
//! Axes as in ISO 8855: x ahead, y to the left, z up, rotations right-handed, so that roll with the left side up and pitch with the nose
//! down are positive as everywhere here. Specific force is the acceleration against free fall, m/s2: a unit at rest reads +g on the axis that
//! points up. With `a` the acceleration of the centre of mass, `R` from body to world axes, `w` and `w'` angular velocity and acceleration
//! in body axes, and `r` the place from the centre of mass,
//!
//! ```text
//!   f = R^T (a - g) + w' x r + w x (w x r)
//! ```
//!
//! Sources (*recalled*): Genta, *Motor Vehicle Dynamics* (1997), appendix on rigid bodies; Titterton & Weston, *Strapdown Inertial
//! Navigation Technology* (2004), chapter 3, for the definition of specific force.

use nalgebra::Vector3;

use super::parameters::GRAVITY_M_S2;

/// What an inertial unit without error reads.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct InertialReading {
    /// Specific force along x, y, z, m/s2.
    pub specific_force_m_s2: [f64; 3],
    /// Angular velocity about x, y, z, rad/s.
    pub rate_rad_s: [f64; 3],
}

/// Motion of a rigid body, in its own axes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RigidMotion {
    /// Specific force at the centre of mass, m/s2.
    pub(crate) specific_force: Vector3<f64>,
    /// Angular velocity, rad/s.
    pub(crate) rate: Vector3<f64>,
    /// Angular acceleration, rad/s2.
    pub(crate) acceleration: Vector3<f64>,
}

impl RigidMotion {
    /// Of a body whose centre of mass only heaves, turned by pitch and then by roll about its own axis: the ride model's, in which all other
    /// motion is constrained.
    pub(crate) fn of_heave_pitch_roll(heave_acceleration: f64, pitch: [f64; 3], roll: [f64; 3]) -> Self {
        let ([theta, theta_1, theta_2], [phi, phi_1, phi_2]) = (pitch, roll);
        let (sin_theta, cos_theta) = libm::sincos(theta);
        let (sin_phi, cos_phi) = libm::sincos(phi);
        let upward = Vector3::new(-sin_theta, cos_theta * sin_phi, cos_theta * cos_phi);
        Self {
            specific_force: upward * (heave_acceleration + GRAVITY_M_S2),
            rate: Vector3::new(phi_1, theta_1 * cos_phi, -theta_1 * sin_phi),
            acceleration: Vector3::new(
                phi_2,
                theta_2 * cos_phi - theta_1 * phi_1 * sin_phi,
                -theta_2 * sin_phi - theta_1 * phi_1 * cos_phi,
            ),
        }
    }

    /// Specific force at a place in body axes from the centre of mass, m/s2.
    pub(crate) fn specific_force_at(&self, place_m: [f64; 3]) -> Vector3<f64> {
        let (place, w) = (Vector3::from(place_m), self.rate);
        self.specific_force + self.acceleration.cross(&place) + w.cross(&w.cross(&place))
    }

    /// What a unit at a place reads.
    pub(crate) fn reading_at(&self, place_m: [f64; 3]) -> InertialReading {
        InertialReading {
            specific_force_m_s2: self.specific_force_at(place_m).into(),
            rate_rad_s: self.rate.into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix3, Rotation3};

    const G: f64 = 9.806_65;

    fn close(found: [f64; 3], expected: [f64; 3], tolerance: f64) {
        let near = found.iter().zip(expected).all(|(a, b)| (a - b).abs() < tolerance);
        assert!(near, "{found:?} {expected:?}");
    }

    #[test]
    fn at_rest_it_reads_gravity_upward_wherever_it_is() {
        let level = RigidMotion::of_heave_pitch_roll(0.0, [0.0; 3], [0.0; 3]);
        let reading = level.reading_at([1.0, -0.5, 0.7]);
        assert_eq!(
            (reading.specific_force_m_s2, reading.rate_rad_s),
            ([0.0, 0.0, G], [0.0; 3])
        );
        // Nose down by 30 degrees: x points down, and z is 30 degrees off the vertical. Left side up: y points up.
        let angle = core::f64::consts::FRAC_PI_6;
        let dived = RigidMotion::of_heave_pitch_roll(0.0, [angle, 0.0, 0.0], [0.0; 3]);
        close(
            dived.reading_at([0.0; 3]).specific_force_m_s2,
            [-0.5 * G, 0.0, 0.75f64.sqrt() * G],
            1e-12,
        );
        let leaning = RigidMotion::of_heave_pitch_roll(0.0, [0.0; 3], [angle, 0.0, 0.0]);
        close(
            leaning.reading_at([0.0; 3]).specific_force_m_s2,
            [0.0, 0.5 * G, 0.75f64.sqrt() * G],
            1e-12,
        );
    }

    /// A merry-go-round: towards the axis `w^2 r`, whatever the height.
    #[test]
    fn a_steady_turn_pulls_to_the_axis() {
        let turning = RigidMotion {
            specific_force: Vector3::new(0.0, 0.0, G),
            rate: Vector3::new(0.0, 0.0, 0.5),
            acceleration: Vector3::zeros(),
        };
        close(
            turning.reading_at([2.0, -1.2, 0.3]).specific_force_m_s2,
            [-0.5, 0.3, G],
            1e-12,
        );
    }

    /// Roll that begins with 2 rad/s2: 0.5 m to the left it goes up with 1 m/s2, 0.3 m up it goes to the right with 0.6 m/s2.
    #[test]
    fn roll_that_begins_lifts_the_left_side() {
        let motion = RigidMotion::of_heave_pitch_roll(0.0, [0.0; 3], [0.0, 0.0, 2.0]);
        close(
            motion.reading_at([4.0, 0.5, 0.3]).specific_force_m_s2,
            [0.0, -0.6, G + 1.0],
            1e-12,
        );
    }

    /// A point is followed through the world by its position alone, which is differentiated twice, and a rotation matrix once.
    #[test]
    fn large_heave_pitch_and_roll_are_the_second_derivative_of_the_path() {
        let heave = |t: f64| 0.3 * libm::sin(2.0 * t);
        let pitch = |t: f64| 0.4 * libm::sin(1.7 * t + 0.3);
        let roll = |t: f64| 0.7 * libm::sin(2.3 * t - 0.5);
        let place = [1.1, -0.6, 0.8];
        let rotation = |t: f64| {
            Rotation3::from_axis_angle(&Vector3::y_axis(), pitch(t))
                * Rotation3::from_axis_angle(&Vector3::x_axis(), roll(t))
        };
        let path = |t: f64| Vector3::new(0.0, 0.0, heave(t)) + rotation(t) * Vector3::from(place);
        let h = 1e-4;
        let second = |of: &dyn Fn(f64) -> f64, t: f64| {
            let (before, now, after) = (of(t - h), of(t), of(t + h));
            [
                now,
                (after - before) / (2.0 * h),
                (after - 2.0 * now + before) / (h * h),
            ]
        };
        for k in 0..40 {
            let t = 0.137 * f64::from(k);
            let felt = (path(t + h) - 2.0 * path(t) + path(t - h)) / (h * h) + Vector3::new(0.0, 0.0, G);
            let back = rotation(t).inverse();
            let change = (rotation(t + h).matrix() - rotation(t - h).matrix()) / (2.0 * h);
            let spin: Matrix3<f64> = back.matrix() * change;
            let motion = RigidMotion::of_heave_pitch_roll(second(&heave, t)[2], second(&pitch, t), second(&roll, t));
            let reading = motion.reading_at(place);
            close(reading.specific_force_m_s2, (back * felt).into(), 2e-6);
            close(reading.rate_rad_s, [spin[(2, 1)], spin[(0, 2)], spin[(1, 0)]], 1e-7);
        }
    }
}
