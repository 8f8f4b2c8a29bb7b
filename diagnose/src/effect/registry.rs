//! From an id to its effect.

use strum::VariantArray;

use super::contract::Effect;
use super::{
    accumulator_piston_friction as accumulator_piston, bump_stop, damper_leakage, damping_fade, entrained_air,
    gas_charge_error, gas_heat_transfer, line_inertance, line_resistance, mount_compliance, oil_compressibility,
    real_gas, seal_friction, sensor, side_load_friction, unlisted, valve_delay, valve_transition, valve3_leakage,
};
use crate::vocabulary::EffectId;

/// The ids of all effects, in the order of the vocabulary.
pub const ALL: &[EffectId] = EffectId::VARIANTS;

/// The effect of an id. This match is the only one over all ids: an id without an effect does not compile.
#[must_use]
pub fn of(id: EffectId) -> &'static dyn Effect {
    match id {
        EffectId::OilCompressibility => &oil_compressibility::OilCompressibility,
        EffectId::EntrainedAir => &entrained_air::EntrainedAir,
        EffectId::GasHeatTransfer => &gas_heat_transfer::GasHeatTransfer,
        EffectId::RealGas => &real_gas::RealGas,
        EffectId::GasChargeError => &gas_charge_error::GasChargeError,
        EffectId::SealFriction => &seal_friction::SealFriction,
        EffectId::SideLoadFriction => &side_load_friction::SideLoadFriction,
        EffectId::AccumulatorPistonFriction => &accumulator_piston::AccumulatorPistonFriction,
        EffectId::DamperLeakage => &damper_leakage::DamperLeakage,
        EffectId::LineResistance => &line_resistance::LineResistance,
        EffectId::LineInertance => &line_inertance::LineInertance,
        EffectId::ValveDelay => &valve_delay::ValveDelay,
        EffectId::ValveTransition => &valve_transition::ValveTransition,
        EffectId::Valve3Leakage => &valve3_leakage::Valve3Leakage,
        EffectId::BumpStop => &bump_stop::BumpStop,
        EffectId::MountCompliance => &mount_compliance::MountCompliance,
        EffectId::DampingFade => &damping_fade::DampingFade,
        EffectId::SensorLag => &sensor::LAG,
        EffectId::SensorGain => &sensor::GAIN,
        EffectId::SensorDrift => &sensor::DRIFT,
        EffectId::SensorSkew => &sensor::SKEW,
        EffectId::SensorSign => &sensor::SIGN,
        EffectId::Unlisted => &unlisted::Unlisted,
    }
}

/// The ids of the effects that a strut may have, in the order of the vocabulary.
#[must_use]
pub fn in_struts() -> Vec<EffectId> {
    (ALL.iter().copied())
        .filter(|id| of(*id).in_strut().is_some())
        .collect()
}
