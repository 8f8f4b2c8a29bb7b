//! What a vehicle is made of, as numbers with units and a source.
//!
//! One TOML file describes one vehicle; the ride model and the handling model read the same file, so that a mass is
//! stated once. Every value of the shipped preset carries the label of its origin in a comment of
//! `presets/defender110.toml`. A file with an unknown key, a missing key or an impossible value is refused with one
//! line that names file, line and key: a simulation of a vehicle nobody meant is worse than none.

use oleo_interface::{Axle, Corner, Corners};
use serde::{Deserialize, Serialize};

use super::seat::Seat;

/// Standard acceleration of gravity, m/s2 (ISO 80000-3).
pub const GRAVITY_M_S2: f64 = 9.80665;

/// A vehicle, complete. All values SI.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VehicleParameters {
    /// What the vehicle is called in reports.
    pub name: String,
    /// Sprung mass.
    pub body: BodyParameters,
    /// Overall dimensions.
    pub layout: LayoutParameters,
    /// Front live axle with its wheels.
    pub front_axle: AxleParameters,
    /// Rear live axle with its wheels.
    pub rear_axle: AxleParameters,
    /// What is the same for all tyres.
    pub tyre: TyreParameters,
    /// Coil springs and dampers of the vehicle as sold, front.
    pub front_baseline: BaselineParameters,
    /// Coil springs and dampers of the vehicle as sold, rear.
    pub rear_baseline: BaselineParameters,
    /// Driver's seat (right front in the preset).
    pub driver_seat: SeatParameters,
    /// Left rear passenger's seat.
    pub passenger_seat: SeatParameters,
    /// Fixed-step integration.
    pub solver: SolverParameters,
}

/// The sprung mass: a rigid body with its principal axes along x (forward), y (left), z (up).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyParameters {
    /// Sprung mass m_s, kg.
    pub sprung_mass_kg: f64,
    /// J_x about the body's own centre of mass, kg m2.
    pub roll_inertia_kg_m2: f64,
    /// J_y, kg m2.
    pub pitch_inertia_kg_m2: f64,
    /// J_z, kg m2.
    pub yaw_inertia_kg_m2: f64,
    /// Height of the *whole vehicle's* centre of mass above ground at static load, m.
    pub vehicle_cg_height_m: f64,
    /// Share of the *whole vehicle's* weight on the front axle, 0..1.
    pub front_mass_share: f64,
}

/// Overall dimensions.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LayoutParameters {
    /// Front to rear axle, m.
    pub wheelbase_m: f64,
    /// Overall width w, which sets the lane widths of ISO 3888, m.
    pub width_m: f64,
}

/// A live axle with its two wheels.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxleParameters {
    /// Axle with wheels, m_f or m_r, kg.
    pub mass_kg: f64,
    /// J_f or J_r: inertia about x and, as Appendix A has it, about z; kg m2.
    pub inertia_kg_m2: f64,
    /// Distance between the left and right wheel centres, m.
    pub track_m: f64,
    /// Distance between the left and right strut on the axle (2 l_g/d2), m.
    pub strut_spacing_m: f64,
    /// k_arb: torque between body and axle per radian of relative roll, N m/rad; 0 = no bar.
    pub anti_roll_stiffness_n_m_rad: f64,
    /// Vertical rate of one tyre, N/m.
    pub tyre_stiffness_n_m: f64,
    /// Vertical damping of one tyre, N s/m.
    pub tyre_damping_n_s_m: f64,
    /// Height of the wheel centre above ground at static load, m.
    pub tyre_radius_m: f64,
}

/// Tyre contact in the vertical direction.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TyreParameters {
    /// Length over which the road height is averaged, m; 0 = point contact as in Appendix A.
    pub contact_length_m: f64,
}

/// Coil spring, damper and stops of one wheel of the vehicle as sold. Bump = compression.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BaselineParameters {
    /// Spring rate, N/m.
    pub coil_stiffness_n_m: f64,
    /// Damper rate in compression, N s/m.
    pub bump_damping_n_s_m: f64,
    /// Damper rate in extension, N s/m.
    pub rebound_damping_n_s_m: f64,
    /// Compression from static at which the bump stop is touched, m.
    pub bump_clearance_m: f64,
    /// Extension from static at which the rebound stop is touched, m.
    pub rebound_clearance_m: f64,
    /// Rate of either stop once touched, N/m.
    pub stop_stiffness_n_m: f64,
}

/// A seat's place on the body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SeatParameters {
    /// Distance behind the front axle, m.
    pub behind_front_axle_m: f64,
    /// Distance to the left of the centre plane, m (right is negative).
    pub left_of_centre_m: f64,
    /// Height of the seat surface above ground at static load, m.
    pub above_ground_m: f64,
}

/// Fixed-step integration.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SolverParameters {
    /// Integration step, s. Must divide the controller's tick (5 ms).
    pub step_s: f64,
}

impl VehicleParameters {
    /// The shipped Defender 110: kerb weight and driver, 2050 kg.
    pub fn defender110() -> Self {
        Self::from_toml(DEFENDER110_TOML, "presets/defender110.toml")
            .expect("the shipped preset is parsed in the tests")
    }

    /// Whole vehicle, kg.
    pub fn total_mass_kg(&self) -> f64 {
        self.body.sprung_mass_kg + self.front_axle.mass_kg + self.rear_axle.mass_kg
    }

    /// Distance from the front axle back to the *body's* centre of mass, m (l_e/c1 of the front axle).
    ///
    /// Moments about the front axle: `m_s a_s = m L (1 - share) - m_r L`.
    pub fn body_cg_behind_front_axle_m(&self) -> f64 {
        let wheelbase_m = self.layout.wheelbase_m;
        let moment = self.total_mass_kg() * wheelbase_m * (1.0 - self.body.front_mass_share)
            - self.rear_axle.mass_kg * wheelbase_m;
        moment / self.body.sprung_mass_kg
    }

    /// Height of the *body's* centre of mass above ground at static load, m; axles at wheel-centre height.
    pub fn body_cg_height_m(&self) -> f64 {
        let axles = self.front_axle.mass_kg * self.front_axle.tyre_radius_m
            + self.rear_axle.mass_kg * self.rear_axle.tyre_radius_m;
        (self.total_mass_kg() * self.body.vehicle_cg_height_m - axles) / self.body.sprung_mass_kg
    }

    /// Weight that each strut carries at rest on level ground, N: what `StrutModel::defender110` is charged for.
    pub fn static_strut_load_n(&self) -> Corners<f64> {
        let behind = self.body_cg_behind_front_axle_m();
        let weight_n = self.body.sprung_mass_kg * GRAVITY_M_S2;
        let rear = 0.5 * weight_n * behind / self.layout.wheelbase_m;
        let front = 0.5 * weight_n - rear;
        Corners::from_fn(|corner| match corner.axle() {
            Axle::Front => front,
            Axle::Rear => rear,
        })
    }

    /// Vertical force of the road on each wheel at rest on level ground, N.
    pub fn static_wheel_load_n(&self) -> Corners<f64> {
        let strut = self.static_strut_load_n();
        Corners::from_fn(|corner| strut[corner] + 0.5 * self.axle_of(corner).mass_kg * GRAVITY_M_S2)
    }

    /// Position of a seat relative to the body's centre of mass, `(x forward, y left)` in m.
    pub fn seat_position_m(&self, seat: &SeatParameters) -> (f64, f64) {
        (
            self.body_cg_behind_front_axle_m() - seat.behind_front_axle_m,
            seat.left_of_centre_m,
        )
    }

    /// A seat's place in body axes (ahead, left, up) from the body's centre of mass, m.
    pub fn seat_place_m(&self, seat: Seat) -> [f64; 3] {
        let seat = match seat {
            Seat::Driver => &self.driver_seat,
            Seat::Passenger => &self.passenger_seat,
        };
        let (x, y) = self.seat_position_m(seat);
        [x, y, seat.above_ground_m - self.body_cg_height_m()]
    }

    /// Parameters of an axle.
    pub fn axle(&self, axle: Axle) -> &AxleParameters {
        match axle {
            Axle::Front => &self.front_axle,
            Axle::Rear => &self.rear_axle,
        }
    }

    /// Parameters of the axle that a corner belongs to.
    pub fn axle_of(&self, corner: Corner) -> &AxleParameters {
        self.axle(corner.axle())
    }

    /// Coil spring and damper of the vehicle as sold at an axle.
    pub fn baseline(&self, axle: Axle) -> &BaselineParameters {
        match axle {
            Axle::Front => &self.front_baseline,
            Axle::Rear => &self.rear_baseline,
        }
    }
}

const DEFENDER110_TOML: &str = include_str!("../../presets/defender110.toml");

#[cfg(test)]
mod tests {
    use super::*;

    /// Table 1 of the seed report counts one "anti-rollbar stiffness" between the two halves of one bar.
    #[test]
    fn the_preset_has_one_anti_roll_bar() {
        let preset = VehicleParameters::defender110();
        let bars = Axle::ALL.map(|axle| preset.axle(axle).anti_roll_stiffness_n_m_rad);
        assert_eq!(bars.iter().filter(|stiffness| **stiffness > 0.0).count(), 1, "{bars:?}");
    }
}
