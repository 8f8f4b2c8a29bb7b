//! Finds the effect of an id.

use strum::VariantArray;

use super::contract::Effect;
use crate::vocabulary::EffectId;

/// The ids of all effects, in the order of the vocabulary.
pub const ALL: &[EffectId] = EffectId::VARIANTS;

/// The effect of an id. This match is the only one over all ids: an id without an effect does not compile.
#[must_use]
pub fn of(id: EffectId) -> &'static dyn Effect {
    match id {
        EffectId::OilCompressibility => &super::oil_compressibility::OilCompressibility,
        EffectId::EntrainedAir => &super::entrained_air::EntrainedAir,
        EffectId::GasHeatTransfer => &super::gas_heat_transfer::GasHeatTransfer,
        EffectId::RealGas => &super::real_gas::RealGas,
        EffectId::GasChargeError => &super::gas_charge_error::GasChargeError,
        EffectId::SealFriction => &super::seal_friction::SealFriction,
        EffectId::SideLoadFriction => &super::side_load_friction::SideLoadFriction,
        EffectId::AccumulatorPistonFriction => &super::accumulator_piston_friction::AccumulatorPistonFriction,
        EffectId::DamperLeakage => &super::damper_leakage::DamperLeakage,
        EffectId::LineResistance => &super::line_resistance::LineResistance,
        EffectId::LineInertance => &super::line_inertance::LineInertance,
        EffectId::ValveDelay => &super::valve_delay::ValveDelay,
        EffectId::ValveTransition => &super::valve_transition::ValveTransition,
        EffectId::Valve3Leakage => &super::valve3_leakage::Valve3Leakage,
        EffectId::BumpStop => &super::bump_stop::BumpStop,
        EffectId::MountCompliance => &super::mount_compliance::MountCompliance,
        EffectId::DampingFade => &super::damping_fade::DampingFade,
        EffectId::CoulombFriction => &super::mechanism::CoulombFriction,
        EffectId::StribeckFriction => &super::mechanism::StribeckFriction,
        EffectId::PreslidingFriction => &super::mechanism::PreslidingFriction,
        EffectId::SmoothYield => &super::mechanism::SmoothYield,
        EffectId::ForceOffset => &super::mechanism::ForceOffset,
        EffectId::Stiffness => &super::mechanism::Stiffness,
        EffectId::GasSpring => &super::mechanism::GasSpring,
        EffectId::Backlash => &super::mechanism::Backlash,
        EffectId::Inertia => &super::mechanism::Inertia,
        EffectId::SensorLag => &super::sensor::LAG,
        EffectId::SensorGain => &super::sensor::GAIN,
        EffectId::SensorDrift => &super::sensor::DRIFT,
        EffectId::SensorSkew => &super::sensor::SKEW,
        EffectId::SensorSign => &super::sensor::SIGN,
        EffectId::Unlisted => &super::unlisted::Unlisted,
    }
}

/// The ids of the effects that a strut may have, in the order of the vocabulary.
#[must_use]
pub fn in_struts() -> Vec<EffectId> {
    (ALL.iter().copied())
        .filter(|id| of(*id).in_strut().is_some())
        .collect()
}
