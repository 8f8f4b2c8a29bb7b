//! What a vehicle is made of beyond [`VehicleParameters`](crate::vehicle::VehicleParameters), as far as its handling
//! needs it: steering, roll centres, frame, drive, driver, tyres.
//!
//! A file of its own so that the ride model's file stays what Appendix A needs. The same rules: every value of the
//! preset carries the label of its origin; an unknown, missing or impossible value is one line with file, line and key.

use oleo_interface::Axle;
use serde::{Deserialize, Serialize};

use super::magic_formula::MagicFormula;
use crate::model_file::{Checked, InvalidValue, Limit, ModelFileError, Range, checked, read};
use crate::vehicle::VehicleParameters;

/// Handling parameters of a vehicle. All values SI.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HandlingParameters {
    /// Steering: limits, elasticity, castor.
    pub steering: Steering,
    /// Front live axle: located sideways by the Panhard rod.
    pub front_axle: HandlingAxle,
    /// Rear live axle: located sideways by the A-frame.
    pub rear_axle: HandlingAxle,
    /// Torsion of the body between the axles.
    pub frame: Frame,
    /// Drive, brakes and speed control.
    pub drive: Drive,
    /// Parameters of the preview driver.
    pub driver: DriverParameters,
    /// The plane that a tyre sees of an uneven road.
    pub ground: Ground,
    /// Outline for the cones of ISO 3888.
    pub outline: Outline,
    /// Tyre coefficients, the same for all wheels.
    pub tyre: MagicFormula,
}

/// Steering, at the road wheels: angles and torques of the steering wheel are referred to them by the steering ratio.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Steering {
    /// Largest steer angle, rad.
    pub max_angle_rad: f64,
    /// Largest rate of steer, rad/s.
    pub max_rate_rad_s: f64,
    /// Torque about the swivel pins of both wheels per angle that the linkage gives way, N m/rad.
    pub linkage_stiffness_n_m_rad: f64,
    /// Time in which the linkage gives way, s.
    pub linkage_time_constant_s: f64,
    /// Distance of the contact point behind the swivel axis, m.
    pub castor_trail_m: f64,
}

impl Checked for Steering {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("max_angle_rad", Range::FromTo(0.01, 1.4), "rad", |p| p.max_angle_rad),
        Limit::one("max_rate_rad_s", Range::FromTo(0.01, 100.0), "rad/s", |p| {
            p.max_rate_rad_s
        }),
        Limit::one("linkage_stiffness_n_m_rad", Range::FromTo(1e3, 1e9), "N m/rad", |p| {
            p.linkage_stiffness_n_m_rad
        }),
        Limit::one("linkage_time_constant_s", Range::FromTo(0.0, 1.0), "s", |p| {
            p.linkage_time_constant_s
        }),
        Limit::one("castor_trail_m", Range::FromTo(-0.5, 0.5), "m", |p| p.castor_trail_m),
    ];
}

/// Parameters of a live axle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HandlingAxle {
    /// Height above ground at static load of the point of the axle that the body holds sideways, m.
    pub roll_centre_height_m: f64,
    /// Inertia of the axle without its wheels about its own axis, kg m2.
    pub housing_pitch_inertia_kg_m2: f64,
    /// Inertia of one wheel with all that turns with it, kg m2.
    pub wheel_spin_inertia_kg_m2: f64,
    /// Distance from the axle to the side-view instant centre of its links, m: behind the front axle, ahead of the rear one.
    pub side_view_swing_arm_m: f64,
    /// Height above ground of the side-view instant centre at static load, m.
    pub side_view_instant_centre_height_m: f64,
    /// Yaw of the axle per roll of the body against it, rad/rad; positive understeers, negative oversteers.
    pub roll_understeer: f64,
}

/// Inertia of an axle's part, kg m2.
const INERTIA_KG_M2: Range = Range::FromTo(0.01, 1e4);

impl Checked for HandlingAxle {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("roll_centre_height_m", Range::FromTo(-1.0, 3.0), "m", |p| {
            p.roll_centre_height_m
        }),
        Limit::one("housing_pitch_inertia_kg_m2", INERTIA_KG_M2, "kg m2", |p| {
            p.housing_pitch_inertia_kg_m2
        }),
        Limit::one("wheel_spin_inertia_kg_m2", INERTIA_KG_M2, "kg m2", |p| {
            p.wheel_spin_inertia_kg_m2
        }),
        Limit::one("side_view_swing_arm_m", Range::FromTo(0.2, 1e6), "m", |p| {
            p.side_view_swing_arm_m
        }),
        Limit::one(
            "side_view_instant_centre_height_m",
            Range::FromTo(-2.0, 1e6),
            "m",
            |p| p.side_view_instant_centre_height_m,
        ),
        Limit::one("roll_understeer", Range::FromTo(-0.5, 0.5), "", |p| p.roll_understeer),
    ];
}

/// Torsion of the body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Frame {
    /// Torque per angle between the front and the rear half, N m/rad.
    pub torsional_stiffness_n_m_rad: f64,
    /// Damping of the torsional mode over critical.
    pub torsional_damping_ratio: f64,
}

impl Checked for Frame {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("torsional_stiffness_n_m_rad", Range::FromTo(1e3, 1e8), "N m/rad", |p| {
            p.torsional_stiffness_n_m_rad
        }),
        Limit::one("torsional_damping_ratio", Range::FromTo(0.0, 2.0), "", |p| {
            p.torsional_damping_ratio
        }),
    ];
}

/// Drive, brakes and speed control; forces are those of all four wheels together.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drive {
    /// Share of the drive torque at the front axle, 0..1.
    pub front_share: f64,
    /// Share of the brake force at the front axle, 0..1.
    pub brake_front_share: f64,
    /// Force per speed error, N s/m.
    pub speed_gain_n_s_m: f64,
    /// Force per integral of the speed error, N/m.
    pub speed_integral_n_m: f64,
    /// Limit of the drive force, N.
    pub max_drive_force_n: f64,
    /// Limit of the drive power at the wheels, W.
    pub max_drive_power_w: f64,
    /// Limit of the brake force, N.
    pub max_brake_force_n: f64,
}

impl Checked for Drive {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("front_share", Range::FromTo(0.0, 1.0), "", |p| p.front_share),
        Limit::one("speed_gain_n_s_m", Range::FromTo(0.0, 1e6), "N s/m", |p| {
            p.speed_gain_n_s_m
        }),
        Limit::one("speed_integral_n_m", Range::FromTo(0.0, 1e6), "N/m", |p| {
            p.speed_integral_n_m
        }),
        Limit::one("brake_front_share", Range::FromTo(0.0, 1.0), "", |p| {
            p.brake_front_share
        }),
        Limit::one("max_drive_force_n", Range::FromTo(0.0, 1e6), "N", |p| {
            p.max_drive_force_n
        }),
        Limit::one("max_drive_power_w", Range::FromTo(0.0, 1e7), "W", |p| {
            p.max_drive_power_w
        }),
        Limit::one("max_brake_force_n", Range::FromTo(0.0, 1e6), "N", |p| {
            p.max_brake_force_n
        }),
    ];
}

/// The report's preview driver, and the one who steers by optimal preview control.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriverParameters {
    /// How far ahead the driver looks, s.
    pub preview_time_s: f64,
    /// Steer over that of the arc through the previewed point.
    pub gain: f64,
    /// Gain of the integral action, 1/s.
    pub integral_per_s: f64,
    /// First-order lag of arms and steering box, s.
    pub lag_s: f64,
    /// How far the driver looks ahead who steers by optimal preview control, s.
    pub optimal_preview_time_s: f64,
}

impl Checked for DriverParameters {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("preview_time_s", Range::FromTo(0.05, 10.0), "s", |p| p.preview_time_s),
        Limit::one("gain", Range::FromTo(0.0, 100.0), "", |p| p.gain),
        Limit::one("integral_per_s", Range::FromTo(0.0, 100.0), "1/s", |p| p.integral_per_s),
        Limit::one("lag_s", Range::FromTo(0.0, 5.0), "s", |p| p.lag_s),
        Limit::one("optimal_preview_time_s", Range::FromTo(0.05, 10.0), "s", |p| {
            p.optimal_preview_time_s
        }),
    ];
}

/// Base of the plane through an uneven road below a tyre.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ground {
    /// Length along the road over which the slope is taken, m.
    pub plane_length_m: f64,
    /// Width across the road over which the slope is taken, m.
    pub plane_width_m: f64,
}

impl Checked for Ground {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("plane_length_m", Range::FromTo(0.01, 2.0), "m", |p| p.plane_length_m),
        Limit::one("plane_width_m", Range::FromTo(0.01, 2.0), "m", |p| p.plane_width_m),
    ];
}

/// Outline of the body beyond the axles.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Outline {
    /// Ahead of the front axle, m.
    pub front_overhang_m: f64,
    /// Behind the rear axle, m.
    pub rear_overhang_m: f64,
}

impl Outline {
    /// Corners of a vehicle's body seen from above, ahead and left of its centre of mass, m: front left and right, rear left and
    /// right.
    #[must_use]
    pub fn corners_m(&self, vehicle: &VehicleParameters) -> [[f64; 2]; 4] {
        let nose_m = vehicle.body_cg_behind_front_axle_m() + self.front_overhang_m;
        let length_m = vehicle.layout.wheelbase_m + self.front_overhang_m + self.rear_overhang_m;
        let (tail_m, half_m) = (nose_m - length_m, 0.5 * vehicle.layout.width_m);
        [[nose_m, half_m], [nose_m, -half_m], [tail_m, half_m], [tail_m, -half_m]]
    }
}

impl Checked for Outline {
    const LIMITS: &'static [Limit<Self>] = &[
        Limit::one("front_overhang_m", Range::FromTo(0.0, 10.0), "m", |p| {
            p.front_overhang_m
        }),
        Limit::one("rear_overhang_m", Range::FromTo(0.0, 10.0), "m", |p| p.rear_overhang_m),
    ];
}

impl Drive {
    /// Largest drive force at a speed, N: the limit of the force, and of the power.
    pub fn most_n(&self, speed_m_s: f64) -> f64 {
        // Below walking pace the force is limited, not the power.
        self.max_drive_force_n.min(self.max_drive_power_w / speed_m_s.max(1.0))
    }
}

impl HandlingParameters {
    /// The file of the shipped Defender 110.
    pub const DEFENDER110_TOML: &'static str = include_str!("../../presets/defender110-handling.toml");

    /// The shipped Defender 110.
    pub fn defender110() -> Self {
        Self::from_toml(Self::DEFENDER110_TOML, "presets/defender110-handling.toml")
            .expect("the shipped preset is parsed in the tests")
    }

    /// Parameters of an axle.
    pub fn axle(&self, axle: Axle) -> &HandlingAxle {
        match axle {
            Axle::Front => &self.front_axle,
            Axle::Rear => &self.rear_axle,
        }
    }

    /// Read and check a file. `file` is the name that appears in errors.
    ///
    /// # Errors
    /// Unknown, missing or mistyped keys and values outside their physical range, each with its line.
    pub fn from_toml(text: &str, file: &str) -> Result<Self, ModelFileError> {
        read(text, file)
    }

    /// The parameters as a file that `from_toml` reads back to the same bits.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).unwrap_or_default()
    }
}

impl Checked for HandlingParameters {
    const LIMITS: &'static [Limit<Self>] = &[];

    fn check_together(&self) -> Result<(), InvalidValue> {
        checked(&self.steering, "steering")?;
        checked(&self.front_axle, "front_axle")?;
        checked(&self.rear_axle, "rear_axle")?;
        checked(&self.frame, "frame")?;
        checked(&self.drive, "drive")?;
        checked(&self.driver, "driver")?;
        checked(&self.ground, "ground")?;
        checked(&self.outline, "outline")?;
        checked(&self.tyre, "tyre")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PRESET: &str = HandlingParameters::DEFENDER110_TOML;
    use crate::model_file::limits::forgotten_keys;

    #[test]
    fn preset_is_read_labelled_and_survives_the_round_trip() {
        let preset = HandlingParameters::defender110();
        assert_eq!(
            HandlingParameters::from_toml(&preset.to_toml(), "again").unwrap(),
            preset
        );
        for line in PRESET
            .lines()
            .filter(|line| line.contains(" = ") && !line.starts_with('#'))
        {
            let label = line.split('#').nth(1).unwrap_or("").trim();
            let known = ["report", "source", "recalled", "assumed", "computed"];
            assert!(known.iter().any(|known| label.starts_with(known)), "no origin: {line}");
        }
    }

    #[test]
    fn every_number_has_a_limit() {
        let p = HandlingParameters::defender110();
        let forgotten = [
            forgotten_keys(&p.steering),
            forgotten_keys(&p.front_axle),
            forgotten_keys(&p.frame),
            forgotten_keys(&p.drive),
            forgotten_keys(&p.driver),
            forgotten_keys(&p.ground),
            forgotten_keys(&p.outline),
            forgotten_keys(&p.tyre),
        ];
        assert!(forgotten.concat().is_empty(), "{forgotten:?}");
    }

    #[test]
    fn a_bad_file_gives_file_line_and_key() {
        let error = |text: &str| HandlingParameters::from_toml(text, "car.toml").unwrap_err().to_string();
        let line = |key: &str| 1 + PRESET.lines().position(|l| l.starts_with(key)).unwrap();
        let impossible = error(&PRESET.replace("preview_time_s = 0.80", "preview_time_s = -1"));
        let at = format!("car.toml:{}: [driver] preview_time_s", line("preview_time_s"));
        assert!(impossible.starts_with(&at), "{impossible}");
        assert!(error(&PRESET.replace("pcx1 = 1.839", "pcx1 = nan")).contains("pcx1"));
        assert!(error(&PRESET.replace("pvy3 = -0.092912", "pvy3 = inf")).contains("pvy3"));
        assert!(error(&PRESET.replace("lag_s", "leg_s")).contains("leg_s"));
        let missing = error(&PRESET.replace("qsy1 = 0.01", "#"));
        assert!(missing.contains("qsy1") && !missing.contains('\n'), "{missing}");
    }
}
