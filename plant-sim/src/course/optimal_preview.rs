//! The driver `hard`: optimal preview control with a model of the vehicle.
//!
//! C. C. MacAdam, "Application of an Optimal Preview Control for Simulation of Closed-Loop Automobile Driving", *IEEE Transactions
//! on Systems, Man, and Cybernetics* 11(6), 1981. The driver has the linear single-track model of the vehicle in mind and sets
//! the one steer angle that, held over the preview time T, brings its path closest to the line:
//!
//! ```text
//! minimise  sum over the preview (f_i - y0_i - g_i delta)^2      delta = sum (f_i - y0_i) g_i / sum g_i^2
//! ```
//!
//! with the line's offsets `f_i` from the present heading, the offsets `y0_i` that the vehicle would reach with straight wheels
//! from its present lateral velocity and yaw rate, and `g_i`, those that a unit steer angle adds. The single-track model in axes of
//! the vehicle (v lateral velocity, r yaw rate, C cornering stiffness of an axle, the front one with its elastic linkage):
//!
//! ```text
//! m (v' + V r) = -(Cf + Cr) v / V - (a Cf - b Cr) r / V + Cf delta
//! J r'         = -(a Cf - b Cr) v / V - (a^2 Cf + b^2 Cr) r / V + a Cf delta
//! psi' = r      y' = v + V psi
//! ```
//!
//! Unlike the report's driver it follows a line with sharp bends, up to what the tyres give.

use oleo_interface::Corner;

use super::track::Track;
use crate::handling::{DriverParameters, HandlingMotion, HandlingParameters};
use crate::vehicle::VehicleParameters;

/// Points of the preview, evenly spaced.
const POINTS: usize = 20;
/// Integration step of the model in mind, s.
const STEP_S: f64 = 0.005;
/// The model is made anew when the speed has changed by this share.
const SPEED_CHANGE: f64 = 0.02;
/// Slowest speed of the model in mind, m/s.
const SLOWEST_M_S: f64 = 2.0;

/// The linear single-track model of a vehicle.
#[derive(Debug, Clone, Copy, PartialEq)]
struct SingleTrack {
    mass_kg: f64,
    yaw_inertia_kg_m2: f64,
    /// Axles ahead of and behind the centre of mass, m.
    front_m: f64,
    rear_m: f64,
    /// Cornering stiffness of an axle, N/rad.
    front_n_rad: f64,
    rear_n_rad: f64,
}

/// Lateral velocity, yaw rate, heading, lateral place.
type State = [f64; 4];

impl SingleTrack {
    fn new(vehicle: &VehicleParameters, handling: &HandlingParameters) -> Self {
        let load = vehicle.static_wheel_load_n();
        let stiffness = |corner: Corner| {
            let axle = vehicle.axle_of(corner);
            let free_m = axle.tyre_radius_m + load[corner] / axle.tyre_stiffness_n_m;
            let tyre = handling.tyre.at(load[corner], 0.0, free_m);
            (2.0 * tyre.cornering_stiffness_n_rad(), tyre.pneumatic_trail_m())
        };
        let (front, trail_m) = stiffness(Corner::FrontLeft);
        let (rear_n_rad, _) = stiffness(Corner::RearLeft);
        let steering = &handling.steering;
        let gives_way = (trail_m + steering.castor_trail_m) / steering.linkage_stiffness_n_m_rad;
        let (mass_kg, wheelbase_m) = (vehicle.total_mass_kg(), vehicle.layout.wheelbase_m);
        let front_m = wheelbase_m * (1.0 - vehicle.body.front_mass_share);
        let rear_m = wheelbase_m - front_m;
        let body_m = front_m - vehicle.body_cg_behind_front_axle_m();
        let (front_axle, rear_axle) = (&vehicle.front_axle, &vehicle.rear_axle);
        let yaw_inertia_kg_m2 = vehicle.body.yaw_inertia_kg_m2
            + vehicle.body.sprung_mass_kg * body_m * body_m
            + front_axle.inertia_kg_m2
            + front_axle.mass_kg * front_m * front_m
            + rear_axle.inertia_kg_m2
            + rear_axle.mass_kg * rear_m * rear_m;
        Self {
            mass_kg,
            yaw_inertia_kg_m2,
            front_m,
            rear_m,
            front_n_rad: front / (1.0 + front * gives_way),
            rear_n_rad,
        }
    }

    fn rate(&self, speed_m_s: f64, [v, r, heading, _]: State, steer_rad: f64) -> State {
        let front = self.front_n_rad * (steer_rad - (v + self.front_m * r) / speed_m_s);
        let rear = -self.rear_n_rad * (v - self.rear_m * r) / speed_m_s;
        [
            (front + rear) / self.mass_kg - speed_m_s * r,
            (self.front_m * front - self.rear_m * rear) / self.yaw_inertia_kg_m2,
            r,
            v + speed_m_s * heading,
        ]
    }

    /// Lateral places at the points of the preview, from a state and with a steer angle that is held: classical Runge-Kutta.
    fn path(&self, speed_m_s: f64, preview_s: f64, start: State, steer_rad: f64) -> [f64; POINTS] {
        let interval_s = preview_s / POINTS as f64;
        let steps = (interval_s / STEP_S).ceil().max(1.0) as u32;
        let h = interval_s / f64::from(steps);
        let mut state = start;
        core::array::from_fn(|_| {
            for _ in 0..steps {
                let rate = |state: State| self.rate(speed_m_s, state, steer_rad);
                let k1 = rate(state);
                let k2 = rate(plus(state, 0.5 * h, k1));
                let k3 = rate(plus(state, 0.5 * h, k2));
                let k4 = rate(plus(state, h, k3));
                for (i, x) in state.iter_mut().enumerate() {
                    *x += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
                }
            }
            state[3]
        })
    }
}

fn plus(state: State, factor: f64, rate: State) -> State {
    core::array::from_fn(|i| state[i] + factor * rate[i])
}

/// What the model in mind says at one speed.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Expectation {
    speed_m_s: f64,
    /// Lateral places per lateral velocity, per yaw rate and per steer angle.
    by_velocity: [f64; POINTS],
    by_yaw_rate: [f64; POINTS],
    by_steer: [f64; POINTS],
}

/// A driver who steers by optimal preview control.
#[derive(Debug, Clone)]
pub struct OptimalPreviewDriver {
    car: SingleTrack,
    preview_s: f64,
    lag_s: f64,
    expectation: Expectation,
    steer_rad: f64,
}

impl OptimalPreviewDriver {
    /// A driver who knows this vehicle.
    pub fn new(vehicle: &VehicleParameters, handling: &HandlingParameters) -> Self {
        let car = SingleTrack::new(vehicle, handling);
        let DriverParameters {
            optimal_preview_time_s,
            lag_s,
            ..
        } = handling.driver;
        Self {
            car,
            preview_s: optimal_preview_time_s,
            lag_s,
            expectation: expectation(&car, optimal_preview_time_s, SLOWEST_M_S),
            steer_rad: 0.0,
        }
    }

    /// Steer angle for the coming step of `step_s`, rad, left positive.
    pub fn steer(&mut self, motion: &HandlingMotion, track: &Track, step_s: f64) -> f64 {
        let speed_m_s = motion.speed_m_s.max(SLOWEST_M_S);
        if (speed_m_s - self.expectation.speed_m_s).abs() > SPEED_CHANGE * speed_m_s {
            self.expectation = expectation(&self.car, self.preview_s, speed_m_s);
        }
        let expected = &self.expectation;
        let (sin, cos) = libm::sincos(motion.yaw_rad);
        let [x, y] = motion.foot_m;
        let (lateral_m_s, yaw_rad_s) = (motion.foot_lateral_m_s, motion.rates_rad_s[2]);
        let (mut wanted, mut weight) = (0.0, 0.0);
        for i in 0..POINTS {
            let ahead_m = speed_m_s * self.preview_s * (i + 1) as f64 / POINTS as f64;
            let line_m = track.error_m(x + ahead_m * cos, y + ahead_m * sin);
            let straight_m = expected.by_velocity[i] * lateral_m_s + expected.by_yaw_rate[i] * yaw_rad_s;
            let by_steer = expected.by_steer[i];
            wanted += (line_m - straight_m) * by_steer;
            weight += by_steer * by_steer;
        }
        let wanted = if weight > 0.0 { wanted / weight } else { 0.0 };
        self.steer_rad += (wanted - self.steer_rad) * (step_s / (self.lag_s + step_s));
        self.steer_rad
    }
}

fn expectation(car: &SingleTrack, preview_s: f64, speed_m_s: f64) -> Expectation {
    let path = |start: State, steer_rad: f64| car.path(speed_m_s, preview_s, start, steer_rad);
    Expectation {
        speed_m_s,
        by_velocity: path([1.0, 0.0, 0.0, 0.0], 0.0),
        by_yaw_rate: path([0.0, 1.0, 0.0, 0.0], 0.0),
        by_steer: path([0.0; 4], 1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn car() -> SingleTrack {
        SingleTrack::new(&VehicleParameters::defender110(), &HandlingParameters::defender110())
    }

    /// Held for long, a steer angle makes the circle of the single-track model: `r = V delta / (L + K V^2)`.
    #[test]
    fn the_model_in_mind_turns_the_circle_of_the_closed_form() {
        let car = car();
        let (speed, steer) = (15.0, 0.02);
        let mut state = [0.0; 4];
        for _ in 0..4000 {
            let rate = car.rate(speed, state, steer);
            state = plus(state, 0.001, rate);
        }
        let wheelbase = car.front_m + car.rear_m;
        let understeer = car.mass_kg / wheelbase * (car.rear_m / car.front_n_rad - car.front_m / car.rear_n_rad);
        let expected = speed * steer / (wheelbase + understeer * speed * speed);
        assert!((state[1] / expected - 1.0).abs() < 1e-3, "{} {expected}", state[1]);
        let gradient = understeer.to_degrees() * 9.81;
        assert!((1.0..4.0).contains(&gradient), "understeers by {gradient} degrees/g");
    }

    /// On the line and along it there is nothing to steer; left of it, to the right; mirrored, the mirror image.
    #[test]
    fn steers_towards_the_line() {
        let driver =
            || OptimalPreviewDriver::new(&VehicleParameters::defender110(), &HandlingParameters::defender110());
        let at = |y: f64| HandlingMotion {
            speed_m_s: 16.0,
            foot_m: [0.0, y],
            ..HandlingMotion::default()
        };
        assert_eq!(driver().steer(&at(0.0), &Track::straight(), 0.001), 0.0);
        let left = driver().steer(&at(1.0), &Track::straight(), 0.001);
        assert!(left < 0.0);
        assert_eq!(driver().steer(&at(-1.0), &Track::straight(), 0.001), -left);
    }

    /// The linear car itself, driven by its driver, follows the severe lane change within 0.2 m where the report's driver
    /// cuts it by more than 0.5 m.
    #[test]
    fn the_linear_car_follows_the_hard_line() {
        use crate::course::{LaneChangeLine, PreviewDriver};
        let (vehicle, handling) = (VehicleParameters::defender110(), HandlingParameters::defender110());
        let track = Track::severe_lane_change(1.79, 25.0, LaneChangeLine::Hard);
        let (car, speed, h) = (car(), 60.0 / 3.6, 0.001);
        let worst = |steer: &mut dyn FnMut(&HandlingMotion) -> f64| {
            let (mut state, mut x, mut worst) = ([0.0; 4], 0.0, 0.0f64);
            while x < 150.0 {
                let motion = HandlingMotion {
                    speed_m_s: speed,
                    foot_m: [x, state[3]],
                    yaw_rad: state[2],
                    foot_lateral_m_s: state[0],
                    rates_rad_s: [0.0, 0.0, state[1]],
                    ..HandlingMotion::default()
                };
                let steer_rad = steer(&motion);
                state = plus(state, h, car.rate(speed, state, steer_rad));
                x += h * speed;
                worst = worst.max((state[3] - track.lateral_m(x)).abs());
            }
            worst
        };
        let mut skilled = OptimalPreviewDriver::new(&vehicle, &handling);
        let mut simple = PreviewDriver::new(&handling.driver, vehicle.layout.wheelbase_m);
        let (skilled, simple) = (
            worst(&mut |motion| skilled.steer(motion, &track, h)),
            worst(&mut |motion| simple.steer(motion, &track, h)),
        );
        assert!(skilled < 0.2 && simple > 0.5, "{skilled} {simple}");
    }
}
