//! What is driven, how it ended, and what was seen on the way.
//!
//! A run is a model, a manoeuvre and a source of valve signals; it gives an [`Ending`] and a [`History`] at the
//! controller's tick. Roll-over, spinning and hit cones are outcomes. Only a model that leaves the real numbers is a failure.

use oleo_interface::tick::TICK_S;
use oleo_interface::{Axle, Corners, StrutValves};

use super::driver::Driver;
use super::model::HandlingModel;
use super::motion::Controls;
use super::parameters::HandlingParameters;
use super::track::Track;
use crate::vehicle::suspension::SuspensionElement;
use crate::vehicle::{SeatAcceleration, Seats, VehicleParameters};

/// Side slip beyond which the vehicle has spun, rad: 45 degrees.
const SPUN_RAD: f64 = core::f64::consts::FRAC_PI_4;
/// Off the line by this much, the manoeuvre is lost, m.
const LOST_M: f64 = 15.0;

/// What is driven.
#[derive(Debug, Clone, PartialEq)]
pub enum Manoeuvre {
    /// Follow a track at constant speed; tracks without an end take `duration_s`.
    Follow {
        /// The line and cones.
        track: Track,
        /// m/s.
        speed_m_s: f64,
        /// Longest time, s.
        duration_s: f64,
    },
    /// ISO 4138, constant radius: follow a circle while the speed rises evenly.
    ConstantRadius {
        /// Positive turns left, m.
        radius_m: f64,
        /// Speed at the start, m/s.
        from_m_s: f64,
        /// Speed at the end, m/s.
        to_m_s: f64,
        /// Time between, s.
        duration_s: f64,
    },
    /// ISO 7401, step of steer at constant speed: after `at_s` to `angle_rad` at the steering's highest rate.
    StepSteer {
        /// m/s.
        speed_m_s: f64,
        /// At the road wheels, rad, left positive.
        angle_rad: f64,
        /// Begin of the step, s.
        at_s: f64,
        /// In all, s.
        duration_s: f64,
    },
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Ending {
    /// To the end.
    Completed,
    /// The body lay on its side or beyond at this time, s.
    RolledOver(f64),
    /// It slid 45 degrees from its heading, s.
    Spun(f64),
    /// It was too far off the line, s.
    LostTrack(f64),
}

impl Ending {
    /// One word for tables.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Completed => "completed",
            Self::RolledOver(_) => "rolled over",
            Self::Spun(_) => "spun",
            Self::LostTrack(_) => "lost the track",
        }
    }
}

/// One instant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[allow(missing_docs)]
pub struct Sample {
    pub time_s: f64,
    pub station_m: f64,
    pub lateral_m: f64,
    pub heave_m: f64,
    pub yaw_rad: f64,
    pub pitch_rad: f64,
    pub roll_rad: f64,
    pub speed_m_s: f64,
    pub side_slip_rad: f64,
    pub yaw_rate_rad_s: f64,
    pub lateral_acceleration_m_s2: f64,
    pub vertical_acceleration_m_s2: f64,
    pub steer_rad: f64,
    pub wheel_load_n: Corners<f64>,
    pub strut_displacement_m: Corners<f64>,
    pub strut_force_n: Corners<f64>,
    pub seat: Seats<SeatAcceleration>,
    pub front_axle_heave_m: f64,
    pub front_axle_roll_rad: f64,
    /// Switching signals of the valves, `true` open; all closed for a suspension that has none.
    pub valves: Signals,
}

/// Switching signals of the twelve valves.
pub type Signals = Corners<StrutValves<bool>>;

/// Samples at the tick.
pub type History = Vec<Sample>;

/// A run's result.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// How it ended.
    pub ending: Ending,
    /// At every tick, from the start.
    pub history: History,
    /// Least room to the cones, m; negative where some were hit; `None` without cones.
    pub cone_margin_m: Option<f64>,
    /// Largest body roll, rad; a roll-over counts as it ended.
    pub max_roll_rad: f64,
    /// Largest lateral acceleration, m/s2.
    pub max_lateral_m_s2: f64,
    /// Time that any wheel was off the ground, s.
    pub wheel_lift_s: f64,
}

/// The model left the real numbers: a defect of model or parameters, not of driving.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("the vehicle's motion is not finite at {time_s:.3} s: take a smaller [solver] step_s or check the parameters")]
pub struct NotFinite {
    /// s.
    pub time_s: f64,
}

impl Manoeuvre {
    fn duration_s(&self) -> f64 {
        match self {
            Self::Follow { duration_s, .. }
            | Self::ConstantRadius { duration_s, .. }
            | Self::StepSteer { duration_s, .. } => *duration_s,
        }
    }

    /// Speed at the start, m/s.
    pub fn initial_speed_m_s(&self) -> f64 {
        match self {
            Self::Follow { speed_m_s, .. } | Self::StepSteer { speed_m_s, .. } => *speed_m_s,
            Self::ConstantRadius { from_m_s, .. } => *from_m_s,
        }
    }

    /// Drives `model` to the end. `signals` is asked at every tick of 5 ms for the suspension's signals and for the valves'
    /// signals to record; `every_step` sees each step (for filters that need the full rate).
    ///
    /// # Errors
    /// [`NotFinite`].
    pub fn drive<E: SuspensionElement>(
        &self,
        model: &mut HandlingModel<E>,
        parameters: &VehicleParameters,
        handling: &HandlingParameters,
        mut signals: impl FnMut(&HandlingModel<E>) -> (Corners<E::Signal>, Signals),
        mut every_step: impl FnMut(&HandlingModel<E>),
    ) -> Result<Run, NotFinite> {
        let circle;
        let track = match self {
            Self::Follow { track, .. } => track,
            Self::ConstantRadius { radius_m, .. } => {
                circle = Track::circle(*radius_m);
                &circle
            }
            Self::StepSteer { .. } => {
                circle = Track::straight();
                &circle
            }
        };
        let h = model.step_s();
        let steps_a_tick = (TICK_S / h).round().max(1.0) as u64;
        let ticks = (self.duration_s() / TICK_S).round() as u64;
        let mut driver = Driver::new(handling, parameters.layout.wheelbase_m);
        let seats = Seats::from_fn(|seat| parameters.seat_place_m(seat));
        let mut run = Run {
            ending: Ending::Completed,
            history: Vec::with_capacity(ticks as usize + 1),
            cone_margin_m: None,
            max_roll_rad: 0.0,
            max_lateral_m_s2: 0.0,
            wheel_lift_s: 0.0,
        };
        for _ in 0..ticks {
            let (signal, valves) = signals(model);
            run.note(model, seats, valves, track, parameters, handling);
            if let Some(ending) = run.over(self, track) {
                run.ending = ending;
                return Ok(run);
            }
            if !run
                .history
                .last()
                .is_some_and(|s| (s.heave_m + s.yaw_rad + s.roll_rad + s.lateral_m).is_finite())
            {
                return Err(NotFinite { time_s: model.time_s() });
            }
            if track.end_m().is_some_and(|end_m| model.motion().position_m[0] > end_m) {
                return Ok(run);
            }
            for _ in 0..steps_a_tick {
                let controls = self.controls(model, &mut driver, track, h);
                model.step(signal, controls);
                every_step(model);
            }
        }
        let (_, valves) = signals(model);
        run.note(model, seats, valves, track, parameters, handling);
        if let Some(ending) = run.over(self, track) {
            run.ending = ending;
        }
        Ok(run)
    }

    fn controls<E: SuspensionElement>(
        &self,
        model: &HandlingModel<E>,
        driver: &mut Driver,
        track: &Track,
        step_s: f64,
    ) -> Controls {
        let motion = model.motion();
        let time_s = model.time_s();
        match self {
            Self::Follow { speed_m_s, .. } => driver.follow(&motion, track, *speed_m_s, step_s),
            Self::ConstantRadius {
                from_m_s,
                to_m_s,
                duration_s,
                ..
            } => {
                let speed = from_m_s + (to_m_s - from_m_s) * (time_s / duration_s);
                driver.follow(&motion, track, speed, step_s)
            }
            Self::StepSteer {
                speed_m_s,
                angle_rad,
                at_s,
                ..
            } => Controls {
                steer_rad: if time_s >= *at_s { *angle_rad } else { 0.0 },
                ..driver.hold_speed(&motion, *speed_m_s, step_s)
            },
        }
    }
}

impl Run {
    fn note<E: SuspensionElement>(
        &mut self,
        model: &HandlingModel<E>,
        seats: Seats<[f64; 3]>,
        valves: Signals,
        track: &Track,
        parameters: &VehicleParameters,
        handling: &HandlingParameters,
    ) {
        let motion = model.motion();
        let wheels = model.wheels();
        let (front_axle_heave_m, front_axle_roll_rad) = model.axle_heave_roll(Axle::Front);
        let sample = Sample {
            time_s: model.time_s(),
            station_m: motion.position_m[0],
            lateral_m: motion.position_m[1],
            heave_m: motion.position_m[2],
            yaw_rad: motion.yaw_rad,
            pitch_rad: motion.pitch_rad,
            roll_rad: motion.roll_rad,
            speed_m_s: motion.speed_m_s,
            side_slip_rad: motion.side_slip_rad,
            yaw_rate_rad_s: motion.rates_rad_s[2],
            lateral_acceleration_m_s2: motion.lateral_acceleration_m_s2,
            vertical_acceleration_m_s2: motion.vertical_acceleration_m_s2,
            steer_rad: model.steer_rad(),
            wheel_load_n: wheels.map(|wheel| wheel.load_n),
            strut_displacement_m: model.strut_displacement_m(),
            strut_force_n: model.suspension_force_n(),
            seat: seats.map(|place| model.acceleration_at(place)),
            front_axle_heave_m,
            front_axle_roll_rad,
            valves,
        };
        self.max_roll_rad = self.max_roll_rad.max(sample.roll_rad.abs());
        self.max_lateral_m_s2 = self.max_lateral_m_s2.max(sample.lateral_acceleration_m_s2.abs());
        if !self.history.is_empty() && sample.wheel_load_n.values().any(|load| *load <= 0.0) {
            self.wheel_lift_s += TICK_S;
        }
        let (sin, cos) = libm::sincos(motion.yaw_rad);
        let nose = parameters.body_cg_behind_front_axle_m() + handling.outline.front_overhang_m;
        let tail =
            nose - parameters.layout.wheelbase_m - handling.outline.front_overhang_m - handling.outline.rear_overhang_m;
        let half_width = 0.5 * parameters.layout.width_m;
        for (along, across) in [
            (nose, half_width),
            (nose, -half_width),
            (tail, half_width),
            (tail, -half_width),
        ] {
            let x = sample.station_m + along * cos - across * sin;
            let y = sample.lateral_m + along * sin + across * cos;
            if let Some(margin) = track.margin_m(x, y) {
                self.cone_margin_m = Some(self.cone_margin_m.map_or(margin, |worst| worst.min(margin)));
            }
        }
        self.history.push(sample);
    }

    /// The ending, once the last sample has one.
    fn over(&self, manoeuvre: &Manoeuvre, track: &Track) -> Option<Ending> {
        let last = self.history.last()?;
        let time_s = last.time_s;
        if last.roll_rad.abs() >= core::f64::consts::FRAC_PI_2 {
            return Some(Ending::RolledOver(time_s));
        }
        if last.side_slip_rad.abs() >= SPUN_RAD || last.speed_m_s < -0.5 {
            return Some(Ending::Spun(time_s));
        }
        let guided = !matches!(manoeuvre, Manoeuvre::StepSteer { .. });
        (guided && track.error_m(last.station_m, last.lateral_m).abs() > LOST_M).then_some(Ending::LostTrack(time_s))
    }
}
