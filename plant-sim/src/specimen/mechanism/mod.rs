//! Mechanisms with one degree of freedom: a damper on a dynamometer and a drive with a carriage.
//!
//! Both resist motion with the same force `R`: a viscous one, which the model of the specimen always has, and the effects
//! below. A damper is moved, and its force `R + m a` is measured. A drive is pushed by a measured force, and moves by
//! `m d2x/dt2 = F - R`.
//!
//! | file | what it holds |
//! |---|---|
//! | `coulomb_friction`, `stribeck_friction`, `presliding_friction`, `smooth_yield`, `force_offset`, `stiffness`, `gas_spring`, `backlash`, `inertia` | one effect each: numbers in a model file, equation and source, code, test against a closed form |
//! | `unnamed` | forces that the vocabulary has no name for, one number each |
//! | `effects` | the table `[effects]` of a model file |
//! | `dry_friction` | the level at which dry friction slides, and how stiff it is before |
//! | `damper`, `drive` | the models: what is read from a file, and what it predicts of a recording |

mod backlash;
mod coulomb_friction;
mod damper;
mod drive;
mod dry_friction;
mod effects;
mod force_offset;
mod gas_spring;
mod inertia;
mod presliding_friction;
mod smooth_yield;
mod stiffness;
mod stribeck_friction;
mod unnamed;

pub use backlash::Backlash;
pub use coulomb_friction::CoulombFriction;
pub use damper::{Damper, DamperModel};
pub use drive::{Drive, DriveModel, WINDOW_S};
pub use effects::MechanismEffects;
pub use force_offset::ForceOffset;
pub use gas_spring::ParallelGasSpring;
pub use inertia::Inertia;
pub use presliding_friction::PreslidingFriction;
pub use smooth_yield::SmoothYield;
pub use stiffness::Stiffness;
pub use stribeck_friction::StribeckFriction;
pub use unnamed::UnnamedForces;
