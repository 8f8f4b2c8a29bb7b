//! Ids of effects.

use serde::{Deserialize, Serialize};
use strum::{Display, EnumString, IntoStaticStr, VariantArray};

/// The id of an effect: a physical law that a model may lack, or a fault of an instrument.
///
/// The texts are those of the vocabulary in the recordings' README.
///
/// ```
/// use oleo_diagnose::vocabulary::EffectId;
///
/// let id: EffectId = "gas_heat_transfer".parse()?;
/// assert_eq!(id, EffectId::GasHeatTransfer);
/// assert_eq!(id.to_string(), "gas_heat_transfer");
/// # Ok::<(), strum::ParseError>(())
/// ```
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    Hash,
    Display,
    EnumString,
    IntoStaticStr,
    VariantArray,
    Serialize,
    Deserialize,
)]
#[strum(serialize_all = "snake_case")]
#[serde(rename_all = "snake_case")]
pub enum EffectId {
    /// The oil of the main chamber has a finite bulk modulus.
    OilCompressibility,
    /// Undissolved air in the oil lowers its bulk modulus at low pressure.
    EntrainedAir,
    /// The gas exchanges heat with its wall: neither isothermal nor adiabatic.
    GasHeatTransfer,
    /// Nitrogen departs from the ideal gas law.
    RealGas,
    /// The gas charge is outside its tolerance.
    GasChargeError,
    /// Coulomb and Stribeck friction of the rod seal.
    SealFriction,
    /// Friction that grows with the force of the strut or the pressure of the cylinder.
    SideLoadFriction,
    /// Pressure held back by the seal of a floating piston.
    AccumulatorPistonFriction,
    /// Oil that passes beside the damper pack.
    DamperLeakage,
    /// Further viscous loss in series with a damper.
    LineResistance,
    /// Inertia of the oil column in a line.
    LineInertance,
    /// The response time of the valves depends on the pressure difference.
    ValveDelay,
    /// The valves open gradually instead of in a step.
    ValveTransition,
    /// The closed valve 3 passes oil.
    #[strum(serialize = "valve3_leakage")]
    #[serde(rename = "valve3_leakage")]
    Valve3Leakage,
    /// Contact near an end of travel.
    BumpStop,
    /// The mount gives way, so the strut moves less than the actuator.
    MountCompliance,
    /// The dampers weaken as their oil warms.
    DampingFade,
    /// Dry friction of constant size in a damper or a drive.
    CoulombFriction,
    /// Dry friction that falls with speed.
    StribeckFriction,
    /// Hysteresis of dry friction over displacement before it slides.
    PreslidingFriction,
    /// A resisting force that saturates with speed.
    SmoothYield,
    /// A constant force.
    ForceOffset,
    /// A linear spring in parallel.
    Stiffness,
    /// A gas spring in parallel.
    GasSpring,
    /// A gap in a joint.
    Backlash,
    /// A moving mass that the model does not have.
    Inertia,
    /// The instrument follows with a first-order lag.
    SensorLag,
    /// The gain of the instrument is wrong.
    SensorGain,
    /// The instrument drifts in proportion to time.
    SensorDrift,
    /// The instrument's clock is late or early.
    SensorSkew,
    /// The instrument has the wrong sign.
    SensorSign,
    /// A law that no other id names.
    Unlisted,
}

impl EffectId {
    /// True for a fault of an instrument: what it shows is wrong, the specimen is not.
    #[must_use]
    pub const fn is_instrument_fault(self) -> bool {
        matches!(
            self,
            Self::SensorLag | Self::SensorGain | Self::SensorDrift | Self::SensorSkew | Self::SensorSign
        )
    }

    /// True for physics that the vocabulary has a name for.
    #[must_use]
    pub fn is_physics(self) -> bool {
        self != Self::Unlisted && !self.is_instrument_fault()
    }

    /// The text of the id.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        self.into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_read_back_and_are_the_same_for_serde() {
        for &id in EffectId::VARIANTS {
            assert_eq!(id.as_str().parse(), Ok(id));
            assert_eq!(serde_json::to_value(id).ok(), Some(id.as_str().into()));
            assert_eq!(id.is_instrument_fault(), id.as_str().starts_with("sensor_"));
        }
    }

    #[test]
    fn the_vocabulary_of_the_recordings_is_there() {
        for text in [
            "oil_compressibility",
            "entrained_air",
            "gas_heat_transfer",
            "real_gas",
            "gas_charge_error",
            "seal_friction",
            "side_load_friction",
            "accumulator_piston_friction",
            "damper_leakage",
            "line_resistance",
            "line_inertance",
            "valve_delay",
            "valve_transition",
            "valve3_leakage",
            "bump_stop",
            "mount_compliance",
            "damping_fade",
            "coulomb_friction",
            "stribeck_friction",
            "presliding_friction",
            "smooth_yield",
            "force_offset",
            "stiffness",
            "gas_spring",
            "backlash",
            "inertia",
            "sensor_lag",
            "sensor_gain",
            "sensor_drift",
            "sensor_skew",
            "sensor_sign",
            "unlisted",
        ] {
            assert!(text.parse::<EffectId>().is_ok(), "{text}");
        }
    }
}
