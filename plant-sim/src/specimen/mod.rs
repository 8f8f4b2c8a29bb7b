//! Test specimens simpler than the strut: a gas spring, a cylinder, a damper and a drive, as found on other people's test
//! machines.
//!
//! Gas spring and cylinder share the strut's physics (energy equation of the gas, friction of the seal) and its vocabulary of
//! effects, so that a diagnosis learnt on one is checked on the others. Damper and drive have a vocabulary of their own.

mod cylinder;
mod gas_spring;
mod mechanism;
mod name;
mod smoothed_motion;

pub use cylinder::{CylinderChamber, CylinderEffects, CylinderModel, CylinderSeal};
pub use gas_spring::{
    Convection, GasHeatTransferTerm, GasProcess, GasSpringEffects, GasSpringGas, GasSpringModel, SpringChamber,
};
pub use mechanism::{
    Backlash, CoulombFriction, Damper, DamperModel, Drive, DriveModel, ForceOffset, Inertia, MechanismEffects,
    ParallelGasSpring, PreslidingFriction, SmoothYield, Stiffness, StribeckFriction, UnnamedForces, WINDOW_S,
};
pub use name::{SpecimenName, specimen_name};
pub use smoothed_motion::{SmoothedMotion, smooth_motion};
