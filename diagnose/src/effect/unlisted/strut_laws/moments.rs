//! Changes at a moment: what breaks, lodges, opens or runs dry while it is recorded. Their many starts are tried only when nothing else joins a model.

use oleo_interface::Valve;
use oleo_plant_sim::strut::LawArgument::Time;
use oleo_plant_sim::strut::LawPlace;

use super::law::{Law, law};
use crate::effect::unlisted::forms::Onset;
use crate::effect::unlisted::knots::TIME_S;
use crate::vocabulary::{Branch, Column, Site};

/// The changes of a strut and those of its instruments.
pub(super) fn laws() -> impl Iterator<Item = &'static Law> {
    LAWS.iter().chain(READINGS)
}

const LAWS: &[Law] = &[
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
        "oil lost over time, from a moment on",
        Site::MainChamber,
        (LawPlace::MainChamberLoss, Time),
        &Onset::Level("flow_in_the_end_m3_s"),
        TIME_S,
        1e-9,
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
        "strength of pack 1 over time, from a moment on",
        Site::Path(Branch::First),
        (LawPlace::Pack1, Time),
        &Onset::Factor,
        TIME_S,
        0.05,
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
        "strength of pack 2 over time, from a moment on",
        Site::Path(Branch::Second),
        (LawPlace::Pack2, Time),
        &Onset::Factor,
        TIME_S,
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
        "gas pressure over time, from a moment on, accumulator 1",
        Site::Accumulator(Branch::First),
        (LawPlace::Accumulator1, Time),
        &Onset::Factor,
        TIME_S,
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
        "gas pressure over time, from a moment on, both accumulators",
        Site::Accumulators,
        (LawPlace::Accumulators, Time),
        &Onset::Factor,
        TIME_S,
        0.01,
    ),
];

/// An instrument that is knocked: its short name, its column, its place in the model, and an error that would be visible.
macro_rules! reading_of {
    ($name:literal, $column:literal, $place:ident, $visible:literal) => {
        law(
            concat!("reading over time, from a moment on, ", $name),
            Site::Sensor(Column::known($column)),
            (LawPlace::$place, Time),
            &Onset::Added(concat!("in_the_end_", $column)),
            TIME_S,
            $visible,
        )
    };
}

const READINGS: &[Law] = &[
    reading_of!("displacement", "displacement_m", InstrumentDisplacement, 1e-4),
    reading_of!("force", "force_N", InstrumentForce, 20.0),
    reading_of!("p1", "p1_Pa", InstrumentP1, 1e4),
    reading_of!("p2", "p2_Pa", InstrumentP2, 1e4),
    reading_of!("p3", "p3_Pa", InstrumentP3, 1e4),
    reading_of!("p4", "p4_Pa", InstrumentP4, 1e4),
];
