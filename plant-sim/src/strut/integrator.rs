//! The strut in time: the integrator, which moves the network, the valves and the rod from step to step.
//!
//! Steps end at kinks of the valves' movements, so that no stage integrates across one. What is stiff is solved one level down, by
//! [`hydraulics`](super::hydraulics).

mod oil_swing;
mod seal_shear;
mod snapshot;

use oleo_interface::{StrutValves, Valve};

use crate::model_file::{Checked, InvalidValue};

use super::beginning::Beginning;
use super::characteristic::Characteristic;
use super::gas::GasState;
use super::hydraulics::{Flowing, GAMMA, Hydraulics, Step};
use super::model::StrutModel;
use super::motion::{Cubic, Segment, StrutMove};
use super::network::LastSolution;
use super::rod_course::RodCourse;
use super::rod_forces::RodForces;
use super::rod_state::{Acceleration, RodState, RodStep};
use super::terms::{LawArgument, LawPlace, ValveTransition, law_at, longest_step_s, total_response_s};
use super::valve::ValveMotion;

use oil_swing::OilSwing;
use seal_shear::SealShear;
pub use snapshot::StrutSnapshot;

/// Longest step while something moves fast, s.
const FAST_STEP_S: f64 = 2.5e-3;
/// The same while a bypass valve is closed, s: behind a damper pack the main chamber takes about 4 ms to settle, which is
/// neither long nor short beside a step, so that the step's error is largest there.
const DAMPED_STEP_S: f64 = 1.25e-3;
/// Longest step while a valve moves, s: the openings are followed, not only their ends.
const VALVE_STEP_S: f64 = 2e-3;
/// Shortest step, s: a sliver shorter than this is not worth a step of its own.
const LEAST_STEP_S: f64 = 1e-6;
/// Below this speed and change of speed a step may be as long as the recording's sampling interval, m/s ...
const SLOW_M_S: f64 = 0.02;
/// ... from this time after the last fast movement on, s: until then the main chamber settles.
const SETTLES_S: f64 = 0.02;

/// Time from which on none of the valves moves or is about to, s.
fn settled_s(valves: &StrutValves<ValveMotion>) -> f64 {
    valves
        .iter()
        .fold(f64::NEG_INFINITY, |latest, (_, valve)| latest.max(valve.settled_s()))
}

/// A fraction of an interval that is not worth a step.
const NOTHING_LEFT: f64 = 1e-9;

/// An interval over which a strut moves, and how far it has come.
#[derive(Debug, Clone, Copy)]
pub(super) struct Interval {
    start_s: f64,
    duration_s: f64,
    segment: Segment,
    motion: Cubic,
    longest_step_s: f64,
    done_s: f64,
    /// The same as a fraction of the interval.
    done: f64,
}

impl Interval {
    /// One that is over.
    pub fn over() -> Self {
        let segment = Segment::rest(0.0);
        Self {
            start_s: 0.0,
            duration_s: 1.0,
            segment,
            motion: Cubic::through(0.0, &segment, 1.0),
            longest_step_s: 1.0,
            done_s: 1.0,
            done: 1.0,
        }
    }

    #[inline(always)]
    pub fn is_over(&self) -> bool {
        self.done > 1.0 - NOTHING_LEFT
    }

    /// A time since its beginning (s) as a fraction. Most intervals are one step, which needs no division.
    #[inline(always)]
    fn fraction(&self, since_start_s: f64) -> f64 {
        if since_start_s == self.duration_s {
            1.0
        } else {
            since_start_s / self.duration_s
        }
    }
}

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
    pub(super) hydraulics: Hydraulics,
    pub(super) rod: RodForces,
    response_polynomial_s: [f64; 3],
    /// Unmodelled time that is added to the response, s, over the pressure difference.
    response_law: Option<Characteristic>,
    /// Unmodelled time that the movement takes, s, over the pressure difference.
    movement_law: Option<Characteristic>,
    initial_delay_fraction: f64,
    /// Longest step that follows the unmodelled laws which repeat, s.
    longest_step_s: f64,
    transition: Option<ValveTransition>,
    /// The oil column of line 2, where it has mass.
    swing: Option<OilSwing>,
    /// The seals of the floating pistons, where they rub.
    seals: Option<SealShear>,
    /// End of the last interval in which the piston moved fast, s.
    fast_until_s: f64,

    time_s: f64,
    actuator_m: f64,
    speed_m_s: f64,
    acceleration: Acceleration,
    pub(super) flowing: Flowing,
    valves: StrutValves<ValveMotion>,
    /// Time from which on no valve moves or is about to, s.
    settled_s: f64,
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
        Self::beginning(model, signals, displacement_m, &Beginning::AtRest)
    }

    /// A strut at a displacement (m) at which it is at rest, or in the middle of a drive.
    ///
    /// # Errors
    /// Impossible values in the model.
    pub(super) fn beginning(
        model: &StrutModel,
        signals: StrutValves<bool>,
        displacement_m: f64,
        begins: &Beginning,
    ) -> Result<Self, InvalidValue> {
        model.check()?;
        let effects = &model.effects;
        let hydraulics = Hydraulics::of(model);
        let (network, ambient_k) = (&hydraulics.network, model.gas.temperature_k);
        let mut state = match begins {
            Beginning::AtRest => network.at_rest(displacement_m, ambient_k),
            Beginning::InMotion(begins) => network.in_motion(displacement_m, ambient_k, begins),
        };
        if let (Some(cooling), Beginning::InMotion(begins)) = (&hydraulics.cooling, begins) {
            state.heat_j = begins.heating_w.map(|power_w| cooling.held_j(power_w, begins.heated_s));
        }
        let mut pressure_pa = [state.p1_pa; 4];
        if let Beginning::InMotion(begins) = begins {
            [pressure_pa[1], pressure_pa[3]] = begins.accumulator_pa;
        }
        Ok(Self {
            swing: OilSwing::of(&hydraulics.network, model.gas.temperature_k),
            seals: SealShear::of(effects),
            fast_until_s: 0.0,
            hydraulics,
            rod: RodForces::of(effects),
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
            flowing: Flowing {
                state,
                last: LastSolution::default(),
                pressure_pa,
                supplied_m: displacement_m,
            },
            valves: signals.map(ValveMotion::at_rest),
            settled_s: f64::NEG_INFINITY,
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
        let segment = Segment {
            to_m: displacement_m,
            from_m_s,
            to_m_s,
        };
        self.advance_by(&StrutMove {
            segment,
            duration_s,
            signals,
        })
    }

    /// Makes a move.
    pub fn advance_by(&mut self, by: &StrutMove) -> StrutOutput {
        let mut interval = self.begin(by);
        self.take_steps(&mut interval);
        self.finish(&interval, None)
    }

    /// Takes the steps of an interval that are left. A step is long, and compiled once for all who take one.
    #[inline(never)]
    pub(super) fn take_steps(&mut self, interval: &mut Interval) {
        while !interval.is_over() {
            let step = self.next_step(interval);
            self.hydraulics.step(&mut self.flowing, &step);
            self.conclude(&step, None, interval);
        }
    }

    /// Begins to make a move.
    #[inline(always)]
    pub(super) fn begin(&mut self, by: &StrutMove) -> Interval {
        self.switch(by.signals);
        let StrutMove {
            segment, duration_s, ..
        } = *by;
        let (from_m_s, to_m_s) = (segment.from_m_s, segment.to_m_s);
        // A corner of the motion is a jump between two intervals.
        let change_m_s = (from_m_s - self.speed_m_s).abs() + (to_m_s - from_m_s).abs();
        let kicked_s = (self.swing.as_ref()).map_or(f64::INFINITY, |swing| swing.longest_step_of_kick_s(change_m_s));
        let fast = from_m_s.abs() > SLOW_M_S || to_m_s.abs() > SLOW_M_S || (to_m_s - from_m_s).abs() > SLOW_M_S;
        if fast {
            self.fast_until_s = self.time_s + duration_s;
        }
        let settles = fast || self.time_s < self.fast_until_s + SETTLES_S;
        Interval {
            start_s: self.time_s,
            duration_s,
            segment,
            motion: Cubic::through(self.actuator_m, &segment, duration_s),
            longest_step_s: match settles {
                false => duration_s,
                true if by.signals[Valve::Bypass1] && by.signals[Valve::Bypass2] => FAST_STEP_S,
                true => DAMPED_STEP_S,
            }
            .min(kicked_s),
            done_s: 0.0,
            done: 0.0,
        }
    }

    /// The next step of an interval that is not over.
    #[inline(always)]
    pub(super) fn next_step(&self, interval: &Interval) -> Step {
        let Interval { duration_s, done_s, .. } = *interval;
        let h = self.step_length(interval.start_s + done_s, duration_s - done_s, interval.longest_step_s);
        let (from, to) = (interval.done, interval.fraction(done_s + h));
        let (middle_m, middle_m_s) = interval.motion.at(from + GAMMA * (to - from));
        let (end_m, end_m_s) = if to > 1.0 - NOTHING_LEFT {
            (interval.segment.to_m, interval.segment.to_m_s)
        } else {
            interval.motion.at(to)
        };
        let now_s = self.time_s;
        Step {
            begins_s: now_s,
            duration_s: h,
            from_m: self.actuator_m,
            from_p1_pa: self.flowing.pressure_pa[0],
            middle: [middle_m, middle_m_s],
            end: [end_m, end_m_s],
            // Sampled a nanosecond before the end: an opening that steps there belongs to the next step.
            opening: self.openings_at_both(now_s + GAMMA * h, now_s + h - 1e-9),
            friction_n: self.rod.friction_n(),
        }
    }

    /// Lets time, rod and course follow a step that the hydraulics have taken. The friction (N) is worked out here, unless it was worked out beside
    /// that of others.
    #[inline(always)]
    pub(super) fn conclude(&mut self, step: &Step, friction_n: Option<f64>, interval: &mut Interval) {
        let [end_m, end_m_s] = step.end;
        let stroke_m = end_m - self.actuator_m;
        self.time_s = step.begins_s + step.duration_s;
        self.actuator_m = end_m;
        self.speed_m_s = end_m_s;
        if let Some(swing) = &mut self.swing {
            swing.follow(step.duration_s, self.flowing.state.q2_m3_s);
        }
        let through = |strut: &Self| RodStep {
            stroke_m,
            duration_s: step.duration_s,
            begun_p1_pa: step.from_p1_pa,
            begun_oil_force_n: strut.hydraulics.network.chamber.area_m2 * step.from_p1_pa,
            end: strut.rod_state(),
        };
        match friction_n {
            Some(friction_n) => self.rod.set_friction_n(friction_n),
            None if self.rod.rubs() => {
                let step = through(self);
                self.rod.follow(&step);
            }
            None => {}
        }
        if self.course.is_some() {
            let step = through(self);
            if let Some(course) = &mut self.course {
                course.push_step(step);
            }
        }
        interval.done_s += step.duration_s;
        interval.done = interval.fraction(interval.done_s);
    }

    /// Ends an interval that is over. The acceleration at its end, m/s2, follows from the speeds where it is not known.
    #[inline(always)]
    pub(super) fn finish(&mut self, interval: &Interval, acceleration_m_s2: Option<f64>) -> StrutOutput {
        let Segment { to_m, from_m_s, to_m_s } = interval.segment;
        self.time_s = interval.start_s + interval.duration_s;
        self.actuator_m = to_m;
        self.speed_m_s = to_m_s;
        match acceleration_m_s2 {
            Some(known) => self.acceleration = Acceleration::known(known),
            None => self.acceleration.follow(to_m_s - from_m_s, interval.duration_s),
        }
        self.output()
    }

    /// Length of the next step, s: `left_s` in equal parts no longer than `limit_s`, but no farther than the next kink of a
    /// valve's movement.
    #[inline(always)]
    fn step_length(&self, now_s: f64, left_s: f64, limit_s: f64) -> f64 {
        let swing_s = (self.swing.as_ref()).map_or(f64::INFINITY, OilSwing::longest_step_s);
        let shear_s = (self.seals.as_ref()).map_or(f64::INFINITY, |seals| {
            seals.longest_step_s(now_s, self.settled_s, self.fast_until_s)
        });
        let limit_s = limit_s.min(self.longest_step_s).min(swing_s).min(shear_s);
        if now_s < self.settled_s {
            return self.step_length_while_valves_move(now_s, left_s, limit_s);
        }
        if left_s <= limit_s {
            left_s
        } else {
            left_s / (left_s / limit_s).ceil()
        }
    }

    /// The same while a valve moves or is about to.
    #[inline(never)]
    fn step_length_while_valves_move(&self, now_s: f64, left_s: f64, limit_s: f64) -> f64 {
        let valves = || self.valves.iter().map(|(_, valve)| valve);
        let kink_s = valves().fold(f64::INFINITY, |t, valve| t.min(valve.next_kink_s(now_s)));
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
    #[inline(always)]
    fn switch(&mut self, signals: StrutValves<bool>) {
        if Valve::ALL
            .into_iter()
            .any(|valve| signals[valve] != self.valves[valve].signal())
        {
            self.begin_movements(signals);
        }
    }

    #[cold]
    #[inline(never)]
    fn begin_movements(&mut self, signals: StrutValves<bool>) {
        let [p1, p2, p3, p4] = self.flowing.pressure_pa;
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
        self.settled_s = settled_s(&self.valves);
    }

    /// Notes from now on what the rod goes through.
    pub(super) fn begin_course(&mut self) {
        self.course = Some(Box::default());
    }

    /// Notes a sample.
    pub(super) fn note_sample(&mut self) {
        if self.course.is_some() {
            let rod = self.rod_state();
            if let Some(course) = &mut self.course {
                course.push_sample(rod);
            }
        }
    }

    /// What the rod went through, if it was noted.
    pub(super) fn into_course(self) -> Option<RodCourse> {
        self.course.map(|course| *course)
    }

    /// Openings at two times, the later one last.
    #[inline(always)]
    fn openings_at_both(&self, first_s: f64, second_s: f64) -> [StrutValves<f64>; 2] {
        if first_s.min(second_s) < self.settled_s {
            [self.openings_at(first_s), self.openings_at(second_s)]
        } else {
            let [valve_1, valve_2, valve_3] = self.valves.as_array();
            let settled = StrutValves::new(
                valve_1.settled_opening(),
                valve_2.settled_opening(),
                valve_3.settled_opening(),
            );
            [settled, settled]
        }
    }

    #[inline(always)]
    fn openings_at(&self, time_s: f64) -> StrutValves<f64> {
        let [valve_1, valve_2, valve_3] = self.valves.as_array();
        StrutValves::new(
            valve_1.opening(time_s),
            valve_2.opening(time_s),
            valve_3.opening(time_s),
        )
    }

    #[inline(always)]
    fn rod_state(&self) -> RodState {
        let [p1_pa, ..] = self.flowing.pressure_pa;
        RodState {
            displacement_m: self.actuator_m,
            speed_m_s: self.speed_m_s,
            acceleration: self.acceleration,
            p1_pa,
            oil_force_n: self.hydraulics.network.chamber.area_m2 * p1_pa,
            time_s: self.time_s,
        }
    }

    /// Force and pressures now.
    #[inline]
    #[must_use]
    pub fn output(&self) -> StrutOutput {
        StrutOutput {
            force_n: self.rod.total_n(&self.rod_state()),
            pressure_pa: self.flowing.pressure_pa,
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
        self.flowing.last.flow
    }

    /// Gas states of accumulators 1 and 2.
    #[must_use]
    pub fn gas(&self) -> [GasState; 2] {
        self.flowing.state.gas
    }
}
