//! Drives a vehicle along a course tick by tick, so that it can be the plant of a loop.
//!
//! ```text
//!  valves' signals --> tick: 5 ms of driver, vehicle and road --> sample: everything measured; ending, once there is one
//! ```
//!
//! Time passes only in [`Drive::tick`], and the driver is in here: a caller that decides valves needs to know neither
//! manoeuvre nor road.

use std::sync::Arc;

use oleo_interface::tick::TICK_S;
use oleo_interface::{Axle, Corners};

use super::manoeuvre::{Manoeuvre, Phase};
use super::optimal_preview::OptimalPreviewDriver;
use super::preview::PreviewDriver;
use super::sample::{Sample, Signals};
use super::speed::SpeedControl;
use super::style::DriverStyle;
use super::track::Track;
use super::{Course, Ending};
use crate::handling::{Controls, HandlingModel, HandlingMotion, HandlingParameters};
use crate::vehicle::suspension::SuspensionElement;
use crate::vehicle::{RideError, Seats, VehicleParameters};

/// Side slip beyond which the vehicle has spun, rad: 45 degrees.
const SPUN_RAD: f64 = core::f64::consts::FRAC_PI_4;
/// Off the line by this much, the manoeuvre is lost, m.
const LOST_M: f64 = 15.0;
/// Slower than this after braking, it stands, m/s.
const STANDING_M_S: f64 = 0.3;

/// The model left the real numbers: a defect of model or parameters, not of driving.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("the vehicle's motion is not finite at {time_s:.3} s: take a smaller [solver] step_s or check the parameters")]
pub struct NotFinite {
    /// Time at which it was noticed, s.
    pub time_s: f64,
}

/// A vehicle with its driver on a course.
pub struct Drive<E: SuspensionElement> {
    model: HandlingModel<E>,
    /// Its motion now, which is asked for many times a step.
    motion: HandlingMotion,
    manoeuvre: Manoeuvre,
    track: Track,
    driver: Driver,
    handling: HandlingParameters,
    mass_kg: f64,
    seats: Seats<[f64; 3]>,
    /// Corners of the body's outline, ahead and left of the centre of mass, m.
    outline_m: [[f64; 2]; 4],
    steps_a_tick: u32,
    ticks: u32,
    last_tick: u32,
}

impl<E: SuspensionElement> Drive<E> {
    /// Puts a vehicle on four suspension elements at the start of a course, rolling straight ahead.
    ///
    /// # Errors
    /// A suspension that would not carry the vehicle; a speed that is not one.
    pub fn begin(
        course: &Course,
        vehicle: &VehicleParameters,
        handling: &HandlingParameters,
        elements: Corners<E>,
    ) -> Result<Self, RideError> {
        let manoeuvre = course.manoeuvre;
        let track = course.track(vehicle);
        let speed_m_s = manoeuvre.initial_speed_m_s();
        let model = HandlingModel::with_elements(vehicle, handling, elements, Arc::clone(&course.road), speed_m_s)?;
        let duration_s = manoeuvre.duration_s(&track);
        Ok(Self {
            steps_a_tick: (TICK_S / model.step_s()).round().max(1.0) as u32,
            driver: Driver::new(course.driver, manoeuvre, vehicle, handling),
            handling: handling.clone(),
            mass_kg: vehicle.total_mass_kg(),
            seats: Seats::from_fn(|seat| vehicle.seat_place_m(seat)),
            outline_m: handling.outline.corners_m(vehicle),
            ticks: 0,
            last_tick: (duration_s / TICK_S).round() as u32,
            motion: model.motion(),
            model,
            manoeuvre,
            track,
        })
    }

    /// Drives on for a tick of 5 ms. `signals` go to the suspension; `every_step` sees each integration step, for filters that
    /// need the full rate.
    ///
    /// # Errors
    /// [`NotFinite`].
    pub fn tick(
        &mut self,
        signals: Corners<E::Signal>,
        mut every_step: impl FnMut(&HandlingModel<E>),
    ) -> Result<(), NotFinite> {
        let step_s = self.model.step_s();
        for _ in 0..self.steps_a_tick {
            let controls = self.controls(step_s);
            self.model.step(signals, controls);
            self.motion = self.model.motion();
            every_step(&self.model);
        }
        self.ticks += 1;
        let motion = self.motion;
        let [_, lateral_m, heave_m] = motion.position_m;
        if (heave_m + lateral_m + motion.yaw_rad + motion.roll_rad).is_finite() {
            Ok(())
        } else {
            Err(NotFinite {
                time_s: self.model.time_s(),
            })
        }
    }

    fn controls(&mut self, step_s: f64) -> Controls {
        let motion = self.motion;
        let time_s = self.model.time_s();
        let drive = &self.handling.drive;
        let speed_m_s = motion.speed_m_s;
        let steer_rad = match self.manoeuvre {
            Manoeuvre::StepSteer { angle_rad, at_s, .. } => {
                if time_s >= at_s {
                    angle_rad
                } else {
                    0.0
                }
            }
            _ if self.manoeuvre.is_guided(time_s) => self.driver.steer(&motion, &self.track, step_s),
            _ => self.model.steer_rad(),
        };
        let pedals = match self.manoeuvre {
            Manoeuvre::ConstantRadius {
                from_m_s,
                to_m_s,
                duration_s,
                ..
            } => {
                let wanted = from_m_s + (to_m_s - from_m_s) * (time_s / duration_s);
                self.driver.speed.hold(drive, speed_m_s, wanted, step_s)
            }
            Manoeuvre::Braking {
                deceleration_m_s2,
                at_s,
                ..
            } if time_s >= at_s => Controls {
                brake_force_n: (self.mass_kg * deceleration_m_s2).min(drive.max_brake_force_n),
                ..Controls::default()
            },
            Manoeuvre::Acceleration {
                acceleration_m_s2,
                at_s,
                ..
            } if time_s >= at_s => Controls {
                drive_force_n: (self.mass_kg * acceleration_m_s2).min(drive.most_n(speed_m_s)),
                ..Controls::default()
            },
            _ => {
                let wanted = self.manoeuvre.initial_speed_m_s();
                self.driver.speed.hold(drive, speed_m_s, wanted, step_s)
            }
        };
        Controls { steer_rad, ..pedals }
    }

    /// How the drive has ended, if it has.
    pub fn ending(&self) -> Option<Ending> {
        let motion = self.motion;
        let time_s = self.model.time_s();
        if motion.roll_rad.abs() >= core::f64::consts::FRAC_PI_2 {
            return Some(Ending::RolledOver(time_s));
        }
        if motion.side_slip_rad.abs() >= SPUN_RAD || motion.speed_m_s < -0.5 {
            return Some(Ending::Spun(time_s));
        }
        let [station_m, lateral_m, _] = motion.position_m;
        if self.manoeuvre.is_guided(time_s) && self.track.error_m(station_m, lateral_m).abs() > LOST_M {
            return Some(Ending::LostTrack(time_s));
        }
        let past = self.manoeuvre.ends_behind_cones() && self.is_behind_cones();
        let stands = matches!(self.manoeuvre, Manoeuvre::Braking { at_s, .. } if time_s > at_s)
            && motion.speed_m_s < STANDING_M_S;
        (past || stands || self.ticks >= self.last_tick).then_some(Ending::Completed)
    }

    fn is_behind_cones(&self) -> bool {
        let [station_m, ..] = self.motion.position_m;
        self.track.end_m().is_some_and(|end_m| station_m > end_m)
    }

    /// Where in the manoeuvre the vehicle is; `None` where the manoeuvre has no cornering.
    pub fn phase(&self) -> Option<Phase> {
        let from_s = self.manoeuvre.corners_from_s()?;
        Some(if self.is_behind_cones() {
            Phase::After
        } else if self.model.time_s() >= from_s {
            Phase::Cornering
        } else {
            Phase::Before
        })
    }

    /// How far the body's centre of mass is from the line that the driver follows, m, positive where it is right of the line;
    /// `None` while the steering wheel is held.
    pub fn path_deviation_m(&self) -> Option<f64> {
        let [station_m, lateral_m, _] = self.motion.position_m;
        (self.manoeuvre.is_guided(self.model.time_s())).then(|| self.track.error_m(station_m, lateral_m))
    }

    /// The line and its cones.
    pub fn track(&self) -> &Track {
        &self.track
    }

    /// Everything measured now; `valves` are the signals that hold from now on.
    pub fn sample(&self, valves: Signals) -> Sample {
        let model = &self.model;
        let motion = self.motion;
        let (front_axle_heave_m, front_axle_roll_rad) = model.axle_heave_roll(Axle::Front);
        Sample {
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
            longitudinal_acceleration_m_s2: motion.longitudinal_acceleration_m_s2,
            lateral_acceleration_m_s2: motion.lateral_acceleration_m_s2,
            vertical_acceleration_m_s2: motion.vertical_acceleration_m_s2,
            steer_rad: model.steer_rad(),
            wheel_steer_rad: model.wheel_steer_rad(Axle::Front),
            wheel_load_n: model.wheels().map(|wheel| wheel.load_n),
            strut_displacement_m: model.strut_displacement_m(),
            strut_force_n: model.suspension_force_n(),
            seat: self.seats.map(|place| model.acceleration_at(place)),
            front_axle_heave_m,
            front_axle_roll_rad,
            valves,
        }
    }

    /// Corners of the body's outline, ahead and left of the centre of mass, m.
    pub fn outline_m(&self) -> [[f64; 2]; 4] {
        self.outline_m
    }

    /// Room between the body's outline and the nearest cones beside it now, m; negative where one is hit; `None` where there
    /// are none.
    pub fn cone_margin_m(&self) -> Option<f64> {
        let motion = self.motion;
        let (sin, cos) = libm::sincos(motion.yaw_rad);
        let [x, y, _] = motion.position_m;
        let margins = self.outline_m.iter().filter_map(|[along, across]| {
            self.track
                .margin_m(x + along * cos - across * sin, y + along * sin + across * cos)
        });
        margins.reduce(f64::min)
    }

    /// The vehicle model that drives.
    pub fn model(&self) -> &HandlingModel<E> {
        &self.model
    }

    /// Number of ticks of 5 ms that were driven.
    pub fn ticks(&self) -> u32 {
        self.ticks
    }

    /// Ticks that the course takes at most.
    pub fn most_ticks(&self) -> u32 {
        self.last_tick
    }

    /// Places of the seats in body axes from the body's centre of mass, m.
    pub fn seat_places_m(&self) -> Seats<[f64; 3]> {
        self.seats
    }
}

/// Hands and foot of the driver.
struct Driver {
    hands: Hands,
    speed: SpeedControl,
}

enum Hands {
    Preview(PreviewDriver),
    Optimal(Box<OptimalPreviewDriver>),
}

impl Driver {
    fn new(
        style: DriverStyle,
        manoeuvre: Manoeuvre,
        vehicle: &VehicleParameters,
        handling: &HandlingParameters,
    ) -> Self {
        // In a long bend the report's driver has an integral that keeps to the circle; the other one is for lane changes.
        let hands = match style {
            DriverStyle::Hard if manoeuvre.radius_m().is_none() => {
                Hands::Optimal(Box::new(OptimalPreviewDriver::new(vehicle, handling)))
            }
            _ => Hands::Preview(PreviewDriver::new(&handling.driver, vehicle.layout.wheelbase_m)),
        };
        Self {
            hands,
            speed: SpeedControl::default(),
        }
    }

    fn steer(&mut self, motion: &HandlingMotion, track: &Track, step_s: f64) -> f64 {
        match &mut self.hands {
            Hands::Preview(driver) => driver.steer(motion, track, step_s),
            Hands::Optimal(driver) => driver.steer(motion, track, step_s),
        }
    }
}

#[cfg(test)]
mod tests;
