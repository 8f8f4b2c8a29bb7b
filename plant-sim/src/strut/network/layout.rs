//! The network as it is built from a model: everything that does not change from step to step.

use super::chamber::Chamber;
use super::path::Path;
use crate::lanes::Number;
use crate::strut::flow_path::FlowPath;
use crate::strut::model::StrutModel;
use crate::strut::terms::{Course, LawArgument, LawPlace, LawTable, law_at, throttle, valve_in_time};

/// The longest Newton step in the drops, Pa, that is taken linearly where the model has unmodelled laws: the kinks of
/// their tables are not looked for.
const UNLISTED_STEP_PA: f64 = 300.0;

/// Main chamber, two paths, and valve 3 between the second path and its accumulator.
#[derive(Debug, Clone)]
pub(in crate::strut) struct Network<N: Number = f64> {
    /// The main chamber of the strut.
    pub chamber: Chamber<N>,
    /// Paths 1 and 2.
    pub(super) paths: [Path<N>; 2],
    /// Flow coefficient of valve 3 when it is open, m3/s/sqrt(Pa).
    pub(super) valve3_coefficient: N,
    /// Flow coefficient of its leak, m3/s/sqrt(Pa).
    pub(super) valve3_leak: N,
    /// Unmodelled factor on its flow.
    pub(super) valve3_throttle: LawTable<N>,
    /// Unmodelled factor on its flow over time.
    pub(super) valve3_in_time: Course<N>,
    /// Unmodelled openings beside it, over displacement and over time.
    pub(super) beside_valve3: [LawTable<N>; 2],
    /// Inertance of line 2, kg/m4.
    pub(super) inertance_kg_m4: N,
    /// Transition pressure of all orifices, Pa.
    pub(super) transition_pa: N,
    /// Whether some table is read whose kinks the solver does not look for.
    pub has_laws: bool,
    /// Longest Newton step in the drops that is then taken linearly, Pa.
    pub(super) longest_step_pa: N,
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
                .map(|over| LawTable::at_place(&effects.unlisted, LawPlace::BesideValve3, over)),
            inertance_kg_m4: (effects.line_inertance.as_ref()).map_or(0.0, |line| line.inertance_2_kg_m4)
                + law_at(&effects.unlisted, LawPlace::Path2, LawArgument::FlowRate)
                    .map_or(0.0, |line| line.at(0.0, &mut 0).1),
            transition_pa: model.orifice.transition_pressure_pa,
            has_laws: !effects.unlisted.is_empty(),
            longest_step_pa: if effects.unlisted.is_empty() {
                f64::INFINITY
            } else {
                UNLISTED_STEP_PA
            },
        }
    }

    /// The networks of several struts side by side, `like` any number of their kind; none where they differ in kind.
    pub fn abreast<N: Number>(networks: &N::Each<&Self>, like: N) -> Option<Network<N>> {
        let all = networks.as_ref();
        // A throttled valve 3 is solved for in another way.
        if (all.iter()).any(|network| network.valve3_throttle.is_none() != all[0].valve3_throttle.is_none()) {
            return None;
        }
        let table = |of: fn(&Self) -> &LawTable| LawTable::abreast(&N::each(|lane| of(all[lane])));
        let of = |value: fn(&Self) -> f64| like.gather(|lane| value(all[lane]));
        let path = |which: FlowPath| Path::abreast(&N::each(|lane| which.of(all[lane].paths.each_ref())), like);
        Some(Network {
            chamber: Chamber::abreast(&N::each(|lane| &all[lane].chamber), like)?,
            paths: [path(FlowPath::One)?, path(FlowPath::Two)?],
            valve3_coefficient: of(|network| network.valve3_coefficient),
            valve3_leak: of(|network| network.valve3_leak),
            valve3_throttle: table(|network| &network.valve3_throttle),
            valve3_in_time: Course::abreast(&N::each(|lane| &all[lane].valve3_in_time), like),
            beside_valve3: [
                table(|network| &network.beside_valve3[0]),
                table(|network| &network.beside_valve3[1]),
            ],
            inertance_kg_m4: of(|network| network.inertance_kg_m4),
            transition_pa: of(|network| network.transition_pa),
            has_laws: all.iter().any(|network| network.has_laws),
            longest_step_pa: of(|network| network.longest_step_pa),
        })
    }
}
