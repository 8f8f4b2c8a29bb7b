//! The unmodelled laws of one path as the solver reads them.

use super::argument::LawArgument;
use super::course::Course;
use super::law::{UnlistedLaw, find};
use super::law_table::{LawTable, together};
use super::place::LawPlace;
use super::remembered::Remembered;
use crate::lanes::Number;
use crate::strut::flow_path::FlowPath;
use crate::strut::terms::accumulator_piston_friction::PRESLIDING_M3;

/// A factor never falls below this fraction of what the model has: an element does not turn round.
const LEAST_FACTOR: f64 = 0.01;
/// The same for the factor on a gas pressure.
const LEAST_GAS_FACTOR: f64 = 0.1;

/// Rounds in which a gas finds the energy that it gets at its own pressure. Each leaves the part of the error that it works within a stage, some
/// hundredths.
const ENERGY_ROUNDS: usize = 3;

/// The laws of one path, of one strut or of several side by side.
#[derive(Debug, Clone)]
pub(in crate::strut) struct PathLaws<N: Number = f64> {
    series: LawTable<N>,
    parallel: LawTable<N>,
    groove: LawTable<N>,
    groove_in_time: LawTable<N>,
    strength: LawTable<N>,
    strength_in_time: Course<N>,
    throttle: LawTable<N>,
    valve_in_time: Course<N>,
    gas: LawTable<N>,
    gas_in_time: Course<N>,
    gas_memory: Remembered<N>,
    gas_energy: Remembered<N>,
    /// Static absolute pressure of the gas times its static volume, J.
    static_energy_j: N,
    pack_energy: Remembered<N>,
    held_back: LawTable<N>,
}

/// What the laws of a gas are asked about: a trial of a stage.
pub(in crate::strut) struct GasLawInputs<N> {
    /// Gas volume over the static one.
    pub relative_volume: N,
    /// What has changed of it lately.
    pub changed: N,
    /// Time since the start, s.
    pub time_s: N,
    /// Duration of the stage, s.
    pub duration_s: N,
    /// Absolute pressure without the laws, Pa.
    pub pressure_pa: N,
    /// Flow of oil into the accumulator, m3/s.
    pub flow_m3_s: N,
    /// Energy held before the stage, over the static pressure times the static volume.
    pub energy: N,
}

/// What they answer.
pub(in crate::strut) struct GasLawAnswer<N> {
    /// Factor on the pressure.
    pub factor: N,
    /// Its derivative by the flow, as far as it follows from the energy, s/m3.
    pub factor_by_flow: N,
    /// Energy held at the end of the stage, over the same.
    pub energy: N,
}

impl PathLaws {
    /// The laws of a path. Its gas has this static absolute pressure times static volume, J.
    pub fn of(laws: &[UnlistedLaw], path: FlowPath, static_energy_j: f64) -> Self {
        let at = |place, over| LawTable::at_place(laws, place, over);
        let valve = path.pick(LawPlace::Valve1, LawPlace::Valve2);
        Self {
            static_energy_j,
            series: at(LawPlace::in_series(path), LawArgument::Flow),
            parallel: at(LawPlace::beside_pack(path), LawArgument::PressureDrop),
            groove: at(LawPlace::beside_pack(path), LawArgument::Displacement),
            groove_in_time: at(LawPlace::beside_pack(path), LawArgument::Time),
            strength: at(LawPlace::pack(path), LawArgument::Displacement),
            strength_in_time: Course::at(laws, LawPlace::pack(path)),
            throttle: throttle(laws, valve),
            valve_in_time: valve_in_time(laws, valve),
            gas: LawTable::of(gas(laws, path, LawArgument::RelativeVolume)),
            gas_in_time: Course::at_first_of(laws, &[LawPlace::accumulator(path), LawPlace::Accumulators]),
            gas_memory: Remembered::of(gas(laws, path, LawArgument::VolumeChange)),
            gas_energy: Remembered::of(gas(laws, path, LawArgument::RelativeEnergy)),
            pack_energy: Remembered::of(find(laws, LawPlace::pack(path), LawArgument::Energy)),
            held_back: at(LawPlace::piston(path), LawArgument::RelativeVolume),
        }
    }

    /// Those of several struts side by side, `like` any number of their kind.
    pub fn abreast<N: Number>(each: &N::Each<&Self>, like: N) -> PathLaws<N> {
        let all = each.as_ref();
        let table = |of: fn(&Self) -> &LawTable| LawTable::abreast(&N::each(|lane| of(all[lane])));
        let course = |of: fn(&Self) -> &Course| Course::abreast(&N::each(|lane| of(all[lane])), like);
        let remembered = |of: fn(&Self) -> &Remembered| Remembered::abreast(&N::each(|lane| of(all[lane])), like);
        PathLaws {
            series: table(|laws| &laws.series),
            parallel: table(|laws| &laws.parallel),
            groove: table(|laws| &laws.groove),
            groove_in_time: table(|laws| &laws.groove_in_time),
            strength: table(|laws| &laws.strength),
            strength_in_time: course(|laws| &laws.strength_in_time),
            throttle: table(|laws| &laws.throttle),
            valve_in_time: course(|laws| &laws.valve_in_time),
            gas: table(|laws| &laws.gas),
            gas_in_time: course(|laws| &laws.gas_in_time),
            gas_memory: remembered(|laws| &laws.gas_memory),
            gas_energy: remembered(|laws| &laws.gas_energy),
            static_energy_j: like.gather_from(all, |laws| laws.static_energy_j),
            pack_energy: remembered(|laws| &laws.pack_energy),
            held_back: table(|laws| &laws.held_back),
        }
    }
}

impl<N: Number> PathLaws<N> {
    /// Drop in series with the path at a flow, Pa, and its derivative by the flow, if there is such a law.
    #[inline(always)]
    pub fn series_drop(&self, flow_m3_s: N) -> Option<(N, N)> {
        self.series.added(flow_m3_s)
    }

    /// Flow beside the pack at its drop, m3/s, and its derivative by the drop, if there is such a law.
    #[inline(always)]
    pub fn parallel_flow(&self, drop_pa: N) -> Option<(N, N)> {
        self.parallel.added(drop_pa)
    }

    /// Flow coefficient of a groove beside the pack at a displacement and a time, m3/s/sqrt(Pa), if there is one.
    #[inline(always)]
    pub fn groove(&self, displacement_m: N, time_s: N) -> Option<N> {
        let over_displacement = self.groove.opening(displacement_m);
        let over_time = self.groove_in_time.opening(time_s);
        together(over_displacement, over_time, N::add)
    }

    /// What the model's drop of the pack is divided by at a displacement and a time, if there is such a law.
    #[inline(always)]
    pub fn weakening(&self, displacement_m: N, time_s: N) -> Option<N> {
        let by_displacement = self.strength.factor(displacement_m, LEAST_FACTOR);
        let by_time = self.strength_in_time.product(time_s, LEAST_FACTOR);
        together(recip(by_displacement), recip(by_time), N::mul)
    }

    /// What the flow of the bypass valve is multiplied by at a time, if there is such a law.
    #[inline(always)]
    pub fn valve_in_time(&self, time_s: N) -> Option<N> {
        passed(&self.valve_in_time, time_s)
    }

    /// Fraction of the bypass valve's flow that does not pass at a drop, if there is such a law.
    #[inline(always)]
    pub fn throttled_fraction(&self, drop_pa: N) -> Option<N> {
        Some(-throttled(&self.throttle, drop_pa)? + 1.0)
    }

    /// What the model's drop of the pack is divided by while its oil holds an energy (J), if there is such a law.
    #[inline(always)]
    pub fn weakening_by_energy(&self, energy_j: N) -> Option<N> {
        recip(self.pack_energy.table.factor(energy_j, LEAST_FACTOR))
    }

    /// Energy that the pack's oil holds after a power (W) for a while (s), J; what it was without a law over it.
    #[inline(always)]
    pub fn pack_j(&self, before_j: N, duration_s: N, power_w: N) -> N {
        if self.pack_energy.is_none() {
            return before_j;
        }
        (before_j + duration_s * power_w) * self.pack_energy.left(duration_s)
    }

    /// The factor on the gas pressure, if there is a law of it.
    #[inline(always)]
    pub fn gas(&self, at: &GasLawInputs<N>) -> Option<GasLawAnswer<N>> {
        let by_volume = self.gas.factor(at.relative_volume, LEAST_GAS_FACTOR);
        let by_time = self.gas_in_time.product(at.time_s, LEAST_GAS_FACTOR);
        let by_change = self.gas_memory.table.factor(at.changed, LEAST_GAS_FACTOR);
        let factor = together(together(by_volume, by_time, N::mul), by_change, N::mul);
        if !self.gas_energy.is_none() {
            return Some(self.gas_by_energy(at, factor.unwrap_or(at.energy.of(1.0))));
        }
        let factor = factor?;
        Some(GasLawAnswer {
            factor,
            factor_by_flow: factor.of(0.0),
            energy: factor.of(0.0),
        })
    }

    /// The same with the law over the energy that the gas holds, beside the factor of the other laws. The gas works at the factor that its energy has
    /// at the end of the stage, and gets that energy by working.
    #[inline(always)]
    fn gas_by_energy(&self, at: &GasLawInputs<N>, beside: N) -> GasLawAnswer<N> {
        let law = &self.gas_energy;
        let one = beside.of(1.0);
        let left = law.left(at.duration_s);
        let without = at.duration_s * beside * at.pressure_pa / self.static_energy_j * left;
        let (mut by_flow, mut energy) = (without, at.energy);
        for _ in 0..ENERGY_ROUNDS {
            by_flow = without * law.table.factor(energy, LEAST_GAS_FACTOR).unwrap_or(one);
            energy = at.energy * left + by_flow * at.flow_m3_s;
        }
        let (factor, slope) = law.table.multiplied(energy).unwrap_or((one, one.of(0.0)));
        GasLawAnswer {
            factor: beside * factor.at_least(one.of(LEAST_GAS_FACTOR)),
            factor_by_flow: beside * slope * by_flow,
            energy,
        }
    }

    /// What an implicit step of a duration leaves of a departure of the gas volume from its mean, 0 to 1; 0 without a memory.
    #[inline(always)]
    pub fn remembered(&self, duration_s: N) -> N {
        if self.gas_memory.is_none() {
            return duration_s.of(0.0);
        }
        self.gas_memory.left(duration_s)
    }

    /// Pressure that the floating piston holds back at a gas volume over the static one, Pa, if there is such a law.
    #[inline(always)]
    pub fn held_back_pa(&self, relative_volume: N) -> Option<N> {
        self.held_back.opening(relative_volume)
    }
}

/// One over a number, if it is there. (`Option::map` is not always compiled in line, and outside of it vectors go through memory.)
#[inline(always)]
fn recip<N: Number>(number: Option<N>) -> Option<N> {
    Some(number?.recip())
}

/// Oil volume that shears the seal of the floating piston of a path to sliding, m3, by its law; where this does not say, by what is assumed of seals.
pub(in crate::strut) fn presliding_m3(laws: &[UnlistedLaw], path: FlowPath) -> f64 {
    let seal = laws.iter().find(|law| law.place == LawPlace::piston(path));
    seal.and_then(|law| law.presliding_volume_m3).unwrap_or(PRESLIDING_M3)
}

/// Largest pressure that the seal of the floating piston of a path holds back at any point of its law, Pa; 0 without one.
pub(in crate::strut) fn most_held_back_pa(laws: &[UnlistedLaw], path: FlowPath) -> f64 {
    let of_seal = laws.iter().filter(|law| law.place == LawPlace::piston(path));
    (of_seal.flat_map(|law| &law.value)).fold(0.0, |most, level| level.abs().max(most))
}

/// The law of the gas of an accumulator is its own or, where it has none, the one of both.
pub(super) fn gas(laws: &[UnlistedLaw], path: FlowPath, over: LawArgument) -> Option<&UnlistedLaw> {
    [LawPlace::accumulator(path), LawPlace::Accumulators]
        .into_iter()
        .find_map(|place| laws.iter().find(|law| law.place == place && law.depends_on == over))
}

/// The law of a valve is its own or, where it has none, the one of all three.
pub(in crate::strut) fn throttle(laws: &[UnlistedLaw], valve: LawPlace) -> LawTable {
    let at = |place| LawTable::at_place(laws, place, LawArgument::PressureDrop);
    at(valve).or(at(LawPlace::Valves))
}

/// The laws over time of a valve are its own or, where it has none, those of all three.
pub(in crate::strut) fn valve_in_time(laws: &[UnlistedLaw], valve: LawPlace) -> Course {
    Course::at_first_of(laws, &[valve, LawPlace::Valves])
}

/// Factor on a valve's flow at a time, if there is such a law.
#[inline(always)]
pub(in crate::strut) fn passed<N: Number>(law: &Course<N>, time_s: N) -> Option<N> {
    law.product(time_s, LEAST_FACTOR)
}

/// Factor on a valve's flow at a pressure drop, if there is such a law.
#[inline(always)]
pub(in crate::strut) fn throttled<N: Number>(law: &LawTable<N>, drop_pa: N) -> Option<N> {
    law.factor(drop_pa.abs(), LEAST_FACTOR)
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
    fn at(relative_volume: f64, changed: f64, time_s: f64) -> GasLawInputs<f64> {
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
            (None, None, None)
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
            (None, None, None)
        );
        assert_eq!(two.series_drop(5e-4), Some((2.5e5, 5e8)));
        assert_eq!(
            (two.weakening(0.0, 0.0), gas_factor(&two, 0.5, 0.0, 0.0)),
            (Some(2.0), Some(1.5))
        );
        assert!(
            (one.throttled_fraction(-5e5).unwrap() - 0.4).abs() < 1e-12,
            "valve 1 has a law of its own"
        );
        assert!(
            (two.throttled_fraction(5e5).unwrap() - 0.2).abs() < 1e-12,
            "valve 2 has that of all valves"
        );
        assert!(
            (one.throttled_fraction(1e9).unwrap() - 0.99).abs() < 1e-12,
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
        assert_eq!(FlowPath::ALL.map(|path| presliding_m3(&laws, path)), [1e-7, 6e-7]);
        assert_eq!(
            FlowPath::ALL.map(|path| most_held_back_pa(&laws[1..], path)),
            [0.0, 5e4]
        );
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
        assert_eq!(
            (one.weakening(0.0, 0.0), one.weakening(0.0, 10.0)),
            (Some(2.0), Some(4.0))
        );
        assert!((one.groove(0.0, 5.0).unwrap() - 2e-7).abs() < 1e-20);
        assert!((gas_factor(&one, 1.0, 0.0, 10.0).unwrap() - 1.6).abs() < 1e-12);
    }
}
