//! Effects of mechanisms with one degree of freedom: dampers and drives.
//!
//! The recordings know the two ends of such a specimen only, so the place of every effect is the specimen as a whole.

mod backlash;
mod coulomb_friction;
mod force_offset;
pub(super) mod friction;
mod gas_spring;
mod inertia;
mod presliding_friction;
mod smooth_yield;
mod stiffness;
mod stribeck_friction;

pub(super) use backlash::Backlash;
pub(super) use coulomb_friction::CoulombFriction;
pub(super) use force_offset::ForceOffset;
pub(super) use gas_spring::GasSpring;
pub(super) use inertia::Inertia;
pub(super) use presliding_friction::PreslidingFriction;
pub(super) use smooth_yield::SmoothYield;
pub(super) use stiffness::Stiffness;
pub(super) use stribeck_friction::StribeckFriction;
