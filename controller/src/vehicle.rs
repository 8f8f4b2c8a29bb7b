//! The description of the vehicle that the controller needs.
//!
//! Masses are absent on purpose: the static load is measured by the struts themselves, laden or not.

use oleo_interface::Axles;

use crate::range::{ConfigurationError, within};

/// Dimensions of struts and vehicle, in SI units. `Default` is the Land Rover Defender 110 of the seed report. See
/// [`Builder`](crate::Builder) for an example.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VehicleDescription {
    /// Piston area of every strut, m2, 1e-4 to 1e-1.
    pub piston_area_m2: f32,
    /// Gas volume of accumulator 1 at static position, m3, 1e-6 to 1e-1.
    pub gas_volume_1_m3: f32,
    /// Gas volume of accumulator 2, behind valve 3, at static position, m3, 1e-6 to 1e-1.
    pub gas_volume_2_m3: f32,
    /// Distance between the left and the right strut of each axle, m, 0.2 to 4.
    pub strut_spacing_m: Axles<f32>,
    /// Distance of each axle from the sprung mass's centre of gravity, m, 0.2 to 10.
    pub axle_distance_m: Axles<f32>,
    /// Height of the sprung mass's centre of gravity above the roll axis, m, 0.05 to 3.
    pub roll_arm_m: f32,
    /// Anti-roll bar of each axle, N m per radian of body roll relative to the axle, 0 to 1e6.
    pub anti_roll_stiffness_n_m_rad: Axles<f32>,
    /// Radius of gyration of the sprung mass in roll, m, 0.1 to 5.
    pub roll_gyration_m: f32,
    /// Radius of gyration of the sprung mass in pitch, m, 0.1 to 10.
    pub pitch_gyration_m: f32,
}

impl Default for VehicleDescription {
    fn default() -> Self {
        Self {
            piston_area_m2: 1.963_495_4e-3,            // computed from the report: bore 50 mm
            gas_volume_1_m3: 1.0e-4,                   // report
            gas_volume_2_m3: 4.0e-4,                   // report
            strut_spacing_m: Axles::splat(1.0),        // assumed, as the vehicle preset
            axle_distance_m: Axles::new(1.389, 1.405), // from the preset: wheelbase 2.794 m, axle loads less axle masses
            roll_arm_m: 0.294, // preset: body's centre of gravity at 0.853 m, roll axis at 0.56 m below it
            anti_roll_stiffness_n_m_rad: Axles::new(0.0, 8.0e3), // preset: one bar, at the rear
            roll_gyration_m: 0.661, // preset: sqrt(700 / 1600)
            pitch_gyration_m: 1.25, // preset: sqrt(2500 / 1600)
        }
    }
}

impl VehicleDescription {
    /// Whether every value is within its range.
    pub(crate) fn check(&self) -> Result<(), ConfigurationError> {
        let both = |name, pair: Axles<f32>, least, most| {
            within(name, pair.front, least, most)?;
            within(name, pair.rear, least, most)
        };
        within("vehicle.piston_area_m2", self.piston_area_m2, 1e-4, 1e-1)?;
        within("vehicle.gas_volume_1_m3", self.gas_volume_1_m3, 1e-6, 1e-1)?;
        within("vehicle.gas_volume_2_m3", self.gas_volume_2_m3, 1e-6, 1e-1)?;
        both("vehicle.strut_spacing_m", self.strut_spacing_m, 0.2, 4.0)?;
        both("vehicle.axle_distance_m", self.axle_distance_m, 0.2, 10.0)?;
        within("vehicle.roll_arm_m", self.roll_arm_m, 0.05, 3.0)?;
        both(
            "vehicle.anti_roll_stiffness_n_m_rad",
            self.anti_roll_stiffness_n_m_rad,
            0.0,
            1e6,
        )?;
        within("vehicle.roll_gyration_m", self.roll_gyration_m, 0.1, 5.0)?;
        within("vehicle.pitch_gyration_m", self.pitch_gyration_m, 0.1, 10.0)
    }
}
