//! Equations of motion of the ride model: seed report, Appendix A, after Genta, *Motor Vehicle Dynamics* (1997) 6.3.
//!
//! Seven generalised coordinates from the static position: heave of body, front and rear axle (m, up positive), pitch
//! (rad, nose down positive, about the y axis to the left), roll of body, front and rear axle (rad, left side up positive,
//! about the x axis forward). Yaw, lateral and longitudinal motion are constrained; forward speed is constant. With
//! `x_i` the place of corner i ahead of the body's centre of mass (`l_e/c1`) and `s_i` its strut's place to the left of
//! the centre plane (`l_g/d2`), the extension of strut i is
//!
//! ```text
//! D_i = Z - Z_axle - x_i theta + s_i (phi - phi_axle)
//! ```
//!
//! and with `T_i` its tension, `W_i` the road's force on the wheel at `w_i` to the left, `k` the anti-roll bars, Lagrange's
//! equations for `T - U` of the appendix are
//!
//! ```text
//! m_s Z''  = - sum T_i - m_s g
//! m_f Zf'' = T_1 + T_2 - m_f g + W_1 + W_2                                       (rear alike)
//! (J_y + J_z phi^2 + J_f phi_f^2 + J_r phi_r^2) theta''
//!          = - 2 (J_z phi phi' + J_f phi_f phi_f' + J_r phi_r phi_r') theta' + sum x_i T_i
//! J_x phi''  = J_z phi theta'^2 - sum s_i T_i - k_f (phi - phi_f) - k_r (phi - phi_r)
//! J_f phi_f'' = J_f phi_f theta'^2 + s_1 T_1 + s_2 T_2 + k_f (phi - phi_f) + w_1 W_1 + w_2 W_2  (rear alike)
//! ```
//!
//! # Misprints and gaps of the printed appendix
//!
//! Found by deriving the equations again from its T, U, F and virtual work. The signs of all rows of `F_[2]` (anti-roll bars
//! included) are right; the fourth is incomplete, see 4.
//!
//! 1. Phi equation: "d/dt dT/dphi' - dT/dphi = J_z phi'' - ..." and the "therefore" after it print `J_z phi''`; dT/dphi' =
//!    J_x phi' above it and the matrix M say **J_x**.
//! 2. "U = U_S + U_G" omits **U_arb**, which the equations for phi, phi_f and phi_r contain.
//! 3. "Point c: the center of mass of the vehicle body (unsprung mass)" is the **sprung** mass.
//! 4. Theta equation: `phi^2 theta''` and its two fellows are dropped as small while `2 phi phi' theta'`, of the same
//!    order, is kept; the rest is then no Lagrangian system and its energy drifts. **Both are kept here**: M stays diagonal,
//!    and energy is conserved.
//! 5. `l_g/a2` and `l_w/a2` (phi equations, virtual work) are **`l_g/d2`, `l_w/d2`** of the definitions and of the rows of
//!    `F_[2]`; no point "a" is defined.
//! 6. The lines dF/dq' print `F_D1 / dq'` for **`dF_D1 / dq'`** throughout, in the phi equation even `F_D1 / phi'`.
//! 7. q is both the vector of seven generalised coordinates (`q_i`) and the state vector of (A1), which has fourteen entries.
//! 8. `l_0i` is defined and never used: it is absorbed in the static position from which the extensions count.
//!
//! Not misprints but to be known: extension and tension are positive in the appendix, compression in the body of the
//! report; with coordinates from the static position `T_i` starts at minus the static load and gravity does not vanish.

use oleo_interface::{Axle, Axles, Corners};

use super::parameters::{AxleParameters, GRAVITY_M_S2, VehicleParameters};

/// Generalised coordinates, their rates or accelerations, in the order of the appendix's state vector.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Coordinates {
    /// Z: body heave, m.
    pub heave: f64,
    /// Z_f: front axle heave, m.
    pub front_heave: f64,
    /// Z_r: rear axle heave, m.
    pub rear_heave: f64,
    /// theta: pitch, rad, nose down positive.
    pub pitch: f64,
    /// phi: body roll, rad, left side up positive.
    pub roll: f64,
    /// phi_f: front axle roll, rad.
    pub front_roll: f64,
    /// phi_r: rear axle roll, rad.
    pub rear_roll: f64,
}

impl Coordinates {
    /// `self + factor * other`.
    pub fn plus(self, factor: f64, other: Self) -> Self {
        Self::from_array(core::array::from_fn(|i| {
            self.to_array()[i] + factor * other.to_array()[i]
        }))
    }

    /// Heave of an axle, m.
    pub fn axle_heave(&self, axle: Axle) -> f64 {
        match axle {
            Axle::Front => self.front_heave,
            Axle::Rear => self.rear_heave,
        }
    }

    /// Roll of an axle, rad, left side up positive.
    pub fn axle_roll(&self, axle: Axle) -> f64 {
        match axle {
            Axle::Front => self.front_roll,
            Axle::Rear => self.rear_roll,
        }
    }

    /// In the order of the appendix: Z, Z_f, Z_r, theta, phi, phi_f, phi_r.
    pub fn to_array(self) -> [f64; 7] {
        [
            self.heave,
            self.front_heave,
            self.rear_heave,
            self.pitch,
            self.roll,
            self.front_roll,
            self.rear_roll,
        ]
    }

    /// Inverse of [`Self::to_array`].
    pub fn from_array([heave, front_heave, rear_heave, pitch, roll, front_roll, rear_roll]: [f64; 7]) -> Self {
        Self {
            heave,
            front_heave,
            rear_heave,
            pitch,
            roll,
            front_roll,
            rear_roll,
        }
    }
}

/// The constants of the equations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Equations {
    /// m_s: sprung mass, kg.
    pub body_mass_kg: f64,
    /// m_f, m_r: mass of each axle with its wheels, kg.
    pub axle_mass_kg: Axles<f64>,
    /// J_x, J_y, J_z of the body, kg m2.
    pub body_inertia_kg_m2: [f64; 3],
    /// J_f, J_r, kg m2.
    pub axle_inertia_kg_m2: Axles<f64>,
    /// l_e/c1: distance of each axle ahead of the body's centre of mass, m; negative behind it.
    pub axle_ahead_m: Axles<f64>,
    /// l_g/d2: half the strut spacing, m.
    pub half_strut_spacing_m: Axles<f64>,
    /// l_w/d2: half the track, m.
    pub half_track_m: Axles<f64>,
    /// Stiffness k_arb of the anti-roll bars, N m/rad.
    pub anti_roll_n_m_rad: Axles<f64>,
}

impl Equations {
    /// From a vehicle's parameters.
    pub fn new(parameters: &VehicleParameters) -> Self {
        let of_axles = |of: fn(&AxleParameters) -> f64| Axles::from_fn(|axle| of(parameters.axle(axle)));
        let ahead = parameters.body_cg_behind_front_axle_m();
        Self {
            body_mass_kg: parameters.body.sprung_mass_kg,
            axle_mass_kg: of_axles(|axle| axle.mass_kg),
            body_inertia_kg_m2: [
                parameters.body.roll_inertia_kg_m2,
                parameters.body.pitch_inertia_kg_m2,
                parameters.body.yaw_inertia_kg_m2,
            ],
            axle_inertia_kg_m2: of_axles(|axle| axle.inertia_kg_m2),
            axle_ahead_m: Axles::new(ahead, ahead - parameters.layout.wheelbase_m),
            half_strut_spacing_m: of_axles(|axle| 0.5 * axle.strut_spacing_m),
            half_track_m: of_axles(|axle| 0.5 * axle.track_m),
            anti_roll_n_m_rad: of_axles(|axle| axle.anti_roll_stiffness_n_m_rad),
        }
    }

    /// Extension of the four struts from the static position (or, from rates, its rate), m (m/s).
    ///
    /// Written as a mean and a difference per axle so that a mirrored motion gives mirrored bits.
    pub fn extension(&self, q: &Coordinates) -> Corners<f64> {
        Corners::from_left_right(Axles::from_fn(|axle| {
            let middle = q.heave - q.axle_heave(axle) - self.axle_ahead_m[axle] * q.pitch;
            let roll = self.half_strut_spacing_m[axle] * (q.roll - q.axle_roll(axle));
            [middle + roll, middle - roll]
        }))
    }

    /// Height of the four wheel centres above their static position (or, from rates, its rate), m (m/s).
    pub fn wheel_height(&self, q: &Coordinates) -> Corners<f64> {
        Corners::from_left_right(Axles::from_fn(|axle| {
            let (middle, roll) = (q.axle_heave(axle), self.half_track_m[axle] * q.axle_roll(axle));
            [middle + roll, middle - roll]
        }))
    }

    /// Accelerations for a state, strut tensions (positive pulling) and road forces on the wheels (N, up positive).
    pub fn acceleration(
        &self,
        q: &Coordinates,
        rate: &Coordinates,
        tension_n: Corners<f64>,
        wheel_force_n: Corners<f64>,
    ) -> Coordinates {
        let m_s = self.body_mass_kg;
        let [j_x, j_y, j_z] = self.body_inertia_kg_m2;
        let [m_f, m_r] = self.axle_mass_kg.into_array();
        let [j_f, j_r] = self.axle_inertia_kg_m2.into_array();
        let [w1, w2, w3, w4] = wheel_force_n.into_array();

        // Sum of the tensions of an axle's struts, and their torque with that of the anti-roll bar.
        let [(front, front_torque), (rear, rear_torque)] = Axles::from_fn(|axle| {
            let [left, right] = tension_n.of_axle(axle);
            let struts = self.half_strut_spacing_m[axle] * (left - right);
            let bar = self.anti_roll_n_m_rad[axle] * (q.roll - q.axle_roll(axle));
            (left + right, struts + bar)
        })
        .into_array();

        let pitch_inertia =
            j_y + j_z * q.roll * q.roll + j_f * q.front_roll * q.front_roll + j_r * q.rear_roll * q.rear_roll;
        let gyration =
            j_z * q.roll * rate.roll + j_f * q.front_roll * rate.front_roll + j_r * q.rear_roll * rate.rear_roll;
        let pitch_rate_2 = rate.pitch * rate.pitch;

        Coordinates {
            heave: -(front + rear) / m_s - GRAVITY_M_S2,
            front_heave: (front + (w1 + w2)) / m_f - GRAVITY_M_S2,
            rear_heave: (rear + (w3 + w4)) / m_r - GRAVITY_M_S2,
            pitch: (self.axle_ahead_m.front * front + self.axle_ahead_m.rear * rear - 2.0 * gyration * rate.pitch)
                / pitch_inertia,
            roll: (j_z * q.roll * pitch_rate_2 - (front_torque + rear_torque)) / j_x,
            front_roll: q.front_roll * pitch_rate_2 + (front_torque + self.half_track_m.front * (w1 - w2)) / j_f,
            rear_roll: q.rear_roll * pitch_rate_2 + (rear_torque + self.half_track_m.rear * (w3 - w4)) / j_r,
        }
    }

    /// Kinetic energy T of the appendix without the constant forward motion, J.
    pub fn kinetic_energy_j(&self, q: &Coordinates, rate: &Coordinates) -> f64 {
        let m_s = self.body_mass_kg;
        let [j_x, j_y, j_z] = self.body_inertia_kg_m2;
        let [m_f, m_r] = self.axle_mass_kg.into_array();
        let [j_f, j_r] = self.axle_inertia_kg_m2.into_array();
        let pitch_inertia =
            j_y + j_z * q.roll * q.roll + j_f * q.front_roll * q.front_roll + j_r * q.rear_roll * q.rear_roll;
        0.5 * (m_s * rate.heave * rate.heave
            + m_f * rate.front_heave * rate.front_heave
            + m_r * rate.rear_heave * rate.rear_heave
            + j_x * rate.roll * rate.roll
            + j_f * rate.front_roll * rate.front_roll
            + j_r * rate.rear_roll * rate.rear_roll
            + pitch_inertia * rate.pitch * rate.pitch)
    }

    /// U_arb + U_G of the appendix, J: what is stored apart from struts and tyres.
    pub fn potential_energy_j(&self, q: &Coordinates) -> f64 {
        let (front, rear) = (q.roll - q.front_roll, q.roll - q.rear_roll);
        let weight = self.body_mass_kg * q.heave
            + self.axle_mass_kg.front * q.front_heave
            + self.axle_mass_kg.rear * q.rear_heave;
        0.5 * (self.anti_roll_n_m_rad.front * front * front + self.anti_roll_n_m_rad.rear * rear * rear)
            + GRAVITY_M_S2 * weight
    }
}
