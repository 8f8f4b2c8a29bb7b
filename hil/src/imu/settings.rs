//! Where the unit is, how it is mounted, and how noisy it is: the table `[imu]` of a scenario.

use oleo_plant_sim::model_file::{Checked, Limit, Range};
use serde::{Deserialize, Serialize};

/// An inertial unit. Without a key it is in the centre of mass, straight, and as noisy as a good one for cars.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ImuSettings {
    /// Place ahead of the centre of mass of the sprung mass in running order (as sold, with nothing loaded), m.
    pub x_m: f64,
    /// To the left of it, m.
    pub y_m: f64,
    /// Above it, m.
    pub z_m: f64,
    /// Angles by which it is turned against the body: first yaw, then pitch, then roll, each about its own axis, degrees.
    pub roll_deg: f64,
    /// Nose down positive, degrees.
    pub pitch_deg: f64,
    /// To the left positive, degrees.
    pub yaw_deg: f64,
    /// Standard deviation of the white noise of each specific force, m/s2.
    pub specific_force_noise_m_s2: f64,
    /// Standard deviation of the white noise of each rate, rad/s.
    pub rate_noise_rad_s: f64,
}

/// Noise as of the BMI088 of Bosch, a unit for cars and drones (*recalled* from its data sheet: 0.175 mg and 0.014 degrees/s in the root of 1 Hz)
/// over a band of 100 Hz.
const SPECIFIC_FORCE_NOISE_M_S2: f64 = 0.017;
const RATE_NOISE_RAD_S: f64 = 0.0024;

impl Default for ImuSettings {
    fn default() -> Self {
        Self {
            x_m: 0.0,
            y_m: 0.0,
            z_m: 0.0,
            roll_deg: 0.0,
            pitch_deg: 0.0,
            yaw_deg: 0.0,
            specific_force_noise_m_s2: SPECIFIC_FORCE_NOISE_M_S2,
            rate_noise_rad_s: RATE_NOISE_RAD_S,
        }
    }
}

impl ImuSettings {
    /// The same unit at another place.
    pub fn at([x_m, y_m, z_m]: [f64; 3], of: Self) -> Self {
        Self { x_m, y_m, z_m, ..of }
    }

    /// Its place from the centre of mass in running order, m.
    pub fn place_m(&self) -> [f64; 3] {
        [self.x_m, self.y_m, self.z_m]
    }
}

impl Checked for ImuSettings {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("x_m", Range::FromTo(-5.0, 5.0), "m", |imu| imu.x_m),
        Limit::one("y_m", Range::FromTo(-2.0, 2.0), "m", |imu| imu.y_m),
        Limit::one("z_m", Range::FromTo(-2.0, 3.0), "m", |imu| imu.z_m),
        Limit::one("roll_deg", Range::FromTo(-45.0, 45.0), "degrees", |imu| imu.roll_deg),
        Limit::one("pitch_deg", Range::FromTo(-45.0, 45.0), "degrees", |imu| imu.pitch_deg),
        Limit::one("yaw_deg", Range::FromTo(-180.0, 180.0), "degrees", |imu| imu.yaw_deg),
        Limit::one("specific_force_noise_m_s2", Range::FromTo(0.0, 10.0), "m/s2", |imu| {
            imu.specific_force_noise_m_s2
        }),
        Limit::one("rate_noise_rad_s", Range::FromTo(0.0, 1.0), "rad/s", |imu| {
            imu.rate_noise_rad_s
        }),
    ];
}
