//! Test specimens simpler than the strut: a gas spring and a cylinder, as found on other people's test machines.
//!
//! They share the strut's physics (energy equation of the gas, friction of the seal) and its vocabulary of effects, so
//! that a diagnosis learnt on one is checked on the others.

mod cylinder;
mod gas_spring;
mod name;

pub use cylinder::{CylinderChamber, CylinderEffects, CylinderModel, CylinderSeal, SmoothedMotion, smooth_motion};
pub use gas_spring::{GasHeatTransferTerm, GasProcess, GasSpringEffects, GasSpringGas, GasSpringModel, SpringChamber};
pub use name::{SpecimenName, specimen_name};
