//! Laws of the accumulators: gas, and floating pistons.

use oleo_plant_sim::strut::LawArgument::{RelativeDensity, RelativeEnergy, RelativeVolume, Time, VolumeChange};
use oleo_plant_sim::strut::LawPlace;

use super::law::{Law, law};
use crate::effect::unlisted::forms::{Factor, Heated, RedlichKwong, Relaxing, SettlingFactor, Shearing};
use crate::effect::unlisted::knots::{
    GAS_ENERGY, RELATIVE_DENSITY, RELATIVE_VOLUME, RELATIVE_VOLUME_FINE, TIME_S, VOLUME_CHANGE,
};
use crate::vocabulary::{Branch, Site};

pub(super) const LAWS: &[Law] = &[
    law(
        "gas pressure over volume, accumulator 1",
        Site::Accumulator(Branch::First),
        (LawPlace::Accumulator1, RelativeVolume),
        &Factor,
        RELATIVE_VOLUME,
        0.01,
    ),
    law(
        "gas pressure over volume, accumulator 2",
        Site::Accumulator(Branch::Second),
        (LawPlace::Accumulator2, RelativeVolume),
        &Factor,
        RELATIVE_VOLUME,
        0.01,
    ),
    law(
        "gas pressure over time, accumulator 1",
        Site::Accumulator(Branch::First),
        (LawPlace::Accumulator1, Time),
        &SettlingFactor,
        TIME_S,
        0.01,
    ),
    law(
        "gas pressure over time, accumulator 2",
        Site::Accumulator(Branch::Second),
        (LawPlace::Accumulator2, Time),
        &SettlingFactor,
        TIME_S,
        0.01,
    ),
    law(
        "gas pressure over volume, both accumulators",
        Site::Accumulators,
        (LawPlace::Accumulators, RelativeVolume),
        &Factor,
        RELATIVE_VOLUME,
        0.01,
    ),
    // One gas is in both.
    law(
        "compressibility factor over density, both accumulators",
        Site::Accumulators,
        (LawPlace::Accumulators, RelativeDensity),
        &RedlichKwong,
        RELATIVE_DENSITY,
        0.01,
    ),
    law(
        "gas pressure over time, both accumulators",
        Site::Accumulators,
        (LawPlace::Accumulators, Time),
        &SettlingFactor,
        TIME_S,
        0.01,
    ),
    law(
        "gas pressure over the change of volume, accumulator 1",
        Site::Accumulator(Branch::First),
        (LawPlace::Accumulator1, VolumeChange),
        &Relaxing,
        VOLUME_CHANGE,
        0.01,
    ),
    law(
        "gas pressure over the change of volume, accumulator 2",
        Site::Accumulator(Branch::Second),
        (LawPlace::Accumulator2, VolumeChange),
        &Relaxing,
        VOLUME_CHANGE,
        0.01,
    ),
    law(
        "gas pressure over the change of volume, both accumulators",
        Site::Accumulators,
        (LawPlace::Accumulators, VolumeChange),
        &Relaxing,
        VOLUME_CHANGE,
        0.01,
    ),
    law(
        "gas pressure over the energy of compression, accumulator 1",
        Site::Accumulator(Branch::First),
        (LawPlace::Accumulator1, RelativeEnergy),
        &Heated,
        GAS_ENERGY,
        0.01,
    ),
    law(
        "gas pressure over the energy of compression, accumulator 2",
        Site::Accumulator(Branch::Second),
        (LawPlace::Accumulator2, RelativeEnergy),
        &Heated,
        GAS_ENERGY,
        0.01,
    ),
    law(
        "gas pressure over the energy of compression, both accumulators",
        Site::Accumulators,
        (LawPlace::Accumulators, RelativeEnergy),
        &Heated,
        GAS_ENERGY,
        0.01,
    ),
    law(
        "pressure held back over volume, accumulator 1",
        Site::Accumulator(Branch::First),
        (LawPlace::Accumulator1Friction, RelativeVolume),
        &Shearing,
        RELATIVE_VOLUME_FINE,
        5e3,
    ),
    law(
        "pressure held back over volume, accumulator 2",
        Site::Accumulator(Branch::Second),
        (LawPlace::Accumulator2Friction, RelativeVolume),
        &Shearing,
        RELATIVE_VOLUME_FINE,
        5e3,
    ),
];
