//! Laws of the two paths: packs, what is beside them, and lines.

use oleo_plant_sim::strut::LawArgument::{Displacement, Energy, Flow, FlowRate, PressureDrop, Time};
use oleo_plant_sim::strut::LawPlace;

use super::law::{Law, law};
use crate::effect::unlisted::forms::{
    Bell, Factor, Fading, Groove, Power, ProportionalAmount, Rising, SettlingFactor, SettlingLevel,
};
use crate::effect::unlisted::knots::{
    FLOW_FINE_M3_S, FLOW_M3_S, FLOW_RATE_M3_S2, GROOVE_M, PACK_J, PACK_PA, STROKE_M, TIME_S,
};
use crate::vocabulary::{Branch, Site};

pub(super) const LAWS: &[Law] = &[
    law(
        "series drop over flow, path 1",
        Site::Path(Branch::First),
        (LawPlace::Path1, Flow),
        &Rising,
        FLOW_M3_S,
        1e4,
    ),
    law(
        "series drop over flow, path 2",
        Site::Path(Branch::Second),
        (LawPlace::Path2, Flow),
        &Rising,
        FLOW_M3_S,
        1e4,
    ),
    law(
        "series drop over flow, a power, path 1",
        Site::Path(Branch::First),
        (LawPlace::Path1, Flow),
        &Power("drop_at_2_l_s_Pa"),
        FLOW_FINE_M3_S,
        1e4,
    ),
    law(
        "series drop over flow, a power, path 2",
        Site::Path(Branch::Second),
        (LawPlace::Path2, Flow),
        &Power("drop_at_2_l_s_Pa"),
        FLOW_FINE_M3_S,
        1e4,
    ),
    law(
        "flow beside pack 1 over pressure drop",
        Site::Path(Branch::First),
        (LawPlace::BesidePack1, PressureDrop),
        &Rising,
        PACK_PA,
        2e-6,
    ),
    law(
        "flow beside pack 2 over pressure drop",
        Site::Path(Branch::Second),
        (LawPlace::BesidePack2, PressureDrop),
        &Rising,
        PACK_PA,
        2e-6,
    ),
    law(
        "opening beside pack 1 over displacement",
        Site::Path(Branch::First),
        (LawPlace::BesidePack1, Displacement),
        &Bell,
        GROOVE_M,
        1e-7,
    ),
    law(
        "opening beside pack 2 over displacement",
        Site::Path(Branch::Second),
        (LawPlace::BesidePack2, Displacement),
        &Bell,
        GROOVE_M,
        1e-7,
    ),
    law(
        "opening beside pack 1 over displacement, with a bottom",
        Site::Path(Branch::First),
        (LawPlace::BesidePack1, Displacement),
        &Groove,
        GROOVE_M,
        1e-7,
    ),
    law(
        "opening beside pack 2 over displacement, with a bottom",
        Site::Path(Branch::Second),
        (LawPlace::BesidePack2, Displacement),
        &Groove,
        GROOVE_M,
        1e-7,
    ),
    law(
        "strength of pack 1 over displacement",
        Site::Path(Branch::First),
        (LawPlace::Pack1, Displacement),
        &Factor,
        STROKE_M,
        0.05,
    ),
    law(
        "strength of pack 2 over displacement",
        Site::Path(Branch::Second),
        (LawPlace::Pack2, Displacement),
        &Factor,
        STROKE_M,
        0.05,
    ),
    law(
        "opening beside pack 1 over time",
        Site::Path(Branch::First),
        (LawPlace::BesidePack1, Time),
        &SettlingLevel("flow_coefficient_after_a_minute"),
        TIME_S,
        1e-7,
    ),
    law(
        "opening beside pack 2 over time",
        Site::Path(Branch::Second),
        (LawPlace::BesidePack2, Time),
        &SettlingLevel("flow_coefficient_after_a_minute"),
        TIME_S,
        1e-7,
    ),
    law(
        "strength of pack 1 over time",
        Site::Path(Branch::First),
        (LawPlace::Pack1, Time),
        &SettlingFactor,
        TIME_S,
        0.05,
    ),
    law(
        "strength of pack 2 over time",
        Site::Path(Branch::Second),
        (LawPlace::Pack2, Time),
        &SettlingFactor,
        TIME_S,
        0.05,
    ),
    law(
        "strength of pack 1 over the energy lost in it",
        Site::Path(Branch::First),
        (LawPlace::Pack1, Energy),
        &Fading,
        PACK_J,
        2e-5,
    ),
    law(
        "strength of pack 2 over the energy lost in it",
        Site::Path(Branch::Second),
        (LawPlace::Pack2, Energy),
        &Fading,
        PACK_J,
        2e-5,
    ),
    law(
        "series drop over rate of flow, path 2",
        Site::Path(Branch::Second),
        (LawPlace::Path2, FlowRate),
        &ProportionalAmount("inertance_kg_m4"),
        FLOW_RATE_M3_S2,
        1e5,
    ),
];
