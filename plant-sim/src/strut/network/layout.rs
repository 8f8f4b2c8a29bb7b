//! The network as it is built from a model: everything that does not change from step to step.

use super::chamber::Chamber;
use super::path::Path;
use super::state::State;
use crate::lanes::Number;
use crate::strut::characteristic::Characteristic;
use crate::strut::flow_path::FlowPath;
use crate::strut::model::StrutModel;
use crate::strut::terms::{Course, LawArgument, LawPlace, law_at, throttle, valve_in_time};

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
    pub(super) valve3_throttle: Option<Characteristic>,
    /// Unmodelled factor on its flow over time.
    pub(super) valve3_in_time: Course,
    /// Unmodelled openings beside it, over displacement and over time.
    pub(super) beside_valve3: [Option<Characteristic>; 2],
    /// Inertance of line 2, kg/m4.
    pub(super) inertance_kg_m4: N,
    /// Transition pressure of all orifices, Pa.
    pub(super) transition_pa: N,
    /// Whether some table is read whose kinks the solver does not look for.
    pub(super) has_unlisted_laws: bool,
}

/// The oil column of line 2 between the main chamber and accumulator 2: a mass between two springs.
#[derive(Debug, Clone, Copy)]
pub(in crate::strut) struct ColumnOscillator {
    /// Inertance of the line, kg/m4.
    pub inertance_kg_m4: f64,
    /// Natural angular frequency without damping, rad/s.
    pub frequency_rad_s: f64,
    /// Amplitude of the pressure after a sudden change of the piston's speed, Pa s/m.
    pub kick_pa_s_m: f64,
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

    /// The oil column of line 2 as an oscillator around a state of rest; none if its oil has no mass.
    pub fn column_oscillator(&self, rest: &State) -> Option<ColumnOscillator> {
        let inertance_kg_m4 = self.inertance_kg_m4;
        if inertance_kg_m4 <= 0.0 {
            return None;
        }
        // By Boyle's law, which is soft enough: gas takes up so much more than oil that its exponent hardly matters.
        let [gas_1, gas_2] = [0, 1].map(|i| rest.gas[i].volume_m3 / self.paths[i].gas.pressure(rest.gas[i]).pa());
        // Rigid oil takes up nothing; behind it is the other accumulator.
        let held = self.chamber.taken_up(rest, rest.p1_pa, 0.0).slope;
        let chamber = if held > 0.0 { held } else { gas_1 };
        let volume_per_pressure = 1.0 / (1.0 / chamber + 1.0 / gas_2);
        Some(ColumnOscillator {
            inertance_kg_m4,
            frequency_rad_s: 1.0 / (inertance_kg_m4 * volume_per_pressure).sqrt(),
            kick_pa_s_m: self.chamber.area_m2 * (inertance_kg_m4 / volume_per_pressure).sqrt(),
        })
    }

    /// The networks of several struts side by side, `like` any number of their kind; none where they differ in kind, or where one has a
    /// law without a name.
    pub fn abreast<N: Number>(networks: &N::Each<&Self>, like: N) -> Option<Network<N>> {
        let all = networks.as_ref();
        if all.iter().any(|network| network.has_unlisted_laws) {
            return None;
        }
        let of = |value: fn(&Self) -> f64| like.gather(|lane| value(all[lane]));
        let path = |which: FlowPath| Path::abreast(&N::each(|lane| which.of(all[lane].paths.each_ref())), like);
        Some(Network {
            chamber: Chamber::abreast(&N::each(|lane| &all[lane].chamber), like)?,
            paths: [path(FlowPath::One)?, path(FlowPath::Two)?],
            valve3_coefficient: of(|network| network.valve3_coefficient),
            valve3_leak: of(|network| network.valve3_leak),
            valve3_throttle: None,
            valve3_in_time: Course::default(),
            beside_valve3: [None, None],
            inertance_kg_m4: of(|network| network.inertance_kg_m4),
            transition_pa: of(|network| network.transition_pa),
            has_unlisted_laws: false,
        })
    }
}
