//! The ids of the vocabulary.

use serde::{Deserialize, Serialize};
use strum::{Display, EnumString, IntoStaticStr, VariantArray};

/// An effect of the vocabulary. Its name in files and reports is [`TermId::key`].
///
/// ```
/// use oleo_plant_sim::strut::TermId;
/// assert_eq!(TermId::Valve3Leakage.key(), "valve3_leakage");
/// assert_eq!("damping_fade".parse(), Ok(TermId::DampingFade));
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
    Serialize,
    Deserialize,
    Display,
    EnumString,
    IntoStaticStr,
    VariantArray,
)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum TermId {
    /// Finite bulk modulus of the oil.
    OilCompressibility,
    /// Undissolved air in the oil.
    EntrainedAir,
    /// Heat between the gas and the wall of its accumulator.
    GasHeatTransfer,
    /// Nitrogen departs from the ideal gas law.
    RealGas,
    /// Gas charge outside its tolerance.
    GasChargeError,
    /// Coulomb and Stribeck friction of the rod seal.
    SealFriction,
    /// Friction of the guides that grows with the strut force.
    SideLoadFriction,
    /// Pressure held back by the seals of the floating pistons.
    AccumulatorPistonFriction,
    /// Oil that passes beside a damper pack.
    DamperLeakage,
    /// Laminar loss in series with a path.
    LineResistance,
    /// Mass of the oil column of a line.
    LineInertance,
    /// Valve response that depends on the pressure difference.
    ValveDelay,
    /// Valves that move gradually.
    ValveTransition,
    /// Oil that passes the closed valve 3.
    Valve3Leakage,
    /// Buffers at the ends of travel.
    BumpStop,
    /// The mount yields elastically under the strut force.
    MountCompliance,
    /// Dampers that weaken as they warm.
    DampingFade,
    /// An instrument that lags.
    SensorLag,
    /// An instrument whose scale is wrong.
    SensorGain,
    /// An instrument that drifts.
    SensorDrift,
    /// An instrument whose clock is late.
    SensorSkew,
    /// An instrument with the wrong sign.
    SensorSign,
    /// An instrument with an offset: calibration, never physics.
    SensorOffset,
    /// A law that the vocabulary has no name for.
    Unlisted,
}

impl TermId {
    /// All ids, in the order of the vocabulary.
    pub const ALL: &'static [Self] = Self::VARIANTS;

    /// The id as files and reports write it, for example `oil_compressibility`.
    #[must_use]
    pub fn key(self) -> &'static str {
        self.into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn serde_and_strum_write_the_same_name() {
        for id in TermId::ALL {
            assert_eq!(toml::Value::try_from(id).unwrap().as_str(), Some(id.key()));
            assert_eq!(id.key().parse(), Ok(*id));
            assert_eq!(id.to_string(), id.key());
        }
    }
}
