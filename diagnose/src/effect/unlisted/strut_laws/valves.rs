//! Laws of the valves: what they pass, and when they move.

use oleo_interface::Valve;
use oleo_plant_sim::strut::LawArgument::{PressureDrop, Time};
use oleo_plant_sim::strut::LawPlace;

use super::law::{Law, law};
use crate::effect::unlisted::forms::{
    Added, Choke, Factor, LevelParabola, Parabola, PulledShut, SettlingLevel, Threshold,
};
use crate::effect::unlisted::knots::{EDGE_FINE_PA, EDGE_PA, EDGE_THRESHOLDS_PA, TIME_S, VALVE_PA};
use crate::vocabulary::Site;

pub(super) const LAWS: &[Law] = &[
    law(
        "flow of the open valves over pressure drop",
        Site::Valves,
        (LawPlace::Valves, PressureDrop),
        &PulledShut,
        VALVE_PA,
        1e-8,
    ),
    law(
        "flow of open valve 1 over pressure drop",
        Site::Valve(Valve::Bypass1),
        (LawPlace::Valve1, PressureDrop),
        &PulledShut,
        VALVE_PA,
        1e-8,
    ),
    law(
        "flow of open valve 2 over pressure drop",
        Site::Valve(Valve::Bypass2),
        (LawPlace::Valve2, PressureDrop),
        &PulledShut,
        VALVE_PA,
        1e-8,
    ),
    law(
        "flow of open valve 3 over pressure drop",
        Site::Valve(Valve::Spring),
        (LawPlace::Valve3, PressureDrop),
        &PulledShut,
        VALVE_PA,
        1e-8,
    ),
    law(
        "flow of the open valves over pressure drop, up to a largest one",
        Site::Valves,
        (LawPlace::Valves, PressureDrop),
        &Choke,
        VALVE_PA,
        1e-8,
    ),
    law(
        "flow of open valve 1 over pressure drop, up to a largest one",
        Site::Valve(Valve::Bypass1),
        (LawPlace::Valve1, PressureDrop),
        &Choke,
        VALVE_PA,
        1e-8,
    ),
    law(
        "flow of open valve 2 over pressure drop, up to a largest one",
        Site::Valve(Valve::Bypass2),
        (LawPlace::Valve2, PressureDrop),
        &Choke,
        VALVE_PA,
        1e-8,
    ),
    law(
        "flow of open valve 3 over pressure drop, up to a largest one",
        Site::Valve(Valve::Spring),
        (LawPlace::Valve3, PressureDrop),
        &Choke,
        VALVE_PA,
        1e-8,
    ),
    law(
        "opening beside valve 3 over time",
        Site::Valve(Valve::Spring),
        (LawPlace::BesideValve3, Time),
        &SettlingLevel("flow_coefficient_after_a_minute"),
        TIME_S,
        1e-9,
    ),
    law(
        "response time over pressure drop",
        Site::Valves,
        (LawPlace::ValveTiming, PressureDrop),
        &Added,
        EDGE_PA,
        2e-3,
    ),
    law(
        "response time over pressure drop, a parabola",
        Site::Valves,
        (LawPlace::ValveTiming, PressureDrop),
        &Parabola(["at_rest_s", "slope_s_Pa", "curvature_s_Pa2"]),
        EDGE_FINE_PA,
        2e-3,
    ),
    law(
        "response time over pressure drop, beyond a threshold",
        Site::Valves,
        (LawPlace::ValveTiming, PressureDrop),
        &Threshold {
            slope: "slope_s_Pa",
            threshold: "threshold_Pa",
            any_sign: true,
        },
        EDGE_THRESHOLDS_PA,
        2e-3,
    ),
    law(
        "duration of the movement over pressure drop",
        Site::Valves,
        (LawPlace::ValveMovement, PressureDrop),
        // As the response time goes with the pressure, so does the time that a part of it takes.
        &LevelParabola(["at_rest_s", "slope_s_Pa", "curvature_s_Pa2"]),
        EDGE_FINE_PA,
        2e-3,
    ),
];

/// What an open valve passes as a table, of which there is none of few points by which its place would be found.
pub(super) const TABLES: &[Law] = &[
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
];
