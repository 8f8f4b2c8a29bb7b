//! The report's driver, and the one who keeps the speed.
//!
//! Section 3.1: "The vehicle is steered over a predetermined course by a simple driver model which estimates the lateral
//! positional error based on the yaw angle of the vehicle body at the current time step and the desired lateral position
//! at a specified driver preview time." So with the preview distance d = V tau the driver looks at the place it would
//! reach on its present heading and steers in proportion to how far the line is beside it there:
//!
//! ```text
//! P = (x + d cos yaw, y + d sin yaw)      e = line - P      steer = gain 2 L / d^2 (e + integral)
//! ```
//!
//! 2 L / d^2 is the angle of the circular arc through P for a wheelbase L (pure pursuit: R. C. Coulter, CMU-RI-TR-92-01,
//! 1992), so `gain` 1 asks for just that arc. The integral is for long bends only; the report has none. A first-order lag
//! stands for arms and steering box; angle and rate are limited in the vehicle ("steering angle limiter", table 1).
//!
//! Speed ("forward speed", a constraint in table 1) is held by a proportional-integral force: drive within engine power and
//! traction, or brake.

use super::motion::{Controls, HandlingMotion};
use super::parameters::HandlingParameters;
use super::track::Track;

/// Walking pace: the preview does not get shorter than at this speed, m/s.
const SLOWEST_M_S: f64 = 2.0;
/// The integral only acts on errors a driver would trim away, m.
const INTEGRAL_BAND_M: f64 = 2.0;

/// A driver: parameters and what it remembers.
#[derive(Debug, Clone)]
pub struct Driver {
    handling: HandlingParameters,
    wheelbase_m: f64,
    integral_m: f64,
    steer_rad: f64,
    force_integral_n: f64,
}

impl Driver {
    /// A driver for a vehicle.
    pub fn new(handling: &HandlingParameters, wheelbase_m: f64) -> Self {
        Self {
            handling: handling.clone(),
            wheelbase_m,
            integral_m: 0.0,
            steer_rad: 0.0,
            force_integral_n: 0.0,
        }
    }

    /// Controls for the coming step of `step_s`: follow `track` at `speed_m_s`.
    pub fn follow(&mut self, motion: &HandlingMotion, track: &Track, speed_m_s: f64, step_s: f64) -> Controls {
        let driver = &self.handling.driver;
        let preview_m = driver.preview_time_s * motion.speed_m_s.max(SLOWEST_M_S);
        let (sin, cos) = libm::sincos(motion.yaw_rad);
        // The driver watches where the vehicle is, not how its body sways.
        let [x, y] = motion.foot_m;
        let error_m = track.error_m(x + preview_m * cos, y + preview_m * sin);
        if error_m.abs() < INTEGRAL_BAND_M {
            self.integral_m += driver.integral_per_s * step_s * error_m;
        }
        let arc = 2.0 * self.wheelbase_m / (preview_m * preview_m);
        let wanted = driver.gain * arc * (error_m + self.integral_m);
        self.steer_rad += (wanted - self.steer_rad) * (step_s / (driver.lag_s + step_s));
        Controls {
            steer_rad: self.steer_rad,
            ..self.hold_speed(motion, speed_m_s, step_s)
        }
    }

    /// Drive and brake that hold `speed_m_s`, straight ahead.
    pub fn hold_speed(&mut self, motion: &HandlingMotion, speed_m_s: f64, step_s: f64) -> Controls {
        let drive = &self.handling.drive;
        let error = speed_m_s - motion.speed_m_s;
        let force = drive.speed_gain_n_s_m * error + self.force_integral_n;
        let most = drive.most_n(motion.speed_m_s);
        // The integral waits while the force is at its limit.
        if force > -drive.max_brake_force_n && force < most {
            self.force_integral_n += drive.speed_integral_n_m * step_s * error;
        }
        Controls {
            steer_rad: 0.0,
            drive_force_n: force.clamp(0.0, most),
            brake_force_n: (-force).clamp(0.0, drive.max_brake_force_n),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steers_the_arc_through_the_previewed_point() {
        let mut handling = HandlingParameters::defender110();
        handling.driver.lag_s = 0.0;
        handling.driver.integral_per_s = 0.0;
        let (wheelbase, speed) = (2.794, 15.0);
        let mut driver = Driver::new(&handling, wheelbase);
        // On a circle, tangent to it: the arc through the previewed point is close to the circle itself.
        let motion = HandlingMotion {
            speed_m_s: speed,
            ..HandlingMotion::default()
        };
        let radius = 200.0;
        let steer = driver.follow(&motion, &Track::circle(radius), speed, 0.001).steer_rad;
        assert!((steer / (wheelbase / radius) - 1.0).abs() < 0.01, "{steer}");
        let mirrored = Driver::new(&handling, wheelbase).follow(&motion, &Track::circle(-radius), speed, 0.001);
        assert_eq!(mirrored.steer_rad, -steer);
    }

    #[test]
    fn yaw_alone_is_an_error() {
        let mut driver = Driver::new(&HandlingParameters::defender110(), 2.794);
        let motion = HandlingMotion {
            speed_m_s: 15.0,
            yaw_rad: 0.1,
            ..HandlingMotion::default()
        };
        assert!(driver.follow(&motion, &Track::straight(), 15.0, 0.001).steer_rad < 0.0);
    }
}
