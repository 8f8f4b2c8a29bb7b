//! A path of oil: damper pack, bypass valve and leaks in parallel, then the line, then the accumulator.

use oleo_interface::Absolute;

use super::stage_end::StageEnd;
use super::state::State;
use crate::strut::characteristic::Characteristic;
use crate::strut::flow_path::FlowPath;
use crate::strut::gas::{Departure, Gas, GasState};
use crate::strut::model::StrutModel;
use crate::strut::orifice::unit_flow;
use crate::strut::terms::{LaminarLine, PackFade, PathLaws, PistonSeal};

/// What a Newton step that is taken without another look may neglect in a pressure drop, Pa. All quantities follow the
/// step linearly, volumes included, so nothing is lost; the error is that of the curved laws, about
/// `step^2 / (2 (|d| + p_t))` for an orifice and `step^2 / p` for gas and bubbles.
pub(super) const NEGLECTED_PA: f64 = 5.0;
/// The same where only a kink of the pack's table is in question: the step across it, Pa.
const ACROSS_KINK_PA: f64 = 50.0;

/// Oil volume that shears the seal of a floating piston to sliding where no term says it, m3.
const PRESLIDING_M3: f64 = 1e-7;

/// One path as the network sees it.
#[derive(Debug, Clone)]
pub(super) struct Path {
    pack: Characteristic,
    valve_coefficient: f64,
    leak_coefficient: f64,
    line: LaminarLine,
    pub gas: Gas,
    pub static_gas_m3: f64,
    piston_seal: PistonSeal,
    pub fade: PackFade,
    /// Unmodelled laws; `None` where the model has none, which then costs one comparison.
    laws: Option<Box<PathLaws>>,
}

/// Where a path starts from in a stage, and what does not change while the stage is solved.
pub(super) struct PathStart<'a> {
    duration_s: f64,
    time_s: f64,
    gas: GasState,
    shear: f64,
    /// What the pack's drop is divided by.
    weakening: f64,
    /// Flow coefficient of all that is in parallel with the pack: bypass valve, leaks and grooves.
    beside_pack: f64,
    /// The bypass valve's part of it.
    bypass: f64,
    transition_pa: f64,
    real: &'a Departure,
    /// Pressure that the floating piston's seal can hold back, Pa.
    breakaway_pa: f64,
    /// Mean of the relative gas volume before the stage, and how much of a departure from it is left at the stage's end.
    mean_volume: f64,
    remembered: f64,
}

/// What a path answers to a trial of the drop across its pack. Slopes are derivatives by the path's flow, but for that
/// of the flow itself, which is by the drop.
pub(super) struct PathAnswer {
    pub flow: f64,
    pub flow_slope: f64,
    /// Gauge pressure on the oil side of the accumulator, Pa.
    pub oil_pa: f64,
    pub oil_slope: f64,
    /// Drop along the line, Pa.
    pub line_pa: f64,
    pub line_slope: f64,
    pub gas: GasState,
    temperature_slope: f64,
    pub shear: f64,
    shear_slope: f64,
    /// Mean of the relative gas volume at the stage's end.
    pub mean_volume: f64,
}

impl PathAnswer {
    /// The answer after the pack's drop has changed by a little.
    #[inline(always)]
    pub fn moved(mut self, step_pa: f64, duration_s: f64) -> Self {
        let flow = self.flow_slope * step_pa;
        self.flow += flow;
        self.oil_pa += self.oil_slope * flow;
        self.shear += self.shear_slope * flow;
        self.gas.temperature_k += self.temperature_slope * flow;
        self.gas.volume_m3 -= duration_s * flow;
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
        Self {
            pack: which.pick(damper_1, damper_2).characteristic(),
            valve_coefficient: which.pick(valve_1, valve_2).total_flow_coefficient(),
            leak_coefficient: (effects.damper_leakage.as_ref()).map_or(0.0, |leak| leak.flow_coefficient(which)),
            line: (effects.line_resistance.as_ref()).map_or_else(LaminarLine::default, |lines| lines.line(which)),
            gas: Gas::charged(
                model.static_pressure().absolute(),
                static_gas_m3,
                model.gas.temperature_k,
                (effects.gas_heat_transfer.as_ref()).map(|heat| heat.time_constant_s(which)),
                effects.real_gas.as_ref().map(|real| real.nitrogen()),
            ),
            static_gas_m3,
            piston_seal: (effects.accumulator_piston_friction.as_ref()).map_or(
                PistonSeal {
                    presliding_m3: PRESLIDING_M3,
                    ..PistonSeal::FREE
                },
                |friction| friction.seal(which),
            ),
            fade: (effects.damping_fade.as_ref()).map_or_else(PackFade::default, |fade| fade.pack(which)),
            laws: (!effects.unlisted.is_empty()).then(|| Box::new(PathLaws::of(&effects.unlisted, which))),
        }
    }

    /// Where the path starts from in a stage. `which` is this path: a constant at every call, so that the state's arrays
    /// are read at fixed places.
    #[inline(always)]
    pub fn start<'a>(
        &self,
        which: FlowPath,
        base: &State,
        at: &StageEnd,
        transition_pa: f64,
        real: &'a Departure,
    ) -> PathStart<'a> {
        let mut bypass = at.opening[which.bypass_valve()] * self.valve_coefficient;
        if let Some(laws) = &self.laws {
            bypass *= laws.valve_in_time(at.time_s);
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
            mean_volume: which.of(base.mean_volume),
            remembered: 0.0,
        };
        if let Some(laws) = &self.laws {
            start.weakening *= laws.weakening(at.displacement_m, at.time_s);
            start.beside_pack += laws.groove(at.displacement_m, at.time_s);
            let held_back_pa = laws.held_back_pa(start.gas.volume_m3 / self.static_gas_m3);
            start.breakaway_pa += held_back_pa.unwrap_or(0.0);
            start.remembered = laws.remembered(at.duration_s);
        }
        start
    }

    /// The path's answer to a trial drop across its pack. `segment` is where in the pack's table the last one was.
    #[inline(always)]
    pub fn answer(&self, start: &PathStart<'_>, drop_pa: f64, segment: &mut usize) -> PathAnswer {
        let (mut flow, mut flow_slope) = self.pack.at(drop_pa * start.weakening, segment);
        flow_slope *= start.weakening;
        if start.beside_pack > 0.0 {
            let (unit, slope) = unit_flow(drop_pa, start.transition_pa);
            let mut coefficient = start.beside_pack;
            if let Some(laws) = &self.laws {
                coefficient -= start.bypass * laws.throttled_fraction(drop_pa);
            }
            flow += coefficient * unit;
            flow_slope += coefficient * slope;
        }
        if let Some(laws) = &self.laws
            && let Some((parallel, slope)) = laws.parallel_flow(drop_pa)
        {
            flow += parallel;
            flow_slope += slope;
        }
        self.answer_to_flow(start, flow, flow_slope)
    }

    /// The part of the answer that follows from the flow.
    #[inline(always)]
    pub fn answer_to_flow(&self, start: &PathStart<'_>, flow: f64, flow_slope: f64) -> PathAnswer {
        let step = self.gas.implicit(start.gas, start.duration_s, flow, start.real);
        let (mut oil_pa, mut oil_slope) = (step.pressure.gauge().pa(), step.pressure_by_flow);
        let mut mean_volume = start.mean_volume;
        if let Some(laws) = &self.laws {
            let relative_volume = step.state.volume_m3 / self.static_gas_m3;
            let changed = start.remembered * (relative_volume - start.mean_volume);
            mean_volume = relative_volume - changed;
            if let Some(factor) = laws.gas_factor(relative_volume, changed, start.time_s) {
                oil_pa = Absolute(factor * step.pressure.pa()).gauge().pa();
                oil_slope *= factor;
            }
        }
        let (mut shear, mut shear_slope) = (start.shear, 0.0);
        if start.breakaway_pa > 0.0 {
            (shear, shear_slope) = self.piston_seal.sheared(start.shear, start.duration_s, flow);
            oil_pa += start.breakaway_pa * shear;
            oil_slope += start.breakaway_pa * shear_slope;
        }
        let (mut line_pa, mut line_slope) = self.line.drop(flow);
        if let Some(laws) = &self.laws
            && let Some((drop, slope)) = laws.series_drop(flow)
        {
            line_pa += drop;
            line_slope += slope;
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
        }
    }

    /// Whether a step from a drop may be taken linearly as far as pack, orifice and piston seal go.
    #[inline(always)]
    pub fn is_nearly_linear(
        &self,
        start: &PathStart<'_>,
        answer: &PathAnswer,
        drop_pa: f64,
        step_pa: f64,
        segment: usize,
    ) -> bool {
        let orifice = step_pa * step_pa <= 2.0 * NEGLECTED_PA * (start.transition_pa + drop_pa.abs());
        let crosses_kink =
            step_pa.abs() > ACROSS_KINK_PA && !self.pack.on_segment((drop_pa + step_pa) * start.weakening, segment);
        let sheared = start.breakaway_pa * answer.shear_slope * answer.flow_slope * step_pa;
        orifice && !crosses_kink && sheared * sheared <= NEGLECTED_PA * start.breakaway_pa
    }
}
