//! Sensor faults: the reading of a sensor is wrong, and the specimen is not.
//!
//! They are the same for every kind of specimen and are judged before physics is. A file holds what tells one fault from
//! the others; what all have in common is in `fault`.

mod drift;
mod fault;
mod gain;
mod lag;
mod sign;
mod skew;

pub(super) use drift::DRIFT;
pub(super) use gain::GAIN;
pub(super) use lag::LAG;
pub(super) use sign::SIGN;
pub(super) use skew::SKEW;

pub use fault::PRESSURE_OF_GAS_SPRING;

use crate::vocabulary::EffectId;

/// The faults in the order in which a search tries them on each column.
pub const IN_ORDER: [EffectId; 5] = [
    EffectId::SensorLag,
    EffectId::SensorSkew,
    EffectId::SensorGain,
    EffectId::SensorDrift,
    EffectId::SensorSign,
];
