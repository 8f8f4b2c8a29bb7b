//! Time integration of the handling model with a fixed step and bit-identical results on every machine.
//!
//! The step is the ride model's (velocity Verlet, kick-drift-kick; see `vehicle::ride` for why it is stable with struts that
//! solve their own flows): half a kick, move, forces at the new place with predicted speeds, half a kick. Tyre slips
//! are implicit (see `wheel`). The suspension elements are the ride model's too, so every spring of one model runs in
//! the other.

mod observe;
mod snapshot;

use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};
use oleo_interface::{Axle, Axles, Corner, Corners, Side};

use super::assembly::masses;
use super::attitude::Attitude;
use super::axle_place::{AxleCoordinates, AxlePlace};
use super::dynamics::{Accelerations, Loads, Masses, Velocities, Wrench};
use super::ground::Probe;
use super::motion::Controls;
use super::parameters::HandlingParameters;
use super::steering::SteeringState;
use super::wheel::{ContactState, Tyre, WheelLoads, WheelMotion, WheelState, WheelTorque};
use crate::road::Road;
use crate::strut::{Strut, StrutOutput};
use crate::vehicle::StrutElement;
use crate::vehicle::suspension::{FourElements, Motion, SuspensionElement};
use crate::vehicle::{GRAVITY_M_S2, RideError, VehicleParameters};

pub use snapshot::VehicleSnapshot;

/// A suspension may carry this much more or less than the static load at its design height.
const STATIC_LOAD_TOLERANCE: f64 = 0.05;

/// The handling model on four suspension elements.
pub struct HandlingModel<E: SuspensionElement> {
    masses: Masses,
    handling: HandlingParameters,
    tyres: Axles<Tyre>,
    probe: Probe,
    road: Arc<dyn Road>,
    suspension: E::Four,
    step_s: f64,
    steps: u64,
    rest_height_m: f64,
    body_height_m: f64,

    position: Vector3<f64>,
    velocity: Vector3<f64>,
    attitude: Attitude,
    rotation: Matrix3<f64>,
    angular: Vector3<f64>,
    axles: Axles<AxleCoordinates>,
    axle_rates: Axles<AxleCoordinates>,
    spin: Corners<f64>,
    twist: f64,
    twist_rate: f64,
    contacts: Corners<ContactState>,
    steering: SteeringState,
    acceleration: Accelerations,
    wheels: Corners<WheelState>,
}

/// The handling model on two-stage struts.
pub type HandlingVehicle = HandlingModel<StrutElement>;

impl HandlingVehicle {
    /// A vehicle on struts, straight ahead at `speed_m_s` from the origin.
    ///
    /// # Errors
    /// A strut that would not carry its static load; a speed that is not one.
    pub fn new(
        parameters: &VehicleParameters,
        handling: &HandlingParameters,
        struts: Corners<Strut>,
        road: Arc<dyn Road>,
        speed_m_s: f64,
    ) -> Result<Self, RideError> {
        Self::with_elements(parameters, handling, struts.map(StrutElement::new), road, speed_m_s)
    }

    /// Outputs of the four struts.
    pub fn strut_output(&self) -> Corners<StrutOutput> {
        self.suspension.output()
    }
}

impl<E: SuspensionElement> HandlingModel<E> {
    /// A vehicle on any four suspension elements, at rest in heave and roll, rolling straight ahead.
    ///
    /// # Errors
    /// As [`HandlingVehicle::new`].
    pub fn with_elements(
        parameters: &VehicleParameters,
        handling: &HandlingParameters,
        elements: Corners<E>,
        road: Arc<dyn Road>,
        speed_m_s: f64,
    ) -> Result<Self, RideError> {
        if !(speed_m_s >= 0.0 && speed_m_s.is_finite()) {
            return Err(RideError::Speed(speed_m_s));
        }
        let needed = parameters.static_strut_load_n();
        for (corner, element) in elements.iter() {
            let (carried_n, needed_n) = (element.force_n(), needed[corner]);
            let fits = (carried_n - needed_n).abs() <= STATIC_LOAD_TOLERANCE * needed_n;
            if !fits {
                return Err(RideError::StaticLoad {
                    corner,
                    carried_n,
                    needed_n,
                });
            }
        }
        let rest_height_m = parameters.body_cg_height_m();
        let wheel_load = parameters.static_wheel_load_n();
        let tyres = Axles::from_fn(|place| {
            let axle = parameters.axle(place);
            Tyre {
                stiffness_n_m: axle.tyre_stiffness_n_m,
                damping_n_s_m: axle.tyre_damping_n_s_m,
                free_radius_m: axle.tyre_radius_m + wheel_load[place.corner(Side::Left)] / axle.tyre_stiffness_n_m,
            }
        });
        let spin = Corners::from_fn(|corner| {
            let tyre = &tyres[corner.axle()];
            let deflection_m = wheel_load[corner] / tyre.stiffness_n_m;
            speed_m_s
                / handling
                    .tyre
                    .rolling_radius_m(tyre.free_radius_m, deflection_m, tyre.stiffness_n_m)
        });
        let mut model = Self {
            masses: masses(parameters, handling),
            tyres,
            probe: Probe {
                half_length_m: 0.5 * handling.ground.plane_length_m,
                half_width_m: 0.5 * handling.ground.plane_width_m,
                half_contact_m: 0.5 * parameters.tyre.contact_length_m,
            },
            handling: handling.clone(),
            road,
            suspension: elements.into(),
            step_s: parameters.solver.step_s,
            steps: 0,
            rest_height_m,
            body_height_m: rest_height_m,
            // The front axle starts at station 0, as in the ride model.
            position: Vector3::new(-parameters.body_cg_behind_front_axle_m(), 0.0, 0.0),
            velocity: Vector3::new(speed_m_s, 0.0, 0.0),
            attitude: Attitude::level(),
            rotation: Matrix3::identity(),
            angular: Vector3::zeros(),
            axles: Axles::default(),
            axle_rates: Axles::default(),
            spin,
            twist: 0.0,
            twist_rate: 0.0,
            contacts: Corners::default(),
            steering: SteeringState::default(),
            acceleration: Accelerations::default(),
            wheels: Corners::default(),
        };
        // At rest on the road's mean level under the wheels at the start, wherever the road's zero is.
        let [a, b, c, d] = Corners::from_fn(|corner| {
            let station = match corner.axle() {
                Axle::Front => 0.0,
                Axle::Rear => -parameters.layout.wheelbase_m,
            };
            let side = 0.5 * sign(corner.side());
            model.road.height_m(station, side * parameters.axle_of(corner).track_m)
        })
        .into_array();
        let datum_m = 0.25 * ((a + b) + (c + d));
        model.rest_height_m += datum_m;
        model.position.z = model.rest_height_m;
        let velocities = model.velocities();
        model.acceleration = model.accelerate(&model.places(), &velocities, Controls::default());
        Ok(model)
    }

    /// Advances one step. `signals` go to the suspension elements, corner by corner.
    pub fn step(&mut self, signals: Corners<E::Signal>, controls: Controls) {
        let h = self.step_s;
        let half = 0.5 * h;
        self.kick(half);
        self.position += self.velocity * h;
        self.attitude = self.attitude.turned(self.angular, h);
        self.rotation = self.attitude.matrix();
        for (place, axle) in self.axles.iter_mut() {
            *axle = axle.plus(h, self.axle_rates[place]);
        }
        self.twist += h * self.twist_rate;
        self.steps += 1;
        self.steering.turn(&self.handling.steering, controls.steer_rad, h);

        // Speeds half a step on, for the forces; the true ones follow from those forces.
        let kept = (self.velocity, self.angular, self.axle_rates, self.spin, self.twist_rate);
        self.kick(half);
        let predicted = self.velocities();
        (self.velocity, self.angular, self.axle_rates, self.spin, self.twist_rate) = kept;

        let places = self.places();
        let mut motions = Corners::splat(Motion::default());
        for (index, axle) in self.masses.axles.iter() {
            let half = half_twist(index);
            let compression = axle.compression(&places[index], self.axles[index], half * self.twist);
            let rate = axle.compression_rate(&places[index], predicted.axles[index], half * predicted.twist);
            for ((side, compression_m), compression_rate_m_s) in Side::ALL.into_iter().zip(compression).zip(rate) {
                let corner = index.corner(side);
                motions[corner] = Motion {
                    compression_m,
                    compression_rate_m_s,
                    duration_s: h,
                };
            }
        }
        self.suspension.advance(&motions, &signals);
        self.acceleration = self.accelerate(&places, &predicted, controls);
        self.steering
            .give_way(&self.handling.steering, self.swivel_torque_n_m(), h);
        self.kick(half);
    }

    /// Torque of the front tyres about the swivel pins, N m, left positive.
    fn swivel_torque_n_m(&self) -> f64 {
        let trail_m = self.handling.steering.castor_trail_m;
        let [left, right] = self.wheels.of_axle(Axle::Front);
        (left.aligning_n_m + right.aligning_n_m) - trail_m * (left.lateral_n + right.lateral_n)
    }

    /// Velocities after `duration_s` of the present accelerations.
    fn kick(&mut self, duration_s: f64) {
        let a = &self.acceleration;
        let mut linear = self.rotation * a.linear;
        linear.z -= GRAVITY_M_S2;
        self.velocity += linear * duration_s;
        self.angular += a.angular * duration_s;
        for (place, rate) in self.axle_rates.iter_mut() {
            *rate = rate.plus(duration_s, a.axles[place]);
        }
        for (corner, spin) in self.spin.iter_mut() {
            *spin += a.spin[corner] * duration_s;
        }
        self.twist_rate += a.twist * duration_s;
    }

    fn velocities(&self) -> Velocities {
        Velocities {
            linear: self.rotation.tr_mul(&self.velocity),
            angular: self.angular,
            axles: self.axle_rates,
            spin: self.spin,
            twist: self.twist_rate,
        }
    }

    fn places(&self) -> Axles<AxlePlace> {
        Axles::from_fn(|axle| self.masses.axles[axle].place(self.axles[axle]))
    }

    /// The four wheels' axes, body axes.
    fn wheel_axes(&self, places: &Axles<AxlePlace>) -> Corners<Vector3<f64>> {
        let axis = Axles::from_fn(|axle| {
            let steer_rad = match axle {
                Axle::Front => self.steering.wheel_rad(),
                Axle::Rear => 0.0,
            };
            let yaw = self.masses.axles[axle].guide.yaw_rad(self.axles[axle]);
            let (sin, cos) = libm::sincos(yaw + steer_rad);
            places[axle].left * cos - Vector3::new(sin, 0.0, 0.0)
        });
        Corners::from_axles(axis)
    }

    /// Accelerations at the present places of the axles.
    fn accelerate(&mut self, places: &Axles<AxlePlace>, velocities: &Velocities, controls: Controls) -> Accelerations {
        let axes = self.wheel_axes(places);
        let pushes = self.suspension.force_n();
        let mut loads = Loads::default();
        let (stiffness, damping) = (
            self.masses.torsional_stiffness_n_m_rad,
            self.masses.torsional_damping_n_m_s_rad,
        );
        loads.twist = -(stiffness * self.twist + damping * velocities.twist);
        for (index, place) in places.iter() {
            let half = half_twist(index);
            let force = pushes.of_axle(index).map(|push| *push);
            let axle = &self.masses.axles[index];
            let (forces, torque) = axle.suspension(place, self.axles[index], half * self.twist, force);
            loads.axles[index] = forces;
            loads.twist += half * torque;

            let drive = &self.handling.drive;
            let share = |front: f64| match index {
                Axle::Front => 0.5 * front * self.tyres[index].free_radius_m,
                Axle::Rear => 0.5 * (1.0 - front) * self.tyres[index].free_radius_m,
            };
            let torque = WheelTorque {
                drive_n_m: share(drive.front_share) * controls.drive_force_n,
                brake_n_m: share(drive.brake_front_share) * controls.brake_force_n,
            };
            let (left, right) = (index.corner(Side::Left), index.corner(Side::Right));
            let left = self.roll_wheel(left, place, axes[left], velocities, torque, &mut loads.spin);
            let right = self.roll_wheel(right, place, axes[right], velocities, torque, &mut loads.spin);
            loads.add_pair(index, &left, &right);
        }
        self.masses.accelerations(places, velocities, &loads, &axes)
    }

    /// Lets a wheel roll: what its tyre does to the axle. Its state is kept, and the torque on its spin noted.
    fn roll_wheel(
        &mut self,
        corner: Corner,
        place: &AxlePlace,
        axis: Vector3<f64>,
        velocities: &Velocities,
        torque: WheelTorque,
        spin_torque_n_m: &mut Corners<f64>,
    ) -> Wrench {
        let index = corner.axle();
        let axle = &self.masses.axles[index];
        let centre = place.mass_centre + place.left * (sign(corner.side()) * axle.half_track_m);
        let rate = velocities.axles[index];
        let motion = WheelMotion {
            centre,
            axis,
            velocity: velocities.linear + velocities.angular.cross(&centre) + axle.guide.velocity(place, &centre, rate),
            turn: velocities.angular + axle.guide.turn(place, rate),
            spin: velocities.spin[corner],
            height_m: 0.0,
        };
        let world = self.position + self.rotation * centre;
        let (ahead_x, ahead_y) = (self.rotation[(0, 0)], self.rotation[(1, 0)]);
        let length = (ahead_x * ahead_x + ahead_y * ahead_y).sqrt().max(1e-9);
        let ahead = (ahead_x / length, ahead_y / length);
        let plane = self.probe.plane(self.road.as_ref(), world.x, world.y, ahead);
        let motion = WheelMotion {
            height_m: world.z,
            ..motion
        };
        let WheelLoads {
            state,
            wrench,
            spin_torque_n_m: spin,
        } = self.tyres[index].roll(
            &self.handling.tyre,
            &mut self.contacts[corner],
            &motion,
            &plane,
            &self.rotation,
            (place, &axle.guide),
            torque,
            self.step_s,
        );
        self.wheels[corner] = state;
        spin_torque_n_m[corner] = spin;
        wrench
    }

    /// Puts the body into a motion, for tests against closed forms: height above rest, velocity in the world, angular
    /// velocity in body axes, axle rates. Forces follow at the next step.
    #[cfg(test)]
    fn throw(
        &mut self,
        height_m: f64,
        velocity_m_s: [f64; 3],
        rates_rad_s: [f64; 3],
        axle_rates: Axles<AxleCoordinates>,
    ) {
        self.position.z = self.rest_height_m + height_m;
        self.velocity = Vector3::from(velocity_m_s);
        self.angular = Vector3::from(rates_rad_s);
        self.axle_rates = axle_rates;
        let velocities = self.velocities();
        self.acceleration = self.accelerate(&self.places(), &velocities, Controls::default());
    }
}

/// Share of the body's twist that an end of the body has turned by.
fn half_twist(axle: Axle) -> f64 {
    match axle {
        Axle::Front => 0.5,
        Axle::Rear => -0.5,
    }
}

/// Direction of a side along y: left positive.
fn sign(side: Side) -> f64 {
    match side {
        Side::Left => 1.0,
        Side::Right => -1.0,
    }
}

#[cfg(test)]
mod steady_tests;
#[cfg(test)]
mod tests;
