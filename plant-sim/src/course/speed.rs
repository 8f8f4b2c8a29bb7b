//! Speed control of the driver: drive and brake forces that hold a speed or a deceleration.
//!
//! The report's model has "forward speed" as a constraint (table 1). Here it is held by a proportional-integral force: drive
//! within engine power and traction, or brake.

use crate::handling::{Controls, Drive};

/// Speed controller: a PI force that keeps the vehicle at a speed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SpeedControl {
    integral_n: f64,
}

impl SpeedControl {
    /// Drive and brake for the coming step of `step_s` at `speed_m_s` towards `wanted_m_s`; straight ahead.
    pub fn hold(&mut self, drive: &Drive, speed_m_s: f64, wanted_m_s: f64, step_s: f64) -> Controls {
        let error = wanted_m_s - speed_m_s;
        let force = drive.speed_gain_n_s_m * error + self.integral_n;
        let most = drive.most_n(speed_m_s);
        // The integral waits while the force is at its limit.
        if force > -drive.max_brake_force_n && force < most {
            self.integral_n += drive.speed_integral_n_m * step_s * error;
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
    use crate::handling::HandlingParameters;

    /// A point mass with drag reaches the speed and stays there, whether it begins slower or faster.
    #[test]
    fn a_mass_reaches_the_speed() {
        let drive = HandlingParameters::defender110().drive;
        for start in [10.0, 20.0] {
            let (mut control, mut speed) = (SpeedControl::default(), start);
            for _ in 0..20_000 {
                let now = control.hold(&drive, speed, 15.0, 0.001);
                assert!(now.drive_force_n >= 0.0 && now.brake_force_n >= 0.0);
                assert!(now.drive_force_n * speed <= drive.max_drive_power_w * (1.0 + 1e-12));
                speed += 0.001 * (now.drive_force_n - now.brake_force_n - 300.0) / 2050.0;
            }
            assert!((speed - 15.0).abs() < 0.02, "{speed}");
        }
    }
}
