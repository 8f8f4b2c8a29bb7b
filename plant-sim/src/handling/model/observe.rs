//! What can be seen of the vehicle: motion, wheels, suspension, energy, and what an accelerometer on a seat reads.

use nalgebra::Vector3;
use oleo_interface::{Axle, Axles, Corners};

use super::{HandlingModel, half_twist};
use crate::handling::attitude::yaw_pitch_roll;
use crate::handling::axle_place::AxleCoordinates;
use crate::handling::motion::HandlingMotion;
use crate::handling::wheel::WheelState;
use crate::vehicle::suspension::{FourElements, SuspensionElement};
use crate::vehicle::{GRAVITY_M_S2, InertialReading, RigidMotion, SeatAcceleration};

impl<E: SuspensionElement> HandlingModel<E> {
    /// Time since the start, s: an exact multiple of the step.
    pub fn time_s(&self) -> f64 {
        self.steps as f64 * self.step_s
    }

    /// The fixed step, s.
    pub fn step_s(&self) -> f64 {
        self.step_s
    }

    /// Steer angle that the driver has set: angle of the steering wheel over the steering ratio, rad, left positive.
    pub fn steer_rad(&self) -> f64 {
        self.steering.set_rad
    }

    /// Angle of an axle's wheels against the body's longitudinal axis, rad, left positive: at the front what the driver has
    /// set, less what the linkage has given way; at both axles the roll steer.
    pub fn wheel_steer_rad(&self, axle: Axle) -> f64 {
        let steer = match axle {
            Axle::Front => self.steering.wheel_rad(),
            Axle::Rear => 0.0,
        };
        steer + self.masses.axles[axle].guide.yaw_rad(self.axles[axle])
    }

    /// Motion of the body.
    pub fn motion(&self) -> HandlingMotion {
        let (yaw_rad, pitch_rad, roll_rad) = yaw_pitch_roll(&self.rotation);
        let (sin, cos) = libm::sincos(yaw_rad);
        let mut acceleration = self.rotation * self.acceleration.linear;
        acceleration.z -= GRAVITY_M_S2;
        let v = self.velocity;
        let below = Vector3::new(0.0, 0.0, -self.body_height_m);
        let foot = self.position + self.rotation * below;
        let foot_velocity = v + self.rotation * self.angular.cross(&below);
        let (along, across) = (v.x * cos + v.y * sin, v.y * cos - v.x * sin);
        HandlingMotion {
            position_m: [self.position.x, self.position.y, self.position.z - self.rest_height_m],
            foot_m: [foot.x, foot.y],
            velocity_m_s: [v.x, v.y, v.z],
            yaw_rad,
            pitch_rad,
            roll_rad,
            rates_rad_s: self.angular.into(),
            angular_acceleration_rad_s2: self.acceleration.angular.into(),
            speed_m_s: along,
            foot_lateral_m_s: foot_velocity.y * cos - foot_velocity.x * sin,
            longitudinal_acceleration_m_s2: acceleration.x * cos + acceleration.y * sin,
            lateral_acceleration_m_s2: acceleration.y * cos - acceleration.x * sin,
            vertical_acceleration_m_s2: acceleration.z,
            side_slip_rad: if along.abs() > 0.1 {
                libm::atan(across / along.abs())
            } else {
                0.0
            },
        }
    }

    /// Load, position and motion of the four wheels.
    pub fn wheels(&self) -> Corners<WheelState> {
        self.wheels
    }

    /// Heave along and roll about the body's axes of front and rear axle, from rest.
    pub fn axles(&self) -> Axles<AxleCoordinates> {
        self.axles
    }

    /// Heave of an axle's middle in the world from rest, m, and its roll in the world, rad: the ride model's coordinates.
    pub fn axle_heave_roll(&self, index: Axle) -> (f64, f64) {
        let place = self.masses.axles[index].place(self.axles[index]);
        let height = (self.rotation * place.mass_centre).z + self.position.z;
        let rest = self.masses.axles[index].place(AxleCoordinates::default()).mass_centre.z + self.rest_height_m;
        (
            height - rest,
            libm::asin((self.rotation * place.left).z.clamp(-1.0, 1.0)),
        )
    }

    /// Displacement of the four struts from rest, m, compression positive.
    pub fn strut_displacement_m(&self) -> Corners<f64> {
        let places = self.places();
        Corners::from_left_right(Axles::from_fn(|axle| {
            let twist = half_twist(axle) * self.twist;
            self.masses.axles[axle].compression(&places[axle], self.axles[axle], twist)
        }))
    }

    /// Force of the four suspension elements, N, compression positive.
    pub fn suspension_force_n(&self) -> Corners<f64> {
        self.suspension.force_n()
    }

    /// What an accelerometer at a place of the body reads; the place in body axes (ahead, left, up) from its centre of mass, m.
    pub fn acceleration_at(&self, place_m: [f64; 3]) -> SeatAcceleration {
        let felt = self.rigid_motion().specific_force_at(place_m);
        SeatAcceleration {
            fore_aft_m_s2: felt.x,
            lateral_m_s2: felt.y,
            vertical_m_s2: felt.z - GRAVITY_M_S2,
        }
    }

    /// What an inertial unit at a place of the body reads; the place in body axes (ahead, left, up) from its centre of mass, m.
    pub fn inertial_at(&self, place_m: [f64; 3]) -> InertialReading {
        self.rigid_motion().reading_at(place_m)
    }

    fn rigid_motion(&self) -> RigidMotion {
        RigidMotion {
            specific_force: self.acceleration.linear,
            rate: self.angular,
            acceleration: self.acceleration.angular,
        }
    }

    /// Kinetic energy, gravity and what anti-roll bars and the body's torsion hold, J (suspension and tyres not counted).
    pub fn energy_j(&self) -> f64 {
        let places = self.places();
        let mut potential = self.masses.body_kg * GRAVITY_M_S2 * self.position.z;
        for (index, axle) in self.masses.axles.iter() {
            let height = (self.rotation * places[index].mass_centre).z + self.position.z;
            let bar = self.axles[index].roll - half_twist(index) * self.twist;
            potential += axle.mass_kg * GRAVITY_M_S2 * height + 0.5 * axle.anti_roll_n_m_rad * bar * bar;
        }
        potential += 0.5 * self.masses.torsional_stiffness_n_m_rad * self.twist * self.twist;
        self.masses.kinetic_energy_j(&places, &self.velocities()) + potential
    }

    /// Momentum and angular momentum about the whole's centre of mass, world axes.
    #[cfg(test)]
    pub(super) fn momentum(&self) -> (Vector3<f64>, Vector3<f64>) {
        let places = self.places();
        let axes = self.wheel_axes(&places);
        let (linear, angular) = self.masses.momentum(&places, &self.velocities(), &axes);
        let mut first = Vector3::zeros();
        let mut mass = self.masses.body_kg;
        for (index, axle) in self.masses.axles.iter() {
            first += places[index].mass_centre * axle.mass_kg;
            mass += axle.mass_kg;
        }
        (
            self.rotation * linear,
            self.rotation * (angular - (first / mass).cross(&linear)),
        )
    }
}
