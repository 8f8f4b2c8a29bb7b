//! The strut in time: the integrator, which moves the network, the valves and the rod from step to step.
//!
//! Stiff by nature: the main chamber (about 1e-12 m3/Pa behind 1e8 to 4e9 Pa s/m3) settles in 0.1 to 4 ms, gas in seconds.
//! Method: SDIRK2 (Alexander, SIAM J. Numer. Anal. 14(6), 1977), second order, L-stable, stiffly accurate, two equal
//! stages of `gamma h`, `gamma = 1 - 1/sqrt 2`. Each stage is solved by the network. Steps end at kinks of the valves'
//! movements, so no stage integrates across one.

mod snapshot;

use oleo_interface::{StrutValves, Valve};

use crate::model_file::{Checked, InvalidValue};

use super::characteristic::Characteristic;
use super::gas::GasState;
use super::model::StrutModel;
use super::motion::{Cubic, Segment};
use super::network::{LastSolution, Network, StageEnd, State};
use super::rod_course::RodCourse;
use super::rod_forces::RodForces;
use super::rod_state::{Acceleration, RodState};
use super::terms::{
    DampingFade, LawArgument, LawPlace, Mount, ValveTransition, law_at, longest_step_s, total_response_s,
};
use super::valve::ValveMotion;

pub use snapshot::StrutSnapshot;

/// `1 - 1/sqrt 2`.
const GAMMA: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;
/// Longest step while something moves fast, s.
const FAST_STEP_S: f64 = 2.5e-3;
/// Longest step while a valve moves, s: the openings are followed, not only their ends.
const VALVE_STEP_S: f64 = 2e-3;
/// Shortest step, s: a sliver shorter than this is not worth a step of its own.
const LEAST_STEP_S: f64 = 1e-6;
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
/// use oleo_interface::StrutValves;
/// use oleo_plant_sim::strut::{Strut, StrutModel};
/// let model = StrutModel::defender110(8000.0);
/// let open = StrutValves::new(true, true, true);
/// let mut strut = Strut::at_rest(&model, open)?;
/// assert!((strut.output().force_n - 8000.0).abs() < 1.0);
/// // 40 mm of jounce within 10 s on the soft spring (0.5 l): Boyle's law and a little heat.
/// let out = (1..=1000).map(|i| strut.advance(4e-5 * f64::from(i), 0.01, open)).last().unwrap();
/// assert!(out.force_n > 9300.0 && out.force_n < 10_200.0, "{}", out.force_n);
/// # Ok::<(), oleo_plant_sim::model_file::InvalidValue>(())
/// ```
#[derive(Debug, Clone)]
pub struct Strut {
    network: Network,
    rod: RodForces,
    mount: Mount,
    fade: Option<DampingFade>,
    response_polynomial_s: [f64; 3],
    /// Unmodelled time that is added to the response, s, over the pressure difference.
    response_law: Option<Characteristic>,
    /// Unmodelled time that the movement takes, s, over the pressure difference.
    movement_law: Option<Characteristic>,
    initial_delay_fraction: f64,
    /// Longest step that follows the unmodelled laws which repeat, s.
    longest_step_s: f64,
    transition: Option<ValveTransition>,

    time_s: f64,
    actuator_m: f64,
    speed_m_s: f64,
    acceleration: Acceleration,
    /// Displacement that the speeds given to the network add up to. The difference to the true one is made good in the
    /// next step, so that no oil is gained or lost over an hour.
    supplied_m: f64,
    state: State,
    last: LastSolution,
    pressure_pa: [f64; 4],
    valves: StrutValves<ValveMotion>,
    /// What the rod goes through, where somebody asked for it.
    course: Option<Box<RodCourse>>,
}

impl Strut {
    /// A strut at rest at displacement zero, ambient temperature and static pressure, its valves settled where their
    /// switching signals (open: true) say.
    ///
    /// # Errors
    /// Impossible values in the model.
    pub fn at_rest(model: &StrutModel, signals: StrutValves<bool>) -> Result<Self, InvalidValue> {
        Self::at_rest_at(model, signals, 0.0)
    }

    /// A strut at rest at a displacement (m) that it has been brought to slowly, both accumulators connected.
    ///
    /// ```
    /// use oleo_interface::StrutValves;
    /// use oleo_plant_sim::strut::{Strut, StrutModel};
    /// let model = StrutModel::defender110(8000.0);
    /// let strut = Strut::at_rest_at(&model, StrutValves::default(), 0.03)?;
    /// assert!(strut.output().force_n > 8500.0);
    /// # Ok::<(), oleo_plant_sim::model_file::InvalidValue>(())
    /// ```
    ///
    /// # Errors
    /// Impossible values in the model.
    pub fn at_rest_at(
        model: &StrutModel,
        signals: StrutValves<bool>,
        displacement_m: f64,
    ) -> Result<Self, InvalidValue> {
        model.check()?;
        let effects = &model.effects;
        let network = Network::of(model);
        let state = network.at_rest(displacement_m, model.gas.temperature_k);
        Ok(Self {
            network,
            rod: RodForces::of(effects),
            mount: (effects.mount_compliance.as_ref()).map_or_else(Mount::default, |mount| mount.mount()),
            fade: effects.damping_fade.clone(),
            response_polynomial_s: model.response_polynomial_s(),
            response_law: law_at(&effects.unlisted, LawPlace::ValveTiming, LawArgument::PressureDrop),
            movement_law: law_at(&effects.unlisted, LawPlace::ValveMovement, LawArgument::PressureDrop),
            initial_delay_fraction: model.valve_timing.initial_delay_fraction,
            longest_step_s: longest_step_s(&effects.unlisted),
            transition: effects.valve_transition.clone(),
            time_s: 0.0,
            actuator_m: displacement_m,
            speed_m_s: 0.0,
            acceleration: Acceleration::default(),
            supplied_m: displacement_m,
            state,
            last: LastSolution::default(),
            pressure_pa: [state.p1_pa; 4],
            valves: signals.map(ValveMotion::at_rest),
            course: None,
        })
    }

    /// Move linearly to `displacement_m` within `duration_s` under switching signals that hold from now on.
    pub fn advance(&mut self, displacement_m: f64, duration_s: f64, signals: StrutValves<bool>) -> StrutOutput {
        let speed = (displacement_m - self.actuator_m) / duration_s;
        self.advance_with_speeds(displacement_m, speed, speed, duration_s, signals)
    }

    /// Move to `displacement_m` within `duration_s` with the speed going from `from_m_s` to `to_m_s`: for inputs whose
    /// speed is known better than its mean over the step.
    ///
    /// ```
    /// use oleo_interface::StrutValves;
    /// use oleo_plant_sim::strut::{Strut, StrutModel};
    /// let dampers_closed = StrutValves::new(false, false, true);
    /// let mut strut = Strut::at_rest(&StrutModel::defender110(8000.0), dampers_closed)?;
    /// // Within 10 ms from rest to 0.4 m/s: the dampers add to the spring's force.
    /// let out = strut.advance_with_speeds(0.002, 0.0, 0.4, 0.01, dampers_closed);
    /// assert!(out.force_n > 8500.0 && out.pressure_pa[0] > out.pressure_pa[1]);
    /// # Ok::<(), oleo_plant_sim::model_file::InvalidValue>(())
    /// ```
    pub fn advance_with_speeds(
        &mut self,
        displacement_m: f64,
        from_m_s: f64,
        to_m_s: f64,
        duration_s: f64,
        signals: StrutValves<bool>,
    ) -> StrutOutput {
        self.switch(signals);
        let start_s = self.time_s;
        let segment = Segment {
            to_m: displacement_m,
            from_m_s,
            to_m_s,
        };
        let motion = Cubic::through(self.actuator_m, &segment, duration_s);
        let fast = from_m_s.abs() > SLOW_M_S || to_m_s.abs() > SLOW_M_S || (to_m_s - from_m_s).abs() > SLOW_M_S;
        let mut done = 0.0;
        loop {
            let h = self.step_length(
                start_s + done,
                duration_s - done,
                if fast { FAST_STEP_S } else { duration_s },
            );
            let (from, to) = (done / duration_s, (done + h) / duration_s);
            let ends = to > 1.0 - 1e-9;
            let middle = motion.at(from + GAMMA * (to - from));
            let end = if ends { (displacement_m, to_m_s) } else { motion.at(to) };
            self.step(h, middle, end);
            done += h;
            if ends {
                break;
            }
        }
        self.time_s = start_s + duration_s;
        self.actuator_m = displacement_m;
        self.speed_m_s = to_m_s;
        self.acceleration.follow(to_m_s - from_m_s, duration_s);
        self.output()
    }

    /// Length of the next step, s: `left_s` in equal parts no longer than `limit_s`, but no farther than the next kink of a
    /// valve's movement.
    fn step_length(&self, now_s: f64, left_s: f64, limit_s: f64) -> f64 {
        let valves = || self.valves.iter().map(|(_, valve)| valve);
        let kink_s = valves().fold(f64::INFINITY, |t, valve| t.min(valve.next_kink_s(now_s)));
        let limit_s = limit_s.min(self.longest_step_s);
        let limit_s = if valves().any(|valve| valve.moving(now_s)) {
            limit_s.min(VALVE_STEP_S)
        } else {
            limit_s
        };
        let until = (kink_s - now_s).min(left_s);
        let until = if left_s - until < LEAST_STEP_S {
            left_s
        } else {
            until.max(LEAST_STEP_S)
        };
        if until <= limit_s {
            until
        } else {
            until / (until / limit_s).ceil()
        }
    }

    /// Let edges of the switching signals begin their valve's movement.
    fn switch(&mut self, signals: StrutValves<bool>) {
        let [p1, p2, p3, p4] = self.pressure_pa;
        let across = StrutValves::new(p1 - p2, p1 - p3, p3 - p4);
        for valve in Valve::ALL {
            if signals[valve] != self.valves[valve].signal() {
                let mut total_s = total_response_s(self.response_polynomial_s, across[valve]);
                if let Some(law) = &self.response_law {
                    total_s = (total_s + law.value(across[valve].abs())).max(0.0);
                }
                let initial_s = self.initial_delay_fraction * total_s;
                let transition = self.transition.as_ref();
                self.valves[valve].switch(signals[valve], self.time_s, total_s, initial_s, transition);
                if let (None, Some(law)) = (transition, &self.movement_law) {
                    self.valves[valve].take(law.value(across[valve].abs()), self.time_s);
                }
            }
        }
    }

    /// One step of `h` seconds; `middle` and `end` are displacement and speed of the actuator at the ends of its stages.
    fn step(&mut self, h: f64, middle: (f64, f64), end: (f64, f64)) {
        let area_m2 = self.network.chamber.area_m2;
        let hg = GAMMA * h;
        // What the speeds have not supplied so far is supplied evenly over this step.
        let owed_m_s = (self.actuator_m - self.supplied_m) / h;
        // The mount bends under what the force exceeds the static one.
        let over_pa = self.state.p1_pa - self.network.chamber.static_pa;
        let bent_m = self.mount.deflection_m(self.rod.friction_n() + area_m2 * over_pa);
        let now_s = self.time_s;
        let mut at = StageEnd {
            duration_s: hg,
            since_last_s: hg,
            time_s: now_s + hg,
            displacement_m: middle.0 - bent_m,
            speed_m_s: middle.1 + owed_m_s,
            opening: self.openings_at(now_s + hg),
        };
        self.supplied_m += h * (1.0 - GAMMA) * at.speed_m_s;
        let first = self.network.stage(&self.state, &at, &mut self.last);
        let base = self.state.blend(&first.state, (1.0 - GAMMA) / GAMMA);
        at.since_last_s = h - hg;
        at.time_s = now_s + h;
        at.displacement_m = end.0 - bent_m;
        at.speed_m_s = end.1 + owed_m_s;
        // Sampled a nanosecond before the end: an opening that steps there belongs to the next step.
        at.opening = self.openings_at(now_s + h - 1e-9);
        self.supplied_m += hg * at.speed_m_s;
        let second = self.network.stage(&base, &at, &mut self.last);
        self.state = second.state;
        self.pressure_pa = second.pressure_pa;
        if let Some(fade) = &self.fade {
            self.state.heat_j = self.state.heat_j.map(|energy_j| fade.cooled(energy_j, h));
        }
        let stroke_m = end.0 - self.actuator_m;
        self.time_s = now_s + h;
        self.actuator_m = end.0;
        self.speed_m_s = end.1;
        let rod = self.rod_state();
        self.rod.follow(stroke_m, h, &rod);
        if let Some(course) = &mut self.course {
            course.push_step(stroke_m, h, rod);
        }
    }

    /// Notes from now on what the rod goes through.
    pub(super) fn begin_course(&mut self) {
        self.course = Some(Box::default());
    }

    /// Notes a sample.
    pub(super) fn note_sample(&mut self) {
        let rod = self.rod_state();
        if let Some(course) = &mut self.course {
            course.push_sample(rod);
        }
    }

    /// What the rod went through, if it was noted.
    pub(super) fn into_course(self) -> Option<RodCourse> {
        self.course.map(|course| *course)
    }

    fn openings_at(&self, time_s: f64) -> StrutValves<f64> {
        StrutValves::from_fn(|valve| self.valves[valve].opening(time_s))
    }

    fn rod_state(&self) -> RodState {
        let [p1_pa, ..] = self.pressure_pa;
        RodState {
            displacement_m: self.actuator_m,
            speed_m_s: self.speed_m_s,
            acceleration: self.acceleration,
            p1_pa,
            oil_force_n: self.network.chamber.area_m2 * p1_pa,
            time_s: self.time_s,
        }
    }

    /// Force and pressures now.
    #[must_use]
    pub fn output(&self) -> StrutOutput {
        StrutOutput {
            force_n: self.rod.total_n(&self.rod_state()),
            pressure_pa: self.pressure_pa,
        }
    }

    /// Openings of the three valves, 0 (closed) to 1 (open).
    #[must_use]
    pub fn openings(&self) -> StrutValves<f64> {
        self.openings_at(self.time_s)
    }

    /// Displacement of the actuator (wheel side), m, compression positive.
    #[must_use]
    pub fn displacement_m(&self) -> f64 {
        self.actuator_m
    }

    /// Flows into path 1 and 2, m3/s, out of the main chamber positive.
    #[must_use]
    pub fn flow_m3_s(&self) -> [f64; 2] {
        self.last.flow
    }

    /// Gas states of accumulators 1 and 2.
    #[must_use]
    pub fn gas(&self) -> [GasState; 2] {
        self.state.gas
    }
}
