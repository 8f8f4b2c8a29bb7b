//! The report's driver, `eased`: preview and pure pursuit.
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

use super::track::Track;
use crate::handling::{DriverParameters, HandlingMotion};

/// Walking pace: the preview does not get shorter than at this speed, m/s.
const SLOWEST_M_S: f64 = 2.0;
/// The integral only acts on errors a driver would trim away, m.
const INTEGRAL_BAND_M: f64 = 2.0;

/// A driver who steers the arc to where the line will be: parameters and what it remembers.
#[derive(Debug, Clone)]
pub struct PreviewDriver {
    driver: DriverParameters,
    wheelbase_m: f64,
    integral_m: f64,
    steer_rad: f64,
}

impl PreviewDriver {
    /// A driver for a vehicle.
    pub fn new(driver: &DriverParameters, wheelbase_m: f64) -> Self {
        Self {
            driver: *driver,
            wheelbase_m,
            integral_m: 0.0,
            steer_rad: 0.0,
        }
    }

    /// Steer angle for the coming step of `step_s`, rad, left positive.
    pub fn steer(&mut self, motion: &HandlingMotion, track: &Track, step_s: f64) -> f64 {
        let driver = &self.driver;
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
        self.steer_rad
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::handling::HandlingParameters;

    #[test]
    fn steers_the_arc_through_the_previewed_point() {
        let mut parameters = HandlingParameters::defender110().driver;
        parameters.lag_s = 0.0;
        parameters.integral_per_s = 0.0;
        let (wheelbase, speed) = (2.794, 15.0);
        let mut driver = PreviewDriver::new(&parameters, wheelbase);
        // On a circle, tangent to it: the arc through the previewed point is close to the circle itself.
        let motion = HandlingMotion {
            speed_m_s: speed,
            ..HandlingMotion::default()
        };
        let radius = 200.0;
        let steer = driver.steer(&motion, &Track::circle(radius), 0.001);
        assert!((steer / (wheelbase / radius) - 1.0).abs() < 0.01, "{steer}");
        let mirrored = PreviewDriver::new(&parameters, wheelbase).steer(&motion, &Track::circle(-radius), 0.001);
        assert_eq!(mirrored, -steer);
    }

    #[test]
    fn yaw_alone_is_an_error() {
        let mut driver = PreviewDriver::new(&HandlingParameters::defender110().driver, 2.794);
        let motion = HandlingMotion {
            speed_m_s: 15.0,
            yaw_rad: 0.1,
            ..HandlingMotion::default()
        };
        assert!(driver.steer(&motion, &Track::straight(), 0.001) < 0.0);
    }
}
