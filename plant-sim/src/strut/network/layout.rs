//! The network as it is built from a model: everything that does not change from step to step.

use super::chamber::Chamber;
use super::path::Path;
use crate::strut::characteristic::Characteristic;
use crate::strut::flow_path::FlowPath;
use crate::strut::model::StrutModel;
use crate::strut::terms::{Course, LawArgument, LawPlace, law_at, throttle, valve_in_time};

/// Main chamber, two paths, and valve 3 between the second path and its accumulator.
#[derive(Debug, Clone)]
pub(in crate::strut) struct Network {
    /// The main chamber of the strut.
    pub chamber: Chamber,
    /// Paths 1 and 2.
    pub(super) paths: [Path; 2],
    /// Flow coefficient of valve 3 when it is open, m3/s/sqrt(Pa).
    pub(super) valve3_coefficient: f64,
    /// Flow coefficient of its leak, m3/s/sqrt(Pa).
    pub(super) valve3_leak: f64,
    /// Unmodelled factor on its flow.
    pub(super) valve3_throttle: Option<Characteristic>,
    /// Unmodelled factor on its flow over time.
    pub(super) valve3_in_time: Course,
    /// Unmodelled openings beside it, over displacement and over time.
    pub(super) beside_valve3: [Option<Characteristic>; 2],
    /// Inertance of line 2, kg/m4.
    pub(super) inertance_kg_m4: f64,
    /// Transition pressure of all orifices, Pa.
    pub(super) transition_pa: f64,
    /// Whether some table is read whose kinks the solver does not look for.
    pub(super) has_unlisted_laws: bool,
}

impl Network {
    /// The network of a model.
    pub fn of(model: &StrutModel) -> Self {
        let effects = &model.effects;
        let [_, _, valve_3] = &model.valve;
        Self {
            chamber: Chamber::of(model),
            paths: FlowPath::ALL.map(|which| Path::of(model, which)),
            valve3_coefficient: valve_3.total_flow_coefficient(),
            valve3_leak: effects
                .valve3_leakage
                .as_ref()
                .map_or(0.0, |leak| leak.flow_coefficient),
            valve3_throttle: throttle(&effects.unlisted, LawPlace::Valve3),
            valve3_in_time: valve_in_time(&effects.unlisted, LawPlace::Valve3),
            beside_valve3: [LawArgument::Displacement, LawArgument::Time]
                .map(|over| law_at(&effects.unlisted, LawPlace::BesideValve3, over)),
            inertance_kg_m4: (effects.line_inertance.as_ref()).map_or(0.0, |line| line.inertance_2_kg_m4)
                + law_at(&effects.unlisted, LawPlace::Path2, LawArgument::FlowRate)
                    .map_or(0.0, |line| line.at(0.0, &mut 0).1),
            transition_pa: model.orifice.transition_pressure_pa,
            has_unlisted_laws: !effects.unlisted.is_empty(),
        }
    }
}
