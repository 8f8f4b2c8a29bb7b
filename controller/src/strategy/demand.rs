//! What a strategy is, and what it asks for.

use oleo_interface::Side;

use crate::estimate::Estimate;
use crate::plausibility::Trusted;
use crate::range::ConfigurationError;
use crate::valves::ValveCommand;
use crate::vehicle::VehicleDescription;

/// How much a change of springs matters against how smooth it is. See [`Demand`] for an example.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Urgency {
    /// Comfort: the change may wait for a smooth moment.
    #[default]
    Comfort,
    /// Handling: the change may wait for a fraction of a body oscillation.
    Handling,
    /// A bend: what is to close does so now, but a spring valve is open while that lets out a lean that was trapped behind it.
    Bend {
        /// Side to which the bend pushes the body.
        outer: Side,
    },
    /// Roll-over guard: what is to close does so now.
    Emergency,
}

impl Urgency {
    /// Whether a closing waits for nothing.
    pub(crate) fn closes_at_once(self) -> bool {
        matches!(self, Self::Bend { .. } | Self::Emergency)
    }
}

/// What a strategy asks for in a tick.
///
/// ```
/// use oleo_controller::strategy::{Demand, Urgency};
/// use oleo_controller::{Corner, Valve, ValveCommand};
/// // Soft springs everywhere, low damping at the front left strut only.
/// let valves = ValveCommand::from_fn(|corner, valve| valve == Valve::Spring || corner == Corner::FrontLeft);
/// let demand = Demand { valves, ..Demand::default() };
/// assert_eq!((demand.urgency, demand.handling), (Urgency::Comfort, false));
/// ```
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

/// A strategy. The implementing type holds its parameters, which do not change while it runs; its state is separate.
///
/// ```
/// use oleo_controller::plausibility::Trusted;
/// use oleo_controller::strategy::{Decide, Demand};
/// use oleo_controller::{ConfigurationError, Estimate, Valve, ValveCommand, VehicleDescription};
///
/// /// Soft springs while the body rolls by less than 0.02 rad.
/// struct SoftWhileUpright;
///
/// impl Decide for SoftWhileUpright {
///     type Tuning = ();
///     type State = ();
///     const INITIAL: () = ();
///     fn check(_: &()) -> Result<(), ConfigurationError> {
///         Ok(())
///     }
///     fn new(_: &VehicleDescription, _: &()) -> Self {
///         Self
///     }
///     fn step(&self, _: &mut (), estimate: &Estimate, _: &Trusted) -> Demand {
///         let soft = estimate.roll_rad.abs() < 0.02;
///         Demand {
///             valves: ValveCommand::from_fn(|_, valve| soft && valve == Valve::Spring),
///             ..Demand::default()
///         }
///     }
/// }
/// let strategy = SoftWhileUpright::new(&VehicleDescription::default(), &());
/// let leaning = Estimate { roll_rad: 0.05, ..Estimate::default() };
/// assert_eq!(strategy.step(&mut (), &leaning, &Trusted::default()).valves, ValveCommand::SAFE);
/// ```
pub trait Decide {
    /// What a person may choose about it, in physical units.
    type Tuning: Copy + core::fmt::Debug + Default + PartialEq;
    /// What it remembers from tick to tick.
    type State: Copy + core::fmt::Debug;
    /// What it remembers before the first tick. On a board every bit of it should be zero, because memory that is only cleared needs no
    /// flash.
    const INITIAL: Self::State;

    /// Whether every value of the tuning is within its range.
    ///
    /// # Errors
    /// The first value that is not a number or outside its range.
    fn check(tuning: &Self::Tuning) -> Result<(), ConfigurationError>;

    /// The parameters for a vehicle. Both arguments have been checked.
    fn new(vehicle: &VehicleDescription, tuning: &Self::Tuning) -> Self;

    /// One tick; returns what is wanted.
    fn step(&self, state: &mut Self::State, estimate: &Estimate, trusted: &Trusted) -> Demand;
}
