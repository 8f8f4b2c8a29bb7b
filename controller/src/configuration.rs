//! What the controller believes about its vehicle, and the thresholds it decides by.
//!
//! [`Builder`] takes physical units and checks each value against the range in which the controller was designed; what comes out is
//! immutable and holds filter coefficients instead of frequencies, so that a tick has nothing left to compute from them.
//! Masses are absent on purpose: the static load is measured by the struts themselves, laden or not.

use crate::filter::{Derivative, LeakyIntegrator, LowPass};
use crate::strategy::{DamperPolicy, Strategy};
use crate::timing::SPEED_CORNER_HZ;
use core::fmt;
use oleo_interface::Axles;

/// Physical description, in SI units. `Default` is the Land Rover Defender 110 of the report.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Builder {
    /// How valves are decided.
    pub strategy: Strategy,
    /// How dampers are switched in ride mode.
    pub damper_policy: DamperPolicy,
    /// Piston area, m2.
    pub piston_area_m2: f32,
    /// Gas volume of accumulator 1 and 2 at static position, m3.
    pub gas_volume_m3: [f32; 2],
    /// Distance left to right between the struts of the front and rear axle, m.
    pub strut_spacing_m: Axles<f32>,
    /// Distance of front and rear axle from the sprung mass's centre of gravity, m.
    pub axle_distance_m: Axles<f32>,
    /// Height of the sprung mass's centre of gravity over the roll axis, m.
    pub roll_arm_m: f32,
    /// Anti-roll bar of front and rear axle, N m per radian of body roll relative to the axle.
    pub anti_roll_stiffness_n_m_rad: Axles<f32>,
    /// Radius of gyration of the sprung mass in roll, m.
    pub roll_gyration_m: f32,
    /// Radius of gyration of the sprung mass in pitch, m.
    pub pitch_gyration_m: f32,
    /// Corner of the lateral surrogate's two lags, Hz: below the body's roll resonance.
    pub lateral_corner_hz: f32,
    /// Time constant of the running mean squares, s.
    pub running_rms_s: f32,
    /// Lateral over vertical running RMS that begins handling mode, and that ends it.
    pub handling_ratio: [f32; 2],
    /// Lateral running RMS below which handling mode does not begin, and at which it ends, m/s2.
    pub handling_floor_m_s2: [f32; 2],
    /// Predicted roll angle relative to the axles that raises the roll-over guard, and the one that releases it, rad.
    pub guard_roll_rad: [f32; 2],
    /// Lateral surrogate that must come with it, m/s2.
    pub guard_lateral_m_s2: f32,
    /// Body velocity over the running RMS of vertical acceleration that Karnopp's rule needs to act, s.
    pub body_velocity_share_s: f32,
    /// Body acceleration below 4 Hz over the running RMS that Hoelscher and Huang's rule needs to act.
    pub body_acceleration_share: f32,
    /// Largest shift of the ride height that closing valve 3 may trap, m.
    pub trapped_shift_m: f32,
    /// Largest force step on opening valve 3, as a share of the static load.
    pub opening_step_share: f32,
}

impl Default for Builder {
    fn default() -> Self {
        Self {
            strategy: Strategy::RideHandling,
            damper_policy: DamperPolicy::Karnopp,
            piston_area_m2: 1.963_495_4e-3,     // computed from the report: bore 50 mm
            gas_volume_m3: [1.0e-4, 4.0e-4],    // report
            strut_spacing_m: Axles::splat(1.0), // assumed, as the vehicle preset
            axle_distance_m: Axles::new(1.389, 1.405), // computed from the preset: wheelbase 2.794 m, axle loads less axle masses
            roll_arm_m: 0.45,                          // assumed: body's centre of gravity 0.85 m, roll axis 0.40 m
            anti_roll_stiffness_n_m_rad: Axles::splat(8.0e3), // assumed, as the vehicle preset
            roll_gyration_m: 0.661,                    // preset: sqrt(700 / 1600)
            pitch_gyration_m: 1.25,                    // preset: sqrt(2500 / 1600)
            lateral_corner_hz: 1.0,                    // vehicle.md: 0.5 to 1 Hz
            running_rms_s: 1.0,                        // recalled: Els, about 1 s
            handling_ratio: [1.0, 0.8],                // recalled: Els switches at equality; hysteresis assumed
            handling_floor_m_s2: [1.0, 0.6],           // assumed: on a smooth straight both are near nothing
            guard_roll_rad: [0.08, 0.04],              // assumed: 4.6 and 2.3 degrees relative to the axles
            guard_lateral_m_s2: 3.0,                   // assumed
            body_velocity_share_s: 0.35,               // measured: docs/controller.md
            body_acceleration_share: 2.2,              // measured: docs/controller.md
            trapped_shift_m: 0.008,                    // assumed
            opening_step_share: 0.05,                  // assumed
        }
    }
}

/// A value outside the range the controller was designed for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConfigurationError {
    /// Name of the value, as the field of [`Builder`].
    pub name: &'static str,
    /// The value.
    pub value: f32,
    /// Smallest and largest permitted value.
    pub range: (f32, f32),
}

impl fmt::Display for ConfigurationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (least, most) = self.range;
        write!(
            f,
            "controller configuration: {} = {}: give a value from {least} to {most}",
            self.name, self.value
        )
    }
}

impl core::error::Error for ConfigurationError {}

impl Builder {
    /// Checks every value and computes the coefficients.
    ///
    /// # Errors
    /// The first value that is not a number or outside its range.
    pub fn build(self) -> Result<Configuration, ConfigurationError> {
        let both = |name, [a, b]: [f32; 2], range| [(name, a, range), (name, b, range)];
        let single = [
            ("piston_area_m2", self.piston_area_m2, (1e-4, 1e-1)),
            ("roll_arm_m", self.roll_arm_m, (0.05, 3.0)),
            ("roll_gyration_m", self.roll_gyration_m, (0.1, 5.0)),
            ("pitch_gyration_m", self.pitch_gyration_m, (0.1, 10.0)),
            ("lateral_corner_hz", self.lateral_corner_hz, (0.1, 5.0)),
            ("running_rms_s", self.running_rms_s, (0.1, 20.0)),
            ("guard_lateral_m_s2", self.guard_lateral_m_s2, (0.5, 10.0)),
            ("body_velocity_share_s", self.body_velocity_share_s, (0.0, 10.0)),
            ("body_acceleration_share", self.body_acceleration_share, (0.0, 100.0)),
            ("trapped_shift_m", self.trapped_shift_m, (1e-4, 0.1)),
            ("opening_step_share", self.opening_step_share, (1e-3, 1.0)),
        ];
        let pairs = [
            both("gas_volume_m3", self.gas_volume_m3, (1e-6, 1e-1)),
            both("strut_spacing_m", self.strut_spacing_m.into_array(), (0.2, 4.0)),
            both("axle_distance_m", self.axle_distance_m.into_array(), (0.2, 10.0)),
            both(
                "anti_roll_stiffness_n_m_rad",
                self.anti_roll_stiffness_n_m_rad.into_array(),
                (0.0, 1e6),
            ),
            both("handling_ratio", self.handling_ratio, (0.05, 20.0)),
            both("handling_floor_m_s2", self.handling_floor_m_s2, (0.05, 10.0)),
            both("guard_roll_rad", self.guard_roll_rad, (0.005, 1.0)),
        ];
        for (name, value, range) in single.into_iter().chain(pairs.into_iter().flatten()) {
            if !(value >= range.0 && value <= range.1) {
                return Err(ConfigurationError { name, value, range });
            }
        }
        // A hysteresis whose end lies beyond its begin would switch every tick.
        for (name, [begin, end]) in [
            ("handling_ratio", self.handling_ratio),
            ("handling_floor_m_s2", self.handling_floor_m_s2),
            ("guard_roll_rad", self.guard_roll_rad),
        ] {
            if end > begin {
                return Err(ConfigurationError {
                    name,
                    value: end,
                    range: (0.0, begin),
                });
            }
        }
        Ok(Configuration::from_checked(&self))
    }
}

/// Immutable while running; made by [`Builder::build`]. Lengths in m, SI throughout.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Configuration {
    pub(crate) strategy: Strategy,
    pub(crate) damper_policy: DamperPolicy,
    pub(crate) piston_area_m2: f32,
    pub(crate) per_piston_area: f32,
    pub(crate) gas_volume_m3: [f32; 2],
    pub(crate) half_spacing_m: Axles<f32>,
    pub(crate) per_spacing: Axles<f32>,
    pub(crate) axle_distance_m: Axles<f32>,
    pub(crate) per_wheelbase: f32,
    pub(crate) per_roll_arm: f32,
    pub(crate) anti_roll_stiffness_n_m_rad: Axles<f32>,
    pub(crate) per_roll_gyration_2: f32,
    pub(crate) per_pitch_gyration_2: f32,
    pub(crate) strut_speed: Derivative,
    pub(crate) pressure_rate: Derivative,
    pub(crate) body_band: LowPass,
    pub(crate) static_load: LowPass,
    pub(crate) lateral: LowPass,
    pub(crate) lateral_bias: LowPass,
    pub(crate) running: LowPass,
    pub(crate) body_velocity: LeakyIntegrator,
    pub(crate) vote: LowPass,
    pub(crate) charge_start: LowPass,
    pub(crate) charge_drift: LowPass,
    pub(crate) handling_ratio_2: [f32; 2],
    pub(crate) handling_floor_2: [f32; 2],
    pub(crate) guard_roll_rad: [f32; 2],
    pub(crate) guard_lateral_m_s2: f32,
    pub(crate) body_velocity_share_2: f32,
    pub(crate) body_acceleration_share_2: f32,
    pub(crate) trapped_shift_m: f32,
    pub(crate) opening_step_share: f32,
}

impl Configuration {
    /// The Land Rover Defender 110 of the report with the ride/handling strategy.
    pub fn defender110() -> Self {
        Self::from_checked(&Builder::default())
    }

    /// The same with another strategy.
    pub fn with_strategy(self, strategy: Strategy) -> Self {
        Self { strategy, ..self }
    }

    /// The same with another damper policy in ride mode.
    pub fn with_damper_policy(self, damper_policy: DamperPolicy) -> Self {
        Self { damper_policy, ..self }
    }

    fn from_checked(b: &Builder) -> Self {
        let square = |x: f32| x * x;
        let Axles {
            front: front_m,
            rear: rear_m,
        } = b.axle_distance_m;
        Self {
            strategy: b.strategy,
            damper_policy: b.damper_policy,
            piston_area_m2: b.piston_area_m2,
            per_piston_area: 1.0 / b.piston_area_m2,
            gas_volume_m3: b.gas_volume_m3,
            half_spacing_m: b.strut_spacing_m.map(|s| 0.5 * s),
            per_spacing: b.strut_spacing_m.map(|s| 1.0 / s),
            axle_distance_m: b.axle_distance_m,
            per_wheelbase: 1.0 / (front_m + rear_m),
            per_roll_arm: 1.0 / b.roll_arm_m,
            anti_roll_stiffness_n_m_rad: b.anti_roll_stiffness_n_m_rad,
            per_roll_gyration_2: 1.0 / square(b.roll_gyration_m),
            per_pitch_gyration_2: 1.0 / square(b.pitch_gyration_m),
            strut_speed: Derivative::from_corner_hz(SPEED_CORNER_HZ),
            // Slower than the strut speed: 5 kPa steps.
            pressure_rate: Derivative::from_corner_hz(8.0),
            // Body frequencies only: the valves cannot follow the wheel.
            body_band: LowPass::from_corner_hz(4.0),
            static_load: LowPass::from_time_constant_s(20.0),
            lateral: LowPass::from_corner_hz(b.lateral_corner_hz),
            lateral_bias: LowPass::from_time_constant_s(30.0),
            running: LowPass::from_time_constant_s(b.running_rms_s),
            body_velocity: LeakyIntegrator::from_corner_hz(0.2),
            vote: LowPass::from_time_constant_s(1.0),
            charge_start: LowPass::from_time_constant_s(0.02),
            charge_drift: LowPass::from_time_constant_s(60.0),
            handling_ratio_2: b.handling_ratio.map(square),
            handling_floor_2: b.handling_floor_m_s2.map(square),
            guard_roll_rad: b.guard_roll_rad,
            guard_lateral_m_s2: b.guard_lateral_m_s2,
            body_velocity_share_2: square(b.body_velocity_share_s),
            body_acceleration_share_2: square(b.body_acceleration_share),
            trapped_shift_m: b.trapped_shift_m,
            opening_step_share: b.opening_step_share,
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::ToString;

    #[test]
    fn the_default_is_valid() {
        assert_eq!(Builder::default().build(), Ok(Configuration::defender110()));
    }

    #[test]
    fn a_wrong_value_is_named_with_its_range() {
        let error = Builder {
            roll_arm_m: f32::NAN,
            ..Builder::default()
        }
        .build()
        .unwrap_err();
        assert_eq!(
            error.to_string(),
            "controller configuration: roll_arm_m = NaN: give a value from 0.05 to 3"
        );
        let error = Builder {
            handling_ratio: [0.8, 1.0],
            ..Builder::default()
        }
        .build()
        .unwrap_err();
        assert_eq!(error.name, "handling_ratio");
    }
}
