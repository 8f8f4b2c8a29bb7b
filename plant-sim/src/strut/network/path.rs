//! A path of oil: damper pack, bypass valve and leaks in parallel, then the line, then the accumulator.

use oleo_interface::Absolute;

use super::stage_end::StageEnd;
use super::state::State;
use crate::lanes::{Mask, Number};
use crate::strut::characteristic::{Characteristic, Line};
use crate::strut::equation_of_state::EquationOfState;
use crate::strut::flow_path::FlowPath;
use crate::strut::gas::{Departure, Gas, GasState};
use crate::strut::model::StrutModel;
use crate::strut::orifice::unit_flow;
use crate::strut::pressure::gauge;
use crate::strut::terms::{Compressibility, GasLawInputs, LaminarLine, PackFade, PathLaws, PistonSeal, presliding_m3};

/// What a Newton step that is taken without another look may neglect in a pressure drop, Pa. All quantities follow the
/// step linearly, volumes included, so nothing is lost; the error is that of the curved laws, about
/// `step^2 / (2 (|d| + p_t))` for an orifice and `step^2 / p` for gas and bubbles.
pub(super) const NEGLECTED_PA: f64 = 5.0;
/// The same where only a kink of the pack's table is in question: the step across it, Pa.
const ACROSS_KINK_PA: f64 = 50.0;

/// One path as the network sees it.
#[derive(Debug, Clone)]
pub(super) struct Path<N: Number = f64> {
    pack: N::Each<Characteristic>,
    valve_coefficient: N,
    leak_coefficient: N,
    line: LaminarLine<N>,
    pub gas: Gas<N>,
    pub static_gas_m3: N,
    pub piston_seal: PistonSeal<N>,
    pub fade: PackFade<N>,
    /// Unmodelled laws; `None` where the model has none.
    laws: Option<Box<PathLaws<N>>>,
}

/// Where a path starts from in a stage, and what does not change while the stage is solved.
pub(super) struct PathStart<'a, N> {
    duration_s: N,
    time_s: N,
    gas: GasState<N>,
    shear: N,
    /// What the pack's drop is divided by.
    weakening: N,
    /// Flow coefficient of all that is in parallel with the pack: bypass valve, leaks and grooves.
    beside_pack: N,
    /// The bypass valve's part of it.
    bypass: N,
    transition_pa: N,
    real: &'a Departure<N>,
    /// Pressure that the floating piston's seal can hold back, Pa.
    breakaway_pa: N,
    /// Mean of the relative gas volume before the stage, and how much of a departure from it is left at the stage's end.
    mean_volume: N,
    remembered: N,
    /// Energy that the gas holds before the stage by a law without a name, over its static pressure times its static volume.
    gas_energy: N,
    /// Energy that the pack's oil holds then by such a law, J.
    pack_j: N,
}

/// What a path answers to a trial of the drop across its pack. Slopes are derivatives by the path's flow, but for that
/// of the flow itself, which is by the drop.
pub(super) struct PathAnswer<N> {
    pub flow: N,
    pub flow_slope: N,
    /// Gauge pressure on the oil side of the accumulator, Pa.
    pub oil_pa: N,
    pub oil_slope: N,
    /// Drop along the line, Pa.
    pub line_pa: N,
    pub line_slope: N,
    pub gas: GasState<N>,
    temperature_slope: N,
    pub shear: N,
    shear_slope: N,
    /// Mean of the relative gas volume at the stage's end.
    pub mean_volume: N,
    /// Energy that the gas holds then by a law without a name, over its static pressure times its static volume.
    pub gas_energy: N,
}

impl<N: Number> PathAnswer<N> {
    /// The answer after the pack's drop has changed by a little.
    #[inline(always)]
    pub fn moved(mut self, step_pa: N, duration_s: N) -> Self {
        let flow = self.flow_slope * step_pa;
        self.flow = self.flow + flow;
        self.oil_pa = self.oil_pa + self.oil_slope * flow;
        self.shear = self.shear + self.shear_slope * flow;
        self.gas.temperature_k = self.gas.temperature_k + self.temperature_slope * flow;
        self.gas.volume_m3 = self.gas.volume_m3 - duration_s * flow;
        self
    }
}

impl Path {
    pub fn of(model: &StrutModel, which: FlowPath) -> Self {
        let effects = &model.effects;
        let [damper_1, damper_2] = &model.damper;
        let [accumulator_1, accumulator_2] = &model.accumulator;
        let [valve_1, valve_2, _] = &model.valve;
        let charge_error = (effects.gas_charge_error.as_ref()).map_or(0.0, |error| error.relative_error(which));
        let static_gas_m3 = which.pick(accumulator_1, accumulator_2).static_gas_volume_m3 * (1.0 + charge_error);
        let laws = (!effects.unlisted.is_empty()).then(|| {
            let static_energy_j = model.static_pressure().absolute().pa() * static_gas_m3;
            Box::new(PathLaws::of(&effects.unlisted, which, static_energy_j))
        });
        // A seal that only a law without a name makes rub shears as the law says.
        let without_term = PistonSeal {
            presliding_m3: presliding_m3(&effects.unlisted, which),
            ..PistonSeal::FREE
        };
        Self {
            pack: [which.pick(damper_1, damper_2).characteristic()],
            valve_coefficient: which.pick(valve_1, valve_2).total_flow_coefficient(),
            leak_coefficient: (effects.damper_leakage.as_ref()).map_or(0.0, |leak| leak.flow_coefficient(which)),
            line: (effects.line_resistance.as_ref()).map_or_else(LaminarLine::default, |lines| lines.line(which)),
            gas: Gas::obeying(
                EquationOfState::of(
                    effects.real_gas.as_ref().map(|real| real.nitrogen()),
                    Compressibility::at(&effects.unlisted, which),
                    model.static_pressure().absolute(),
                    model.gas.temperature_k,
                ),
                model.static_pressure().absolute(),
                static_gas_m3,
                model.gas.temperature_k,
                (effects.gas_heat_transfer.as_ref()).map(|heat| heat.time_constant_s(which)),
            ),
            static_gas_m3,
            piston_seal: (effects.accumulator_piston_friction.as_ref())
                .map_or(without_term, |friction| friction.seal(which)),
            fade: (effects.damping_fade.as_ref()).map_or_else(PackFade::default, |fade| fade.pack(which)),
            laws,
        }
    }

    /// The same path of several struts side by side, `like` any number of their kind; none where they differ in kind.
    pub fn abreast<N: Number>(paths: &N::Each<&Self>, like: N) -> Option<Path<N>> {
        let all = paths.as_ref();
        let without = PathLaws::of(&[], FlowPath::One, 1.0);
        let laws = N::each(|lane| all[lane].laws.as_deref().unwrap_or(&without));
        let has_laws = all.iter().any(|path| path.laws.is_some());
        let of = |value: fn(&Self) -> f64| like.gather(|lane| value(all[lane]));
        Some(Path {
            pack: N::each(|lane| all[lane].pack[0].clone()),
            valve_coefficient: of(|path| path.valve_coefficient),
            leak_coefficient: of(|path| path.leak_coefficient),
            line: LaminarLine {
                resistance_pa_s_m3: of(|path| path.line.resistance_pa_s_m3),
            },
            gas: Gas::abreast(&N::each(|lane| &all[lane].gas), like)?,
            static_gas_m3: of(|path| path.static_gas_m3),
            piston_seal: PistonSeal {
                breakaway_pa: of(|path| path.piston_seal.breakaway_pa),
                presliding_m3: of(|path| path.piston_seal.presliding_m3),
            },
            fade: PackFade {
                per_j: of(|path| path.fade.per_j),
            },
            laws: has_laws.then(|| Box::new(PathLaws::abreast(&laws, like))),
        })
    }
}

impl<N: Number> Path<N> {
    #[inline(always)]
    fn laws<const LAWS: bool>(&self) -> Option<&PathLaws<N>> {
        if LAWS { self.laws.as_deref() } else { None }
    }

    /// Where the path starts from in a stage. `which` is this path: a constant at every call, so that the state's arrays
    /// are read at fixed places.
    #[inline(always)]
    pub fn start<'a, const LAWS: bool>(
        &self,
        which: FlowPath,
        base: &State<N>,
        at: &StageEnd<N>,
        transition_pa: N,
        real: &'a Departure<N>,
    ) -> PathStart<'a, N> {
        let mut bypass = at.opening[which.bypass_valve()] * self.valve_coefficient;
        if let Some(laws) = self.laws::<LAWS>()
            && let Some(factor) = laws.valve_in_time(at.time_s)
        {
            bypass = bypass * factor;
        }
        let mut start = PathStart {
            duration_s: at.duration_s,
            time_s: at.time_s,
            gas: which.of(base.gas),
            shear: which.of(base.shear),
            weakening: self.fade.weakening(which.of(base.heat_j)),
            beside_pack: bypass + self.leak_coefficient,
            bypass,
            transition_pa,
            real,
            breakaway_pa: self.piston_seal.breakaway_pa,
            mean_volume: which.of(base.laws.mean_volume),
            gas_energy: which.of(base.laws.gas_energy),
            pack_j: which.of(base.laws.pack_j),
            remembered: at.time_s.of(0.0),
        };
        if let Some(laws) = self.laws::<LAWS>() {
            if let Some(weakening) = laws.weakening(at.displacement_m, at.time_s) {
                start.weakening = start.weakening * weakening;
            }
            if let Some(weakening) = laws.weakening_by_energy(start.pack_j) {
                start.weakening = start.weakening * weakening;
            }
            if let Some(groove) = laws.groove(at.displacement_m, at.time_s) {
                start.beside_pack = start.beside_pack + groove;
            }
            if let Some(held_back_pa) = laws.held_back_pa(start.gas.volume_m3 / self.static_gas_m3) {
                start.breakaway_pa = start.breakaway_pa + held_back_pa;
            }
            start.remembered = laws.remembered(at.duration_s);
        }
        start
    }

    /// Energy that the pack's oil holds by a law without a name at the end of a stage, J, after oil has flowed (m3/s) across a drop (Pa).
    #[inline(always)]
    pub fn pack_j<const LAWS: bool>(&self, before_j: N, duration_s: N, drop_pa: N, flow_m3_s: N) -> N {
        match self.laws::<LAWS>() {
            Some(laws) => laws.pack_j(before_j, duration_s, drop_pa * flow_m3_s),
            None => before_j,
        }
    }

    /// The line of the pack's table at a segment that was remembered.
    #[inline(always)]
    pub fn line(&self, segment: &N::Each<usize>, like: N) -> Line<N> {
        Line::remembered(&self.pack, segment, like)
    }

    /// The path's answer to a trial drop across its pack. `line` is the part of the pack's table that the last one was on.
    #[inline(always)]
    pub fn answer<const LAWS: bool>(
        &self,
        start: &PathStart<'_, N>,
        drop_pa: N,
        segment: &mut N::Each<usize>,
        line: &mut Line<N>,
    ) -> PathAnswer<N> {
        let (flow, flow_slope) = self.flow::<LAWS>(start, drop_pa, segment, line);
        self.answer_to_flow::<LAWS>(start, flow, flow_slope)
    }

    /// Flow at a trial drop, m3/s, and its derivative by the drop.
    #[inline(always)]
    pub fn flow<const LAWS: bool>(
        &self,
        start: &PathStart<'_, N>,
        drop_pa: N,
        segment: &mut N::Each<usize>,
        line: &mut Line<N>,
    ) -> (N, N) {
        let cold_drop_pa = drop_pa * start.weakening;
        if !line.holds(cold_drop_pa).all() {
            *line = Line::found(&self.pack, segment, cold_drop_pa);
        }
        let (mut flow, flow_slope) = line.at(cold_drop_pa);
        let mut flow_slope = flow_slope * start.weakening;
        let bypassed = start.beside_pack.above(drop_pa.of(0.0));
        if bypassed.any() {
            let (unit, slope) = unit_flow(drop_pa, start.transition_pa);
            let mut coefficient = start.beside_pack;
            if let Some(laws) = self.laws::<LAWS>()
                && let Some(fraction) = laws.throttled_fraction(drop_pa)
            {
                coefficient = coefficient - start.bypass * fraction;
            }
            flow = N::choose(bypassed, flow + coefficient * unit, flow);
            flow_slope = N::choose(bypassed, flow_slope + coefficient * slope, flow_slope);
        }
        if let Some(laws) = self.laws::<LAWS>()
            && let Some((parallel, slope)) = laws.parallel_flow(drop_pa)
        {
            flow = flow + parallel;
            flow_slope = flow_slope + slope;
        }
        (flow, flow_slope)
    }

    /// The part of the answer that follows from the flow.
    #[inline(always)]
    pub fn answer_to_flow<const LAWS: bool>(&self, start: &PathStart<'_, N>, flow: N, flow_slope: N) -> PathAnswer<N> {
        let step = self.gas.implicit(start.gas, start.duration_s, flow, start.real);
        let (mut oil_pa, mut oil_slope) = (gauge(step.pressure).pa(), step.pressure_by_flow);
        let (mut mean_volume, mut gas_energy) = (start.mean_volume, start.gas_energy);
        if let Some(laws) = self.laws::<LAWS>() {
            let relative_volume = step.state.volume_m3 / self.static_gas_m3;
            let changed = start.remembered * (relative_volume - start.mean_volume);
            mean_volume = relative_volume - changed;
            let gas = laws.gas(&GasLawInputs {
                relative_volume,
                changed,
                time_s: start.time_s,
                duration_s: start.duration_s,
                pressure_pa: step.pressure.pa(),
                flow_m3_s: flow,
                energy: start.gas_energy,
            });
            if let Some(gas) = gas {
                oil_pa = gauge(Absolute(gas.factor * step.pressure.pa())).pa();
                oil_slope = oil_slope * gas.factor + step.pressure.pa() * gas.factor_by_flow;
                gas_energy = gas.energy;
            }
        }
        let (mut shear, mut shear_slope) = (start.shear, flow.of(0.0));
        let rubs = start.breakaway_pa.above(flow.of(0.0));
        if rubs.any() {
            let (sheared, slope) = self.piston_seal.sheared(start.shear, start.duration_s, flow);
            shear = N::choose(rubs, sheared, shear);
            shear_slope = N::choose(rubs, slope, shear_slope);
            oil_pa = N::choose(rubs, oil_pa + start.breakaway_pa * shear, oil_pa);
            oil_slope = N::choose(rubs, oil_slope + start.breakaway_pa * shear_slope, oil_slope);
        }
        let (mut line_pa, mut line_slope) = self.line.drop(flow);
        if let Some(laws) = self.laws::<LAWS>()
            && let Some((drop, slope)) = laws.series_drop(flow)
        {
            line_pa = line_pa + drop;
            line_slope = line_slope + slope;
        }
        PathAnswer {
            flow,
            flow_slope,
            oil_pa,
            oil_slope,
            line_pa,
            line_slope,
            gas: step.state,
            temperature_slope: step.temperature_by_flow,
            shear,
            shear_slope,
            mean_volume,
            gas_energy,
        }
    }

    /// Where a step from a drop may be taken linearly as far as pack, orifice and piston seal go.
    #[inline(always)]
    pub fn is_nearly_linear(
        &self,
        start: &PathStart<'_, N>,
        answer: &PathAnswer<N>,
        drop_pa: N,
        step_pa: N,
        line: &Line<N>,
    ) -> N::Mask {
        let orifice = (step_pa * step_pa).up_to((start.transition_pa + drop_pa.abs()) * (2.0 * NEGLECTED_PA));
        let stays_on_line =
            step_pa.abs().up_to(step_pa.of(ACROSS_KINK_PA)) | line.holds((drop_pa + step_pa) * start.weakening);
        let sheared = start.breakaway_pa * answer.shear_slope * answer.flow_slope * step_pa;
        orifice & stays_on_line & (sheared * sheared).up_to(start.breakaway_pa * NEGLECTED_PA)
    }
}
