//! How the links of a live axle guide it: what moves fore and aft, pitches and yaws when the axle heaves and rolls.
//!
//! **Side view.** Radius arms (front) or trailing links and A-frame (rear) make the axle turn about a point of the body, its
//! side-view instant centre, at height h and distance d from the axle; d is behind the front axle and ahead of the rear one.
//! A wheel that rises by ds therefore moves fore and aft, and a brake force at the ground pushes or pulls the body up or down
//! by `F h / d` beside what the springs carry: anti-dive in front, anti-lift and anti-squat at the rear (W. F. and D. L. Milliken,
//! *Race Car Vehicle Dynamics*, SAE 1995, 17.3; brakes and differential are on the axle, so the force acts at the ground). With
//! the share b of the brake force at an axle, wheelbase L and height H of the centre of mass, the usual percentage is
//! `100 b (h / d) (L / H)`.
//!
//! **Plan view.** The axle rolls about an inclined line, so it yaws in proportion to its roll against the body: roll steer
//! (T. D. Gillespie, *Fundamentals of Vehicle Dynamics*, SAE 1992, chapter 6). Positive values understeer: the front axle
//! yaws out of the bend, the rear axle into it.
//!
//! Velocities of the contact points and generalised forces have both motions, with the same Jacobian, so that no energy appears
//! from nowhere. The axle's mass follows its fore-aft motion; the inertia of its small pitch and yaw is left out.

use nalgebra::Vector3;

use super::axle_place::{AxleCoordinates, AxlePlace};

/// Linkage of an axle. All in body axes (x ahead, y left, z up) from the body's centre of mass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Guide {
    /// Pitch of the axle per heave, nose down positive, rad/m: the inverse of the instant centre's distance ahead of the axle.
    pub pitch_per_heave_rad_m: f64,
    /// Height of the side-view instant centre, m.
    pub instant_centre_z_m: f64,
    /// Yaw of the axle, left positive, per roll of the axle against the body, left side up positive.
    pub yaw_per_roll: f64,
}

impl Guide {
    /// How far the axle has moved ahead with its heave, m: its centre is now at height `z_m`.
    pub(super) fn fore_aft_m(&self, z_m: f64, heave_m: f64) -> f64 {
        self.pitch_per_heave_rad_m * heave_m * (z_m - 0.5 * heave_m - self.instant_centre_z_m)
    }

    /// Movement of the axle's centre, at height `z_m`, per unit of heave.
    pub(super) fn lift(&self, z_m: f64) -> Vector3<f64> {
        Vector3::new(self.pitch_per_heave_rad_m * (z_m - self.instant_centre_z_m), 0.0, 1.0)
    }

    /// Yaw of the axle against the body, rad, left positive.
    pub(super) fn yaw_rad(&self, q: AxleCoordinates) -> f64 {
        self.yaw_per_roll * q.roll
    }

    /// Angular velocity of the axle against the body, rad/s: roll about the body's x, pitch about the axle's own y, yaw.
    pub(super) fn turn(&self, place: &AxlePlace, rate: AxleCoordinates) -> Vector3<f64> {
        let roll = Vector3::new(rate.roll, 0.0, self.yaw_per_roll * rate.roll);
        roll + place.left * (self.pitch_per_heave_rad_m * rate.heave)
    }

    /// Velocity against the body of a point that is fixed to the axle, m/s.
    pub(super) fn velocity(&self, place: &AxlePlace, point: &Vector3<f64>, rate: AxleCoordinates) -> Vector3<f64> {
        let pitch = place.left.cross(&(point - place.mass_centre)) * self.pitch_per_heave_rad_m;
        (place.lift + pitch) * rate.heave + self.rolled(place, point) * rate.roll
    }

    /// What a force at a point of the axle (N) and a moment (N m) do to the axle's heave and roll.
    pub(super) fn generalised(
        &self,
        place: &AxlePlace,
        force: &Vector3<f64>,
        point: &Vector3<f64>,
        moment: &Vector3<f64>,
    ) -> AxleCoordinates {
        let pitching = (point - place.mass_centre).cross(force) + moment;
        AxleCoordinates {
            heave: force.dot(&place.lift) + self.guided(place, &pitching).heave,
            roll: force.dot(&self.rolled(place, point)) + moment.x + self.guided(place, moment).roll,
        }
    }

    /// Share of a moment on the axle that acts on heave by the pitch and on roll by the yaw that the links give it.
    pub(super) fn guided(&self, place: &AxlePlace, moment: &Vector3<f64>) -> AxleCoordinates {
        AxleCoordinates {
            heave: self.pitch_per_heave_rad_m * place.left.dot(moment),
            roll: self.yaw_per_roll * moment.z,
        }
    }

    /// Movement of a point of the axle per unit of roll.
    fn rolled(&self, place: &AxlePlace, point: &Vector3<f64>) -> Vector3<f64> {
        let arm = point - place.centre;
        Vector3::new(-self.yaw_per_roll * arm.y, self.yaw_per_roll * arm.x - arm.z, arm.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::handling::HandlingParameters;
    use crate::handling::assembly::masses;
    use crate::vehicle::VehicleParameters;
    use oleo_interface::Axle;

    /// A point of the axle moves as a point of a rigid body that turns about the side-view instant centre.
    #[test]
    fn heave_is_a_rotation_about_the_instant_centre() {
        let (vehicle, handling) = (VehicleParameters::defender110(), HandlingParameters::defender110());
        let masses = masses(&vehicle, &handling);
        for axle in Axle::ALL {
            let geometry = &masses.axles[axle];
            let place = geometry.place(AxleCoordinates::default());
            let ahead = 1.0 / geometry.guide.pitch_per_heave_rad_m;
            assert_eq!(
                ahead > 0.0,
                axle == Axle::Rear,
                "trailing links at the rear, radius arms in front"
            );
            let centre = Vector3::new(place.mass_centre.x + ahead, 0.0, geometry.guide.instant_centre_z_m);
            let rate = AxleCoordinates { heave: 1.0, roll: 0.0 };
            for point in [place.mass_centre, place.mass_centre + Vector3::new(0.2, 0.7, -0.38)] {
                let rigid = geometry.guide.turn(&place, rate).cross(&(point - centre));
                let moved = geometry.guide.velocity(&place, &point, rate);
                assert!((moved - rigid).norm() < 1e-12, "{moved} {rigid}");
            }
        }
    }

    /// The generalised force is the work of force and moment per coordinate, by difference quotient of nothing but motion.
    #[test]
    fn generalised_forces_do_the_work_of_the_motion() {
        let (vehicle, handling) = (VehicleParameters::defender110(), HandlingParameters::defender110());
        let geometry = &masses(&vehicle, &handling).axles.front;
        let place = geometry.place(AxleCoordinates { heave: 0.03, roll: 0.1 });
        let (force, moment) = (Vector3::new(300.0, -700.0, 5000.0), Vector3::new(20.0, -90.0, 15.0));
        let point = place.mass_centre + place.left * 0.743 - Vector3::new(0.0, 0.0, 0.38);
        let q = geometry.guide.generalised(&place, &force, &point, &moment);
        for (rate, expected) in [
            (AxleCoordinates { heave: 1.0, roll: 0.0 }, q.heave),
            (AxleCoordinates { heave: 0.0, roll: 1.0 }, q.roll),
        ] {
            let work = force.dot(&geometry.guide.velocity(&place, &point, rate))
                + moment.dot(&geometry.guide.turn(&place, rate));
            assert!((work - expected).abs() < 1e-9 * expected.abs(), "{work} {expected}");
        }
    }
}
