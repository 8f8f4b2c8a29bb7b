//! What swings in time: forces, flows, and values that are believed constant, and readings of the instruments.

use oleo_interface::Valve;
use oleo_plant_sim::strut::LawArgument::Phase;
use oleo_plant_sim::strut::LawPlace;

use super::law::{Law, law};
use crate::effect::unlisted::forms::{SwingingAdded, SwingingFactor};
use crate::effect::unlisted::knots::PHASE_TURNS;
use crate::vocabulary::{Branch, Column, Site};

/// A part of a damper's drop or of a valve's flow that would be visible.
const VISIBLE_PART: f64 = 0.05;
/// A part of a gas pressure that would be visible.
const VISIBLE_PART_OF_GAS: f64 = 0.005;

const fn added(
    label: &'static str,
    site: Site,
    place: LawPlace,
    amplitude: &'static SwingingAdded,
    visible: f64,
) -> Law {
    law(label, site, (place, Phase), amplitude, PHASE_TURNS, visible)
}

const fn factor(label: &'static str, site: Site, place: LawPlace, visible: f64) -> Law {
    law(label, site, (place, Phase), &SwingingFactor, PHASE_TURNS, visible)
}

/// The law of an instrument: its name, its column, its place in the model, and an error that would be visible.
macro_rules! reading_of {
    ($name:literal, $column:literal, $unit:literal, $place:ident, $visible:literal) => {
        added(
            concat!("reading over time, periodic, ", $name),
            Site::Sensor(Column::known($column)),
            LawPlace::$place,
            &SwingingAdded {
                key: concat!("amplitude_", $column),
                unit: $unit,
            },
            $visible,
        )
    };
}

/// A force at the main seal stands for a load cell too that adds it: no recording tells the two apart.
pub(super) const LAWS: &[Law] = &[
    added(
        "force over time, periodic",
        Site::MainSeal,
        LawPlace::MainSeal,
        &SwingingAdded {
            key: "amplitude_N",
            unit: "N",
        },
        20.0,
    ),
    added(
        "friction over time, periodic",
        Site::MainSeal,
        LawPlace::MainSealFriction,
        &SwingingAdded {
            key: "amplitude_N",
            unit: "N",
        },
        20.0,
    ),
    added(
        "flow out of the chamber over time, periodic",
        Site::MainChamber,
        LawPlace::MainChamberLoss,
        &SwingingAdded {
            key: "amplitude_m3_s",
            unit: "m3/s",
        },
        1e-7,
    ),
    factor(
        "strength of pack 1 over time, periodic",
        Site::Path(Branch::First),
        LawPlace::Pack1,
        VISIBLE_PART,
    ),
    factor(
        "strength of pack 2 over time, periodic",
        Site::Path(Branch::Second),
        LawPlace::Pack2,
        VISIBLE_PART,
    ),
    factor(
        "flow of the open valves over time, periodic",
        Site::Valves,
        LawPlace::Valves,
        VISIBLE_PART,
    ),
    factor(
        "flow of open valve 1 over time, periodic",
        Site::Valve(Valve::Bypass1),
        LawPlace::Valve1,
        VISIBLE_PART,
    ),
    factor(
        "flow of open valve 2 over time, periodic",
        Site::Valve(Valve::Bypass2),
        LawPlace::Valve2,
        VISIBLE_PART,
    ),
    factor(
        "flow of open valve 3 over time, periodic",
        Site::Valve(Valve::Spring),
        LawPlace::Valve3,
        VISIBLE_PART,
    ),
    factor(
        "gas pressure over time, periodic, accumulator 1",
        Site::Accumulator(Branch::First),
        LawPlace::Accumulator1,
        VISIBLE_PART_OF_GAS,
    ),
    factor(
        "gas pressure over time, periodic, accumulator 2",
        Site::Accumulator(Branch::Second),
        LawPlace::Accumulator2,
        VISIBLE_PART_OF_GAS,
    ),
    factor(
        "gas pressure over time, periodic, both accumulators",
        Site::Accumulators,
        LawPlace::Accumulators,
        VISIBLE_PART_OF_GAS,
    ),
    reading_of!("displacement", "displacement_m", "m", InstrumentDisplacement, 1e-4),
    reading_of!("p1", "p1_Pa", "Pa", InstrumentP1, 1e4),
    reading_of!("p2", "p2_Pa", "Pa", InstrumentP2, 1e4),
    reading_of!("p3", "p3_Pa", "Pa", InstrumentP3, 1e4),
    reading_of!("p4", "p4_Pa", "Pa", InstrumentP4, 1e4),
];
