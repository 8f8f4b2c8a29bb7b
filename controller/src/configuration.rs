//! All parameters of the controller, computed from the description of the vehicle and the tuning of each part.
//!
//! [`Builder`] takes physical units and checks each value against the range in which the controller was designed. What
//! comes out is immutable and holds filter coefficients instead of frequencies, so that a tick has nothing left to compute
//! from them. Each part defines its own parameters and knows no others; only this file knows all parts.

use crate::estimate;
use crate::plausibility;
use crate::range::ConfigurationError;
use crate::spring;
use crate::strategy::{self, Strategy};
use crate::vehicle::VehicleDescription;

/// What a person may choose about the parts of the controller. See [`strategy::Tuning`] for an example.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tuning {
    /// Tuning of the estimate.
    pub estimate: estimate::Tuning,
    /// Of each strategy, whether it is chosen or not.
    pub strategy: strategy::Tuning,
    /// Tuning of the spring valves.
    pub spring: spring::Tuning,
}

/// Description of a vehicle and of the controller that it is to have. `Default` is the Land Rover Defender 110 of the seed
/// report with the ride/handling strategy.
///
/// ```
/// use oleo_controller::{Builder, Strategy, VehicleDescription};
/// let vehicle = VehicleDescription { roll_arm_m: 0.5, ..VehicleDescription::default() };
/// let builder = Builder { vehicle, strategy: Strategy::AlwaysStiff, ..Builder::default() };
/// assert!(builder.build().is_ok());
///
/// let vehicle = VehicleDescription { roll_arm_m: -0.5, ..vehicle };
/// let error = Builder { vehicle, ..builder }.build().unwrap_err();
/// assert_eq!(
///     error.to_string(),
///     "controller configuration: vehicle.roll_arm_m = -0.5: give a value from 0.05 to 3"
/// );
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Builder {
    /// Masses, dimensions and struts of the vehicle.
    pub vehicle: VehicleDescription,
    /// Strategy that sets the valves.
    pub strategy: Strategy,
    /// Thresholds and filters of each part.
    pub tuning: Tuning,
}

impl Builder {
    /// Checks every value and computes the coefficients.
    ///
    /// # Errors
    /// The first value that is not a number or outside its range.
    pub fn build(self) -> Result<Configuration, ConfigurationError> {
        self.vehicle.check()?;
        self.tuning.estimate.check()?;
        self.tuning.strategy.check()?;
        self.tuning.spring.check()?;
        Ok(Configuration::from_checked(&self))
    }
}

/// Parameters of every part, immutable while the controller runs; made by [`Builder::build`].
///
/// ```
/// use oleo_controller::{Configuration, Strategy};
/// let soft = Configuration::defender110().with_strategy(Strategy::AlwaysSoft);
/// assert_ne!(soft, Configuration::defender110());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Configuration {
    /// Of the checks on readings.
    pub plausibility: plausibility::Parameters,
    /// Parameters of the estimate.
    pub estimate: estimate::Parameters,
    /// Parameters of the strategy.
    pub strategy: strategy::Parameters,
    /// Parameters of the spring valves.
    pub spring: spring::Parameters,
}

impl Configuration {
    /// The Land Rover Defender 110 of the seed report with the ride/handling strategy.
    pub fn defender110() -> Self {
        Self::from_checked(&Builder::default())
    }

    /// The same with another strategy.
    #[must_use]
    pub fn with_strategy(mut self, strategy: Strategy) -> Self {
        self.strategy.choose(strategy);
        self
    }

    fn from_checked(builder: &Builder) -> Self {
        let Builder {
            vehicle,
            strategy,
            tuning,
        } = builder;
        Self {
            plausibility: plausibility::Parameters::new(vehicle),
            estimate: estimate::Parameters::new(vehicle, &tuning.estimate),
            strategy: strategy::Parameters::new(*strategy, vehicle, &tuning.strategy),
            spring: spring::Parameters::new(vehicle, &tuning.spring),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::range::Hysteresis;

    #[test]
    fn the_default_is_valid() {
        assert_eq!(Builder::default().build(), Ok(Configuration::defender110()));
    }

    /// One wrong value in each part: none is forgotten.
    #[test]
    fn every_part_is_checked() {
        let name = |change: fn(&mut Builder)| {
            let mut builder = Builder::default();
            change(&mut builder);
            builder.build().map_err(|error| error.name)
        };
        assert_eq!(
            name(|b| b.vehicle.axle_distance_m.rear = 0.0),
            Err("vehicle.axle_distance_m")
        );
        assert_eq!(
            name(|b| b.tuning.estimate.running_rms_s = f32::NAN),
            Err("tuning.estimate.running_rms_s")
        );
        assert_eq!(
            name(|b| b.tuning.spring.trapped_shift_m = 1.0),
            Err("tuning.spring.trapped_shift_m")
        );
        assert_eq!(
            name(|b| {
                b.tuning.strategy.road_and_cornering.rough_m_s2 = Hysteresis { begin: 0.8, end: 1.0 };
            }),
            Err("tuning.strategy.road_and_cornering.rough_m_s2")
        );
        assert_eq!(
            name(|b| b.tuning.strategy.road_and_cornering.cornering.floor_m_s2 = 0.0),
            Err("tuning.strategy.road_and_cornering.cornering.floor_m_s2")
        );
        assert_eq!(
            name(|b| b.tuning.strategy.road_and_cornering.rollover_guard.lateral_m_s2 = 0.0),
            Err("tuning.strategy.road_and_cornering.rollover_guard.lateral_m_s2")
        );
        assert_eq!(
            name(|b| b.tuning.estimate.lateral.smoothed_share = 1.1),
            Err("tuning.estimate.lateral.smoothed_share")
        );
        #[cfg(feature = "comparison")]
        assert_eq!(
            name(|b| {
                b.tuning.strategy.ride_handling.running_rms.ratio = Hysteresis { begin: 0.8, end: 1.0 };
            }),
            Err("tuning.strategy.ride_handling.running_rms.ratio")
        );
    }
}
