//! The laws that are tried on a strut, as a table of place, dependence and form.
//!
//! A new row is a new law to search for; a new dependence or place is one of plant-sim's ([`LawArgument`], [`LawPlace`]).

use oleo_interface::Valve;
use oleo_plant_sim::strut::LawArgument::{
    Acceleration, Displacement, Flow, FlowRate, P1, PressureDrop, Reading, ReadingRate, RelativeVolume, Speed, Time,
    VolumeChange,
};
use oleo_plant_sim::strut::{LawArgument, LawPlace, UnlistedLaw};

use super::forms::{
    Added, Bell, Choke, Factor, Form, Grid, Level, Proportional, ProportionalAmount, Relaxing, Rising, SettlingAdded,
    SettlingFactor, SettlingLevel,
};
use super::knots::{
    ACCELERATION_M_S2, CHAMBER_PA, EDGE_PA, FEW_EDGES_PA, FLOW_M3_S, FLOW_RATE_M3_S2, FORCE_N, GROOVE_M, P1_PA,
    PACK_PA, RATE, RELATIVE_VOLUME, SPEED_M_S, STROKE_M, TIME_S, TRAVEL_M, VALVE_PA, VOLUME_CHANGE,
};
use crate::effect::candidate::Candidate;
use crate::vocabulary::{Branch, Column, EffectId, Site};

/// One law that is searched for.
struct Law {
    /// What it relates, for people: "force over speed".
    label: &'static str,
    /// Place at which the law is reported.
    site: Site,
    /// Where it acts in the model.
    place: LawPlace,
    /// Quantity on which the law depends.
    depends_on: LawArgument,
    /// How its table comes from fitted numbers.
    form: &'static dyn Form,
    /// Values of the argument at which the table has points.
    knots: &'static [f64],
    /// Size of one fitted number that would be visible.
    visible: f64,
}

const fn law(
    label: &'static str,
    site: Site,
    (place, depends_on): (LawPlace, LawArgument),
    form: &'static dyn Form,
    knots: &'static [f64],
    visible: f64,
) -> Law {
    Law {
        label,
        site,
        place,
        depends_on,
        form,
        knots,
        visible,
    }
}

const LAWS: &[Law] = &[
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
        "oil lost over pressure",
        Site::MainChamber,
        (LawPlace::MainChamberLoss, P1),
        &Level,
        P1_PA,
        1e-9,
    ),
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
        "flow of the open valves over pressure drop",
        Site::Valves,
        (LawPlace::Valves, PressureDrop),
        &Choke,
        VALVE_PA,
        1e-8,
    ),
    law(
        "flow of open valve 1 over pressure drop",
        Site::Valve(Valve::Bypass1),
        (LawPlace::Valve1, PressureDrop),
        &Choke,
        VALVE_PA,
        1e-8,
    ),
    law(
        "flow of open valve 2 over pressure drop",
        Site::Valve(Valve::Bypass2),
        (LawPlace::Valve2, PressureDrop),
        &Choke,
        VALVE_PA,
        1e-8,
    ),
    law(
        "flow of open valve 3 over pressure drop",
        Site::Valve(Valve::Spring),
        (LawPlace::Valve3, PressureDrop),
        &Choke,
        VALVE_PA,
        1e-8,
    ),
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
        &SettlingAdded("end_force_N"),
        TIME_S,
        20.0,
    ),
    law(
        "friction over time",
        Site::MainSeal,
        (LawPlace::MainSealFriction, Time),
        &SettlingLevel("end_friction_N"),
        TIME_S,
        20.0,
    ),
    law(
        "oil lost over time",
        Site::MainChamber,
        (LawPlace::MainChamberLoss, Time),
        &SettlingLevel("end_flow_m3_s"),
        TIME_S,
        1e-9,
    ),
    law(
        "opening beside pack 1 over time",
        Site::Path(Branch::First),
        (LawPlace::BesidePack1, Time),
        &SettlingLevel("end_flow_coefficient"),
        TIME_S,
        1e-7,
    ),
    law(
        "opening beside pack 2 over time",
        Site::Path(Branch::Second),
        (LawPlace::BesidePack2, Time),
        &SettlingLevel("end_flow_coefficient"),
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
        "pressure held back over volume, accumulator 1",
        Site::Accumulator(Branch::First),
        (LawPlace::Accumulator1Friction, RelativeVolume),
        &Level,
        RELATIVE_VOLUME,
        5e3,
    ),
    law(
        "pressure held back over volume, accumulator 2",
        Site::Accumulator(Branch::Second),
        (LawPlace::Accumulator2Friction, RelativeVolume),
        &Level,
        RELATIVE_VOLUME,
        5e3,
    ),
    law(
        "opening beside valve 3 over time",
        Site::Valve(Valve::Spring),
        (LawPlace::BesideValve3, Time),
        &SettlingLevel("end_flow_coefficient"),
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
        "series drop over rate of flow, path 2",
        Site::Path(Branch::Second),
        (LawPlace::Path2, FlowRate),
        &ProportionalAmount("inertance_kg_m4"),
        FLOW_RATE_M3_S2,
        1e5,
    ),
    law(
        "duration of the movement over pressure drop",
        Site::Valves,
        (LawPlace::ValveMovement, PressureDrop),
        &Level,
        FEW_EDGES_PA,
        2e-3,
    ),
    law(
        "reading over reading, displacement",
        Site::Sensor(Column::known("displacement_m")),
        (LawPlace::InstrumentDisplacement, Reading),
        &Added,
        TRAVEL_M,
        1e-4,
    ),
    law(
        "reading over time, displacement",
        Site::Sensor(Column::known("displacement_m")),
        (LawPlace::InstrumentDisplacement, Time),
        &SettlingAdded("end_displacement_m"),
        TIME_S,
        1e-4,
    ),
    law(
        "reading over its rate, displacement",
        Site::Sensor(Column::known("displacement_m")),
        (LawPlace::InstrumentDisplacement, ReadingRate),
        &Proportional("late_s"),
        RATE,
        1e-3,
    ),
    law(
        "reading over reading, force",
        Site::Sensor(Column::known("force_N")),
        (LawPlace::InstrumentForce, Reading),
        &Added,
        FORCE_N,
        20.0,
    ),
    law(
        "reading over time, force",
        Site::Sensor(Column::known("force_N")),
        (LawPlace::InstrumentForce, Time),
        &SettlingAdded("end_force_N"),
        TIME_S,
        20.0,
    ),
    law(
        "reading over its rate, force",
        Site::Sensor(Column::known("force_N")),
        (LawPlace::InstrumentForce, ReadingRate),
        &Proportional("late_s"),
        RATE,
        1e-3,
    ),
    law(
        "reading over reading, p1",
        Site::Sensor(Column::known("p1_Pa")),
        (LawPlace::InstrumentP1, Reading),
        &Added,
        P1_PA,
        1e4,
    ),
    law(
        "reading over time, p1",
        Site::Sensor(Column::known("p1_Pa")),
        (LawPlace::InstrumentP1, Time),
        &SettlingAdded("end_p1_Pa"),
        TIME_S,
        1e4,
    ),
    law(
        "reading over its rate, p1",
        Site::Sensor(Column::known("p1_Pa")),
        (LawPlace::InstrumentP1, ReadingRate),
        &Proportional("late_s"),
        RATE,
        1e-3,
    ),
    law(
        "reading over reading, p2",
        Site::Sensor(Column::known("p2_Pa")),
        (LawPlace::InstrumentP2, Reading),
        &Added,
        P1_PA,
        1e4,
    ),
    law(
        "reading over time, p2",
        Site::Sensor(Column::known("p2_Pa")),
        (LawPlace::InstrumentP2, Time),
        &SettlingAdded("end_p2_Pa"),
        TIME_S,
        1e4,
    ),
    law(
        "reading over its rate, p2",
        Site::Sensor(Column::known("p2_Pa")),
        (LawPlace::InstrumentP2, ReadingRate),
        &Proportional("late_s"),
        RATE,
        1e-3,
    ),
    law(
        "reading over reading, p3",
        Site::Sensor(Column::known("p3_Pa")),
        (LawPlace::InstrumentP3, Reading),
        &Added,
        P1_PA,
        1e4,
    ),
    law(
        "reading over time, p3",
        Site::Sensor(Column::known("p3_Pa")),
        (LawPlace::InstrumentP3, Time),
        &SettlingAdded("end_p3_Pa"),
        TIME_S,
        1e4,
    ),
    law(
        "reading over its rate, p3",
        Site::Sensor(Column::known("p3_Pa")),
        (LawPlace::InstrumentP3, ReadingRate),
        &Proportional("late_s"),
        RATE,
        1e-3,
    ),
    law(
        "reading over reading, p4",
        Site::Sensor(Column::known("p4_Pa")),
        (LawPlace::InstrumentP4, Reading),
        &Added,
        P1_PA,
        1e4,
    ),
    law(
        "reading over time, p4",
        Site::Sensor(Column::known("p4_Pa")),
        (LawPlace::InstrumentP4, Time),
        &SettlingAdded("end_p4_Pa"),
        TIME_S,
        1e4,
    ),
    law(
        "reading over its rate, p4",
        Site::Sensor(Column::known("p4_Pa")),
        (LawPlace::InstrumentP4, ReadingRate),
        &Proportional("late_s"),
        RATE,
        1e-3,
    ),
];

impl Law {
    /// At rest a law adds nothing and leaves everything as believed: displacement, speed, flow and drop zero, gas volume
    /// the static one, smallest pressure.
    fn grid(&self) -> Grid {
        Grid {
            knots: self.knots,
            at_rest: match (self.place, self.depends_on) {
                (_, RelativeVolume) => 1.0,
                // A response may be longer at any pressure difference.
                (LawPlace::ValveTiming, _) => EDGE_PA[0],
                _ => 0.0,
            },
            visible: self.visible,
        }
    }
}

/// Candidates for every law.
pub fn candidates() -> Vec<Candidate> {
    let candidate = |law: &Law| {
        Candidate::new(EffectId::Unlisted, law.site.clone(), law.form.parameters(&law.grid()))
            .labelled(law.label)
            .starting_at(law.form.starts(&law.grid()))
            .in_place_of(EffectId::Unlisted)
    };
    LAWS.iter().map(candidate).collect()
}

/// The law of a candidate with its fitted numbers, as a model file holds it; `None` for a label that no law has.
#[must_use]
pub fn table(label: &str, fitted: &[f64]) -> Option<UnlistedLaw> {
    let law = LAWS.iter().find(|law| law.label == label)?;
    Some(UnlistedLaw {
        place: law.place,
        depends_on: law.depends_on,
        argument: law.knots.to_vec(),
        value: law.form.values(&law.grid(), fitted),
        time_constant_s: law.form.time_constant_s(fitted),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plant_sim_reads_every_law_where_it_is_put() {
        for law in LAWS {
            assert!(law.place.arguments().contains(&law.depends_on), "{}", law.label);
            assert!(law.knots.windows(2).all(|w| w[0] < w[1]), "{}", law.label);
            let others = LAWS.iter().filter(|other| other.label == law.label);
            assert_eq!(others.count(), 1, "{}", law.label);
        }
    }

    #[test]
    fn a_law_whose_numbers_say_absent_leaves_the_model_as_it_is() {
        for law in LAWS {
            let fitted: Vec<f64> = law.form.parameters(&law.grid()).iter().map(|p| p.start).collect();
            let table = table(law.label, &fitted).expect("a law");
            // What is added is zero, a factor is one.
            let first = table.value[0];
            assert!(first == 0.0 || first == 1.0, "{}", law.label);
            assert!(table.value.iter().all(|v| *v == first), "{}", law.label);
        }
    }
}
