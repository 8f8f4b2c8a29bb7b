//! Laws of the instruments: four for each column that is recorded, and a fifth for all but the displacement.

use oleo_plant_sim::strut::LawArgument::{Reading, ReadingChange, ReadingRate, Time};
use oleo_plant_sim::strut::LawPlace;

use super::law::{Law, law};
use crate::effect::unlisted::forms::{Added, Lingering, Proportional, SettlingAdded};
use crate::effect::unlisted::knots::{CHANGE, DRIFT_S, FORCE_N, P1_PA, RATE, TIME_S, TRAVEL_M};
use crate::vocabulary::{Column, Site};

/// A delay that would be visible, s.
const VISIBLE_DELAY_S: f64 = 1e-3;
/// Time over which a drift is as large as an error that would be visible, s.
const DRIFTING_S: f64 = 20.0;
/// Part of a recent change that would be visible.
const VISIBLE_PART: f64 = 0.05;

/// The laws that every instrument can have: its short name, its column, its place in the model, the readings at which a curve has points, and an
/// error that would be visible, in the column's unit.
macro_rules! laws_of {
    ($name:literal, $column:literal, $place:ident, $readings:ident, $visible:literal) => {{
        const SITE: Site = Site::Sensor(Column::known($column));
        [
            law(
                concat!("reading over reading, ", $name),
                SITE,
                (LawPlace::$place, Reading),
                &Added,
                $readings,
                $visible,
            ),
            law(
                concat!("reading over time, ", $name),
                SITE,
                (LawPlace::$place, Time),
                &SettlingAdded(concat!("after_a_minute_", $column)),
                TIME_S,
                $visible,
            ),
            law(
                concat!("reading over its rate, ", $name),
                SITE,
                (LawPlace::$place, ReadingRate),
                &Proportional("late_s"),
                RATE,
                VISIBLE_DELAY_S,
            ),
            law(
                concat!("reading over time, at a constant rate, ", $name),
                SITE,
                (LawPlace::$place, Time),
                &Proportional(concat!("drift_", $column, "_s")),
                DRIFT_S,
                $visible / DRIFTING_S,
            ),
        ]
    }};
}

/// An instrument that remembers: the displacement's cannot, because it is an input.
macro_rules! memory_of {
    ($name:literal, $column:literal, $place:ident) => {
        law(
            concat!("reading over its recent change, ", $name),
            Site::Sensor(Column::known($column)),
            (LawPlace::$place, ReadingChange),
            &Lingering,
            CHANGE,
            VISIBLE_PART,
        )
    };
}

pub(super) const MEMORIES: &[Law] = &[
    memory_of!("force", "force_N", InstrumentForce),
    memory_of!("p1", "p1_Pa", InstrumentP1),
    memory_of!("p2", "p2_Pa", InstrumentP2),
    memory_of!("p3", "p3_Pa", InstrumentP3),
    memory_of!("p4", "p4_Pa", InstrumentP4),
];

pub(super) const LAWS: &[[Law; 4]] = &[
    laws_of!("displacement", "displacement_m", InstrumentDisplacement, TRAVEL_M, 1e-4),
    laws_of!("force", "force_N", InstrumentForce, FORCE_N, 20.0),
    laws_of!("p1", "p1_Pa", InstrumentP1, P1_PA, 1e4),
    laws_of!("p2", "p2_Pa", InstrumentP2, P1_PA, 1e4),
    laws_of!("p3", "p3_Pa", InstrumentP3, P1_PA, 1e4),
    laws_of!("p4", "p4_Pa", InstrumentP4, P1_PA, 1e4),
];
