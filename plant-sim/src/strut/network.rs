//! The strut in time: valves, the two-stage implicit Runge-Kutta step, friction and stops, sensors' truth.
//!
//! Stiff by nature: the main chamber (about 1e-12 m3/Pa behind 1e8 to 4e9 Pa s/m3) settles in 0.1 to 4 ms, gas in seconds.
//! Method: SDIRK2 (Alexander, SIAM J. Numer. Anal. 14(6), 1977), second order, L-stable, stiffly accurate, two equal
//! stages of `gamma h`, `gamma = 1 - 1/sqrt 2`; each stage is [`Parameters::stage`], of static size. Steps end at kinks of
//! valve movements, so no stage integrates across one.

use super::characteristic::Characteristic;
use super::effects::{BumpStop, Effects, GasEquation, LawArgument, LawPlace, OilCount, SealFriction, SideLoadFriction};
use super::friction::advance_friction;
use super::gas::{Gas, GasState};
use super::laws::{PathLaws, law_at, throttle_of};
use super::model::{ATMOSPHERE_PA, ModelError, StrutModel};
use super::nitrogen::Nitrogen;
use super::solve::{Guess, Moment, Parameters, Path, Store};
use super::stops::stop_force_n;
use super::valve::ValveMotion;

/// `1 - 1/sqrt 2`.
const GAMMA: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;
/// Longest step while something moves fast, s.
const FAST_STEP_S: f64 = 2.5e-3;
/// Longest step while a valve moves, s: the openings are followed, not only their ends.
const VALVE_STEP_S: f64 = 2e-3;
/// Below this speed and change of speed a step may be as long as the recording's sampling interval, m/s.
const SLOW_M_S: f64 = 0.02;

/// What the instruments of one strut would read without noise.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StrutOutput {
    /// Force, N, compression positive.
    pub force_n: f64,
    /// Gauge pressures p1 to p4, Pa.
    pub pressure_pa: [f64; 4],
}

/// A strut: compiled model and state. Compression positive; displacement from the static position.
///
/// ```
/// use oleo_plant_sim::strut::{Strut, StrutModel};
/// let model = StrutModel::defender110(8000.0);
/// let mut strut = Strut::at_rest(&model, [true, true, true])?;
/// assert!((strut.output().force_n - 8000.0).abs() < 1.0);
/// // 40 mm of jounce within 10 s on the soft spring (0.5 l): Boyle's law and a little heat.
/// let out = (1..=1000).map(|i| strut.advance(4e-5 * f64::from(i), 0.01, [true; 3])).last().unwrap();
/// assert!(out.force_n > 9300.0 && out.force_n < 10_200.0, "{}", out.force_n);
/// # Ok::<(), oleo_plant_sim::strut::ModelError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Strut {
    parameters: Parameters,
    seal: Option<SealFriction>,
    side_load: Option<SideLoadFriction>,
    stops: Option<BumpStop>,
    force_law: Option<(LawArgument, Characteristic)>,
    friction_law: Option<(LawArgument, Characteristic)>,
    cooling_time_s: f64,
    response: [f64; 3],
    initial_delay_fraction: f64,
    gradual: bool,

    time_s: f64,
    actuator_m: f64,
    speed_m_s: f64,
    /// Displacement that the flows have been told of; the difference to the true one is given back in the next step, so
    /// that no oil is gained or lost over an hour.
    told_m: f64,
    friction_n: f64,
    static_pa: f64,
    store: Store,
    guess: Guess,
    pressure: [f64; 4],
    valves: [ValveMotion; 3],
}

impl Strut {
    /// A strut at rest at displacement zero, ambient temperature and static pressure, its valves settled.
    ///
    /// # Errors
    /// Impossible values in the model.
    pub fn at_rest(model: &StrutModel, signals: [bool; 3]) -> Result<Self, ModelError> {
        Self::at_rest_at(model, signals, 0.0)
    }

    /// A strut at rest at a displacement that it has been brought to slowly, both accumulators connected.
    ///
    /// # Errors
    /// Impossible values in the model.
    pub fn at_rest_at(model: &StrutModel, signals: [bool; 3], displacement_m: f64) -> Result<Self, ModelError> {
        model.check().map_err(|(key, what)| ModelError {
            file: model.specimen.name.clone(),
            line: None,
            what: format!("{key} {what}"),
        })?;
        let e = &model.effects;
        let parameters = parameters(model);
        let static_pa = model.cylinder.static_pressure_pa;
        let rest_pa = rest_pressure(&parameters, static_pa, displacement_m);
        let at_rest = |i: usize| GasState {
            volume_m3: parameters.paths[i].gas.volume_at(rest_pa + ATMOSPHERE_PA),
            temperature_k: model.gas.temperature_k,
        };
        let store = Store {
            p1: rest_pa,
            gas: [at_rest(0), at_rest(1)],
            held: parameters.held(rest_pa, displacement_m).0,
            squeezed: parameters.squeezed(rest_pa).0,
            q2: 0.0,
            shear: [0.0; 2],
            heat: [0.0; 2],
        };
        let polynomial = e
            .valve_delay
            .as_ref()
            .map_or(&model.valve_timing.response_polynomial_s[..], |d| {
                &d.response_polynomial_s
            });
        let mut response = [0.0; 3];
        response.iter_mut().zip(polynomial).for_each(|(to, from)| *to = *from);
        Ok(Self {
            parameters,
            seal: e.seal_friction.clone(),
            side_load: e.side_load_friction.clone(),
            stops: e.bump_stop.clone(),
            force_law: seal_law(e, LawPlace::MainSeal),
            friction_law: seal_law(e, LawPlace::MainSealFriction),
            cooling_time_s: e.damping_fade.as_ref().map_or(f64::INFINITY, |f| f.cooling_time_s),
            response,
            initial_delay_fraction: model.valve_timing.initial_delay_fraction,
            gradual: e.valve_transition.is_some(),
            time_s: 0.0,
            actuator_m: displacement_m,
            speed_m_s: 0.0,
            told_m: displacement_m,
            friction_n: 0.0,
            static_pa,
            store,
            guess: Guess::default(),
            pressure: [rest_pa; 4],
            valves: signals.map(ValveMotion::at_rest),
        })
    }

    /// Move linearly to `displacement_m` within `duration_s` under switching signals that hold from now on.
    pub fn advance(&mut self, displacement_m: f64, duration_s: f64, signals: [bool; 3]) -> StrutOutput {
        let speed = (displacement_m - self.actuator_m) / duration_s;
        self.advance_with_speeds(displacement_m, speed, speed, duration_s, signals)
    }

    /// Move to `displacement_m` within `duration_s` with the speed going from `from_m_s` to `to_m_s`: for inputs whose
    /// speed is known better than its mean over the step.
    pub fn advance_with_speeds(
        &mut self,
        displacement_m: f64,
        from_m_s: f64,
        to_m_s: f64,
        duration_s: f64,
        signals: [bool; 3],
    ) -> StrutOutput {
        self.switch(signals);
        let (start, x0) = (self.time_s, self.actuator_m);
        // Cubic through both ends: displacement and speed agree at any kink inside the step.
        let (a, b) = (from_m_s * duration_s, to_m_s * duration_s);
        let rise = displacement_m - x0;
        let at = |s: f64| {
            let (c2, c3) = (3.0 * rise - 2.0 * a - b, a + b - 2.0 * rise);
            (
                x0 + s * (a + s * (c2 + s * c3)),
                (a + s * (2.0 * c2 + 3.0 * s * c3)) / duration_s,
            )
        };
        let fast = from_m_s.abs() > SLOW_M_S || to_m_s.abs() > SLOW_M_S || (to_m_s - from_m_s).abs() > SLOW_M_S;
        let mut done = 0.0;
        loop {
            let now = start + done;
            let kink = self.valves.iter().fold(f64::INFINITY, |t, v| t.min(v.next_kink_s(now)));
            let moving = self.valves.iter().any(|v| v.moving(now));
            let mut limit = if fast { FAST_STEP_S } else { duration_s };
            if moving {
                limit = limit.min(VALVE_STEP_S);
            }
            let left = duration_s - done;
            // Equal steps to the next kink or the end; a sliver shorter than a microsecond is not worth a step.
            let until = (kink - now).min(left);
            let until = if left - until < 1e-6 { left } else { until.max(1e-6) };
            let h = if until <= limit {
                until
            } else {
                until / (until / limit).ceil()
            };
            let (s0, s1) = (done / duration_s, (done + h) / duration_s);
            let ends = s1 > 1.0 - 1e-9;
            let middle = at(s0 + GAMMA * (s1 - s0));
            let end = if ends { (displacement_m, to_m_s) } else { at(s1) };
            self.step(h, middle, end);
            done += h;
            if ends {
                break;
            }
        }
        self.time_s = start + duration_s;
        self.actuator_m = displacement_m;
        self.speed_m_s = to_m_s;
        self.output()
    }

    /// Let edges of the switching signals begin their valve's movement.
    fn switch(&mut self, signals: [bool; 3]) {
        let p = &self.pressure;
        let across = [p[0] - p[1], p[0] - p[2], p[2] - p[3]];
        for i in 0..3 {
            if signals[i] != self.valves[i].signal() {
                let mega = 1e-6 * across[i].abs();
                let [c0, c1, c2] = self.response;
                let total = (c0 + mega * (c1 + mega * c2)).max(0.0);
                self.valves[i].switch(
                    signals[i],
                    self.time_s,
                    total,
                    self.initial_delay_fraction * total,
                    self.gradual,
                );
            }
        }
    }

    fn step(&mut self, h: f64, middle: (f64, f64), end: (f64, f64)) {
        let p = &self.parameters;
        let hg = GAMMA * h;
        // Displacement not yet told to the flows, told evenly over this step.
        let owed = (self.actuator_m - self.told_m) / h;
        // The mount bends by what the force exceeds the static one.
        let bent = (self.friction_n + p.area_m2 * (self.store.p1 - self.static_pa)) * p.mount_flexibility;
        let now = self.time_s;
        let opening = |t: f64| {
            [
                self.valves[0].opening(t),
                self.valves[1].opening(t),
                self.valves[2].opening(t),
            ]
        };
        let mut at = Moment {
            h: hg,
            since: hg,
            displacement_m: middle.0 - bent,
            speed_m_s: middle.1 + owed,
            opening: opening(now + hg),
        };
        self.told_m += h * (1.0 - GAMMA) * at.speed_m_s;
        let first = p.stage(&self.store, &at, &mut self.guess);
        let base = self.store.blend(&first.store, (1.0 - GAMMA) / GAMMA);
        at.since = h - hg;
        at.displacement_m = end.0 - bent;
        at.speed_m_s = end.1 + owed;
        // Sampled a nanosecond before the end: an opening that steps there belongs to the next step.
        at.opening = opening(now + h - 1e-9);
        self.told_m += hg * at.speed_m_s;
        let last = p.stage(&base, &at, &mut self.guess);
        self.store = last.store;
        self.pressure = last.pressure;
        if self.cooling_time_s.is_finite() {
            let kept = 1.0 / (1.0 + h / self.cooling_time_s);
            self.store.heat = self.store.heat.map(|e| e * kept);
        }
        if self.seal.is_some() || self.side_load.is_some() || self.friction_law.is_some() {
            let stroke = end.0 - self.actuator_m;
            let mut level = self.seal.as_ref().map_or(0.0, |s| s.level_n(stroke / h));
            if let Some(side) = &self.side_load {
                level += side.level_n(p.area_m2 * last.pressure[0], end.0);
            }
            if let Some((argument, law)) = &self.friction_law {
                level += law.value(seal_argument(*argument, end.0, end.1, last.pressure[0]));
            }
            self.friction_n = advance_friction(self.friction_n, stroke, level, self.seal.as_ref());
        }
        self.time_s = now + h;
        self.actuator_m = end.0;
        self.speed_m_s = end.1;
    }

    /// Force and pressures now.
    #[must_use]
    pub fn output(&self) -> StrutOutput {
        let mut force_n = self.parameters.area_m2 * self.pressure[0] + self.friction_n;
        if let Some(stops) = &self.stops {
            force_n += stop_force_n(stops, self.actuator_m);
        }
        if let Some((argument, law)) = &self.force_law {
            let at = seal_argument(*argument, self.actuator_m, self.speed_m_s, self.pressure[0]);
            force_n += law.value(at);
        }
        StrutOutput {
            force_n,
            pressure_pa: self.pressure,
        }
    }

    /// Openings of the three valves, 0 to 1.
    #[must_use]
    pub fn openings(&self) -> [f64; 3] {
        [0, 1, 2].map(|i| self.valves[i].opening(self.time_s))
    }

    /// Displacement of the actuator (wheel side), m, compression positive.
    #[must_use]
    pub fn displacement_m(&self) -> f64 {
        self.actuator_m
    }

    /// Flows into path 1 and 2, m3/s.
    #[must_use]
    pub fn flow_m3_s(&self) -> [f64; 2] {
        self.guess.flow
    }

    /// Gas states of accumulators 1 and 2.
    #[must_use]
    pub fn gas(&self) -> [GasState; 2] {
        self.store.gas
    }
}

fn seal_law(effects: &Effects, place: LawPlace) -> Option<(LawArgument, Characteristic)> {
    (effects.unlisted.iter())
        .find(|l| l.place == place)
        .map(|l| (l.depends_on, Characteristic::through(&l.argument, &l.value)))
}

/// What a law at the seal is read at.
fn seal_argument(argument: LawArgument, displacement_m: f64, speed_m_s: f64, p1_pa: f64) -> f64 {
    match argument {
        LawArgument::Displacement => displacement_m,
        LawArgument::Speed => speed_m_s,
        _ => p1_pa,
    }
}

/// Gauge pressure at which both gas charges and the oil fill the strut at a displacement: the volume they give way,
/// from static, is the piston's. Newton's method on a monotone function.
fn rest_pressure(parameters: &Parameters, static_pa: f64, displacement_m: f64) -> f64 {
    if displacement_m == 0.0 {
        return static_pa;
    }
    let given_way = |p: f64| {
        let gas = |i: usize| {
            let g = &parameters.paths[i].gas;
            g.volume_at(static_pa + ATMOSPHERE_PA) - g.volume_at(p + ATMOSPHERE_PA)
        };
        gas(0) + gas(1) + parameters.oil_volume_m3 * parameters.inverse_bulk_modulus * (p - static_pa)
    };
    let wanted = parameters.area_m2 * displacement_m;
    let mut p = static_pa;
    for _ in 0..30 {
        let dp = 1e-4 * (p + ATMOSPHERE_PA);
        let slope = (given_way(p + dp) - given_way(p)) / dp;
        p = (p + (wanted - given_way(p)) / slope).clamp(-0.9 * ATMOSPHERE_PA, 60e6);
    }
    p
}

/// What the solver needs of a model.
fn parameters(model: &StrutModel) -> Parameters {
    let e: &Effects = &model.effects;
    let area_m2 = model.piston_area_m2();
    let real = e.real_gas.as_ref().map(|r| match r.equation {
        GasEquation::Reference => Nitrogen::reference(),
        GasEquation::Bwr => Nitrogen::bwr(),
    });
    let path = |i: usize| {
        let pick = |a: f64, b: f64| if i == 0 { a } else { b };
        let tau = e
            .gas_heat_transfer
            .as_ref()
            .map(|t| pick(t.time_constant_1_s, t.time_constant_2_s));
        let charge = e
            .gas_charge_error
            .as_ref()
            .map_or(0.0, |c| pick(c.relative_error_1, c.relative_error_2));
        let volume = model.accumulator[i].static_gas_volume_m3 * (1.0 + charge);
        Path {
            pack: model.damper[i].characteristic(),
            valve_coefficient: model.valve[i].total_flow_coefficient(),
            leak_coefficient: e
                .damper_leakage
                .as_ref()
                .map_or(0.0, |l| pick(l.flow_coefficient_1, l.flow_coefficient_2)),
            resistance: e
                .line_resistance
                .as_ref()
                .map_or(0.0, |l| pick(l.resistance_1_pa_s_m3, l.resistance_2_pa_s_m3)),
            gas: Gas::charged(
                model.cylinder.static_pressure_pa + ATMOSPHERE_PA,
                volume,
                model.gas.temperature_k,
                tau,
                real.clone(),
            ),
            piston_presliding_m3: (e.accumulator_piston_friction.as_ref()).map_or(1.0, |f| f.presliding_volume_m3),
            piston_friction_pa: e
                .accumulator_piston_friction
                .as_ref()
                .map_or(0.0, |f| pick(f.pressure_1_pa, f.pressure_2_pa)),
            fade_per_j: e
                .damping_fade
                .as_ref()
                .map_or(0.0, |f| pick(f.fade_1_per_j, f.fade_2_per_j)),
            laws: PathLaws::of(&e.unlisted, i),
            static_gas_m3: volume,
        }
    };
    let flexibility = e.mount_compliance.as_ref().map_or(0.0, |m| 1.0 / m.stiffness_n_m);
    Parameters {
        area_m2,
        oil_volume_m3: model.cylinder.oil_volume_m3,
        inverse_bulk_modulus: e.oil_compressibility.as_ref().map_or(0.0, |o| 1.0 / o.bulk_modulus_pa),
        conserves_oil: e
            .oil_compressibility
            .as_ref()
            .is_some_and(|o| o.counted_at == OilCount::Static),
        static_pa: model.cylinder.static_pressure_pa,
        air: e.entrained_air.clone(),
        mount_compliance: area_m2 * area_m2 * flexibility,
        mount_flexibility: flexibility,
        volume_law: law_at(&e.unlisted, LawPlace::MainChamber, LawArgument::P1),
        loss_law: law_at(&e.unlisted, LawPlace::MainChamberLoss, LawArgument::P1),
        valve3_law: throttle_of(&e.unlisted, 2),
        has_unlisted: !e.unlisted.is_empty(),
        paths: [path(0), path(1)],
        valve3_coefficient: model.valve[2].total_flow_coefficient(),
        valve3_leak: e.valve3_leakage.as_ref().map_or(0.0, |l| l.flow_coefficient),
        inertance: e.line_inertance.as_ref().map_or(0.0, |l| l.inertance_2_kg_m4),
        transition_pa: model.orifice.transition_pressure_pa,
    }
}
