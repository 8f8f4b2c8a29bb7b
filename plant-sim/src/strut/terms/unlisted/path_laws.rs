//! The unmodelled laws of one path as the solver reads them.

use super::argument::LawArgument;
use super::course::Course;
use super::law::{Remembered, UnlistedLaw, law_at};
use super::place::LawPlace;
use crate::strut::characteristic::Characteristic;
use crate::strut::flow_path::FlowPath;
use crate::strut::terms::accumulator_piston_friction::PRESLIDING_M3;

/// A factor never falls below this fraction of what the model has: an element does not turn round.
const LEAST_FACTOR: f64 = 0.01;
/// The same for the factor on a gas pressure.
const LEAST_GAS_FACTOR: f64 = 0.1;

/// Rounds in which a gas finds the energy that it gets at its own pressure. Each leaves the part of the error that it works within a stage, some
/// hundredths.
const ENERGY_ROUNDS: usize = 3;

/// The laws of one path. Where there is none, each of them is what leaves the model as it is.
#[derive(Debug, Clone, Default)]
pub(in crate::strut) struct PathLaws {
    series: Option<Characteristic>,
    parallel: Option<Characteristic>,
    groove: Option<Characteristic>,
    groove_in_time: Option<Characteristic>,
    strength: Option<Characteristic>,
    strength_in_time: Course,
    throttle: Option<Characteristic>,
    valve_in_time: Course,
    gas: Option<Characteristic>,
    gas_in_time: Course,
    gas_memory: Option<Remembered>,
    gas_energy: Option<Remembered>,
    /// Static absolute pressure of the gas times its static volume, J.
    static_energy_j: f64,
    pack_energy: Option<Remembered>,
    held_back: Option<Characteristic>,
    /// Oil volume that shears the seal of the floating piston, m3.
    presliding_m3: f64,
}

/// What the laws of a gas are asked about: a trial of a stage.
pub(in crate::strut) struct GasLawInputs {
    /// Gas volume over the static one.
    pub relative_volume: f64,
    /// What has changed of it lately.
    pub changed: f64,
    /// Time since the start, s.
    pub time_s: f64,
    /// Duration of the stage, s.
    pub duration_s: f64,
    /// Absolute pressure without the laws, Pa.
    pub pressure_pa: f64,
    /// Flow of oil into the accumulator, m3/s.
    pub flow_m3_s: f64,
    /// Energy held before the stage, over the static pressure times the static volume.
    pub energy: f64,
}

/// What they answer.
#[derive(Debug, Clone)]
pub(in crate::strut) struct GasLawAnswer {
    /// Factor on the pressure.
    pub factor: f64,
    /// Its derivative by the flow, as far as it follows from the energy, s/m3.
    pub factor_by_flow: f64,
    /// Energy held at the end of the stage, over the same.
    pub energy: f64,
}

impl PathLaws {
    /// The laws of a path. Its gas has this static absolute pressure times static volume, J.
    pub fn of(laws: &[UnlistedLaw], path: FlowPath, static_energy_j: f64) -> Self {
        Self {
            static_energy_j,
            series: law_at(laws, LawPlace::in_series(path), LawArgument::Flow),
            parallel: law_at(laws, LawPlace::beside_pack(path), LawArgument::PressureDrop),
            groove: law_at(laws, LawPlace::beside_pack(path), LawArgument::Displacement),
            groove_in_time: law_at(laws, LawPlace::beside_pack(path), LawArgument::Time),
            strength: law_at(laws, LawPlace::pack(path), LawArgument::Displacement),
            strength_in_time: Course::at(laws, LawPlace::pack(path)),
            throttle: throttle(laws, path.pick(LawPlace::Valve1, LawPlace::Valve2)),
            valve_in_time: valve_in_time(laws, path.pick(LawPlace::Valve1, LawPlace::Valve2)),
            gas: gas(laws, path, LawArgument::RelativeVolume).map(UnlistedLaw::characteristic),
            gas_in_time: Course::at_first_of(laws, &[LawPlace::accumulator(path), LawPlace::Accumulators]),
            gas_memory: gas(laws, path, LawArgument::VolumeChange).and_then(Remembered::of),
            gas_energy: gas(laws, path, LawArgument::RelativeEnergy).and_then(Remembered::of),
            pack_energy: Remembered::at(laws, LawPlace::pack(path), LawArgument::Energy),
            held_back: law_at(laws, LawPlace::piston(path), LawArgument::RelativeVolume),
            presliding_m3: (laws.iter().find(|law| law.place == LawPlace::piston(path)))
                .and_then(|law| law.presliding_volume_m3)
                .unwrap_or(PRESLIDING_M3),
        }
    }

    /// Drop in series with the path at a flow, Pa, and its derivative by the flow, if there is such a law.
    #[inline]
    pub fn series_drop(&self, flow_m3_s: f64) -> Option<(f64, f64)> {
        self.series.as_ref().map(|law| law.at(flow_m3_s, &mut 0))
    }

    /// Flow beside the pack at its drop, m3/s, and its derivative by the drop, if there is such a law.
    #[inline]
    pub fn parallel_flow(&self, drop_pa: f64) -> Option<(f64, f64)> {
        self.parallel.as_ref().map(|law| law.at(drop_pa, &mut 0))
    }

    /// Flow coefficient of a groove beside the pack at a displacement and a time, m3/s/sqrt(Pa).
    #[inline]
    pub fn groove(&self, displacement_m: f64, time_s: f64) -> f64 {
        let by = |law: &Option<Characteristic>, argument| law.as_ref().map_or(0.0, |law| law.value(argument).max(0.0));
        by(&self.groove, displacement_m) + by(&self.groove_in_time, time_s)
    }

    /// What the model's drop of the pack is divided by at a displacement and a time.
    #[inline]
    pub fn weakening(&self, displacement_m: f64, time_s: f64) -> f64 {
        let by_displacement =
            (self.strength.as_ref()).map_or(1.0, |law| 1.0 / law.value(displacement_m).max(LEAST_FACTOR));
        by_displacement * (1.0 / self.strength_in_time.product(time_s, LEAST_FACTOR))
    }

    /// What the flow of the bypass valve is multiplied by at a time.
    #[inline]
    pub fn valve_in_time(&self, time_s: f64) -> f64 {
        passed(&self.valve_in_time, time_s)
    }

    /// Fraction of the bypass valve's flow that does not pass at a drop.
    #[inline]
    pub fn throttled_fraction(&self, drop_pa: f64) -> f64 {
        self.throttle.as_ref().map_or(0.0, |law| 1.0 - throttled(law, drop_pa))
    }

    /// What the model's drop of the pack is divided by while its oil holds an energy (J).
    #[inline]
    pub fn weakening_by_energy(&self, energy_j: f64) -> f64 {
        (self.pack_energy.as_ref()).map_or(1.0, |law| 1.0 / law.table.value(energy_j).max(LEAST_FACTOR))
    }

    /// Energy that the pack's oil holds after a power (W) for a while (s), J; none without a law over it.
    #[inline]
    pub fn pack_j(&self, before_j: f64, duration_s: f64, power_w: f64) -> f64 {
        (self.pack_energy.as_ref()).map_or(0.0, |law| (before_j + duration_s * power_w) * law.left(duration_s))
    }

    /// The factor on the gas pressure, if there is a law of it.
    #[inline]
    pub fn gas(&self, at: &GasLawInputs) -> Option<GasLawAnswer> {
        let none = self.gas.is_none() && self.gas_in_time.is_none() && self.gas_memory.is_none();
        if none && self.gas_energy.is_none() {
            return None;
        }
        let by =
            |law: Option<&Characteristic>, argument| law.map_or(1.0, |law| law.value(argument).max(LEAST_GAS_FACTOR));
        let memory = self.gas_memory.as_ref().map(|memory| &memory.table);
        let mut answer = GasLawAnswer {
            factor: by(self.gas.as_ref(), at.relative_volume)
                * self.gas_in_time.product(at.time_s, LEAST_GAS_FACTOR)
                * by(memory, at.changed),
            factor_by_flow: 0.0,
            energy: 0.0,
        };
        if let Some(law) = &self.gas_energy {
            // The gas works at the factor that its energy has at the end of the stage, and gets that energy by working.
            let left = law.left(at.duration_s);
            let without = at.duration_s * answer.factor * at.pressure_pa / self.static_energy_j * left;
            let (mut by_flow, mut energy) = (without, at.energy);
            for _ in 0..ENERGY_ROUNDS {
                by_flow = without * by(Some(&law.table), energy);
                energy = at.energy * left + by_flow * at.flow_m3_s;
            }
            answer.energy = energy;
            let (factor, slope) = law.table.at(answer.energy, &mut 0);
            answer.factor_by_flow = answer.factor * slope * by_flow;
            answer.factor *= factor.max(LEAST_GAS_FACTOR);
        }
        Some(answer)
    }

    /// What an implicit step of a duration leaves of a departure of the gas volume from its mean, 0 to 1; 0 without a memory.
    #[inline]
    pub fn remembered(&self, duration_s: f64) -> f64 {
        (self.gas_memory.as_ref()).map_or(0.0, |memory| memory.left(duration_s))
    }

    /// Oil volume that shears the seal of the floating piston to sliding, m3, by its law; where this does not say, by what is assumed of seals.
    pub fn presliding_m3(&self) -> f64 {
        self.presliding_m3
    }

    /// Pressure that the floating piston holds back at a gas volume over the static one, Pa, if there is such a law.
    #[inline]
    pub fn held_back_pa(&self, relative_volume: f64) -> Option<f64> {
        self.held_back.as_ref().map(|law| law.value(relative_volume).max(0.0))
    }
}

/// The law of the gas of an accumulator is its own or, where it has none, the one of both.
pub(super) fn gas(laws: &[UnlistedLaw], path: FlowPath, over: LawArgument) -> Option<&UnlistedLaw> {
    [LawPlace::accumulator(path), LawPlace::Accumulators]
        .into_iter()
        .find_map(|place| laws.iter().find(|law| law.place == place && law.depends_on == over))
}

/// The law of a valve is its own or, where it has none, the one of all three.
pub(in crate::strut) fn throttle(laws: &[UnlistedLaw], valve: LawPlace) -> Option<Characteristic> {
    [valve, LawPlace::Valves]
        .into_iter()
        .find_map(|place| law_at(laws, place, LawArgument::PressureDrop))
}

/// The laws over time of a valve are its own or, where it has none, those of all three.
pub(in crate::strut) fn valve_in_time(laws: &[UnlistedLaw], valve: LawPlace) -> Course {
    Course::at_first_of(laws, &[valve, LawPlace::Valves])
}

/// Factor on a valve's flow at a time.
#[inline]
pub(in crate::strut) fn passed(law: &Course, time_s: f64) -> f64 {
    law.product(time_s, LEAST_FACTOR)
}

/// Factor on a valve's flow at a pressure drop.
#[inline]
pub(in crate::strut) fn throttled(law: &Characteristic, drop_pa: f64) -> f64 {
    law.value(drop_pa.abs()).max(LEAST_FACTOR)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(place: LawPlace, depends_on: LawArgument, argument: [f64; 2], value: [f64; 2]) -> UnlistedLaw {
        UnlistedLaw {
            place,
            depends_on,
            argument: argument.to_vec(),
            value: value.to_vec(),
            time_constant_s: None,
            frequency_hz: None,
            presliding_volume_m3: None,
            attraction: None,
        }
    }

    /// A trial of a stage without flow.
    fn at(relative_volume: f64, changed: f64, time_s: f64) -> GasLawInputs {
        GasLawInputs {
            relative_volume,
            changed,
            time_s,
            duration_s: 1e-3,
            pressure_pa: 2e6,
            flow_m3_s: 0.0,
            energy: 0.0,
        }
    }

    fn gas_factor(laws: &PathLaws, relative_volume: f64, changed: f64, time_s: f64) -> Option<f64> {
        laws.gas(&at(relative_volume, changed, time_s)).map(|gas| gas.factor)
    }

    #[test]
    fn without_laws_the_model_is_as_it_was() {
        let none = PathLaws::of(&[], FlowPath::One, 1.0);
        assert_eq!(
            (
                none.groove(0.1, 9.0),
                none.weakening(0.1, 9.0),
                none.throttled_fraction(1e6)
            ),
            (0.0, 1.0, 0.0)
        );
        assert!(
            none.series_drop(1e-3).is_none()
                && none.parallel_flow(1e6).is_none()
                && none.gas(&at(0.5, 0.1, 9.0)).is_none()
        );
    }

    #[test]
    fn each_law_reads_its_own_table_and_only_its_own_path() {
        let laws = [
            law(LawPlace::Path2, LawArgument::Flow, [0.0, 1e-3], [0.0, 5e5]),
            law(LawPlace::Pack2, LawArgument::Displacement, [0.0, 1.0], [0.5, 0.5]),
            law(LawPlace::Valve1, LawArgument::PressureDrop, [0.0, 1e6], [1.0, 0.2]),
            law(LawPlace::Valves, LawArgument::PressureDrop, [0.0, 1e6], [1.0, 0.6]),
            law(
                LawPlace::Accumulator2,
                LawArgument::RelativeVolume,
                [0.0, 1.0],
                [2.0, 1.0],
            ),
        ];
        let [one, two] = FlowPath::ALL.map(|path| PathLaws::of(&laws, path, 1.0));
        assert_eq!(
            (
                one.series_drop(1e-3),
                one.weakening(0.0, 0.0),
                gas_factor(&one, 0.5, 0.0, 0.0)
            ),
            (None, 1.0, None)
        );
        assert_eq!(two.series_drop(5e-4), Some((2.5e5, 5e8)));
        assert_eq!(
            (two.weakening(0.0, 0.0), gas_factor(&two, 0.5, 0.0, 0.0)),
            (2.0, Some(1.5))
        );
        assert!(
            (one.throttled_fraction(-5e5) - 0.4).abs() < 1e-12,
            "valve 1 has a law of its own"
        );
        assert!(
            (two.throttled_fraction(5e5) - 0.2).abs() < 1e-12,
            "valve 2 has that of all valves"
        );
        assert!(
            (one.throttled_fraction(1e9) - 0.99).abs() < 1e-12,
            "a valve never turns its flow round"
        );
    }

    #[test]
    fn each_piston_has_the_seal_of_its_own_law() {
        let seal = |place, presliding_volume_m3| UnlistedLaw {
            presliding_volume_m3,
            ..law(place, LawArgument::RelativeVolume, [0.0, 2.0], [5e4, 1e4])
        };
        let laws = [
            seal(LawPlace::Accumulator1Friction, None),
            seal(LawPlace::Accumulator2Friction, Some(6e-7)),
        ];
        let [one, two] = FlowPath::ALL.map(|path| PathLaws::of(&laws, path, 1.0));
        assert_eq!((one.presliding_m3(), two.presliding_m3()), (1e-7, 6e-7));
        assert_eq!((one.held_back_pa(1.0), two.held_back_pa(1.0)), (Some(3e4), Some(3e4)));
    }

    #[test]
    fn laws_over_time_multiply_or_add_to_those_over_a_state() {
        let over = |place, depends_on, value| law(place, depends_on, [0.0, 10.0], value);
        let (time, displacement) = (LawArgument::Time, LawArgument::Displacement);
        let laws = [
            over(LawPlace::Pack1, displacement, [0.5, 0.5]),
            over(LawPlace::Pack1, time, [1.0, 0.5]),
            over(LawPlace::BesidePack1, displacement, [1e-7, 1e-7]),
            over(LawPlace::BesidePack1, time, [0.0, 2e-7]),
            over(LawPlace::Accumulator1, LawArgument::RelativeVolume, [2.0, 2.0]),
            over(LawPlace::Accumulator1, time, [1.0, 0.8]),
        ];
        let one = PathLaws::of(&laws, FlowPath::One, 1.0);
        assert_eq!((one.weakening(0.0, 0.0), one.weakening(0.0, 10.0)), (2.0, 4.0));
        assert!((one.groove(0.0, 5.0) - 2e-7).abs() < 1e-20);
        assert!((gas_factor(&one, 1.0, 0.0, 10.0).unwrap() - 1.6).abs() < 1e-12);
    }
}
