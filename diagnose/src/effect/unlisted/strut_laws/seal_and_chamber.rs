//! Laws of the main seal and the main chamber.

use oleo_plant_sim::strut::LawArgument::{Acceleration, Displacement, P1, Speed, Time};
use oleo_plant_sim::strut::LawPlace;

use super::law::{Law, law};
use crate::effect::unlisted::forms::{
    Added, Level, Power, Proportional, Ramp, Rising, Saturating, SettlingAdded, SettlingLevel, Stiffening, Stops,
    ThresholdAdded, ThresholdLevel,
};
use crate::effect::unlisted::knots::{
    ACCELERATION_M_S2, CHAMBER_FINE_PA, CHAMBER_PA, P1_PA, P1_THRESHOLDS_PA, SPEED_FINE_M_S, SPEED_M_S, STOPS_M,
    TIME_S, TRAVEL_M,
};
use crate::vocabulary::Site;

pub(super) const LAWS: &[Law] = &[
    law(
        "force over displacement",
        Site::MainSeal,
        (LawPlace::MainSeal, Displacement),
        &Added,
        TRAVEL_M,
        20.0,
    ),
    law(
        "force over speed",
        Site::MainSeal,
        (LawPlace::MainSeal, Speed),
        &Added,
        SPEED_M_S,
        20.0,
    ),
    law(
        "force over displacement, stiffening",
        Site::MainSeal,
        (LawPlace::MainSeal, Displacement),
        &Stiffening,
        STOPS_M,
        20.0,
    ),
    law(
        "force over speed, a power",
        Site::MainSeal,
        (LawPlace::MainSeal, Speed),
        &Power("force_at_1_m_s_N"),
        SPEED_FINE_M_S,
        20.0,
    ),
    law(
        "force over pressure",
        Site::MainSeal,
        (LawPlace::MainSeal, P1),
        &Added,
        P1_PA,
        20.0,
    ),
    law(
        "friction over displacement",
        Site::MainSeal,
        (LawPlace::MainSealFriction, Displacement),
        &Level,
        TRAVEL_M,
        20.0,
    ),
    law(
        "friction over speed",
        Site::MainSeal,
        (LawPlace::MainSealFriction, Speed),
        &Level,
        SPEED_M_S,
        20.0,
    ),
    law(
        "friction over pressure",
        Site::MainSeal,
        (LawPlace::MainSealFriction, P1),
        &Level,
        P1_PA,
        20.0,
    ),
    law(
        "volume over pressure",
        Site::MainChamber,
        (LawPlace::MainChamber, P1),
        &Rising,
        CHAMBER_PA,
        5e-8,
    ),
    law(
        "volume over pressure, up to an end",
        Site::MainChamber,
        (LawPlace::MainChamber, P1),
        &Saturating("end_volume_m3", "half_at_Pa"),
        CHAMBER_FINE_PA,
        5e-8,
    ),
    law(
        "force over displacement, beyond a threshold",
        Site::EndStop,
        (LawPlace::MainSeal, Displacement),
        &Stops,
        STOPS_M,
        20.0,
    ),
    law(
        "oil lost over pressure",
        Site::MainChamber,
        (LawPlace::MainChamberLoss, P1),
        &Level,
        P1_PA,
        1e-9,
    ),
    law(
        "force over acceleration",
        Site::MainSeal,
        (LawPlace::MainSeal, Acceleration),
        &Proportional("moving_mass_kg"),
        ACCELERATION_M_S2,
        2.0,
    ),
    law(
        "force over time",
        Site::MainSeal,
        (LawPlace::MainSeal, Time),
        &SettlingAdded("force_after_a_minute_N"),
        TIME_S,
        20.0,
    ),
    law(
        "friction over time",
        Site::MainSeal,
        (LawPlace::MainSealFriction, Time),
        &SettlingLevel("friction_after_a_minute_N"),
        TIME_S,
        20.0,
    ),
    law(
        "oil lost over time",
        Site::MainChamber,
        (LawPlace::MainChamberLoss, Time),
        &SettlingLevel("flow_after_a_minute_m3_s"),
        TIME_S,
        1e-9,
    ),
    law(
        "oil lost over time, growing and then constant",
        Site::MainChamber,
        (LawPlace::MainChamberLoss, Time),
        &Ramp("flow_after_a_minute_m3_s"),
        TIME_S,
        1e-9,
    ),
    law(
        "force over pressure, beyond a threshold",
        Site::MainSeal,
        (LawPlace::MainSeal, P1),
        &ThresholdAdded {
            slope: "per_Pa_N",
            threshold: "threshold_Pa",
        },
        P1_THRESHOLDS_PA,
        20.0,
    ),
    law(
        "friction over pressure, beyond a threshold",
        Site::MainSeal,
        (LawPlace::MainSealFriction, P1),
        &ThresholdLevel {
            slope: "per_Pa_N",
            threshold: "threshold_Pa",
        },
        P1_THRESHOLDS_PA,
        20.0,
    ),
    law(
        "volume over pressure, beyond a threshold",
        Site::MainChamber,
        (LawPlace::MainChamber, P1),
        &ThresholdLevel {
            slope: "per_Pa_m3",
            threshold: "threshold_Pa",
        },
        P1_THRESHOLDS_PA,
        5e-8,
    ),
    law(
        "oil lost over pressure, beyond a threshold",
        Site::MainChamber,
        (LawPlace::MainChamberLoss, P1),
        &ThresholdLevel {
            slope: "per_Pa_m3_s",
            threshold: "threshold_Pa",
        },
        P1_THRESHOLDS_PA,
        1e-9,
    ),
];
