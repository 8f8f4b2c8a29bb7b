//! What a vehicle is made of beyond [`VehicleParameters`](crate::vehicle::VehicleParameters), as far as its handling
//! needs it: steering, roll centres, frame, drive, driver, tyres.
//!
//! A file of its own so that the ride model's file stays what Appendix A needs. The same rules: every value of the
//! preset carries the label of its origin; an unknown, missing or impossible value is one line with file, line and key.

use oleo_interface::Axle;
use serde::{Deserialize, Serialize};

use super::magic_formula::MagicFormula;
use crate::vehicle::ParameterError;
use crate::vehicle::parameter_file::{Limits, describe, line_at, line_of, within};

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
    /// Preview driver.
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

/// A live axle.
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

/// Torsion of the body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Frame {
    /// Torque per angle between the front and the rear half, N m/rad.
    pub torsional_stiffness_n_m_rad: f64,
    /// Damping of the torsional mode over critical.
    pub torsional_damping_ratio: f64,
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

/// The report's preview driver, and the one who steers by optimal preview control.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriverParameters {
    /// How far ahead the driver looks, s.
    pub preview_time_s: f64,
    /// Steer over that of the arc through the previewed point.
    pub gain: f64,
    /// Integral action, 1/s.
    pub integral_per_s: f64,
    /// First-order lag of arms and steering box, s.
    pub lag_s: f64,
    /// How far the driver looks ahead who steers by optimal preview control, s.
    pub optimal_preview_time_s: f64,
}

/// Base of the plane through an uneven road below a tyre.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ground {
    /// Along, m.
    pub plane_length_m: f64,
    /// Across, m.
    pub plane_width_m: f64,
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

impl Drive {
    /// Largest drive force at a speed, N: the limit of the force, and of the power.
    pub fn most_n(&self, speed_m_s: f64) -> f64 {
        // Below walking pace the force is limited, not the power.
        self.max_drive_force_n.min(self.max_drive_power_w / speed_m_s.max(1.0))
    }
}

const PRESET: &str = include_str!("../../presets/defender110-handling.toml");
const COEFFICIENT: Limits = (-1000.0, 1000.0);

impl HandlingParameters {
    /// The shipped Defender 110.
    pub fn defender110() -> Self {
        Self::from_toml(PRESET, "presets/defender110-handling.toml").expect("the shipped preset is parsed in the tests")
    }

    /// Parameters of an axle.
    pub fn axle(&self, axle: Axle) -> &HandlingAxle {
        match axle {
            Axle::Front => &self.front_axle,
            Axle::Rear => &self.rear_axle,
        }
    }

    /// Parses and checks a file. `source_name` appears in errors.
    ///
    /// # Errors
    /// Unknown, missing or mistyped keys and values outside their physical range, each with its line.
    pub fn from_toml(text: &str, source_name: &str) -> Result<Self, ParameterError> {
        let parameters: Self = toml::from_str(text).map_err(|error| ParameterError {
            source_name: source_name.to_owned(),
            line: error.span().map_or(1, |span| line_at(text, span.start)),
            problem: describe(text, &error),
        })?;
        parameters.check().map_err(|(table, key, why)| ParameterError {
            source_name: source_name.to_owned(),
            line: line_of(text, table, key),
            problem: format!("[{table}] {key}: {why}"),
        })?;
        Ok(parameters)
    }

    /// The parameters as a file that `from_toml` reads back to the same bits.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).unwrap_or_default()
    }

    /// First impossible value as (table, key, reason).
    fn check(&self) -> Result<(), (&'static str, &'static str, String)> {
        within("steering", "max_angle_rad", self.steering.max_angle_rad, (0.01, 1.4))?;
        within(
            "steering",
            "max_rate_rad_s",
            self.steering.max_rate_rad_s,
            (0.01, 100.0),
        )?;
        within(
            "steering",
            "linkage_stiffness_n_m_rad",
            self.steering.linkage_stiffness_n_m_rad,
            (1e3, 1e9),
        )?;
        within(
            "steering",
            "linkage_time_constant_s",
            self.steering.linkage_time_constant_s,
            (0.0, 1.0),
        )?;
        within("steering", "castor_trail_m", self.steering.castor_trail_m, (-0.5, 0.5))?;
        for (table, axle) in [("front_axle", &self.front_axle), ("rear_axle", &self.rear_axle)] {
            within(table, "roll_centre_height_m", axle.roll_centre_height_m, (-1.0, 3.0))?;
            let inertia: Limits = (0.01, 1e4);
            within(
                table,
                "housing_pitch_inertia_kg_m2",
                axle.housing_pitch_inertia_kg_m2,
                inertia,
            )?;
            within(
                table,
                "wheel_spin_inertia_kg_m2",
                axle.wheel_spin_inertia_kg_m2,
                inertia,
            )?;
        }
        for (table, axle) in [("front_axle", &self.front_axle), ("rear_axle", &self.rear_axle)] {
            within(table, "side_view_swing_arm_m", axle.side_view_swing_arm_m, (0.2, 1e6))?;
            within(
                table,
                "side_view_instant_centre_height_m",
                axle.side_view_instant_centre_height_m,
                (-2.0, 1e6),
            )?;
            within(table, "roll_understeer", axle.roll_understeer, (-0.5, 0.5))?;
        }
        let frame = &self.frame;
        within(
            "frame",
            "torsional_stiffness_n_m_rad",
            frame.torsional_stiffness_n_m_rad,
            (1e3, 1e8),
        )?;
        within(
            "frame",
            "torsional_damping_ratio",
            frame.torsional_damping_ratio,
            (0.0, 2.0),
        )?;
        let drive = &self.drive;
        within("drive", "front_share", drive.front_share, (0.0, 1.0))?;
        within("drive", "speed_gain_n_s_m", drive.speed_gain_n_s_m, (0.0, 1e6))?;
        within("drive", "speed_integral_n_m", drive.speed_integral_n_m, (0.0, 1e6))?;
        within("drive", "brake_front_share", drive.brake_front_share, (0.0, 1.0))?;
        within("drive", "max_drive_force_n", drive.max_drive_force_n, (0.0, 1e6))?;
        within("drive", "max_drive_power_w", drive.max_drive_power_w, (0.0, 1e7))?;
        within("drive", "max_brake_force_n", drive.max_brake_force_n, (0.0, 1e6))?;
        let driver = &self.driver;
        within("driver", "preview_time_s", driver.preview_time_s, (0.05, 10.0))?;
        within("driver", "gain", driver.gain, (0.0, 100.0))?;
        within("driver", "integral_per_s", driver.integral_per_s, (0.0, 100.0))?;
        within("driver", "lag_s", driver.lag_s, (0.0, 5.0))?;
        within(
            "driver",
            "optimal_preview_time_s",
            driver.optimal_preview_time_s,
            (0.05, 10.0),
        )?;
        within("ground", "plane_length_m", self.ground.plane_length_m, (0.01, 2.0))?;
        within("ground", "plane_width_m", self.ground.plane_width_m, (0.01, 2.0))?;
        within(
            "outline",
            "front_overhang_m",
            self.outline.front_overhang_m,
            (0.0, 10.0),
        )?;
        within("outline", "rear_overhang_m", self.outline.rear_overhang_m, (0.0, 10.0))?;
        within("tyre", "nominal_load_n", self.tyre.nominal_load_n, (100.0, 1e5))?;
        within("tyre", "friction_scale", self.tyre.friction_scale, (0.0, 3.0))?;
        let positive: Limits = (1e-3, 1000.0);
        for (key, value) in [
            ("pcx1", self.tyre.pcx1),
            ("pdx1", self.tyre.pdx1),
            ("pkx1", self.tyre.pkx1),
            ("pcy1", self.tyre.pcy1),
            ("pdy1", self.tyre.pdy1),
            ("pky1", -self.tyre.pky1),
            ("pky2", self.tyre.pky2),
            ("ptx1", self.tyre.ptx1),
            ("pty1", self.tyre.pty1),
            ("pty2", self.tyre.pty2),
        ] {
            within("tyre", key, value, positive)?;
        }
        for (key, value) in self.tyre.named() {
            within("tyre", key, value, COEFFICIENT)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
