//! Time integration of the ride model with a fixed step and bit-identical results on every machine.
//!
//! One step of `h` (1 ms in the preset) is velocity Verlet, the kick-drift-kick form of leapfrog:
//!
//! ```text
//! v_half = v + h/2 a          q' = q + h v_half          v* = v_half + h/2 a
//! struts move to q' within h; tyres and struts give their forces at (q', v*)
//! a' = equations(q', v*, forces)                          v' = v_half + h/2 a'
//! ```
//!
//! Why this is stable. Leapfrog is symplectic and stable while `omega h < 2`. The stiffest thing the axle sees is the
//! tyre on one side and the strut on the other; a strut is never stiffer than its locked oil column, `beta A^2 / V` (some
//! 3 MN/m: 170 rad/s against half an axle, `omega h` = 0.17), however steep its damper or valve, since the strut solves
//! its own flows implicitly within the step. Damper forces use the predicted speed `v*` and are stable while `c h / m < 1`.
//! Order: two, the strut included, which is told the piston's speed at both ends of the step.

use std::sync::Arc;

use oleo_interface::{Axle, Corner, Corners, Side};

use super::contact::{Contact, Tyre};
use super::equations::{Coordinates, Equations};
use super::inertial::{InertialReading, RigidMotion};
use super::parameters::VehicleParameters;
use super::strut_element::StrutElement;
use super::suspension::{CoilElement, FourElements, Motion, SuspensionElement, tension_n};
use crate::road::Road;
use crate::strut::{Strut, StrutOutput};

/// A vehicle that cannot be put on the road.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum RideError {
    /// The suspension would not carry the vehicle near its design height.
    #[error(
        "the {} strut carries {carried_n:.0} N at its static position, but the vehicle's weight on it is {needed_n:.0} N: \
         set the strut's static pressure for that load, or change the vehicle's masses",
        corner.name()
    )]
    StaticLoad {
        /// Corner at which the strut is.
        corner: Corner,
        /// Force of the strut at displacement 0, N.
        carried_n: f64,
        /// Static load of the corner, N.
        needed_n: f64,
    },
    /// Forward speed is negative, infinite or not a number.
    #[error("speed {0} m/s is not a forward speed: give a finite value of 0 or more")]
    Speed(f64),
}

/// Motion of the sprung mass at its centre of mass, from the static position. Roll: left side up positive; pitch: nose
/// down positive.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BodyMotion {
    /// Heave of the body's centre of mass, m, positive up.
    pub heave_m: f64,
    /// Roll of the body, rad, positive with the left side up.
    pub roll_rad: f64,
    /// Pitch of the body, rad, positive with the nose down.
    pub pitch_rad: f64,
    /// Heave rate of the body, m/s.
    pub heave_rate_m_s: f64,
    /// Roll rate of the body, rad/s.
    pub roll_rate_rad_s: f64,
    /// Pitch rate of the body, rad/s.
    pub pitch_rate_rad_s: f64,
    /// Heave acceleration of the body, m/s2, without gravity.
    pub heave_acceleration_m_s2: f64,
    /// Roll acceleration of the body, rad/s2.
    pub roll_acceleration_rad_s2: f64,
    /// Pitch acceleration of the body, rad/s2.
    pub pitch_acceleration_rad_s2: f64,
}

/// Vertical motion of one wheel.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WheelMotion {
    /// Wheel centre above its static position, m.
    pub height_m: f64,
    /// Rate of the height, m/s.
    pub height_rate_m_s: f64,
    /// Road under the wheel (after enveloping), relative to the level the vehicle started on, m.
    pub road_height_m: f64,
    /// Its rate at the present speed, m/s.
    pub road_height_rate_m_s: f64,
    /// Road's force on the wheel, N; 0 when the wheel is off the ground.
    pub force_n: f64,
}

/// Share of the static load by which a suspension may miss it at the start; beyond, the vehicle would hang in its stops.
const STATIC_LOAD_TOLERANCE: f64 = 0.25;

/// The 7-degree-of-freedom ride model on any suspension.
pub struct RideModel<E: SuspensionElement> {
    equations: Equations,
    suspension: E::Four,
    contacts: Corners<Contact>,
    tyres: Corners<Tyre>,
    step_s: f64,
    steps: u64,
    speed_m_s: f64,
    wheelbase_m: f64,
    datum_m: f64,
    q: Coordinates,
    rate: Coordinates,
    acceleration: Coordinates,
    wheels: Corners<WheelMotion>,
    /// Road heights of the step to come, so that the rate at the present one is a central difference.
    next_road_m: Corners<f64>,
}

/// The ride model on four two-stage hydropneumatic struts.
pub type RideVehicle = RideModel<StrutElement>;

/// The ride model on the coil springs and dampers of the vehicle as sold.
pub type BaselineVehicle = RideModel<CoilElement>;

impl RideVehicle {
    /// A vehicle at rest relative to its suspension, front axle at station 0, moving at `speed_m_s`.
    ///
    /// # Errors
    /// A speed that is none, or struts charged for another vehicle.
    pub fn new(
        parameters: &VehicleParameters,
        struts: Corners<Strut>,
        road: Arc<dyn Road>,
        speed_m_s: f64,
    ) -> Result<Self, RideError> {
        Self::with_elements(parameters, struts.map(StrutElement::new), road, speed_m_s)
    }

    /// Force and pressures of the four struts.
    pub fn strut_output(&self) -> Corners<StrutOutput> {
        self.suspension.output()
    }
}

impl BaselineVehicle {
    /// The vehicle as sold.
    ///
    /// # Errors
    /// As [`RideVehicle::new`].
    pub fn baseline(parameters: &VehicleParameters, road: Arc<dyn Road>, speed_m_s: f64) -> Result<Self, RideError> {
        Self::with_elements(parameters, CoilElement::of_vehicle(parameters), road, speed_m_s)
    }
}

impl<E: SuspensionElement> RideModel<E> {
    /// A vehicle on any four suspension elements.
    ///
    /// # Errors
    /// As [`RideVehicle::new`].
    pub fn with_elements(
        parameters: &VehicleParameters,
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
            let missed_n = (carried_n - needed_n).abs();
            if missed_n.is_nan() || missed_n > STATIC_LOAD_TOLERANCE * needed_n {
                return Err(RideError::StaticLoad {
                    corner,
                    carried_n,
                    needed_n,
                });
            }
        }
        let equations = Equations::new(parameters);
        let wheel_load = parameters.static_wheel_load_n();
        let contacts = Corners::from_fn(|corner| {
            let half_track_m = 0.5 * parameters.axle_of(corner).track_m;
            let lateral_m = match corner.side() {
                Side::Left => half_track_m,
                Side::Right => -half_track_m,
            };
            Contact::new(Arc::clone(&road), lateral_m, parameters.tyre.contact_length_m)
        });
        let tyres = Corners::from_fn(|corner| {
            let axle = parameters.axle_of(corner);
            Tyre {
                stiffness_n_m: axle.tyre_stiffness_n_m,
                damping_n_s_m: axle.tyre_damping_n_s_m,
                static_load_n: wheel_load[corner],
            }
        });
        let mut model = Self {
            equations,
            suspension: elements.into(),
            contacts,
            tyres,
            step_s: parameters.solver.step_s,
            steps: 0,
            speed_m_s,
            wheelbase_m: parameters.layout.wheelbase_m,
            datum_m: 0.0,
            q: Coordinates::default(),
            rate: Coordinates::default(),
            acceleration: Coordinates::default(),
            wheels: Corners::default(),
            next_road_m: Corners::default(),
        };
        // The static position rests on the road's mean level at the start, wherever the file's zero is.
        let [a, b, c, d] = model.road_heights_m(0.0).into_array();
        model.datum_m = 0.25 * ((a + b) + (c + d));
        let before = model.road_heights_m(-model.step_s);
        model.next_road_m = model.road_heights_m(0.0);
        for (corner, wheel) in model.wheels.iter_mut() {
            wheel.road_height_m = before[corner] - model.datum_m;
        }
        model.roll_wheels(&Coordinates::default());
        model.acceleration = model.accelerate(&Coordinates::default());
        Ok(model)
    }

    /// Advances one step. `signals` are the controller's, by corner; about 0.2 us plus the suspension's own time.
    pub fn step(&mut self, signals: Corners<E::Signal>) {
        let half_s = 0.5 * self.step_s;
        let rate_half = self.rate.plus(half_s, self.acceleration);
        self.q = self.q.plus(self.step_s, rate_half);
        let predicted = rate_half.plus(half_s, self.acceleration);
        self.steps += 1;

        let extension = self.equations.extension(&self.q);
        let extension_rate = self.equations.extension(&predicted);
        let motions =
            Corners::from_fn(|corner| Motion::from_extension(extension[corner], extension_rate[corner], self.step_s));
        self.suspension.advance(&motions, &signals);
        self.roll_wheels(&predicted);
        self.acceleration = self.accelerate(&predicted);
        self.rate = rate_half.plus(half_s, self.acceleration);
    }

    /// Moves the wheels to the present position with `rate`, and finds the tyre forces.
    fn roll_wheels(&mut self, rate: &Coordinates) {
        let time_s = self.time_s();
        let present_m = self.next_road_m;
        self.next_road_m = self.road_heights_m(time_s + self.step_s);
        let height = self.equations.wheel_height(&self.q);
        let height_rate = self.equations.wheel_height(rate);
        for (corner, wheel) in self.wheels.iter_mut() {
            let past_m = wheel.road_height_m;
            let ahead_m = self.next_road_m[corner] - self.datum_m;
            wheel.road_height_m = present_m[corner] - self.datum_m;
            wheel.road_height_rate_m_s = (ahead_m - past_m) / (2.0 * self.step_s);
            wheel.height_m = height[corner];
            wheel.height_rate_m_s = height_rate[corner];
            wheel.force_n = self.tyres[corner].force_n(
                wheel.road_height_m - wheel.height_m,
                wheel.road_height_rate_m_s - wheel.height_rate_m_s,
            );
        }
    }

    fn accelerate(&self, rate: &Coordinates) -> Coordinates {
        let tension = self.suspension.force_n().map(tension_n);
        let wheel_force = self.wheels.map(|wheel| wheel.force_n);
        self.equations.acceleration(&self.q, rate, tension, wheel_force)
    }

    /// Road under the four wheels at a time, m above the road's own zero.
    fn road_heights_m(&mut self, time_s: f64) -> Corners<f64> {
        let front_m = self.speed_m_s * time_s;
        let rear_m = front_m - self.wheelbase_m;
        Corners::from_fn(|corner| {
            let station_m = match corner.axle() {
                Axle::Front => front_m,
                Axle::Rear => rear_m,
            };
            self.contacts[corner].height_m(station_m)
        })
    }

    /// Time since the start, s: an exact multiple of the step.
    pub fn time_s(&self) -> f64 {
        self.steps as f64 * self.step_s
    }

    /// The fixed step, s.
    pub fn step_s(&self) -> f64 {
        self.step_s
    }

    /// Station of the front axle, m.
    pub fn station_m(&self) -> f64 {
        self.speed_m_s * self.time_s()
    }

    /// Forward speed of the vehicle, m/s.
    pub fn speed_m_s(&self) -> f64 {
        self.speed_m_s
    }

    /// Displacement of the four struts from the static position, m, compression positive.
    pub fn strut_displacement_m(&self) -> Corners<f64> {
        self.equations.extension(&self.q).map(|extension| -extension)
    }

    /// Force of the four suspension elements, N, compression positive.
    pub fn suspension_force_n(&self) -> Corners<f64> {
        self.suspension.force_n()
    }

    /// Motion of the sprung mass.
    pub fn body(&self) -> BodyMotion {
        BodyMotion {
            heave_m: self.q.heave,
            roll_rad: self.q.roll,
            pitch_rad: self.q.pitch,
            heave_rate_m_s: self.rate.heave,
            roll_rate_rad_s: self.rate.roll,
            pitch_rate_rad_s: self.rate.pitch,
            heave_acceleration_m_s2: self.acceleration.heave,
            roll_acceleration_rad_s2: self.acceleration.roll,
            pitch_acceleration_rad_s2: self.acceleration.pitch,
        }
    }

    /// Vertical motion of the four wheels.
    pub fn wheels(&self) -> Corners<WheelMotion> {
        self.wheels
    }

    /// Vertical acceleration of the body, m/s2 without gravity, at a place `x_m` ahead and `y_m` to the left of its
    /// centre of mass (`VehicleParameters::seat_position_m` gives a seat's).
    pub fn vertical_acceleration_at(&self, x_m: f64, y_m: f64) -> f64 {
        self.acceleration.heave - x_m * self.acceleration.pitch + y_m * self.acceleration.roll
    }

    /// What an inertial unit at a place of the body reads; the place in body axes (ahead, left, up) from its centre of mass, m. The model holds
    /// the body against all motion ahead, sideways and in yaw: the forces that do so are in what it reads along x and y.
    pub fn inertial_at(&self, place_m: [f64; 3]) -> InertialReading {
        let (q, rate, acceleration) = (&self.q, &self.rate, &self.acceleration);
        let pitch = [q.pitch, rate.pitch, acceleration.pitch];
        let roll = [q.roll, rate.roll, acceleration.roll];
        RigidMotion::of_heave_pitch_roll(acceleration.heave, pitch, roll).reading_at(place_m)
    }

    /// Generalised coordinates and their rates, as in Appendix A.
    pub fn state(&self) -> (Coordinates, Coordinates) {
        (self.q, self.rate)
    }

    /// Puts the model into a state: for tests against closed forms. Forces follow at the next step.
    pub fn set_state(&mut self, q: Coordinates, rate: Coordinates) {
        self.q = q;
        self.rate = rate;
        self.roll_wheels(&rate);
        self.acceleration = self.accelerate(&rate);
    }

    /// The constants of the equations of motion.
    pub fn equations(&self) -> &Equations {
        &self.equations
    }
}
