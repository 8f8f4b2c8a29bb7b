//! How valves are decided: replaceable, each strategy in a file of its own.
//!
//! A strategy only says what it wants. How a wanted spring is reached at whatever displacement the strut happens to have is
//! [`crate::spring`]'s business, how often a bypass valve may move is decided after it, and what is permitted is
//! [`crate::failsafe`]'s.
//!
//! | strategy | springs | dampers |
//! |---|---|---|
//! | `always-soft` | soft | low |
//! | `always-stiff` | stiff | high |
//! | `road-and-cornering` | soft on a rough road, stiff on a smooth one and in bends | by the road; high where the springs are stiff |
//! | `road-and-dampers` | the same | on a rough road the damper policy |
//! | `predictive` | the same | on a road on which the body heaves a forecast sets the rear ones |
//! | `ride-handling` | soft in ride mode, stiff in handling mode or under the roll-over guard | ride mode: the damper policy; else high |
//!
//! A new strategy is a file here with a type that implements [`Decide`], and one line in the list at the end of this
//! file. Its name on the command line is the name of its variant: `AlwaysSoft` is `always-soft`.

mod demand;
#[cfg(feature = "comparison")]
mod fixed;
pub mod parts;
#[cfg(feature = "comparison")]
pub mod predictive;
#[cfg(feature = "comparison")]
pub mod ride_handling;
pub mod road_and_cornering;
#[cfg(feature = "comparison")]
pub mod road_and_dampers;

use strum::{EnumString, IntoStaticStr, VariantArray, VariantNames};

pub use demand::{Decide, Demand, Urgency};
#[cfg(feature = "comparison")]
pub use parts::semi_active::DamperPolicy;

use crate::estimate::Estimate;
use crate::plausibility::Trusted;
use crate::range::ConfigurationError;
use crate::vehicle::VehicleDescription;

/// From one line for each strategy: the enum of their names, and their tunings, parameters and states side by side.
macro_rules! strategies {
    ($($(#[$attribute:meta])* $variant:ident, $field:ident: $strategy:ty;)*) => {
        /// The strategies there are. Their names are those of the command line: `ride-handling`.
        ///
        /// ```
        /// use oleo_controller::Strategy;
        /// assert_eq!("always-soft".parse(), Ok(Strategy::AlwaysSoft));
        /// assert_eq!(Strategy::RideHandling.name(), "ride-handling");
        /// ```
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
        #[derive(EnumString, IntoStaticStr, VariantArray, VariantNames)]
        #[strum(serialize_all = "kebab-case")]
        pub enum Strategy {
            $($(#[$attribute])* $variant,)*
        }

        /// What a person may choose about each strategy, whether it is the one in use or not.
        ///
        /// ```
        /// use oleo_controller::{Builder, DamperPolicy};
        /// let mut builder = Builder::default();
        /// builder.tuning.strategy.ride_handling.dampers.policy = DamperPolicy::Low;
        /// assert!(builder.build().is_ok());
        /// ```
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct Tuning {
            $(
                #[doc = concat!("Tuning of [`Strategy::", stringify!($variant), "`].")]
                pub $field: <$strategy as Decide>::Tuning,
            )*
        }

        impl Tuning {
            /// Whether every value is within its range.
            pub(crate) fn check(&self) -> Result<(), ConfigurationError> {
                $(<$strategy as Decide>::check(&self.$field)?;)*
                Ok(())
            }
        }

        /// Which strategy is in use, and the parameters of each. See [`State`] for an example.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Parameters {
            strategy: Strategy,
            $($field: $strategy,)*
        }

        impl Parameters {
            /// From a description and a tuning that have been checked.
            pub(crate) fn new(strategy: Strategy, vehicle: &VehicleDescription, tuning: &Tuning) -> Self {
                Self {
                    strategy,
                    $($field: <$strategy as Decide>::new(vehicle, &tuning.$field),)*
                }
            }
        }

        /// Memory of each strategy.
        ///
        /// ```
        /// use oleo_controller::plausibility::Trusted;
        /// use oleo_controller::{Configuration, Estimate, Strategy, ValveCommand, strategy};
        /// let parameters = Configuration::defender110().with_strategy(Strategy::AlwaysSoft).strategy;
        /// let mut state = strategy::State::default();
        /// let demand = state.step(&parameters, &Estimate::default(), &Trusted::default());
        /// assert_eq!(demand.valves, ValveCommand::SOFT);
        /// ```
        #[derive(Clone, Copy, Debug)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        pub struct State {
            $($field: <$strategy as Decide>::State,)*
        }

        impl Default for State {
            fn default() -> Self {
                Self::INITIAL
            }
        }

        impl State {
            pub(crate) const INITIAL: Self = Self {
                $($field: <$strategy as Decide>::INITIAL,)*
            };

            /// One tick of the strategy in use; returns what it wants.
            pub fn step(&mut self, parameters: &Parameters, estimate: &Estimate, trusted: &Trusted) -> Demand {
                match parameters.strategy {
                    $(Strategy::$variant => parameters.$field.step(&mut self.$field, estimate, trusted),)*
                }
            }
        }
    };
}

impl Strategy {
    /// Name on the command line and in scenario files.
    pub fn name(self) -> &'static str {
        self.into()
    }
}

impl Parameters {
    /// Puts another strategy into use.
    pub(crate) fn choose(&mut self, strategy: Strategy) {
        self.strategy = strategy;
    }
}

#[cfg(feature = "comparison")]
strategies! {
    /// All valves open, for comparison.
    AlwaysSoft, always_soft: fixed::AlwaysSoft;
    /// All valves closed, for comparison.
    AlwaysStiff, always_stiff: fixed::AlwaysStiff;
    /// Ride mode or handling mode by running RMS, with a roll-over guard.
    RideHandling, ride_handling: ride_handling::RideHandling;
    /// Stiff on a smooth road and as soon as the vehicle corners; low damping by the road else.
    #[default]
    RoadAndCornering, road_and_cornering: road_and_cornering::RoadAndCornering;
    /// The same, but on a rough road a damper policy switches the dampers.
    RoadAndDampers, road_and_dampers: road_and_dampers::RoadAndDampers;
    /// The same, but on a rough road the dampers are set by a forecast.
    Predictive, predictive: predictive::Predictive;
}

// The board's image holds the one strategy that it drives with.
#[cfg(not(feature = "comparison"))]
strategies! {
    /// Stiff on a smooth road and as soon as the vehicle corners; low damping by the road else.
    #[default]
    RoadAndCornering, road_and_cornering: road_and_cornering::RoadAndCornering;
}

#[cfg(test)]
mod tests {
    use super::*;
    use strum::{VariantArray, VariantNames};

    #[test]
    fn every_strategy_has_a_name_and_decides() {
        let tuning = Tuning::default();
        assert_eq!(tuning.check(), Ok(()));
        for (strategy, name) in <Strategy as VariantArray>::VARIANTS
            .iter()
            .zip(<Strategy as VariantNames>::VARIANTS)
        {
            assert_eq!((strategy.name(), name.parse()), (*name, Ok(*strategy)));
            let parameters = Parameters::new(*strategy, &VehicleDescription::default(), &tuning);
            let demand = State::default().step(&parameters, &Estimate::default(), &Trusted::default());
            assert!(!demand.rollover_guard, "{name} at rest");
        }
    }
}
