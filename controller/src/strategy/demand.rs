//! What a strategy is, and what it asks for.

use crate::estimate::Estimate;
use crate::plausibility::Trusted;
use crate::range::ConfigurationError;
use crate::valves::ValveCommand;
use crate::vehicle::VehicleDescription;

/// How much a change of springs matters against how smooth it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Urgency {
    /// Comfort: the change may wait for a smooth moment.
    #[default]
    Comfort,
    /// Handling: the change may wait for a fraction of a body oscillation.
    Handling,
    /// Roll-over guard: the change happens now.
    Emergency,
}

/// What a strategy asks for in a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Demand {
    /// Wanted position of each of the twelve valves. That valve 2 has no effect behind a closed valve 3 is not the
    /// strategy's business.
    pub valves: ValveCommand,
    /// How much a change of springs matters.
    pub urgency: Urgency,
    /// The strategy is in handling mode.
    pub handling: bool,
    /// The roll-over guard is active.
    pub rollover_guard: bool,
}

/// A strategy: its parameters are the implementing type, its state is separate.
pub trait Decide {
    /// What a person may choose about it, in physical units.
    type Tuning: Copy + core::fmt::Debug + Default + PartialEq;
    /// What it remembers from tick to tick.
    type State: Copy + core::fmt::Debug + Default;

    /// Whether every value of the tuning is within its range.
    ///
    /// # Errors
    /// The first value that is not a number or outside its range.
    fn check(tuning: &Self::Tuning) -> Result<(), ConfigurationError>;

    /// The parameters for a vehicle. Both arguments have been checked.
    fn new(vehicle: &VehicleDescription, tuning: &Self::Tuning) -> Self;

    /// One tick.
    fn step(&self, state: &mut Self::State, estimate: &Estimate, trusted: &Trusted) -> Demand;
}
