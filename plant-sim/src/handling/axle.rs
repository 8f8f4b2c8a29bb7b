//! A live axle on the body: where it is, how it moves, and what moves with its two coordinates.
//!
//! The axle is located as the report's table 1 says: links hold it along and across the body (Panhard rod in front, A-frame
//! at the rear) and leave it free to heave and to roll. So its roll centre, a point fixed in the axle, slides along the
//! body's vertical axis (`heave`), and the axle turns about the body's longitudinal axis through that point (`roll`). All
//! side forces of the tyres reach the body there, which is what makes the lateral load path: a high roll centre carries
//! much of the load transfer through links, a low one through springs. The rod's own arc is left out, so left and right
//! are mirror images. Pitch and yaw of the axle follow from its heave and roll, see `guide`: the links react drive and brake
//! torque.
//!
//! All vectors are in body axes (x ahead, y left, z up) from the body's centre of mass.

use nalgebra::{Matrix3, Vector3};

use super::axle_place::{AxleCoordinates, AxlePlace};
use super::guide::Guide;

/// What does not change of an axle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxleGeometry {
    /// Axle with wheels, kg.
    pub mass_kg: f64,
    /// About x, and about the axle's own z, kg m2 (Appendix A: J_f, J_r).
    pub roll_inertia_kg_m2: f64,
    /// Housing about the axle's own y, kg m2; the wheels' spin is counted apart.
    pub pitch_inertia_kg_m2: f64,
    /// Roll centre at rest.
    pub roll_centre_m: Vector3<f64>,
    /// Wheel centres below the roll centre, m.
    pub drop_m: f64,
    /// Half the track, m.
    pub half_track_m: f64,
    /// Half the distance between the struts, m.
    pub half_strut_spacing_m: f64,
    /// Anti-roll bar, N m/rad.
    pub anti_roll_n_m_rad: f64,
    /// What its links make of heave and roll.
    pub guide: Guide,
}

impl AxleGeometry {
    pub(super) fn place(&self, q: AxleCoordinates) -> AxlePlace {
        let (sin_roll, cos_roll) = libm::sincos(q.roll);
        let left = Vector3::new(0.0, cos_roll, sin_roll);
        let centre = self.roll_centre_m + Vector3::new(0.0, 0.0, q.heave);
        let arm = Vector3::new(0.0, self.drop_m * sin_roll, -self.drop_m * cos_roll);
        let (j_y, j_z) = (self.pitch_inertia_kg_m2, self.roll_inertia_kg_m2);
        let product = (j_y - j_z) * cos_roll * sin_roll;
        let inertia = Matrix3::new(
            self.roll_inertia_kg_m2,
            0.0,
            0.0,
            0.0,
            j_y * cos_roll * cos_roll + j_z * sin_roll * sin_roll,
            product,
            0.0,
            product,
            j_y * sin_roll * sin_roll + j_z * cos_roll * cos_roll,
        );
        let hub = centre + arm;
        AxlePlace {
            centre,
            mass_centre: hub + Vector3::new(self.guide.fore_aft_m(hub.z, q.heave), 0.0, 0.0),
            left,
            arm,
            lift: self.guide.lift(hub.z),
            swing: Vector3::new(0.0, -arm.z, arm.y),
            inertia,
            sin_roll,
            cos_roll,
        }
    }

    /// Compression of the left and right strut from rest, m. `twist` is the roll of the body's end above this axle
    /// against the body's mean, rad.
    pub(super) fn compression(&self, place: &AxlePlace, q: AxleCoordinates, twist: f64) -> [f64; 2] {
        let roll = self.half_strut_spacing_m * (place.sin_roll - twist);
        [q.heave + roll, q.heave - roll]
    }

    /// Rate of [`Self::compression`], m/s.
    pub(super) fn compression_rate(&self, place: &AxlePlace, rate: AxleCoordinates, twist_rate: f64) -> [f64; 2] {
        let roll = self.half_strut_spacing_m * (place.cos_roll * rate.roll - twist_rate);
        [rate.heave + roll, rate.heave - roll]
    }

    /// Generalised forces on the axle's heave and roll and the torque on the body's end above it, from the struts
    /// (N, compression positive) and the anti-roll bar: minus the derivative of their potential.
    pub(super) fn suspension(
        &self,
        place: &AxlePlace,
        q: AxleCoordinates,
        twist: f64,
        force_n: [f64; 2],
    ) -> (AxleCoordinates, f64) {
        let [left, right] = force_n;
        let struts = self.half_strut_spacing_m * (left - right);
        let bar = self.anti_roll_n_m_rad * (q.roll - twist);
        let forces = AxleCoordinates {
            heave: -(left + right),
            roll: -(struts * place.cos_roll + bar),
        };
        (forces, struts + bar)
    }
}
