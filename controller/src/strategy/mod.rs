//! How valves are decided: replaceable, each strategy in a file of its own.
//!
//! A strategy only *wants*. How a wanted spring setting is reached at whatever displacement the strut happens to have is [`crate::spring`]'s
//! business, how often a valve may move is [`crate::dwell`]'s, and what is permitted is [`crate::failsafe`]'s.
//!
//! | strategy | springs | dampers |
//! |---|---|---|
//! | `always-soft` | soft | low |
//! | `always-stiff` | stiff | high |
//! | `ride-handling` | soft in ride mode, stiff in handling mode or under the roll-over guard | ride mode: the damper policy; else high |

pub mod ride_handling;
pub mod rollover;
pub mod semi_active;

use oleo_interface::StrutValves;

use crate::configuration::Configuration;
use crate::estimate::Estimate;
use crate::plausibility::Trusted;
use crate::valves::ValveCommand;
use ride_handling::RideHandling;
use rollover::Rollover;
use semi_active::SemiActive;

/// The strategies there are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Strategy {
    /// All valves open, for comparison.
    AlwaysSoft,
    /// All valves closed, for comparison.
    AlwaysStiff,
    /// Ride mode or handling mode by running RMS.
    #[default]
    RideHandling,
}

impl Strategy {
    /// Names, as on a command line.
    pub const ALL: [(&'static str, Self); 3] = [
        ("always-soft", Self::AlwaysSoft),
        ("always-stiff", Self::AlwaysStiff),
        ("ride-handling", Self::RideHandling),
    ];

    /// By name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find_map(|(n, strategy)| (n == name).then_some(strategy))
    }
}

/// How dampers are switched in ride mode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum DamperPolicy {
    /// Low damping always.
    Low,
    /// High where the damper's force opposes the body's velocity (skyhook in two stages).
    #[default]
    Karnopp,
    /// High where the damper's force opposes the body's acceleration.
    HoelscherHuang,
}

impl DamperPolicy {
    /// Names, as on a command line.
    pub const ALL: [(&'static str, Self); 3] = [
        ("low", Self::Low),
        ("karnopp", Self::Karnopp),
        ("hoelscher-huang", Self::HoelscherHuang),
    ];

    /// By name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find_map(|(n, policy)| (n == name).then_some(policy))
    }
}

/// How much a change of springs matters against how smooth it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Urgency {
    /// Comfort: may wait for a smooth moment.
    #[default]
    Comfort,
    /// Handling: may wait for a fraction of a body oscillation.
    Handling,
    /// Roll-over guard: now.
    Emergency,
}

/// What a strategy wants.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Demand {
    /// Wanted position of every valve. Valve 2 is wanted for itself: that it has no effect behind a closed valve 3 is
    /// not the strategy's business.
    pub valves: ValveCommand,
    /// How much a change of springs matters.
    pub urgency: Urgency,
    /// Handling mode.
    pub handling: bool,
    /// Roll-over guard active.
    pub rollover_guard: bool,
}

/// Memory of the strategies.
#[derive(Clone, Copy, Debug, Default)]
pub struct State {
    mode: RideHandling,
    guard: Rollover,
    dampers: SemiActive,
}

impl State {
    /// One tick.
    pub fn step(&mut self, c: &Configuration, estimate: &Estimate, trusted: &Trusted) -> Demand {
        match c.strategy {
            Strategy::AlwaysSoft => Demand {
                valves: ValveCommand::SOFT,
                ..Demand::default()
            },
            Strategy::AlwaysStiff => Demand {
                urgency: Urgency::Handling,
                handling: true,
                ..Demand::default()
            },
            Strategy::RideHandling => {
                let rollover_guard = self.guard.step(c, estimate);
                let handling = self.mode.step(c, estimate);
                let low_damping = self.dampers.step(c, estimate, trusted);
                let stiff = handling || rollover_guard;
                Demand {
                    valves: if stiff {
                        ValveCommand::SAFE
                    } else {
                        ValveCommand::from_corners(low_damping.map(|low| StrutValves::new(low, low, true)))
                    },
                    urgency: if rollover_guard {
                        Urgency::Emergency
                    } else if handling {
                        Urgency::Handling
                    } else {
                        Urgency::Comfort
                    },
                    handling,
                    rollover_guard,
                }
            }
        }
    }
}
