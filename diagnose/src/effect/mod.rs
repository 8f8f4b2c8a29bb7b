//! Effects: what a model may lack, one file for each.
//!
//! Everything that `oleo diagnose` knows of one effect is in its file: its id and words, the candidates that the search
//! tries (places, starts, ranges), how a candidate is put into a model, how it is concealed in a self-test, in which
//! channels it shows, which relation of the model it changes, how it is reported, and what to record to tell it from its
//! rivals. Search, localisation, self-test, page and terminal know the traits of `contract` and no effect.
//!
//! The equation and its source are not here: they come from plant-sim, where they stand beside the code that computes them.
//!
//! | file | what it holds |
//! |---|---|
//! | `contract` | the traits: [`Effect`], and what it does in one kind of specimen ([`ActsOn`], [`Concealed`]) |
//! | `registry` | [`of`]: from an id to its effect; an id without a file does not compile |
//! | `candidate` | [`Candidate`]: an effect at a place with the numbers to fit |
//! | `drawn` | what a self-test draws of a concealed effect |
//! | `relation` | the relation of the model at a place |
//! | `mechanism/` | effects of dampers and drives |
//! | `sensor/` | faults of instruments, the same for every kind of specimen |
//! | `unlisted/` | laws that the vocabulary has no name for: forms, and where they act on what |
//! | every other file | the effect of its name |
//!
//! `docs/adding-physics.md` walks through adding one.

mod candidate;
mod contract;
mod drawn;
mod mechanism;
mod registry;
mod relation;
pub mod sensor;
pub mod unlisted;

mod accumulator_piston_friction;
mod bump_stop;
mod damper_leakage;
mod damping_fade;
mod entrained_air;
mod gas_charge_error;
mod gas_heat_transfer;
mod line_inertance;
mod line_resistance;
mod mount_compliance;
mod oil_compressibility;
mod real_gas;
mod seal_friction;
mod side_load_friction;
mod valve3_leakage;
mod valve_delay;
mod valve_transition;

#[cfg(test)]
mod tests;

pub use candidate::{Candidate, ExclusionGroup, Joins};
pub use contract::{
    ActsOn, CoSimulation, Concealed, Cylinder, Effect, Experiment, GasSpring, Kind, Mechanism, ShowsIn, Strut,
    StrutEffect,
};
pub use drawn::{Drawn, TrueNumber};
pub use registry::{ALL, in_struts, of};
