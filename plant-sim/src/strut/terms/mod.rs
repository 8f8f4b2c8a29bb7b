//! The terms a strut model may have: the vocabulary of the recordings, one file for each effect.
//!
//! A file holds everything about its effect on the plant's side: the struct as it stands in `[effects]` of `model.toml`,
//! the limits of its numbers, its equation and source as pages print them ([`Equation`]), the equation as the solver uses it
//! (with the derivative where the solver needs one), and tests of it against a closed form. The network and the integrator
//! only call it.
//!
//! A term that is absent is physics left out, never a default value.
//!
//! # Adding a term
//!
//! 1. A file here with struct, limits, equation, source and tests; two lines in this file.
//! 2. A variant of [`TermId`] in `id.rs` and a field of [`Effects`] in `effects.rs`. The four matches over the ids there
//!    do not compile until the new one stands in each of them.
//! 3. The place in `network`, `integrator` or `rod_forces` where the equation acts.
//! 4. A test of the whole strut in `plant-sim/tests/strut_terms.rs`, and a line in `docs/physics.md`.
//!
//! `docs/adding-physics.md` walks through it, up to the effect that `oleo diagnose` finds; `./test adding-physics` follows.

mod accumulator_piston_friction;
mod bump_stop;
mod damper_leakage;
mod damping_fade;
mod effects;
mod entrained_air;
mod equation;
mod gas_charge_error;
mod gas_heat_transfer;
mod id;
mod line_inertance;
mod line_resistance;
mod mount_compliance;
mod oil_compressibility;
mod real_gas;
mod seal_friction;
pub(super) mod sensor;
mod side_load_friction;
mod unlisted;
mod valve3_leakage;
mod valve_delay;
mod valve_transition;

pub use accumulator_piston_friction::{AccumulatorPistonFriction, PistonSeal};
pub use bump_stop::BumpStop;
pub use damper_leakage::DamperLeakage;
pub use damping_fade::{DampingFade, PackCooling, PackFade};
pub use effects::Effects;
pub use entrained_air::{Bubbles, EntrainedAir};
pub use equation::Equation;
pub use gas_charge_error::GasChargeError;
pub use gas_heat_transfer::GasHeatTransfer;
pub use id::TermId;
pub use line_inertance::LineInertance;
pub use line_resistance::{LaminarLine, LineResistance};
pub use mount_compliance::{Mount, MountCompliance};
pub use oil_compressibility::{OilCompressibility, OilCount};
pub use real_gas::{GasEquation, RealGas};
pub use seal_friction::SealFriction;
pub use sensor::{COLUMNS, SensorEffect, check_columns};
pub use side_load_friction::SideLoadFriction;
pub use unlisted::{LawArgument, LawForm, LawPlace, UnlistedLaw};
pub use valve_delay::ValveDelay;
pub use valve_transition::{TransitionShape, ValveTransition};
pub use valve3_leakage::Valve3Leakage;

pub(super) use entrained_air::LEAST_BUBBLE_PRESSURE;
pub(super) use gas_heat_transfer::EnergyStep;
pub(super) use line_inertance::OilColumn;
pub(super) use oil_compressibility::{held_at_static_density, taken_up_at_chamber_density};
pub(super) use seal_friction::SealLevel;
pub(super) use side_load_friction::GuideLevel;
pub(super) use unlisted::{
    ChamberLaws, Compressibility, Course, GasLawInputs, InstrumentLaws, LawTable, PathLaws, SealLaw, law_at,
    longest_step_s, most_held_back_pa, passed, presliding_m3, throttle, throttled, valve_in_time,
};
pub(super) use valve_delay::{COEFFICIENT as RESPONSE_COEFFICIENT, check_constant, total_response_s};
