//! Tables in fine steps, which are fitted only in the place of an effect that is there and leaves much behind.
//!
//! A table that is screened has few points, so that what has a kink, a spot or a step between them is found at its place and leaves a misfit. A table of
//! all these points would be screened slowly, and in vain where nothing of its kind is missing.

use oleo_interface::Valve;
use oleo_plant_sim::strut::LawArgument::{
    Displacement, Energy, Flow, Force, P1, PressureDrop, Reading, ReadingChange, RelativeVolume, Speed, VolumeChange,
};
use oleo_plant_sim::strut::LawPlace;

use super::law::{Law, law};
use crate::effect::unlisted::forms::{Added, Factor, Level, Rising, WithMemory, WithPresliding};
use crate::effect::unlisted::knots::{GROOVE_M, fine};
use crate::vocabulary::{Branch, Column, Site};

/// The tables of a strut and those of its instruments.
pub(super) fn laws() -> impl Iterator<Item = &'static Law> {
    LAWS.iter().chain(READINGS).chain(MEMORIES)
}

const LAWS: &[Law] = &[
    law(
        "force over displacement, in fine steps",
        Site::MainSeal,
        (LawPlace::MainSeal, Displacement),
        &Added,
        GROOVE_M,
        20.0,
    ),
    law(
        "force over speed, in fine steps",
        Site::MainSeal,
        (LawPlace::MainSeal, Speed),
        &Added,
        fine::SPEED_M_S,
        20.0,
    ),
    law(
        "force over pressure, in fine steps",
        Site::MainSeal,
        (LawPlace::MainSeal, P1),
        &Added,
        fine::PRESSURE_PA,
        20.0,
    ),
    law(
        "friction over displacement, in fine steps",
        Site::MainSeal,
        (LawPlace::MainSealFriction, Displacement),
        &Level,
        GROOVE_M,
        20.0,
    ),
    law(
        "friction over speed, in fine steps",
        Site::MainSeal,
        (LawPlace::MainSealFriction, Speed),
        &Level,
        fine::SPEED_M_S,
        20.0,
    ),
    law(
        "friction over pressure, in fine steps",
        Site::MainSeal,
        (LawPlace::MainSealFriction, P1),
        &Level,
        fine::PRESSURE_PA,
        20.0,
    ),
    law(
        "volume over pressure, in fine steps",
        Site::MainChamber,
        (LawPlace::MainChamber, P1),
        &Rising,
        fine::PRESSURE_PA,
        5e-8,
    ),
    law(
        "oil lost over pressure, in fine steps",
        Site::MainChamber,
        (LawPlace::MainChamberLoss, P1),
        &Level,
        fine::PRESSURE_PA,
        1e-9,
    ),
    law(
        "deflection over force, in fine steps",
        Site::Mount,
        (LawPlace::Mount, Force),
        &Rising,
        fine::MOUNT_N,
        2e-5,
    ),
    law(
        "series drop over flow, in fine steps, path 1",
        Site::Path(Branch::First),
        (LawPlace::Path1, Flow),
        &Rising,
        fine::FLOW_M3_S,
        1e4,
    ),
    law(
        "flow beside pack 1 over pressure drop, in fine steps",
        Site::Path(Branch::First),
        (LawPlace::BesidePack1, PressureDrop),
        &Rising,
        fine::PACK_PA,
        2e-6,
    ),
    law(
        "opening beside pack 1 over displacement, in fine steps",
        Site::Path(Branch::First),
        (LawPlace::BesidePack1, Displacement),
        &Level,
        GROOVE_M,
        1e-7,
    ),
    law(
        "strength of pack 1 over displacement, in fine steps",
        Site::Path(Branch::First),
        (LawPlace::Pack1, Displacement),
        &Factor,
        GROOVE_M,
        0.05,
    ),
    law(
        "strength of pack 1 over the energy lost in it, in fine steps",
        Site::Path(Branch::First),
        (LawPlace::Pack1, Energy),
        &WithMemory(Factor),
        fine::PACK_J,
        0.05,
    ),
    law(
        "series drop over flow, in fine steps, path 2",
        Site::Path(Branch::Second),
        (LawPlace::Path2, Flow),
        &Rising,
        fine::FLOW_M3_S,
        1e4,
    ),
    law(
        "flow beside pack 2 over pressure drop, in fine steps",
        Site::Path(Branch::Second),
        (LawPlace::BesidePack2, PressureDrop),
        &Rising,
        fine::PACK_PA,
        2e-6,
    ),
    law(
        "opening beside pack 2 over displacement, in fine steps",
        Site::Path(Branch::Second),
        (LawPlace::BesidePack2, Displacement),
        &Level,
        GROOVE_M,
        1e-7,
    ),
    law(
        "strength of pack 2 over displacement, in fine steps",
        Site::Path(Branch::Second),
        (LawPlace::Pack2, Displacement),
        &Factor,
        GROOVE_M,
        0.05,
    ),
    law(
        "strength of pack 2 over the energy lost in it, in fine steps",
        Site::Path(Branch::Second),
        (LawPlace::Pack2, Energy),
        &WithMemory(Factor),
        fine::PACK_J,
        0.05,
    ),
    law(
        "opening beside valve 3 over displacement, in fine steps",
        Site::Valve(Valve::Spring),
        (LawPlace::BesideValve3, Displacement),
        &Level,
        GROOVE_M,
        1e-9,
    ),
    law(
        "response time over pressure drop, in fine steps",
        Site::Valves,
        (LawPlace::ValveTiming, PressureDrop),
        &Added,
        fine::EDGE_PA,
        2e-3,
    ),
    law(
        "gas pressure over volume, in fine steps, accumulator 1",
        Site::Accumulator(Branch::First),
        (LawPlace::Accumulator1, RelativeVolume),
        &Factor,
        fine::RELATIVE_VOLUME,
        0.01,
    ),
    law(
        "gas pressure over the change of volume, in fine steps, accumulator 1",
        Site::Accumulator(Branch::First),
        (LawPlace::Accumulator1, VolumeChange),
        &WithMemory(Factor),
        fine::VOLUME_CHANGE,
        0.01,
    ),
    law(
        "gas pressure over volume, in fine steps, accumulator 2",
        Site::Accumulator(Branch::Second),
        (LawPlace::Accumulator2, RelativeVolume),
        &Factor,
        fine::RELATIVE_VOLUME,
        0.01,
    ),
    law(
        "gas pressure over the change of volume, in fine steps, accumulator 2",
        Site::Accumulator(Branch::Second),
        (LawPlace::Accumulator2, VolumeChange),
        &WithMemory(Factor),
        fine::VOLUME_CHANGE,
        0.01,
    ),
    law(
        "gas pressure over volume, in fine steps, both accumulators",
        Site::Accumulators,
        (LawPlace::Accumulators, RelativeVolume),
        &Factor,
        fine::RELATIVE_VOLUME,
        0.01,
    ),
    law(
        "gas pressure over the change of volume, in fine steps, both accumulators",
        Site::Accumulators,
        (LawPlace::Accumulators, VolumeChange),
        &WithMemory(Factor),
        fine::VOLUME_CHANGE,
        0.01,
    ),
    law(
        "pressure held back over volume, in fine steps, accumulator 1",
        Site::Accumulator(Branch::First),
        (LawPlace::Accumulator1Friction, RelativeVolume),
        &WithPresliding,
        fine::RELATIVE_VOLUME,
        5e3,
    ),
    law(
        "pressure held back over volume, in fine steps, accumulator 2",
        Site::Accumulator(Branch::Second),
        (LawPlace::Accumulator2Friction, RelativeVolume),
        &WithPresliding,
        fine::RELATIVE_VOLUME,
        5e3,
    ),
];

/// What an instrument reads wrongly: its short name, its column, its place in the model, the readings of its curve, and an error that would be visible.
macro_rules! reading_of {
    ($name:literal, $column:literal, $place:ident, $readings:expr, $visible:literal) => {
        law(
            concat!("reading over reading, in fine steps, ", $name),
            Site::Sensor(Column::known($column)),
            (LawPlace::$place, Reading),
            &Added,
            $readings,
            $visible,
        )
    };
}

const READINGS: &[Law] = &[
    reading_of!("displacement", "displacement_m", InstrumentDisplacement, GROOVE_M, 1e-4),
    reading_of!("force", "force_N", InstrumentForce, fine::FORCE_N, 20.0),
    reading_of!("p1", "p1_Pa", InstrumentP1, fine::PRESSURE_PA, 1e4),
    reading_of!("p2", "p2_Pa", InstrumentP2, fine::PRESSURE_PA, 1e4),
    reading_of!("p3", "p3_Pa", InstrumentP3, fine::PRESSURE_PA, 1e4),
    reading_of!("p4", "p4_Pa", InstrumentP4, fine::PRESSURE_PA, 1e4),
];

/// An instrument that remembers.
macro_rules! memory_of {
    ($name:literal, $column:literal, $place:ident, $changes:expr, $visible:literal) => {
        law(
            concat!("reading over its recent change, in fine steps, ", $name),
            Site::Sensor(Column::known($column)),
            (LawPlace::$place, ReadingChange),
            &WithMemory(Added),
            $changes,
            $visible,
        )
    };
}

const MEMORIES: &[Law] = &[
    memory_of!("force", "force_N", InstrumentForce, fine::FORCE_CHANGE_N, 20.0),
    memory_of!("p1", "p1_Pa", InstrumentP1, fine::PRESSURE_CHANGE_PA, 1e4),
    memory_of!("p2", "p2_Pa", InstrumentP2, fine::PRESSURE_CHANGE_PA, 1e4),
    memory_of!("p3", "p3_Pa", InstrumentP3, fine::PRESSURE_CHANGE_PA, 1e4),
    memory_of!("p4", "p4_Pa", InstrumentP4, fine::PRESSURE_CHANGE_PA, 1e4),
];
