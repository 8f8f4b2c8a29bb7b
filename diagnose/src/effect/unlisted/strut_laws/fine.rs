//! Laws that are fitted only in the place of an effect that is there and leaves much behind: tables in fine steps, and changes at a moment.
//!
//! A table that is screened has few points, so that what has a kink, a spot or a step between them is found at its place and leaves a misfit. A table of
//! all these points would be screened slowly and in vain where nothing of its kind is missing.

use oleo_interface::Valve;
use oleo_plant_sim::strut::LawArgument::{
    Displacement, Energy, Flow, Force, P1, PressureDrop, Reading, ReadingChange, RelativeVolume, Speed, Time,
    VolumeChange,
};
use oleo_plant_sim::strut::LawPlace;

use super::law::{Law, law};
use crate::effect::candidate::Joins;
use crate::effect::unlisted::forms::{Added, Factor, Level, Onset, Rising, WithMemory, WithPresliding};
use crate::effect::unlisted::knots::{GROOVE_M, TIME_S, VALVE_PA, fine};
use crate::vocabulary::{Branch, Column, Site};

/// The laws of a strut and those of its instruments.
pub(super) fn laws() -> impl Iterator<Item = &'static Law> {
    (LAWS.iter()).chain(INSTRUMENTS.iter().flatten()).chain(MEMORIES)
}

/// When a law joins a model. Changes at a moment and the flow of a valve have no table of few points by which their place is found.
pub(super) fn joins(law: &Law) -> Joins {
    let of_open_valve = matches!(
        law.place,
        LawPlace::Valve1 | LawPlace::Valve2 | LawPlace::Valve3 | LawPlace::Valves
    );
    if law.depends_on == Time || of_open_valve {
        Joins::AtLast
    } else {
        Joins::InPlace
    }
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
        "force over time, from a moment on",
        Site::MainSeal,
        (LawPlace::MainSeal, Time),
        &Onset::Added("force_in_the_end_N"),
        TIME_S,
        20.0,
    ),
    law(
        "friction over time, from a moment on",
        Site::MainSeal,
        (LawPlace::MainSealFriction, Time),
        &Onset::Level("friction_in_the_end_N"),
        TIME_S,
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
        "oil lost over time, from a moment on",
        Site::MainChamber,
        (LawPlace::MainChamberLoss, Time),
        &Onset::Level("flow_in_the_end_m3_s"),
        TIME_S,
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
        "opening beside pack 1 over time, from a moment on",
        Site::Path(Branch::First),
        (LawPlace::BesidePack1, Time),
        &Onset::Level("flow_coefficient_in_the_end"),
        TIME_S,
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
        "strength of pack 1 over time, from a moment on",
        Site::Path(Branch::First),
        (LawPlace::Pack1, Time),
        &Onset::Factor,
        TIME_S,
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
        "opening beside pack 2 over time, from a moment on",
        Site::Path(Branch::Second),
        (LawPlace::BesidePack2, Time),
        &Onset::Level("flow_coefficient_in_the_end"),
        TIME_S,
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
        "strength of pack 2 over time, from a moment on",
        Site::Path(Branch::Second),
        (LawPlace::Pack2, Time),
        &Onset::Factor,
        TIME_S,
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
        "flow of open valve 1 over pressure drop, in fine steps",
        Site::Valve(Valve::Bypass1),
        (LawPlace::Valve1, PressureDrop),
        &Factor,
        VALVE_PA,
        0.05,
    ),
    law(
        "flow of open valve 2 over pressure drop, in fine steps",
        Site::Valve(Valve::Bypass2),
        (LawPlace::Valve2, PressureDrop),
        &Factor,
        VALVE_PA,
        0.05,
    ),
    law(
        "flow of open valve 3 over pressure drop, in fine steps",
        Site::Valve(Valve::Spring),
        (LawPlace::Valve3, PressureDrop),
        &Factor,
        VALVE_PA,
        0.05,
    ),
    law(
        "flow of the open valves over pressure drop, in fine steps",
        Site::Valves,
        (LawPlace::Valves, PressureDrop),
        &Factor,
        VALVE_PA,
        0.05,
    ),
    law(
        "opening beside valve 3 over time, from a moment on",
        Site::Valve(Valve::Spring),
        (LawPlace::BesideValve3, Time),
        &Onset::Level("flow_coefficient_in_the_end"),
        TIME_S,
        1e-9,
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
        "gas pressure over time, from a moment on, accumulator 1",
        Site::Accumulator(Branch::First),
        (LawPlace::Accumulator1, Time),
        &Onset::Factor,
        TIME_S,
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
        "gas pressure over time, from a moment on, accumulator 2",
        Site::Accumulator(Branch::Second),
        (LawPlace::Accumulator2, Time),
        &Onset::Factor,
        TIME_S,
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
        "gas pressure over time, from a moment on, both accumulators",
        Site::Accumulators,
        (LawPlace::Accumulators, Time),
        &Onset::Factor,
        TIME_S,
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

/// What every instrument can have: its short name, its column, its place in the model, the readings of its curve, and an error that would be visible.
macro_rules! laws_of {
    ($name:literal, $column:literal, $place:ident, $readings:expr, $visible:literal) => {{
        const SITE: Site = Site::Sensor(Column::known($column));
        [
            law(
                concat!("reading over reading, in fine steps, ", $name),
                SITE,
                (LawPlace::$place, Reading),
                &Added,
                $readings,
                $visible,
            ),
            law(
                concat!("reading over time, from a moment on, ", $name),
                SITE,
                (LawPlace::$place, Time),
                &Onset::Added(concat!("in_the_end_", $column)),
                TIME_S,
                $visible,
            ),
        ]
    }};
}

const INSTRUMENTS: &[[Law; 2]] = &[
    laws_of!("displacement", "displacement_m", InstrumentDisplacement, GROOVE_M, 1e-4),
    laws_of!("force", "force_N", InstrumentForce, fine::FORCE_N, 20.0),
    laws_of!("p1", "p1_Pa", InstrumentP1, fine::PRESSURE_PA, 1e4),
    laws_of!("p2", "p2_Pa", InstrumentP2, fine::PRESSURE_PA, 1e4),
    laws_of!("p3", "p3_Pa", InstrumentP3, fine::PRESSURE_PA, 1e4),
    laws_of!("p4", "p4_Pa", InstrumentP4, fine::PRESSURE_PA, 1e4),
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
